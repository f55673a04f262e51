//! Diagnosis: what the model of an arm misses, named from measured logs with a controlled rate of false alarms.
//!
//! | room | in | out |
//! |---|---|---|
//! | `answer` | arm, logs, options | the diagnosis and the extended model |
//! | `relevance` | effects found | those that matter, smaller ones |
//! | `lack_of_fit` | residual | structure that no effect explains |
//! | `variance` | residual | sizes of the kinds of functions that it follows |
//! | `search` | fits, candidates | effects found, by forward selection |
//! | `preparation` | logs, arm | filters and widths |
//! | `evidence` | a candidate; torque at the rate of the log | p-values and held-out gains; impacts in gears with play |
//! | `model` | rows, arm, effects | regressor, fits |
//! | `noise` | residual | whiteners |
//! | `logs` | recordings | rows |
//! | `regression` | columns | solutions, score tests |
//! | `criteria` | a number and its threshold | a judgement |
//!
//! Each room imports only from rooms below it.

pub(crate) mod answer;
mod criteria;
mod evidence;
mod lack_of_fit;
mod logs;
pub(crate) mod model;
pub(crate) mod noise;
mod preparation;
pub(crate) mod regression;
mod relevance;
mod search;
#[cfg(test)]
mod test_logs;
mod variance;
mod watch;

pub use answer::{
    Answer, Conclusion, DIAGNOSIS_SCHEMA, Derived, Diagnosis, DiagnosisBuilder, EXTENDED_MJCF, EXTENDED_SCENARIO,
    EXTENDED_URDF, Engine, Errors, Estimated, EstimatedEffect, Evidence, ExtendedModel, Finding, Followed, Follows,
    Gain, LeftOut, LogSummary, Measured, NamedAlternative, NamedParameter, NotFound, OfSampling, Outcome,
    ResidualStructure, Resimulation, Scope, Share, Simulator, Worst,
};
pub use criteria::{
    ComparisonCriteria, Criteria, EstimateCriteria, Gate, Judgement, Levels, SearchCriteria, StructureCriteria,
    VerdictCriteria,
};
pub use evidence::{Play, Ranked};
pub use lack_of_fit::{LOGS_DISAGREE, RejectedStructure, Replaced, Unexplained};
pub use logs::{CleanLogs, Consequence, DataFault, GivenLog, LowPass, Screened, screen};
pub use model::{Candidate, Family, Member};
pub use regression::Column;
pub use relevance::Minor;
pub use search::{Alternative, Found, Rejected, Verdict};
pub use variance::{JointMap, Kind, Line, Part, ResidualMap};
pub use watch::Progress;

use crate::effects;
use crate::error::{Error, Result};
use crate::identification::effect_model::Trust;

/// Error of a sum of shares that is rounding.
const ROUNDING: f64 = 1e-9;

/// What to look for, and with which false-alarm rate.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::diagnosis::Options;
/// use tauscope::identification::effect_model::Trust;
///
/// // Two laws alone, with the inertias of the description believed.
/// let candidates = ["backlash", "stribeck_friction"].map(str::to_owned).to_vec();
/// let options = Options { trust: Trust::Nominal, candidates, ..Options::default() };
/// assert!(options.check().is_ok() && options.alpha == 0.05);
///
/// let refused = Options { candidates: vec!["backlsh".to_owned()], ..options }.check().unwrap_err();
/// assert!(refused.to_string().contains("did you mean `backlash`?"));
/// ```
#[derive(Debug, Clone)]
pub struct Options {
    /// Whether the inertias of the description are believed, or estimated.
    pub trust: Trust,
    /// Family-wise false-alarm rate: probability of reporting any effect when the model is correct.
    pub alpha: f64,
    /// Most effects that are reported.
    pub max_findings: usize,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Names of the effects to look for; all where empty.
    pub candidates: Vec<String>,
    /// What decides whether an effect found is reported.
    pub criteria: Criteria,
}

impl Default for Options {
    fn default() -> Self {
        Options {
            trust: Trust::Structure,
            alpha: 0.05,
            max_findings: 24,
            seed: 0,
            candidates: Vec::new(),
            criteria: Criteria::default(),
        }
    }
}

impl Options {
    /// Refuses values out of range.
    ///
    /// # Errors
    /// If alpha is no probability between 0 and 1, the shares of it that the criteria spend exceed it, or a candidate is no effect of the
    /// library.
    pub fn check(&self) -> Result<()> {
        if !(self.alpha > 0.0 && self.alpha < 1.0) {
            return Err(Error::request("alpha", format!("is {}; give a probability between 0 and 1", self.alpha)));
        }
        let shares = self.criteria.shares_of_alpha();
        let spent: f64 = shares.iter().sum();
        if spent.is_nan() || spent > 1.0 + ROUNDING || shares.iter().any(|share| *share < 0.0) {
            let problem =
                format!("spend {spent} of alpha; give shares that are not negative and whose sum is at most one");
            return Err(Error::request("criteria.search and criteria.structure.together", problem));
        }
        self.candidates.iter().try_for_each(|name| effects::find(name).map(|_| ()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_more_than_alpha_can_be_spent() {
        let with = |training: f64| {
            let mut options = Options::default();
            options.criteria.search.training += training;
            options.check()
        };
        assert!(with(0.0).is_ok() && with(-0.1).is_ok());
        // No share makes room for another by being negative.
        let mut negative = Options::default();
        (negative.criteria.search.training, negative.criteria.search.confirmed) = (0.7, -0.1);
        assert!(negative.check().is_err());
        let message = with(1e-3).unwrap_err().to_string();
        assert!(message.contains("criteria.search") && message.contains("at most one"), "{message}");
        assert!(with(f64::NAN).is_err());
    }
}
