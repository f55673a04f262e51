//! A model and the models attached to it: each keeps its own settings and default classes.

use super::super::xml::XmlText;
use super::compiler::Compiler;
use super::defaults::{Defaults, Settled};
use super::element::{Element, load};
use crate::error::Result;
use crate::robot::model::Pose;
use std::path::Path;

/// Models within models; more than any robot has.
const DEEPEST: usize = 8;

/// Attributes that name bodies and joints.
const NAMES: [&str; 7] = ["name", "joint", "joint1", "joint2", "jointinparent", "body1", "body2"];

/// A default class of the bodies around an element, and the model it belongs to.
pub(super) type Class<'a> = Option<(&'a str, usize)>;

/// All models, the main one first.
pub(super) struct Models(Vec<(Compiler, Defaults)>);

impl Models {
    /// The settings and classes of a model and of all it attaches, which are put in their places.
    ///
    /// # Errors
    /// If a setting is unknown, or an attached model cannot be read.
    pub(super) fn of(root: &mut Element) -> Result<Self> {
        let mut models = Models(Vec::new());
        models.add(root, 0)?;
        Ok(models)
    }

    fn add(&mut self, root: &mut Element, depth: usize) -> Result<()> {
        let own = self.0.len();
        root.belong_to(own);
        self.0.push((Compiler::of(root)?, Defaults::of(root)));
        let files: Vec<Element> = root.all("asset").flat_map(|asset| asset.all("model")).cloned().collect();
        let mut sections = Vec::new();
        self.attach(root, &files, depth, &mut sections)?;
        root.children.extend(sections);
        Ok(())
    }

    /// Puts a frame with the attached bodies in the place of each `<attach>`, and hands back the sections that go with them.
    fn attach(
        &mut self,
        element: &mut Element,
        files: &[Element],
        depth: usize,
        sections: &mut Vec<Element>,
    ) -> Result<()> {
        for child in &mut element.children {
            if child.tag != "attach" {
                self.attach(child, files, depth, sections)?;
                continue;
            }
            let named = |file: &&Element| file.get("name").is_some() && file.get("name") == child.get("model");
            let Some(name) = files.iter().find(named).and_then(|file| file.get("file")) else {
                return Err(child.error("it attaches a model that no <model> of <asset> names"));
            };
            if depth >= DEEPEST {
                return Err(child.error("models are attached to each other in a circle; take one out"));
            }
            let path = child.file.parent().unwrap_or(Path::new("")).join(name.replace('\\', "/"));
            if !path.is_file() {
                return Err(child.error(format!("the attached file {name} is not there; copy it next to this one")));
            }
            let mut root = load(&XmlText::read(&path, "the MuJoCo model")?)?;
            self.add(&mut root, depth + 1)?;
            root.prefix(child.get("prefix").unwrap_or_default(), &NAMES);
            let wanted = child.get("body").map(|body| format!("{}{body}", child.get("prefix").unwrap_or_default()));
            let bodies: Vec<Element> = match wanted {
                Some(body) => root.find("body", &body).cloned().into_iter().collect(),
                None => root.all("worldbody").flat_map(|world| world.children.clone()).collect(),
            };
            if bodies.is_empty() {
                return Err(child.error(format!("there is nothing to attach in {name}")));
            }
            sections
                .extend(root.children.into_iter().filter(|part| ["actuator", "equality"].contains(&part.tag.as_str())));
            "frame".clone_into(&mut child.tag);
            child.children = bodies;
        }
        Ok(())
    }

    /// The settings of the model that an element belongs to.
    pub(super) fn compiler(&self, element: &Element) -> &Compiler {
        &self.0[element.model].0
    }

    /// The settings of the main model.
    pub(super) fn main(&self) -> &Compiler {
        &self.0[0].0
    }

    /// Angles that were taken as multiples of 15 degrees, in all models.
    pub(super) fn rounded(&self) -> usize {
        self.0.iter().map(|(compiler, _)| compiler.rounded.get()).sum()
    }

    /// An element with its defaults.
    ///
    /// # Errors
    /// If its class is not there.
    pub(super) fn settled<'a>(&'a self, element: &'a Element, class: Class<'a>) -> Result<Settled<'a>> {
        let class = class.filter(|(_, model)| *model == element.model).map(|(class, _)| class);
        self.0[element.model].1.apply(element, class)
    }

    /// The pose of an element that has no defaults.
    ///
    /// # Errors
    /// See [`Compiler::pose`].
    pub(super) fn pose(&self, element: &Element) -> Result<Pose> {
        self.compiler(element).pose(&Settled::plain(element))
    }
}

/// The class of the elements within an element, where that of the bodies around it is `outer`.
pub(super) fn class_within<'a>(element: &'a Element, outer: Class<'a>) -> Class<'a> {
    element.get("childclass").map(|class| (class, element.model)).or(outer)
}
