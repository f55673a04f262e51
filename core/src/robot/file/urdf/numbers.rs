//! The numbers in a URDF, checked where they stand: the URDF crate reports what is wrong, but not where.

use super::super::xml::{attribute, child, line, words};
use crate::error::{Error, Result};
use crate::robot::model::LARGEST;
use roxmltree::Node;
use std::path::Path;

/// Elements of a body with their attributes and how many numbers each holds.
const BODY: [(&str, &[(&str, usize)]); 3] = [
    ("origin", &[("xyz", 3), ("rpy", 3), ("quat_xyzw", 4)]),
    ("mass", &[("value", 1)]),
    ("inertia", &[("ixx", 1), ("ixy", 1), ("ixz", 1), ("iyy", 1), ("iyz", 1), ("izz", 1)]),
];

/// Elements of a moving joint; a fixed one has its origin alone.
const JOINT: [(&str, &[(&str, usize)]); 5] = [
    ("origin", &[("xyz", 3), ("rpy", 3), ("quat_xyzw", 4)]),
    ("axis", &[("xyz", 3)]),
    ("limit", &[("lower", 1), ("upper", 1), ("velocity", 1), ("effort", 1)]),
    ("dynamics", &[("damping", 1), ("friction", 1), ("armature", 1)]),
    ("mimic", &[("multiplier", 1), ("offset", 1)]),
];

/// Checks the numbers of a link's inertial.
///
/// # Errors
/// Names file, line, element and attribute of a number that is malformed, not finite or beyond 1e9.
pub(super) fn check_body(path: &Path, link: &Node) -> Result<()> {
    let Some(inertial) = child(link, "inertial") else { return Ok(()) };
    BODY.iter().try_for_each(|(tag, attributes)| check(path, link, &inertial, tag, attributes))
}

/// Checks the numbers of a joint; limits may be infinite, and those of its drive of any size.
///
/// # Errors
/// As [`check_body`].
pub(super) fn check_joint(path: &Path, joint: &Node, fixed: bool) -> Result<()> {
    let elements = if fixed { &JOINT[..1] } else { &JOINT };
    elements.iter().try_for_each(|(tag, attributes)| check(path, joint, joint, tag, attributes))
}

fn check(path: &Path, owner: &Node, parent: &Node, tag: &str, attributes: &[(&str, usize)]) -> Result<()> {
    let Some(node) = child(parent, tag) else { return Ok(()) };
    for (name, count) in attributes {
        let Some(text) = attribute(&node, name) else { continue };
        let refuse = |problem: String| {
            let owner = owner.attribute("name").unwrap_or("?").trim();
            Err(Error::input(path, Some(line(&node)), format!("{name} of <{tag}> in `{owner}`"), problem))
        };
        let words: Vec<&str> = words(text).collect();
        if words.len() != *count {
            return refuse(format!("\"{text}\" must be {count} number(s), found {}", words.len()));
        }
        for word in words {
            match word.parse::<f64>() {
                Ok(value) if value.abs() <= LARGEST || (tag == "limit" && !value.is_nan()) => {}
                // What is beyond any machine there is the reader's to judge.
                Ok(value) if tag == "dynamics" && value.is_finite() => {}
                Ok(value) if value.is_finite() => {
                    return refuse(format!("{word} is no arm's; numbers go up to {LARGEST:e}"));
                }
                _ => return refuse(format!("\"{word}\" must be a finite number")),
            }
        }
    }
    Ok(())
}
