//! Thresholds of model comparison.

use serde::Serialize;

/// Thresholds that decide which of several candidates is chosen, and which are listed as its alternatives.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::diagnosis::{ComparisonCriteria, Criteria};
///
/// // Compare more candidates before one is chosen.
/// let comparison = ComparisonCriteria { shortlist: 8, ..ComparisonCriteria::default() };
/// let criteria = Criteria { comparison, ..Criteria::default() };
/// assert!(criteria.comparison.shortlist > Criteria::default().comparison.shortlist);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ComparisonCriteria {
    /// Candidates that are fitted with a noise model of their own before one is chosen.
    pub shortlist: usize,
    /// Share of the best statistic that a rival must reach to be compared.
    pub rival: f64,
    /// Share of the winner's statistic from which a rival is close enough for held-out logs to judge.
    pub close: f64,
    /// Share of a sum of squares of the held-out logs, as a lower bound, for which a rival takes the winner's place: less may come of a
    /// further parameter, of any simplification of a law, or of chance.
    pub clearly_better: f64,
}

impl Default for ComparisonCriteria {
    fn default() -> Self {
        ComparisonCriteria { shortlist: 4, rival: 0.3, close: 0.8, clearly_better: 0.02 }
    }
}
