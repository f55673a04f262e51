//! Gates, and what they decide.

use serde::Serialize;

/// A gate that a candidate of the search, or a finding, must pass.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::diagnosis::Gate;
///
/// // Why what fails a gate is no finding, as the end of a sentence.
/// assert_eq!(format!("stribeck_friction {}", Gate::Size.reason()), "stribeck_friction is too small to matter");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Gate {
    /// Its family-wise p-value on the training logs, in the noise that is estimated with it and adjusted for errors in variables: at most
    /// its share of alpha.
    FamilyWise,
    /// None of its shapes is best at a bound of its law: what the statistic of the test loses inside it.
    AtBound,
    /// A law of friction over speed is likelier than friction whose sign is rounded: logarithm of the likelihood ratio to a plain sign.
    Rounding,
    /// Torque is flat where the model exceeds the saturation limit: slope of the measured torque over the model's.
    Flat,
    /// The torque stays within the saturation limit: the largest one, less the noise of its sensor, over the limit.
    Exceeded,
    /// Its p-value without the most influential blocks.
    Influence,
    /// It turns the sign of no earlier finding that has one sign only: number of those.
    EarlierSigns,
    /// It leaves the parameters of earlier findings identifiable: number of those that the logs determine without it and not with it.
    EarlierParameters,
    /// Its gain on held-out logs: share of the residual that it explains, its lower bound (84 %), or its upper one where it takes the place of
    /// other findings.
    HeldOutGain,
    /// p-value of training and held-out logs together.
    Confirmation,
    /// p-value of each log by what the others predict for it.
    OtherLogs,
    /// The residual of its joints is the noise: over the noise, on the worst one.
    Misfit,
    /// A machine can have it, at the search with what was found before it and in the end with all findings: its largest value over the
    /// limit of that value, infinite where a value has a sign that none can have.
    Believable,
    /// Its amplitudes are within the bounds of its law: standard deviations by which one is beyond.
    WithinBounds,
    /// It is about as large as the size at which its columns were taken: factor between both, infinite where they differ in sign.
    SameSize,
    /// Its torque is in proportion to that of its joint: over the most that can be.
    InProportion,
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
    /// Lags of single joints do not undo a shift of all torques: number of joints on which they do.
    Undone,
    /// Its amplitudes differ from zero by more than unexplained structure makes of them: p-value, for all shapes of its kind.
    UnderStructure,
    /// It explains more than generic functions do: gain of the logarithm of the restricted likelihood.
    BeyondStructure,
    /// The others do not make it superfluous: its p-value with them in the model.
    Needed,
    /// It explains about as much as the two findings whose place it would take: half of what the statistic loses over the number of
    /// parameters fewer (Akaike's criterion).
    Parsimony,
    /// Structure that no law explains does not replace it: share of what it explains that such structure explains beyond it.
    Replaced,
    /// It explains most of a joint of which structure stays unexplained with certainty: share of the held-out excess over the noise.
    Explained,
    /// The joints that it acts on are not predicted worse with it: factor on the held-out sum of squares.
    Predicts,
    /// Impacts of gear teeth are significant: family-wise p-value.
    Impacts,
    /// They are so on the held-out logs, too: p-value.
    ImpactsAgain,
    /// They are so among moments only in which the loads of gears change as much: p-value.
    ImpactsAlike,
    /// The play of a gear can be estimated: number of impacts whose time is determined.
    ImpactsTimed,
    /// A delay or a lag is more than sampling makes: its time over a sample.
    Sampling,
    /// Structure that no law explains is significant: family-wise p-value.
    Structure,
    /// The held-out logs show it too: p-value.
    StructureAgain,
    /// The same spectral line is in other logs: distance of the nearest one, Hz.
    SameLine,
    /// They gain by it: share of the residual that it explains, that without the block that gains most, or its lower bound (84 %).
    StructureGain,
    /// It is large enough: share of the joint's residual, in squares.
    StructureShare,
    /// A residual stands clear of what was expected: over that.
    AboveExpected,
    /// With all inertias estimated no more joints have unexplained structure that is certain than with those of the URDF: their number.
    InertiasUnexplained,
    /// With all inertias estimated fewer effects are found, where as many joints have such structure: their number.
    InertiasFindings,
}

impl Gate {
    /// Why what fails is not a finding, as the end of a sentence that begins with it.
    pub fn reason(self) -> &'static str {
        match self {
            Gate::FamilyWise => "is not significant",
            Gate::AtBound => "fits best at a bound of its parameters, where it is another law",
            Gate::Rounding => "is no likelier than friction whose sign is rounded",
            Gate::Flat => "is not flat where the model exceeds the limit",
            Gate::Exceeded => "is exceeded by the measured torque",
            Gate::Influence => "depends on two influential blocks",
            Gate::EarlierSigns => "gives an earlier finding a sign that it cannot have",
            Gate::EarlierParameters => "leaves parameters of an earlier finding undetermined",
            Gate::HeldOutGain => "explains too little of the held-out logs",
            Gate::Confirmation => "is not confirmed by the held-out logs",
            Gate::OtherLogs => "is not what the other logs predict",
            Gate::Misfit => "is on a joint whose residual is well above its noise",
            Gate::Believable => "has a size that no machine has",
            Gate::WithinBounds => "would have a parameter beyond its bounds",
            Gate::SameSize => "has an estimate of another size than that at which it was tested",
            Gate::InProportion => "would take more torque than its joint has",
            Gate::Size => "is too small to matter",
            Gate::Strength => "does not differ significantly from zero by its scatter between blocks",
            Gate::OwnJoint => "explains nothing of the held-out residual of its own joint",
            Gate::HeldOutLogs => "is contradicted by a held-out log",
            Gate::EveryJoint => "makes a joint's held-out prediction worse",
            Gate::Undone => "is undone by lags on several joints",
            Gate::UnderStructure => "does not differ significantly from zero in view of unexplained structure",
            Gate::BeyondStructure => "explains no more than generic functions do",
            Gate::Needed => "is superfluous with the other findings in the model",
            Gate::Parsimony => "explains less than the two findings whose place it would take",
            Gate::Replaced => "explains nothing beyond structure that no law explains",
            Gate::Explained => "explains a part only, with unexplained structure left",
            Gate::Predicts => "fits the training logs and not the held-out logs",
            Gate::Impacts | Gate::ImpactsAlike => "shows in impacts no more than chance does",
            Gate::ImpactsAgain => "does not show in impacts of the held-out logs",
            Gate::ImpactsTimed => "has no impact whose time is determined",
            Gate::Sampling => "is below a sample and below the noise, as sampling causes it",
            Gate::Structure => "is not significant",
            Gate::StructureAgain => "does not show in the held-out logs",
            Gate::SameLine => "is no spectral line of the other logs",
            Gate::StructureGain => "does not predict the held-out logs",
            Gate::StructureShare => "is too small a share of the residual",
            Gate::AboveExpected => "is not clear of what was expected",
            Gate::InertiasUnexplained => "leaves structure on more joints than the inertias of the description",
            Gate::InertiasFindings => "needs as many effects as the inertias of the description",
        }
    }
}

/// The judgement of a gate.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::diagnosis::{Gate, Judgement};
///
/// // A p-value of 0.2 is above alpha; a size of three times the least one is enough.
/// let judgements = [Judgement::at_least(Gate::Size, 3.0, 1.0), Judgement::at_most(Gate::FamilyWise, 0.2, 0.05)];
/// let failed = Judgement::first_failed(judgements).expect("one fails");
/// assert_eq!((failed.gate, failed.value, failed.threshold), (Gate::FamilyWise, 0.2, 0.05));
/// ```
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

    /// Passed where the value is below the threshold.
    pub fn below(gate: Gate, value: f64, threshold: f64) -> Self {
        Judgement { gate, value, threshold, passed: value < threshold }
    }

    /// Passed where the value exceeds the threshold.
    pub fn above(gate: Gate, value: f64, threshold: f64) -> Self {
        Judgement { gate, value, threshold, passed: value > threshold }
    }

    /// Passed too where another condition holds.
    pub fn or(self, other: bool) -> Self {
        Judgement { passed: self.passed || other, ..self }
    }

    /// The first that is not passed.
    pub fn first_failed(judgements: impl IntoIterator<Item = Judgement>) -> Option<Judgement> {
        judgements.into_iter().find(|judgement| !judgement.passed)
    }
}

#[cfg(test)]
mod tests {
    use super::super::thresholds::Criteria;
    use super::*;

    #[test]
    fn either_side_of_a_threshold() {
        let least = Criteria::default().levels.log_odds;
        assert!(Judgement::at_least(Gate::BeyondStructure, least, least).passed);
        assert!(!Judgement::at_least(Gate::BeyondStructure, least - 1e-9, least).passed);
        let most = Criteria::default().worse();
        assert!(Judgement::at_most(Gate::EveryJoint, most, most).passed);
        assert!(!Judgement::at_most(Gate::EveryJoint, most + 1e-9, most).passed);
        assert!(!Judgement::at_most(Gate::Strength, f64::NAN, 0.01).passed);
        assert!(Judgement::above(Gate::HeldOutGain, 1e-9, 0.0).passed);
        assert!(!Judgement::above(Gate::HeldOutGain, 0.0, 0.0).passed);
        assert!(Judgement::below(Gate::Flat, 0.5 - 1e-9, 0.5).passed && !Judgement::below(Gate::Flat, 0.5, 0.5).passed);
        let failed = Judgement::above(Gate::HeldOutGain, -1.0, 0.0);
        assert!(failed.or(true).passed && !failed.or(false).passed);
        assert_eq!(Judgement::first_failed([failed.or(true), failed]), Some(failed));
    }
}
