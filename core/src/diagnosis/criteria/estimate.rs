//! What an estimate can be.

use super::judgement::{Gate, Judgement};
use serde::Serialize;

/// Thresholds that decide whether an estimate is one that a machine can have and that its columns describe.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::diagnosis::{Criteria, EstimateCriteria};
///
/// // Columns of a law that is not linear in a parameter describe it up to half as much again, not up to twice as much.
/// let estimate = EstimateCriteria { same_size: 1.5, ..EstimateCriteria::default() };
/// let criteria = Criteria { estimate, ..Criteria::default() };
/// assert!(criteria.estimate.same_size < Criteria::default().estimate.same_size);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct EstimateCriteria {
    /// Factor within which an estimate must agree with the size at which its columns were taken: the columns of a law that is not linear in
    /// it describe no other size, and torque is cut off wholly or not at all.
    pub same_size: f64,
}

impl Default for EstimateCriteria {
    fn default() -> Self {
        EstimateCriteria { same_size: 2.0 }
    }
}

impl EstimateCriteria {
    /// Whether an estimate agrees with the size at which its columns were taken; both may be negative.
    pub(crate) fn same_size(&self, estimate: f64, size: f64) -> Judgement {
        let share = estimate / size;
        let factor = if share > 0.0 { share.max(1.0 / share) } else { f64::INFINITY };
        Judgement::below(Gate::SameSize, factor, self.same_size)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn either_side_of_the_same_size() {
        let criteria = EstimateCriteria::default();
        let passes = |estimate: f64, size: f64| criteria.same_size(estimate, size).passed;
        assert!(passes(1.99, 1.0) && !passes(2.01, 1.0));
        assert!(passes(0.51, 1.0) && !passes(0.49, 1.0));
        assert!(passes(-1.0, -1.0) && !passes(-1.0, 1.0));
        assert!(!passes(f64::NAN, 1.0));
    }
}
