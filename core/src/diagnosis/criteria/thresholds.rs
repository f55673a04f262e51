//! All thresholds together.

use super::comparison::ComparisonCriteria;
use super::estimate::EstimateCriteria;
use super::levels::Levels;
use super::search::SearchCriteria;
use super::structure::StructureCriteria;
use super::verdict::VerdictCriteria;
use serde::Serialize;
use statrs::distribution::{ChiSquared, ContinuousCDF, Normal};

/// Thresholds that decide which effects are found and which of them are reported as findings.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::diagnosis::{Criteria, Options};
///
/// // Report what is 1 % of a joint's torque; by default it is 2 %.
/// let criteria = Criteria { share_of_torque: 0.01, ..Criteria::default() };
/// let options = Options { criteria, ..Options::default() };
/// assert!(options.check().is_ok());
///
/// // Probability is not for free: more than alpha cannot be spent.
/// let mut options = Options::default();
/// options.criteria.search.training = 0.9;
/// assert!(options.check().is_err());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Criteria {
    /// Least size of a finding over the torque of a joint, both root mean square: below 2 % no simulation is better for it.
    pub share_of_torque: f64,
    /// Levels that several questions share.
    pub levels: Levels,
    /// Thresholds of what an estimate can be.
    pub estimate: EstimateCriteria,
    /// Thresholds of the search that finds them.
    pub search: SearchCriteria,
    /// Thresholds of model comparison.
    pub comparison: ComparisonCriteria,
    /// Thresholds of structure that no effect explains.
    pub structure: StructureCriteria,
    /// Thresholds of the verdict.
    pub verdict: VerdictCriteria,
}

impl Default for Criteria {
    fn default() -> Self {
        Criteria {
            share_of_torque: 0.02,
            levels: Levels::default(),
            estimate: EstimateCriteria::default(),
            search: SearchCriteria::default(),
            comparison: ComparisonCriteria::default(),
            structure: StructureCriteria::default(),
            verdict: VerdictCriteria::default(),
        }
    }
}

impl Criteria {
    /// Size below which nothing matters on a joint with so much `torque`, both root mean square, however quiet its sensor is: a minor part
    /// of what matters does not. Torque constants are known five times less well than these 0.2 %.
    pub(crate) fn floor(&self, torque: f64) -> f64 {
        self.levels.minor * self.share_of_torque * torque
    }

    /// Factor over the baseline by which no joint's held-out residual may grow with a finding.
    pub(crate) fn worse(&self) -> f64 {
        1.0 + self.levels.minor
    }

    /// Shares of alpha that are spent: those of the search, and those of structure by tests of blocks and by the map.
    pub fn shares_of_alpha(&self) -> Vec<f64> {
        self.search.shares().into_iter().chain([self.structure.together; 2]).collect()
    }

    /// Most that the statistic of a test may lose where a shape at a bound of its law is moved inside: chi-square of one degree of freedom
    /// at the strict level. A law that is better at its bound than inside is not the law that acts; one that the logs do not determine
    /// loses nothing.
    pub fn at_bound(&self) -> f64 {
        ChiSquared::new(1.0).map_or(f64::NAN, |chi_square| chi_square.inverse_cdf(1.0 - self.levels.strict_p))
    }

    /// One-sided level at which a held-out residual grows.
    pub fn worse_p(&self) -> f64 {
        Normal::standard().sf(self.levels.bound_std)
    }

    /// Largest gap of the information criterion up to which a rival with more parameters stays an alternative: twice the logarithm of the
    /// odds.
    pub(crate) fn criterion_gap(&self) -> f64 {
        2.0 * self.levels.log_odds
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{Value, json};

    /// Every number here can be wrong: there are to be no more.
    #[test]
    fn thresholds_are_few() {
        fn numbers(value: &Value) -> usize {
            match value {
                Value::Object(fields) => fields.values().map(numbers).sum(),
                Value::Array(values) => values.iter().map(numbers).sum(),
                _ => 1,
            }
        }
        let count = numbers(&json!(Criteria::default()));
        assert!(count < 40, "{count}");
    }
}
