//! Lines of keys in a TOML file, for error messages.

use crate::error::Error;
use std::path::Path;
use toml::de::{DeTable, DeValue};

/// A TOML file in which keys can be found.
pub(super) struct Located<'a> {
    path: &'a Path,
    text: &'a str,
}

impl<'a> Located<'a> {
    pub(super) fn new(path: &'a Path, text: &'a str) -> Self {
        Located { path, text }
    }

    /// An error about the dotted key `key`, with the line where it (or the nearest table around it) stands.
    pub(super) fn error(&self, key: &str, problem: impl Into<String>) -> Error {
        Error::input(self.path, self.line(key), key, problem)
    }

    fn line(&self, key: &str) -> Option<usize> {
        let document = DeTable::parse(self.text).ok()?;
        let mut table = document.get_ref();
        let mut position = None;
        for part in key.split('.') {
            let Some((name, value)) = table.get_key_value(part) else { break };
            position = Some(name.span().start);
            match value.get_ref() {
                DeValue::Table(inner) => table = inner,
                _ => break,
            }
        }
        position.map(|at| line_of(self.text, at))
    }
}

/// The error of a TOML file that does not parse or does not have the wanted keys.
pub(super) fn parse_error(path: &Path, text: &str, error: &toml::de::Error) -> Error {
    let line = error.span().map(|span| line_of(text, span.start));
    let field = error
        .span()
        .and_then(|span| text.get(span))
        .and_then(|found| found.lines().next())
        .filter(|found| !found.is_empty() && found.len() < 60)
        .map_or("scenario".to_owned(), |found| format!("`{found}`"));
    Error::input(path, line, field, error.message())
}

fn line_of(text: &str, position: usize) -> usize {
    1 + text[..position.min(text.len())].matches('\n').count()
}
