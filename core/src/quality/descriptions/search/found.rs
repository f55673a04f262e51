//! The outcome of a search that found something.

use crate::quality::descriptions::compare::Comparison;
use crate::quality::descriptions::tried::Tried;

/// The outcome of a search that found something.
pub(in crate::quality::descriptions) struct Found {
    /// The smallest set of changes.
    pub best: Tried,
    /// Sets of the same size that are not clearly worse.
    pub rivals: Vec<Tried>,
    /// The best of those that are.
    pub next: Option<Tried>,
    /// Its gain over the logs as they are.
    pub gain: Comparison,
    /// Whether the logs alone determine the direction of gravity, where that is changed.
    pub is_determined: bool,
}
