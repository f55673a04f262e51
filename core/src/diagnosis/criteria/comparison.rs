//! Thresholds of model comparison.

use serde::Serialize;

/// Thresholds that decide which of several candidates is chosen, and which are listed as its alternatives.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ComparisonCriteria {
    /// Candidates that are fitted with a noise model of their own before one is chosen.
    pub shortlist: usize,
    /// Share of the best statistic that a rival must reach to be compared.
    pub rival: f64,
    /// Share of the winner's statistic from which a rival is close enough for held-out logs to judge.
    pub close: f64,
    /// Share of the held-out sum of squares, as a lower bound, for which a rival takes the winner's place: less may come of a further
    /// parameter or of chance.
    pub clearly_better: f64,
    /// p-value, by the scatter between held-out blocks, of the growth of the held-out sum of squares below which a load at the flange is
    /// no explanation of what changed in the bodies where one link explains more of the training logs.
    pub surely_worse_p: f64,
    /// p-value of what the winner adds to a rival below which the rival is excluded.
    pub encompassed_p: f64,
    /// p-value of what a rival with more parameters adds to the winner below which it stays an alternative.
    pub superfluous_p: f64,
    /// Largest gap of the information criterion up to which such a rival stays an alternative.
    pub criterion_gap: f64,
    /// p-value, with all other findings in the model, above which a finding is dropped as superfluous.
    pub dropped_p: f64,
}

impl Default for ComparisonCriteria {
    fn default() -> Self {
        ComparisonCriteria {
            shortlist: 4,
            rival: 0.3,
            close: 0.8,
            clearly_better: 0.02,
            surely_worse_p: 1e-3,
            encompassed_p: 1e-3,
            superfluous_p: 0.05,
            criterion_gap: 6.0,
            dropped_p: 1e-4,
        }
    }
}
