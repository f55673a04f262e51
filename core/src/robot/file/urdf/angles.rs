//! Rounded angles of a URDF with all their digits: frames that are parallel must be so.

use super::super::rounding::{FEWEST, meant};
use super::super::xml::{child, children};
use super::edits::{Edit, words};
use roxmltree::Document;

/// The edits that give rounded roll, pitch and yaw angles of joints all their digits, and a note that counts them.
pub(super) fn edits(document: &Document, notes: &mut Vec<String>) -> Vec<Edit> {
    let mut edits = Vec::new();
    let (mut first, mut furthest) = (None, 0.0f64);
    for joint in children(&document.root_element(), "joint") {
        let Some(origin) = child(&joint, "origin") else { continue };
        for (range, word) in words(&origin, "rpy") {
            if let Some(angle) = meant(word, FEWEST) {
                first.get_or_insert_with(|| word.to_owned());
                furthest = furthest.max((angle - word.parse::<f64>().unwrap_or(angle)).abs());
                edits.push((range, format!("{angle:?}")));
            }
        }
    }
    if let Some(first) = first {
        let count = edits.len();
        let angles = if count == 1 { "angle is" } else { "angles are" };
        notes.push(format!(
            "{count} rounded {angles} taken as the multiple of 15 degrees within the printed digits ({first} and the like, by {furthest:.1e} rad at most: a \
             simulation of the file as printed differs by that)"
        ));
    }
    edits
}
