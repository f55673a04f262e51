//! Findings as `diagnosis.json` and the reports hold them: effect, joints, parameters with units, alternatives.

use crate::diagnosis::answer::diagnosis::Diagnosis;
use crate::diagnosis::answer::inertias::Gain;
use crate::diagnosis::answer::quantities::Derived;
use crate::diagnosis::criteria::{Judgement, Levels};
use crate::diagnosis::model::Family;
use crate::diagnosis::search::{Found, Verdict};
use crate::effects::{self, Placed, Role, Scope};
use crate::robot::Robot;
use serde::Serialize;

/// Explanation of the finding that the inertias of the description are wrong as a whole.
const ALL_INERTIAS: &str = "The inertias of the robot description are wrong on several links: no single effect explains the \
                            logs, and re-identified base parameters do. extended.urdf holds them.";

/// Note on a finding whose amplitudes the logs leave open.
pub const NOT_SIZED: &str =
    "the logs show that it is there, and not how its parameters share it: none differs significantly from zero";

/// An effect that was found, in words and units.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// # use tauscope::diagnosis::Diagnosis;
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Ignored)?;
/// # let log = |name: &str| recording::load(format!("../tests/reference/pendulum/{name}.csv"), None);
/// # let (train, test) = (log("train")?, log("test")?);
/// # let answer = Diagnosis::of(&robot).train([&train]).test([&test]).candidates(["torque_ripple"]).run()?;
///
/// // What was found, where, how sure it is, and what it explains.
/// let finding = &answer.findings()[0];
/// assert_eq!((finding.effect, &finding.joints[..]), ("torque_ripple", &["pivot".to_owned()][..]));
/// assert!(finding.alternatives.is_empty() && finding.family_wise_p.is_some_and(|p| p < 1e-6));
/// assert!(finding.test_rms_after_nm[0] < 0.1 * finding.test_rms_before_nm[0]);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Serialize)]
pub struct Finding {
    /// Name of the effect.
    pub effect: &'static str,
    /// Names of its joints; none for an effect of the whole arm.
    pub joints: Vec<String>,
    /// Named, one of several, or unexplained.
    pub verdict: Verdict,
    /// Other effects that explain the logs as well, the likeliest first.
    pub alternatives: Vec<NamedAlternative>,
    /// Its parameters, and what derives from them.
    pub parameters: Vec<NamedParameter>,
    /// The gate that it failed once all was known, where its verdict is unexplained for that.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub withdrawn: Option<Judgement>,
    /// Whether any of its amplitudes differs significantly from zero.
    #[serde(rename = "size_told")]
    pub is_sized: bool,
    /// Family-wise p-value; None where none was worked out.
    pub family_wise_p: Option<f64>,
    /// Root mean square of the held-out residual without the effect, per joint, N m (N).
    pub test_rms_before_nm: Vec<f64>,
    /// The same with it.
    pub test_rms_after_nm: Vec<f64>,
    /// Lower bound (84 %) of the share of the held-out sum of squares that it explains.
    pub gain_lower_bound: f64,
    /// What the effect is.
    pub explanation: &'static str,
}

/// Another effect that explains the logs as well as a finding.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::diagnosis::NamedAlternative;
///
/// // As `Finding::alternatives` has it: another effect, half as likely by the logs.
/// let joints = vec!["elbow".to_owned()];
/// let other = NamedAlternative { effect: "torque_offset", joints, relative_likelihood: 0.5 };
/// let text = format!("or {} on {}: {}", other.effect, other.joints.join(", "), other.relative_likelihood);
/// assert_eq!(text, "or torque_offset on elbow: 0.5");
/// ```
#[derive(Debug, Clone, Serialize)]
pub struct NamedAlternative {
    /// Name of the effect.
    pub effect: &'static str,
    /// Names of its joints; none for an effect of the whole arm.
    pub joints: Vec<String>,
    /// Likelihood over that of the finding.
    pub relative_likelihood: f64,
}

/// A parameter of a finding.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// # use tauscope::diagnosis::Diagnosis;
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Ignored)?;
/// # let log = |name: &str| recording::load(format!("../tests/reference/pendulum/{name}.csv"), None);
/// # let (train, test) = (log("train")?, log("test")?);
/// # let answer = Diagnosis::of(&robot).train([&train]).test([&test]).candidates(["torque_ripple"]).run()?;
///
/// // The ripple has seven periods a turn.
/// let finding = &answer.findings()[0];
/// let harmonic = finding.parameters.iter().find(|parameter| parameter.name == "harmonic").expect("a shape");
/// assert!((harmonic.value - 7.0).abs() < 3.0 * harmonic.std && harmonic.unit == "1/turn");
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Serialize)]
pub struct NamedParameter {
    /// Its name.
    pub name: &'static str,
    /// The joint; None for an effect of the whole arm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub joint: Option<String>,
    /// The estimate.
    pub value: f64,
    /// Its standard deviation; infinite where the logs do not determine it.
    pub std: f64,
    /// Unit of both.
    pub unit: &'static str,
}

/// The law that stands for the inertias of the description as a whole.
pub(in crate::diagnosis::answer) fn law_of_inertias() -> &'static str {
    effects::wrong_inertia().about().name
}

/// All findings, wrong inertias as a whole first.
pub fn findings(robot: &Robot, diagnosis: &Diagnosis) -> Vec<Finding> {
    let inertias = diagnosis.inertias.iter().map(|gain| all_inertias(robot, gain));
    let found = diagnosis.found.iter().zip(&diagnosis.derived);
    let levels = &diagnosis.scope.criteria.levels;
    inertias.chain(found.map(|(found, derived)| finding(robot, found, derived, levels))).collect()
}

/// The inertias of the description are wrong as a whole.
fn all_inertias(robot: &Robot, gain: &Gain) -> Finding {
    let [before, after] = gain.rms.clone();
    Finding {
        effect: law_of_inertias(),
        joints: robot.joint_names(),
        verdict: Verdict::Named,
        alternatives: Vec::new(),
        parameters: Vec::new(),
        withdrawn: None,
        is_sized: false,
        family_wise_p: None,
        test_rms_before_nm: before,
        test_rms_after_nm: after,
        gain_lower_bound: gain.lower_bound,
        explanation: ALL_INERTIAS,
    }
}

/// An effect found, with what follows from its parameters; `levels` decide whether its size is significant.
pub fn finding(robot: &Robot, found: &Found, derived: &[Derived], levels: &Levels) -> Finding {
    let placed = &found.member.placed;
    let own = joints(robot, found.member.candidate.family());
    let values = placed.effect.parameters().iter().enumerate().zip(placed.parameters.iter().zip(&found.member.std));
    let alternatives = found.alternatives.iter().map(|other| NamedAlternative {
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
            .map(|(name, value, std, unit)| NamedParameter { name, joint: joint.clone(), value, std, unit })
            .collect(),
        withdrawn: found.withdrawn,
        is_sized: found.member.is_sized(levels),
        joints: own,
        family_wise_p: Some(found.family_wise_p),
        test_rms_before_nm: before,
        test_rms_after_nm: after,
        gain_lower_bound: found.gain_lower_bound,
        explanation: placed.effect.about().explanation,
    }
}

/// Names of the joints of an effect; none for one on the whole arm.
pub fn joints(robot: &Robot, family: Family) -> Vec<String> {
    let effect = effects::find(family.effect).ok();
    let placed = effect.filter(|effect| effect.about().scope != Scope::Arm);
    let placed = placed.map(|effect| Placed::typical(effect, family.joint).joints()).unwrap_or_default();
    placed.into_iter().map(|joint| robot.joints[joint].name.clone()).collect()
}
