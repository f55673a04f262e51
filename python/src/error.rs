//! Errors of tauscope as Python exceptions.

use pyo3::PyErr;
use pyo3::create_exception;
use pyo3::exceptions::PyValueError;
use tauscope::error::Error;

create_exception!(
    tauscope,
    TauscopeError,
    PyValueError,
    "Bad input: the text says what is wrong, where, and what to do."
);

/// An error with the text that the command prints.
pub(crate) fn raised(error: &Error) -> PyErr {
    TauscopeError::new_err(error.to_string())
}

/// An error about an argument.
pub(crate) fn wrong(argument: &str, problem: impl std::fmt::Display) -> PyErr {
    TauscopeError::new_err(format!("{argument}: {problem}"))
}
