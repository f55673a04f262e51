//! The verdict on a description, with its alternatives.

use super::change::{Change, Description};

/// A set of changes with the share of the torque that stays unexplained under it, held out.
#[derive(Debug, Clone, PartialEq)]
pub struct Alternative {
    /// The changes.
    pub changes: Vec<Change>,
    /// Geometric mean over the torques of residual over torque.
    pub unexplained: f64,
}

/// What explains the logs clearly better than their description.
#[derive(Debug, Clone, PartialEq)]
pub struct Verdict {
    /// The changed description.
    pub description: Description,
    /// Share of the torque that stays unexplained under the description as it was, held out.
    pub before: f64,
    /// The same under the changed description.
    pub after: f64,
    /// Both for every torque channel that takes part.
    pub each: [Vec<Option<f64>>; 2],
    /// Other sets of as many changes that explain the logs as well.
    pub alternatives: Vec<Alternative>,
    /// The best of the sets that are clearly worse.
    pub next: Option<Alternative>,
    /// Factors of the torques to those of the described bodies, where their scale is wrong.
    pub factors: Vec<Option<f64>>,
    /// Whether positions or gravity are changed, and the described bodies explain the torques no better for it: the log may be that of
    /// another arm.
    pub unlike_bodies: bool,
    /// Whether there is no alternative and the logs are long enough, or several that agree: then the changed description
    /// can be gone on with.
    pub beyond_doubt: bool,
}
