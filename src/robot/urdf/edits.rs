//! A URDF as it is meant: its text with numbers in SI units and all their digits, lines as in the file.

use super::super::xml::{self, XmlText};
use super::{angles, units};
use crate::error::Result;
use roxmltree::Node;
use std::ops::Range;
use std::path::Path;

/// A place in a text and what stands there instead.
pub(super) type Edit = (Range<usize>, String);

/// The text of a URDF as it is meant, and a note on each kind of change.
///
/// # Errors
/// If the file cannot be read or is no XML.
pub(super) fn settled(path: &Path) -> Result<(XmlText, Vec<String>)> {
    of(XmlText::read(path, "the URDF")?)
}

/// [`settled`] for a text at hand.
pub(super) fn of(source: XmlText) -> Result<(XmlText, Vec<String>)> {
    let mut notes = Vec::new();
    let edits = {
        let document = source.parse()?;
        let mut edits = units::edits(&document, &mut notes);
        edits.extend(angles::edits(&document, &mut notes));
        edits
    };
    let text = if edits.is_empty() { source.text } else { applied(&source.text, edits) };
    Ok((XmlText { path: source.path, text }, notes))
}

/// The text after edits that do not overlap.
pub(super) fn applied(text: &str, mut edits: Vec<Edit>) -> String {
    edits.sort_by_key(|(range, _)| range.start);
    let mut edited = String::with_capacity(text.len());
    let mut done = 0;
    for (range, new) in edits {
        // What an entity stands for is read wherever the entity is named, and changed once; of two changes the first stands.
        if range.start >= done {
            edited += &text[done..range.start];
            edited += &new;
            done = range.end;
        }
    }
    edited + &text[done..]
}

/// The words of an attribute with their places in the text; none where entities stand for part of it.
pub(super) fn words<'a>(node: &Node<'a, '_>, attribute: &str) -> Vec<(Range<usize>, &'a str)> {
    let Some(attribute) = node.attribute_node(attribute) else { return Vec::new() };
    let (range, text) = (attribute.range_value(), node.document().input_text());
    let value: &'a str = &text[range.clone()];
    if value.contains('&') {
        return Vec::new();
    }
    let place = |word: &str| {
        let start = range.start + (word.as_ptr() as usize - value.as_ptr() as usize);
        start..start + word.len()
    };
    xml::words(value).map(|word| (place(word), word)).collect()
}
