//! The one error type: every variant names the file, line, joint or field at fault and says what to do.

use std::path::{Path, PathBuf};

/// Result of everything in this crate that can fail on user input.
pub type Result<T> = std::result::Result<T, Error>;

/// What went wrong, where, and what to do about it. All of these are the caller's to mend (exit code 2).
#[derive(Debug, thiserror::Error)]
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
        Error::Io { path: path.as_ref().to_owned(), action: action.into(), source }
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

    /// An [`Error::Request`] about `subject`.
    pub fn request(subject: impl Into<String>, problem: impl Into<String>) -> Self {
        Error::Request { subject: subject.into(), problem: problem.into() }
    }
}
