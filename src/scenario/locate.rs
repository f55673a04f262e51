//! Lines of keys in a TOML file, for error messages.

use crate::error::{Error, line_at};
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

    /// An error about the table number `index` (from 0) of the list of tables `[[list]]`.
    pub(super) fn item_error(&self, list: &str, index: usize, problem: impl Into<String>) -> Error {
        let document = DeTable::parse(self.text).ok();
        let item = document.as_ref().and_then(|document| match document.get_ref().get(list)?.get_ref() {
            DeValue::Array(items) => items.get(index),
            _ => None,
        });
        let line = item.map(|item| line_at(self.text, item.span().start));
        Error::input(self.path, line, format!("{list} {}", index + 1), problem)
    }

    /// What went wrong inside, said of the dotted key `key`.
    pub(super) fn wrap(&self, key: &str, problem: &Error) -> Error {
        self.error(key, problem.to_string())
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
        position.map(|at| line_at(self.text, at))
    }
}
