//! `<replicate>`: bodies that a model repeats along a line, a circle or a helix, each written out.

use super::defaults::Settled;
use super::element::Element;
use super::models::Models;
use crate::error::Result;
use nalgebra::Vector3;

/// Copies of one `<replicate>`; no robot has as many parts of a kind.
const MOST_COPIES: usize = 1000;

/// Elements that all copies together may have; no robot has as many.
const MOST_ELEMENTS: usize = 100_000;

/// Attributes of drives and equalities that name joints, and those that name bodies.
const REFERENCES: [(&str, bool); 6] =
    [("joint", true), ("jointinparent", true), ("joint1", true), ("joint2", true), ("body1", false), ("body2", false)];

/// Elements that belong in a body.
const OF_BODIES: [&str; 3] = ["joint", "freejoint", "inertial"];

/// Puts the copies in the place of every `<replicate>`, each in a frame of its own and with a number behind its names, and repeats the
/// drives and equalities of what is repeated. Hands back what is worth a note.
///
/// # Errors
/// If a count is missing or malformed, or something stands in a `<replicate>` that belongs in a body.
pub(super) fn expand(root: &mut Element, models: &Models) -> Result<Vec<String>> {
    let is_section = |element: &Element| ["actuator", "equality"].contains(&element.tag.as_str());
    let (sections, mut rest): (Vec<Element>, Vec<Element>) =
        std::mem::take(&mut root.children).into_iter().partition(is_section);
    let mut expansion = Expansion { models, sections, notes: Vec::new(), elements: 0 };
    rest.iter_mut().filter(|part| part.tag == "worldbody").try_for_each(|world| expansion.within(world))?;
    root.children = rest;
    root.children.extend(expansion.sections);
    Ok(expansion.notes)
}

struct Expansion<'a> {
    models: &'a Models,
    sections: Vec<Element>,
    notes: Vec<String>,
    /// Elements in all copies so far.
    elements: usize,
}

impl Expansion<'_> {
    /// The innermost first: theirs are the first numbers behind a name.
    fn within(&mut self, element: &mut Element) -> Result<()> {
        for child in &mut element.children {
            self.within(child)?;
            if child.tag == "replicate" {
                self.copies(child)?;
            }
        }
        Ok(())
    }

    /// Makes a `<replicate>` a frame with a frame for each copy. As in MuJoCo, a copy has a multiple of the Euler angles, and stands by
    /// the offset from the one before, in the axes of that one.
    fn copies(&mut self, element: &mut Element) -> Result<()> {
        let count = count(element)?;
        if let Some(lost) = element.children.iter().find(|child| OF_BODIES.contains(&child.tag.as_str())) {
            return Err(lost.error("it stands in a <replicate>, not in a body; put a <body> around it"));
        }
        self.elements += count * element.size();
        if self.elements > MOST_ELEMENTS {
            return Err(element.error(format!("the copies have more than {MOST_ELEMENTS} elements; is this a robot?")));
        }
        let separator = element.get("sep").unwrap_or_default();
        let digits = count.to_string().len();
        let suffixes: Vec<String> = (0..count).map(|copy| format!("{separator}{copy:0digits$}")).collect();
        self.repeat_references(element, &suffixes);
        let content = std::mem::take(&mut element.children);
        let given = Settled::plain(element);
        let offset = given.vector("offset")?.unwrap_or_default();
        let angles = given.numbers("euler", [3, 3])?.unwrap_or_default();
        let mut all = element.frame(&[("childclass", element.get("childclass").unwrap_or_default())]);
        let mut at = Vector3::zeros();
        for (copy, suffix) in suffixes.iter().enumerate() {
            let turned: Vec<f64> = angles.iter().map(|angle| angle * copy as f64).collect();
            let mut frame = element.frame(&[("pos", &text(at.as_slice())), ("euler", &text(&turned))]);
            at += self.models.pose(&frame)?.rotation * offset;
            frame.children.clone_from(&content);
            frame.children.iter_mut().for_each(|child| child.suffix(suffix, &["name"]));
            all.children.push(frame);
        }
        *element = all;
        Ok(())
    }

    /// Repeats what names joints and bodies within an element. As in MuJoCo, an equality of a part that is repeated with one that is not
    /// falls away.
    fn repeat_references(&mut self, element: &Element, suffixes: &[String]) {
        for section in &mut self.sections {
            let mut settled = Vec::new();
            for part in std::mem::take(&mut section.children) {
                let references: Vec<(&str, &[&str])> = REFERENCES
                    .iter()
                    .filter(|(name, _)| part.get(name).is_some())
                    .map(|&(name, joint)| (name, if joint { &["joint", "freejoint"][..] } else { &["body"][..] }))
                    .collect();
                let is_inside = |(name, tags): &(&str, &[&str])| {
                    let wanted = part.get(name).unwrap_or_default();
                    element.children.iter().any(|child| tags.iter().any(|tag| child.find(tag, wanted).is_some()))
                };
                let inside = references.iter().filter(|reference| is_inside(reference)).count();
                if inside == 0 {
                    settled.push(part);
                } else if inside < references.len() {
                    let (tag, line) = (&part.tag, part.line);
                    self.notes.push(format!(
                        "the {tag} equality in line {line} is not read: one of its ends is replicated and the other is not"
                    ));
                } else {
                    let names: Vec<&str> = references.iter().map(|(name, _)| *name).chain(["name"]).collect();
                    settled.extend(suffixes.iter().map(|suffix| {
                        let mut copy = part.clone();
                        copy.suffix(suffix, &names);
                        copy
                    }));
                }
            }
            section.children = settled;
        }
    }
}

/// Numbers as an attribute.
fn text(numbers: &[f64]) -> String {
    numbers.iter().map(|number| format!("{number:?}")).collect::<Vec<_>>().join(" ")
}

/// How many copies are wanted.
fn count(element: &Element) -> Result<usize> {
    let Some(text) = element.get("count") else {
        return Err(element.error("it has no count; add count=\"...\""));
    };
    match text.parse::<usize>() {
        Ok(count) if count <= MOST_COPIES => Ok(count),
        _ => Err(element.error(format!("count=\"{text}\" must be a whole number up to {MOST_COPIES}"))),
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::xml::XmlText;
    use crate::error::Result;
    use crate::robot::description::Description;
    use std::path::Path;

    fn read(inner: &str, rest: &str) -> Result<Description> {
        let text = format!("<mujoco><worldbody>{inner}</worldbody>{rest}</mujoco>");
        super::super::read(&XmlText::new(Path::new("arm.xml"), text))
    }

    const BODY: &str = "<body name=\"b\"><joint name=\"j\"/><geom size=\"0.1\"/></body>";

    fn names(count: usize) -> Vec<String> {
        let robot = read(&format!("<replicate count=\"{count}\" sep=\"_\">{BODY}</replicate>"), "").unwrap();
        robot.joints.into_iter().map(|joint| joint.name).collect()
    }

    #[test]
    fn numbers_have_as_many_digits_as_the_count() {
        assert_eq!(names(1), ["j_0"]);
        assert_eq!(names(9).last().map(String::as_str), Some("j_8"));
        assert_eq!(names(10).first().map(String::as_str), Some("j_00"));
        assert_eq!(names(101).last().map(String::as_str), Some("j_100"));
    }

    #[test]
    fn equalities_within_a_copy_are_repeated_and_others_fall_away() {
        let pair = "<body name=\"o\"><joint name=\"z\"/><geom size=\"1\"/></body><replicate count=\"2\"><body><joint name=\"a\"/>\
                    <geom size=\"1\"/><body><joint name=\"d\"/><geom size=\"1\"/></body></body></replicate>";
        let equality = "<equality><joint joint1=\"d\" joint2=\"a\" polycoef=\"0 2\"/><joint joint1=\"a\" joint2=\"z\"/></equality>";
        let robot = read(pair, equality).unwrap();
        let followers: Vec<_> =
            robot.joints.iter().map(|j| (j.name.as_str(), j.mimic.as_ref().map(|m| m.master.as_str()))).collect();
        assert_eq!(followers, [("z", None), ("a0", None), ("d0", Some("a0")), ("a1", None), ("d1", Some("a1"))]);
        assert!(robot.notes.iter().any(|note| note.contains("one of its ends is replicated")), "{:?}", robot.notes);
    }

    #[test]
    fn what_cannot_be_repeated_is_refused() {
        for (text, word) in [
            (format!("<replicate>{BODY}</replicate>"), "has no count"),
            (format!("<replicate count=\"1.5\">{BODY}</replicate>"), "whole number"),
            (format!("<replicate count=\"1001\">{BODY}</replicate>"), "whole number up to 1000"),
            ("<body><replicate count=\"2\"><joint/></replicate></body>".to_owned(), "put a <body> around it"),
            (
                format!("<replicate count=\"1000\"><replicate count=\"100\">{BODY}</replicate></replicate>"),
                "more than 100000 elements",
            ),
            (format!("<replicate count=\"0\">{BODY}</replicate>"), "there is no body"),
        ] {
            let message = read(&text, "").unwrap_err().to_string();
            assert!(message.contains(word), "{message}");
        }
    }
}
