//! A URDF as it is meant: its text with numbers in SI units and all their digits, lines as in the file.

use super::super::xml::XmlText;
use super::edits::applied;
use super::{angles, units};
use crate::error::Result;
use std::path::Path;

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
