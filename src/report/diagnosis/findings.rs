//! The findings of `diagnosis.json`.

use crate::diagnosis::{Diagnosis, Family, Found, Gain, Verdict};
use crate::effects::{self, Placed, Role, Scope};
use crate::robot::Robot;
use serde::Serialize;

/// File of the scenario with the extended model, and of its bodies and drives.
pub(crate) const EXTENDED_SCENARIO: &str = "extended.toml";
/// The URDF that [`EXTENDED_SCENARIO`] refers to.
pub(crate) const EXTENDED_URDF: &str = "extended.urdf";

/// What is said where the inertias of the description are wrong as a whole.
const ALL_INERTIAS: &str = "The inertias of the robot description are wrong on several links: no single effect explains the \
                            logs, and re-identified base parameters do. extended.urdf holds them.";

#[derive(Debug, Serialize)]
pub(super) struct Finding {
    pub(super) effect: &'static str,
    pub(super) joints: Vec<String>,
    pub(super) verdict: Verdict,
    pub(super) alternatives: Vec<Alternative>,
    pub(super) parameters: Vec<Parameter>,
    /// Whether any of its amplitudes is told from zero.
    pub(super) size_told: bool,
    pub(super) family_wise_p: f64,
    pub(super) test_rms_before_nm: Vec<f64>,
    pub(super) test_rms_after_nm: Vec<f64>,
    pub(super) gain_lower_bound: f64,
    pub(super) explanation: &'static str,
}

#[derive(Debug, Serialize)]
pub(super) struct Alternative {
    pub(super) effect: &'static str,
    pub(super) joints: Vec<String>,
    pub(super) relative_likelihood: f64,
}

#[derive(Debug, Serialize)]
pub(super) struct Parameter {
    pub(super) name: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) joint: Option<String>,
    pub(super) value: f64,
    pub(super) std: f64,
    pub(super) unit: &'static str,
}

pub(super) fn findings(robot: &Robot, diagnosis: &Diagnosis) -> Vec<Finding> {
    let inertias = diagnosis.inertias.iter().map(|gain| all_inertias(robot, gain));
    let found = diagnosis.found.iter().zip(&diagnosis.derived);
    inertias.chain(found.map(|(found, derived)| finding(robot, found, derived))).collect()
}

/// What is said of a finding whose amplitudes the logs leave open.
pub(crate) const NOT_SIZED: &str =
    "the logs show that it is there, and not how its parameters share it: none is told from zero";

/// The inertias of the description are wrong as a whole.
fn all_inertias(robot: &Robot, gain: &Gain) -> Finding {
    let [before, after] = gain.rms.clone();
    Finding {
        effect: "link_inertia_error",
        joints: robot.joint_names(),
        verdict: Verdict::Named,
        alternatives: Vec::new(),
        parameters: Vec::new(),
        size_told: false,
        family_wise_p: 0.0,
        test_rms_before_nm: before,
        test_rms_after_nm: after,
        gain_lower_bound: gain.lower_bound,
        explanation: ALL_INERTIAS,
    }
}

pub(super) fn finding(robot: &Robot, found: &Found, derived: &[crate::diagnosis::Derived]) -> Finding {
    let placed = &found.member.placed;
    let own = joints(robot, found.member.candidate.family());
    let values = placed.effect.parameters().iter().enumerate().zip(placed.parameters.iter().zip(&found.member.std));
    let alternatives = found.alternatives.iter().map(|other| Alternative {
        effect: other.family.effect,
        joints: joints(robot, other.family),
        relative_likelihood: other.relative_likelihood,
    });
    let joint = own.first().cloned();
    let parameters = values
        .filter(|((_, parameter), _)| parameter.role != Role::Held)
        .map(|((k, parameter), (&value, &std))| (parameter.name, value, std, placed.unit(k, robot)));
    let derived = derived.iter().map(|one| (one.name, one.value, one.std, one.unit));
    let [before, after] = found.rms.clone();
    Finding {
        effect: placed.effect.about().name,
        verdict: found.verdict,
        alternatives: alternatives.collect(),
        parameters: parameters
            .chain(derived)
            .map(|(name, value, std, unit)| Parameter { name, joint: joint.clone(), value, std, unit })
            .collect(),
        size_told: found.member.is_sized(),
        joints: own,
        family_wise_p: found.family_wise_p,
        test_rms_before_nm: before,
        test_rms_after_nm: after,
        gain_lower_bound: found.gain_lower_bound,
        explanation: placed.effect.about().explanation,
    }
}

/// Names of the joints of an effect; none for one on the whole arm.
pub(crate) fn joints(robot: &Robot, family: Family) -> Vec<String> {
    let effect = effects::find(family.effect).ok();
    let placed = effect.filter(|effect| effect.about().scope != Scope::Arm);
    let placed = placed.map(|effect| Placed::typical(effect, family.joint).joints()).unwrap_or_default();
    placed.into_iter().map(|joint| robot.joints[joint].name.clone()).collect()
}
