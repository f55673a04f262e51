//! Thresholds of the tests for structure that no effect explains.

use serde::Serialize;

/// Thresholds that decide which structure of the residual is reported as unexplained, and which findings it replaces.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct StructureCriteria {
    /// Share of alpha at which training and held-out logs together show structure, and at which the map of all logs does: generic functions
    /// are many, and what they find cannot be checked against a law.
    pub together: f64,
    /// Share of alpha at which the training logs by themselves show structure with certainty.
    pub certain: f64,
    /// Highest p-value of a block in the noise that does not know it at which the noise is estimated anew with it.
    pub suggested_p: f64,
    /// Least share of the residual of a joint that structure must have to be reported: with many rows that of any simplification of a
    /// simulator or a sensor is significant.
    pub share_of_residual: f64,
    /// Share of what a finding explains by itself that structure must explain beyond it to replace it: less may be any simplification of
    /// its law.
    pub beyond_finding: f64,
    /// Highest p-value, over all kinds of structure of a joint with a finding, of training and held-out logs together at which the finding
    /// is not all: that something is there is known, and the question is only whether the finding is it.
    pub not_all_p: f64,
    /// Share of the cut-off of a joint's positions up to which a spectral line counts: nearer to it, what the differences make of encoder
    /// noise is a peak, too.
    pub below_cutoff: f64,
    /// Difference of two spectral lines up to which they are one, Hz: half the width of the peak in a Hann window of 20 s.
    pub same_line_hz: f64,
    /// Factor by which the held-out residual of other logs must exceed that of the training logs and the standard deviation of the
    /// prediction, averages over half a second.
    pub foreign: f64,
    /// Factor by which it must exceed the noise of a single row.
    pub foreign_noise: f64,
    /// Share of the baseline's held-out residual up to which what was found explains the held-out logs too.
    pub carried_on: f64,
    /// Factor on the noise from which the held-out residual of a search that was ended is reported: noise that is estimated without the
    /// structure is up to 1.7 times too small on quiet logs.
    pub above_noise: f64,
}

impl Default for StructureCriteria {
    fn default() -> Self {
        StructureCriteria {
            together: 0.2,
            certain: 0.02,
            suggested_p: 0.1,
            share_of_residual: 0.03,
            beyond_finding: 0.02,
            not_all_p: 0.01,
            below_cutoff: 0.5,
            same_line_hz: 0.1,
            foreign: 3.0,
            foreign_noise: 2.0,
            carried_on: 0.5,
            above_noise: 2.0,
        }
    }
}
