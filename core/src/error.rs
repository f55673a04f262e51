//! The one error type: every variant names the file, line, joint or field at fault and says what to do.

use std::path::{Path, PathBuf};

/// Result of everything in this crate that can fail on user input.
pub type Result<T> = std::result::Result<T, Error>;

/// What went wrong, where, and what to do about it. All of these are the caller's to correct (exit code 2).
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::error::Error;
/// use tauscope::robot::{self, InertiaCheck};
///
/// // Errors name the file, place or option, and say what to do.
/// let missing = robot::load("no.urdf", InertiaCheck::Ignored).unwrap_err();
/// assert!(matches!(missing, Error::Io { .. }) && missing.to_string().starts_with("no.urdf: cannot read"));
///
/// let own = Error::input("log.csv", Some(7), "tau2", "is empty; leave the row out");
/// assert_eq!(own.to_string(), "log.csv:7: tau2: is empty; leave the row out");
/// ```
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file or folder could not be read or written.
    #[error("{}: cannot {action}: {source}", path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// What was tried, as a verb phrase: "read the scenario", "create the folder".
        action: String,
        /// The operating system's word.
        source: std::io::Error,
    },
    /// A place in an input file is wrong.
    #[error("{}{}: {field}: {problem}", path.display(), line.map_or(String::new(), |l| format!(":{l}")))]
    Input {
        /// The file at fault.
        path: PathBuf,
        /// Line in the file, counted from 1, where known.
        line: Option<usize>,
        /// The key, element, column or joint at fault.
        field: String,
        /// What is wrong and what to do.
        problem: String,
    },
    /// A request that no single file is to blame for: a motion outside limits, too few samples, a wrong argument.
    #[error("{subject}: {problem}")]
    Request {
        /// The joint, option, signal or quantity at fault.
        subject: String,
        /// What is wrong and what to do.
        problem: String,
    },
}

impl Error {
    /// An [`Error::Io`] for `path`; `action` completes "cannot ...".
    pub fn io(path: impl AsRef<Path>, action: impl Into<String>, source: std::io::Error) -> Self {
        Error::Io { path: path.as_ref().to_owned(), action: action.into(), source: of_system(source) }
    }

    /// The same error about the file `named`, where it is about the `draft` of that file.
    pub fn named(mut self, draft: &Path, named: impl AsRef<Path>) -> Self {
        if let Error::Io { path, .. } | Error::Input { path, .. } = &mut self
            && path == draft
        {
            *path = named.as_ref().to_owned();
        }
        self
    }

    /// An [`Error::Input`] at a place in a file.
    pub fn input(
        path: impl AsRef<Path>,
        line: Option<usize>,
        field: impl Into<String>,
        problem: impl Into<String>,
    ) -> Self {
        Error::Input { path: path.as_ref().to_owned(), line, field: field.into(), problem: problem.into() }
    }

    /// The [`Error::Input`] of a TOML file that does not parse or does not hold the wanted keys.
    pub fn toml(path: impl AsRef<Path>, text: &str, error: &toml::de::Error) -> Self {
        let line = error.span().map(|span| line_at(text, span.start));
        let place = line.and_then(|line| text.lines().nth(line - 1)).map_or("", str::trim);
        let table =
            place.strip_prefix('[').map(|header| header.split(']').next().unwrap_or("").trim_matches(['[', ' ']));
        let missing = error.message().strip_prefix("missing field `").and_then(|rest| rest.split('`').next());
        let key = place.split_once('=').map(|(key, _)| key.trim()).filter(|key| !key.is_empty());
        let field = match (missing, table) {
            (Some(key), Some(table)) => format!("{table}.{key}"),
            (Some(key), None) => key.to_owned(),
            (None, table) => table.or(key).unwrap_or("the file").to_owned(),
        };
        Error::input(path, line, field, error.message())
    }

    /// An [`Error::Request`] about `subject`.
    pub fn request(subject: impl Into<String>, problem: impl Into<String>) -> Self {
        Error::Request { subject: subject.into(), problem: problem.into() }
    }
}

impl Clone for Error {
    fn clone(&self) -> Self {
        match self {
            // The operating system's error has no copy; its kind and words have.
            Error::Io { path, action, source } => {
                Error::io(path, action.clone(), std::io::Error::new(source.kind(), source.to_string()))
            }
            Error::Input { path, line, field, problem } => Error::input(path, *line, field.clone(), problem.clone()),
            Error::Request { subject, problem } => Error::request(subject.clone(), problem.clone()),
        }
    }
}

/// The system's error alone: one about a temporary file also names that file, which no user knows.
fn of_system(error: std::io::Error) -> std::io::Error {
    // The crate that makes temporary files gives the place in no other way than in its text.
    let text = error.to_string();
    match text.split_once(" at path \"") {
        Some((system, _)) => std::io::Error::new(error.kind(), system),
        None => error,
    }
}

/// Line, counted from 1, of a byte offset in a text.
pub fn line_at(text: &str, offset: usize) -> usize {
    1 + text.bytes().take(offset).filter(|&byte| byte == b'\n').count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, serde::Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Outer {
        #[serde(rename = "seed")]
        _seed: u64,
        #[serde(rename = "plant")]
        _plant: Inner,
    }

    #[derive(Debug, serde::Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Inner {
        #[serde(rename = "step_s")]
        _step: f64,
    }

    #[test]
    fn temporary_files_are_not_named() {
        let folder = tempfile::tempdir().unwrap();
        let source = tempfile::tempdir_in(folder.path().join("none")).unwrap_err();
        let message = Error::io("log.csv", "write it", source).to_string();
        assert_eq!(message, "log.csv: cannot write it: No such file or directory (os error 2)");
        let draft = Path::new(".draft/x.csv");
        let about = |path: &str| Error::input(path, None, "t", "is wrong").named(draft, "x.csv").to_string();
        assert_eq!([about(".draft/x.csv"), about("y.csv")], ["x.csv: t: is wrong", "y.csv: t: is wrong"]);
    }

    #[test]
    fn toml_errors_name_line_and_key() {
        for (text, expected) in [
            ("seed = 1\n\n[plant] # the arm\n", "a.toml:3: plant.step_s: missing field"),
            ("\n[plant]\nstep_s = 1\n", "a.toml:1: seed: missing field"),
            ("seed = -1\n[plant]\nstep_s = 1\n", "a.toml:1: seed: invalid value"),
            ("seed = 1\n[plant]\nstep_s = \"x\"\n", "a.toml:3: step_s: invalid type"),
            ("seed = 1\n[plant]\nstp = 1\nstep_s = 1\n", "a.toml:3: stp: unknown field"),
            ("seed = 1\n[plantt]\n", "a.toml:2: plantt: unknown field"),
            ("<xml/>", "a.toml:1: the file: "),
        ] {
            let message = Error::toml("a.toml", text, &toml::from_str::<Outer>(text).unwrap_err()).to_string();
            assert!(message.starts_with(expected), "{message}");
        }
    }
}
