//! Thresholds of the verdict on findings, once all are known.

use serde::Serialize;

/// Thresholds that decide which findings stay named, and whether the description as a whole is what is wrong.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::diagnosis::{Criteria, VerdictCriteria};
///
/// // Keep findings on a joint of which half of the excess is explained; by default it is 70 %.
/// let verdict = VerdictCriteria { explained: 0.5, ..VerdictCriteria::default() };
/// let criteria = Criteria { verdict, ..Criteria::default() };
/// assert!(criteria.verdict.explained < Criteria::default().verdict.explained);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct VerdictCriteria {
    /// Share of a joint's excess over the noise, in squares, that must be explained for the findings on it to stay where structure is
    /// unexplained with certainty.
    pub explained: f64,
    /// Delay or lag of at most a sample, s, that the sampling of the loop makes, however small the noise: half of a servo cycle of 2 ms.
    pub sampling_s: f64,
}

impl Default for VerdictCriteria {
    fn default() -> Self {
        VerdictCriteria { explained: 0.7, sampling_s: 1e-3 }
    }
}
