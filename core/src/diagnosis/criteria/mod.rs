//! Thresholds that decide what is reported, each with its reason, and the judgement of a gate.
//!
//! In: the name of a gate, a number and its threshold. Out: whether it passes, and by how much.

mod comparison;
mod impacts;
mod replication;
mod search;
mod structure;
mod verdict;

pub(crate) use comparison::ComparisonCriteria;
pub(crate) use impacts::ImpactCriteria;
pub(crate) use replication::ReplicationCriteria;
pub use search::SearchCriteria;
pub(crate) use structure::StructureCriteria;
pub(crate) use verdict::VerdictCriteria;

use serde::Serialize;
use serde_json::{Value, json};

/// Thresholds that decide which effects are found and which of them are reported as findings.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Criteria {
    /// Least size of a finding over the torque of a joint, both root mean square: below 2 % no simulation is better for it.
    pub share_of_torque: f64,
    /// The same over the excess of the baseline's residual over the noise: a tenth of what is missing matters however small
    /// that is.
    pub share_of_excess: f64,
    /// Highest p-value of the strength of a finding by its scatter between blocks of the training logs (two-sided t test):
    /// the p-value of the search takes the noise for known, this one does not.
    pub strength_p: f64,
    /// Factor over the baseline by which no joint's held-out residual may grow with a finding: the parameters of the arm are estimated
    /// together, and every joint's prediction moves by a few percent with any.
    pub worse: f64,
    /// One-sided level of that growth: one standard deviation, since no joint is to be worse.
    pub worse_p: f64,
    /// Least gain of the logarithm of the restricted likelihood by a law over generic functions of all kinds: 3 are odds of
    /// 20 to 1.
    pub beyond_structure: f64,
    /// Thresholds of what held-out logs say.
    pub replication: ReplicationCriteria,
    /// Thresholds of the search that finds them.
    pub search: SearchCriteria,
    /// Thresholds of model comparison.
    pub comparison: ComparisonCriteria,
    /// Thresholds of gears with play that impacts show.
    pub impacts: ImpactCriteria,
    /// Thresholds of structure that no effect explains.
    pub structure: StructureCriteria,
    /// Thresholds of the verdict.
    pub verdict: VerdictCriteria,
}

impl Default for Criteria {
    fn default() -> Self {
        Criteria {
            share_of_torque: 0.02,
            share_of_excess: 0.1,
            strength_p: 0.01,
            worse: 1.1,
            worse_p: 0.16,
            beyond_structure: 3.0,
            replication: ReplicationCriteria::default(),
            search: SearchCriteria::default(),
            comparison: ComparisonCriteria::default(),
            impacts: ImpactCriteria::default(),
            structure: StructureCriteria::default(),
            verdict: VerdictCriteria::default(),
        }
    }
}

impl Criteria {
    /// The thresholds as `diagnosis.json` holds them: one that serves several questions also stands where each of them had its own.
    pub(crate) fn to_document(self) -> Value {
        let Criteria { comparison, replication, .. } = self;
        let shared = [
            ("", "contradicted_p", json!(replication.again_p)),
            ("/search", "again_p", json!(replication.again_p)),
            ("/search", "confirms_p", json!(replication.leans_p)),
            ("/search", "attempts", json!(replication.attempts())),
            ("/search", "hopeless_p", json!(replication.asked_p)),
            ("/structure", "again_p", json!(replication.again_p)),
            ("/structure", "confirmed_p", json!(replication.alone_p)),
            ("/structure", "looked_for_p", json!(replication.asked_p)),
            ("/structure", "leans_p", json!(replication.leans_p)),
            ("/structure", "adds_nothing_p", json!(comparison.encompassed_p)),
            ("/impacts", "each_p", json!(replication.again_p)),
        ];
        let mut document = json!(self);
        for (place, name, value) in shared {
            if let Some(Value::Object(fields)) = document.pointer_mut(place) {
                fields.insert(name.to_owned(), value);
            }
        }
        document
    }
}

/// A gate that a candidate of the search, or a finding, must pass.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Gate {
    /// Its family-wise p-value on the training logs, in the noise that is estimated with it and adjusted for errors in variables: at most
    /// its share of alpha.
    FamilyWise,
    /// None of its shapes is best at a bound of its law: what the statistic of the test loses inside it.
    AtBound,
    /// Torque is flat where the model exceeds the saturation limit: slope of the measured torque over the model's.
    Flat,
    /// Its p-value without the most influential blocks.
    Influence,
    /// It turns the sign of no earlier finding that has one sign only: number of those.
    EarlierSigns,
    /// It leaves the parameters of earlier findings identifiable: number of those that the logs determine without it and not with it.
    EarlierParameters,
    /// Its gain on held-out logs: lower bound (84 %) of the share of the residual that it explains.
    HeldOutGain,
    /// p-value of training and held-out logs together.
    Confirmation,
    /// p-value of each log by what the others predict for it.
    OtherLogs,
    /// A machine can have it with the parameters of the fit of all findings together: 1 where none can, as at the search each had to be
    /// possible with what was found before it.
    Believable,
    /// Its size matters: over the smaller of both least sizes.
    Size,
    /// Its strength differs from zero: p-value by its scatter between blocks.
    Strength,
    /// It explains some of the held-out residual of its own joints: share of the sum of squares.
    OwnJoint,
    /// No held-out log contradicts it: standard deviations by which the residual of the worst one grows.
    HeldOutLogs,
    /// No joint is predicted worse than by the baseline: factor on the residual of the one that is worst.
    EveryJoint,
    /// It explains more than generic functions do: gain of the logarithm of the restricted likelihood.
    BeyondStructure,
}

impl Gate {
    /// Why what fails is not a finding, as the end of a sentence that begins with it.
    pub fn reason(self) -> &'static str {
        match self {
            Gate::FamilyWise => "is not significant",
            Gate::AtBound => "is best at a bound of its law, where it is not that law any more",
            Gate::Flat => "is not flat where the model exceeds the limit",
            Gate::Influence => "rests on a moment or two",
            Gate::EarlierSigns => "gives an earlier finding a sign that it cannot have",
            Gate::EarlierParameters => "leaves parameters of an earlier finding undetermined",
            Gate::HeldOutGain => "explains too little of the held-out logs",
            Gate::Confirmation => "is not confirmed by the held-out logs",
            Gate::OtherLogs => "is not what the other logs predict",
            Gate::Believable => "has a size that no machine has",
            Gate::Size => "is too small to matter",
            Gate::Strength => "does not differ significantly from zero by its scatter between blocks",
            Gate::OwnJoint => "explains nothing of the held-out residual of its own joint",
            Gate::HeldOutLogs => "is contradicted by a held-out log",
            Gate::EveryJoint => "makes a joint's held-out prediction worse",
            Gate::BeyondStructure => "explains no more than generic functions do",
        }
    }
}

/// The judgement of a gate.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Judgement {
    /// The gate.
    pub gate: Gate,
    /// The value that decides.
    pub value: f64,
    /// The threshold that it is compared with.
    pub threshold: f64,
    /// Whether the candidate or finding passes.
    pub passed: bool,
}

impl Judgement {
    /// Passed where the value is at least the threshold.
    pub fn at_least(gate: Gate, value: f64, threshold: f64) -> Self {
        Judgement { gate, value, threshold, passed: value >= threshold }
    }

    /// Passed where the value is at most the threshold.
    pub fn at_most(gate: Gate, value: f64, threshold: f64) -> Self {
        Judgement { gate, value, threshold, passed: value <= threshold }
    }

    /// Passed where the value exceeds the threshold.
    pub fn above(gate: Gate, value: f64, threshold: f64) -> Self {
        Judgement { gate, value, threshold, passed: value > threshold }
    }

    /// Passed too where another condition holds.
    pub fn or(self, other: bool) -> Self {
        Judgement { passed: self.passed || other, ..self }
    }

    /// Passed only where another condition holds too.
    pub fn and(self, other: bool) -> Self {
        Judgement { passed: self.passed && other, ..self }
    }

    /// The first that is not passed.
    pub fn first_failed(judgements: impl IntoIterator<Item = Judgement>) -> Option<Judgement> {
        judgements.into_iter().find(|judgement| !judgement.passed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        assert!(count <= 60, "{count}");
        let document = Criteria::default().to_document();
        assert_eq!(document["structure"]["again_p"], document["replication"]["again_p"]);
        assert_eq!(document["search"]["attempts"], json!([1.25, 5.0]));
    }

    #[test]
    fn either_side_of_a_threshold() {
        let least = Criteria::default().beyond_structure;
        assert!(Judgement::at_least(Gate::BeyondStructure, least, least).passed);
        assert!(!Judgement::at_least(Gate::BeyondStructure, least - 1e-9, least).passed);
        let most = Criteria::default().worse;
        assert!(Judgement::at_most(Gate::EveryJoint, most, most).passed);
        assert!(!Judgement::at_most(Gate::EveryJoint, most + 1e-9, most).passed);
        assert!(!Judgement::at_most(Gate::Strength, f64::NAN, 0.01).passed);
        assert!(Judgement::above(Gate::HeldOutGain, 1e-9, 0.0).passed);
        assert!(!Judgement::above(Gate::HeldOutGain, 0.0, 0.0).passed);
        let failed = Judgement::above(Gate::HeldOutGain, -1.0, 0.0);
        assert!(failed.or(true).passed && !failed.or(false).passed && !failed.or(true).and(false).passed);
        assert_eq!(Judgement::first_failed([failed.or(true), failed]), Some(failed));
    }
}
