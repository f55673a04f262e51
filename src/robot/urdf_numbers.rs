//! The numbers in a URDF, checked where they stand: the URDF crate says what is wrong, but not where.

use super::LARGEST;
use crate::error::{Error, Result};
use std::path::Path;

/// Elements with their attributes and how many numbers each holds.
const NUMBERS: [(&str, &[(&str, usize)]); 6] = [
    ("origin", &[("xyz", 3), ("rpy", 3)]),
    ("axis", &[("xyz", 3)]),
    ("mass", &[("value", 1)]),
    ("inertia", &[("ixx", 1), ("ixy", 1), ("ixz", 1), ("iyy", 1), ("iyz", 1), ("izz", 1)]),
    ("limit", &[("lower", 1), ("upper", 1), ("velocity", 1), ("effort", 1)]),
    ("dynamics", &[("damping", 1), ("friction", 1), ("armature", 1)]),
];

/// Attributes that an element must have.
const REQUIRED: [(&str, &[&str]); 3] = [
    ("mass", &["value"]),
    ("inertia", &["ixx", "ixy", "ixz", "iyy", "iyz", "izz"]),
    ("limit", &["velocity", "effort"]),
];

/// Checks the numbers of all joints and inertials.
///
/// # Errors
/// Names file, line, element and attribute of a number that is missing, malformed, not finite or beyond 1e9 (limits may be
/// infinite).
pub(super) fn check(path: &Path, document: &roxmltree::Document) -> Result<()> {
    let relevant = |node: &roxmltree::Node| {
        node.ancestors().any(|above| above.has_tag_name("joint") || above.has_tag_name("inertial"))
            && node.ancestors().all(|above| !above.has_tag_name("transmission"))
    };
    for node in document.descendants().filter(|node| node.is_element()).filter(relevant) {
        let tag = node.tag_name().name();
        let line = document.text_pos_at(node.range().start).row as usize;
        let refuse = |attribute: &str, problem: String| {
            let owner = node.ancestors().find_map(|above| above.attribute("name")).unwrap_or("?").trim();
            Err(Error::input(path, Some(line), format!("{attribute} of <{tag}> in `{owner}`"), problem))
        };
        let required = REQUIRED.iter().filter(|(name, _)| *name == tag).flat_map(|(_, attributes)| *attributes);
        if let Some(attribute) = required.into_iter().find(|attribute| node.attribute(**attribute).is_none()) {
            return refuse(attribute, "is missing; add it".to_owned());
        }
        for (attribute, count) in NUMBERS.iter().filter(|(name, _)| *name == tag).flat_map(|(_, numbers)| *numbers) {
            let Some(text) = node.attribute(*attribute) else { continue };
            let words: Vec<&str> = text.split_whitespace().collect();
            if words.len() != *count {
                return refuse(attribute, format!("\"{text}\" must be {count} number(s), found {}", words.len()));
            }
            for word in words {
                match word.parse::<f64>() {
                    Ok(value) if value.abs() <= LARGEST || (tag == "limit" && !value.is_nan()) => {}
                    Ok(value) if value.is_finite() => {
                        return refuse(attribute, format!("{word} is no arm's; numbers go up to {LARGEST:e}"));
                    }
                    _ => return refuse(attribute, format!("\"{word}\" must be a finite number")),
                }
            }
        }
    }
    Ok(())
}
