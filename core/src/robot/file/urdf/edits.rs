//! Edits of the text of a URDF, in place.

use super::super::xml;
use roxmltree::Node;
use std::ops::Range;

/// A place in a text and what stands there instead.
pub(super) type Edit = (Range<usize>, String);

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
