//! The field's usual smoothing as one way among others, which may find nothing.

use crate::error::Result;

/// An identification that is made for comparison alone: what keeps it from being made is no error of the run, but is reported.
pub(super) fn compared<T>(identified: Result<T>) -> (Option<T>, Option<String>) {
    match identified {
        Ok(scored) => (Some(scored), None),
        Err(problem) => (None, Some(problem.to_string())),
    }
}
