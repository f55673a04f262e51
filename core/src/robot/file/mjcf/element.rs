//! The elements of a MuJoCo model, with the files it includes in their places.

use super::super::xml::{XmlText, line};
use crate::error::{Error, Result};
use crate::robot::model::LARGEST;
use roxmltree::Node;
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// Elements within elements; bodies of a robot hang on each other less often than this.
const DEEPEST: usize = 256;

/// Files that include each other; MuJoCo allows no file twice, and no model needs as many in a row.
const MOST_INCLUDES: usize = 32;

/// Attributes of drives and ranges, which no geometry depends on: a number beyond any machine's is the reader's to judge.
const OF_DRIVES: [&str; 10] = [
    "damping",
    "frictionloss",
    "armature",
    "stiffness",
    "range",
    "actuatorfrcrange",
    "forcerange",
    "ctrlrange",
    "gear",
    "gainprm",
];

/// An element.
#[derive(Debug, Clone)]
pub(super) struct Element {
    /// Its name.
    pub tag: String,
    /// Its attributes, trimmed; empty ones are left out.
    attributes: Vec<(String, String)>,
    /// The elements within it.
    pub children: Vec<Element>,
    /// The file it stands in.
    pub file: Rc<Path>,
    /// Its line, counted from 1.
    pub line: usize,
    /// Which of the models attached to each other it belongs to.
    pub model: usize,
}

/// The root element of a model.
///
/// # Errors
/// If a file cannot be read, is no XML, is nested too deep, or includes itself.
pub(super) fn load(source: &XmlText) -> Result<Element> {
    let folder = source.path.parent().unwrap_or(Path::new("")).to_owned();
    let mut root = of_text(source, &folder, &mut Vec::new())?;
    root.pop().ok_or_else(|| Error::input(&source.path, None, "<mujoco>", "there is no element"))
}

/// The root element of a text as the only member of a list.
fn of_text(source: &XmlText, folder: &Path, open: &mut Vec<PathBuf>) -> Result<Vec<Element>> {
    let path = &source.path;
    if open.len() >= MOST_INCLUDES || open.contains(path) {
        return Err(Error::input(path, None, "<include>", "the file is included by itself; take the inner one out"));
    }
    let document = source.parse()?;
    open.push(path.clone());
    let elements = Reader { file: path.as_path().into(), folder }.elements(&document.root_element(), 0, open);
    open.pop();
    elements
}

struct Reader<'a> {
    file: Rc<Path>,
    folder: &'a Path,
}

impl Reader<'_> {
    /// An element; for an `<include>` the elements of the file it names.
    fn elements(&self, node: &Node, depth: usize, open: &mut Vec<PathBuf>) -> Result<Vec<Element>> {
        let refuse = |problem: String| Err(Error::input(&*self.file, Some(line(node)), tag_of(node), problem));
        if depth > DEEPEST {
            return refuse(format!("elements are nested more than {DEEPEST} times; is this a robot?"));
        }
        if node.has_tag_name("include") {
            let Some(name) = node.attribute("file").map(str::trim).filter(|name| !name.is_empty()) else {
                return refuse("it names no file; add file=\"...\"".to_owned());
            };
            let name = &name.replace('\\', "/");
            // MuJoCo looks from the folder of the main file, and from that of the including one.
            let own = self.file.parent().unwrap_or(Path::new("")).join(name);
            let path = Some(self.folder.join(name)).filter(|path| path.is_file()).unwrap_or(own);
            if !path.is_file() {
                return refuse(format!("the included file {name} is not there; copy it next to this one"));
            }
            let root = of_text(&XmlText::read(&path, "the MuJoCo model")?, self.folder, open)?;
            return Ok(root.into_iter().flat_map(|root| root.children).collect());
        }
        let mut children = Vec::new();
        for child in node.children().filter(Node::is_element) {
            children.extend(self.elements(&child, depth + 1, open)?);
        }
        let attributes = node.attributes().map(|a| (a.name().to_owned(), a.value().trim().to_owned()));
        Ok(vec![Element {
            tag: node.tag_name().name().to_owned(),
            attributes: attributes.filter(|(_, value)| !value.is_empty()).collect(),
            children,
            file: Rc::clone(&self.file),
            line: line(node),
            model: 0,
        }])
    }
}

fn tag_of(node: &Node) -> String {
    format!("<{}>", node.tag_name().name())
}

impl Element {
    /// The value of an attribute.
    pub(super) fn get(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(own, _)| own == name).map(|(_, value)| value.as_str())
    }

    /// All attributes.
    pub(super) fn attributes(&self) -> impl Iterator<Item = (&str, &str)> {
        self.attributes.iter().map(|(name, value)| (name.as_str(), value.as_str()))
    }

    /// Sets the model that this element and all within it belong to.
    pub(super) fn belong_to(&mut self, model: usize) {
        self.model = model;
        self.children.iter_mut().for_each(|child| child.belong_to(model));
    }

    /// Puts a prefix before the values of attributes, here and in all elements within.
    pub(super) fn prefix(&mut self, prefix: &str, names: &[&str]) {
        for (_, value) in self.attributes.iter_mut().filter(|(name, _)| names.contains(&name.as_str())) {
            value.insert_str(0, prefix);
        }
        self.children.iter_mut().for_each(|child| child.prefix(prefix, names));
    }

    /// Puts a suffix behind the values of attributes, here and in all elements within.
    pub(super) fn suffix(&mut self, suffix: &str, names: &[&str]) {
        for (_, value) in self.attributes.iter_mut().filter(|(name, _)| names.contains(&name.as_str())) {
            value.push_str(suffix);
        }
        self.children.iter_mut().for_each(|child| child.suffix(suffix, names));
    }

    /// An empty frame in the place of this element; attributes without a value are left out.
    pub(super) fn frame(&self, attributes: &[(&str, &str)]) -> Element {
        let given = attributes.iter().filter(|(_, value)| !value.is_empty());
        Element {
            tag: "frame".to_owned(),
            attributes: given.map(|&(name, value)| (name.to_owned(), value.to_owned())).collect(),
            children: Vec::new(),
            file: Rc::clone(&self.file),
            line: self.line,
            model: self.model,
        }
    }

    /// Number of elements within this one.
    pub(super) fn size(&self) -> usize {
        self.children.iter().map(|child| 1 + child.size()).sum()
    }

    /// The first element of a kind and name within this one.
    pub(super) fn find(&self, tag: &str, name: &str) -> Option<&Element> {
        if self.tag == tag && self.get("name") == Some(name) {
            return Some(self);
        }
        self.children.iter().find_map(|child| child.find(tag, name))
    }

    /// All children of this name.
    pub(super) fn all(&self, tag: &'static str) -> impl Iterator<Item = &Element> {
        self.children.iter().filter(move |child| child.tag == tag)
    }

    /// The first child of this name.
    pub(super) fn first(&self, tag: &'static str) -> Option<&Element> {
        self.children.iter().find(|child| child.tag == tag)
    }

    /// The error that something is wrong with this element.
    pub(super) fn error(&self, problem: impl Into<String>) -> Error {
        let name = self.get("name").map_or(String::new(), |name| format!(" `{name}`"));
        Error::input(&*self.file, Some(self.line), format!("<{}>{name}", self.tag), problem)
    }

    /// Numbers in a text that belongs to this element; `least` to `most` of them.
    ///
    /// # Errors
    /// If there are fewer or more, or one is malformed, not finite or, but for those of drives, beyond 1e9.
    pub(super) fn numbers(&self, name: &str, text: &str, [least, most]: [usize; 2]) -> Result<Vec<f64>> {
        let words: Vec<&str> = text.split_whitespace().collect();
        if words.len() < least || words.len() > most {
            let wanted = if least == most { least.to_string() } else { format!("{least} to {most}") };
            return Err(self.error(format!("{name}=\"{text}\" must be {wanted} number(s), found {}", words.len())));
        }
        let number = |word: &&str| match word.parse::<f64>() {
            Ok(value) if value.abs() <= LARGEST || (value.is_finite() && OF_DRIVES.contains(&name)) => Ok(value),
            Ok(value) if value.is_finite() => {
                Err(self.error(format!("{name}: {word} is no arm's; numbers go up to {LARGEST:e}")))
            }
            _ => Err(self.error(format!("{name}: \"{word}\" must be a finite number"))),
        };
        words.iter().map(number).collect()
    }
}
