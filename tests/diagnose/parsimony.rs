//! Of laws that explain the same, the simplest is named, and none is that is best at a bound of itself.

use super::{SETUP, answer, diagnosed, logs, with};
use tauscope::diagnosis::{Diagnosis, Gate};
use tauscope::effects::{Placed, find};
use tauscope::recording::{self, Recording};
use tauscope::robot::{InertiaCheck, load};

const WRIST: usize = 5;

/// Every finding with its alternatives.
fn names(diagnosis: &Diagnosis) -> Vec<(&'static str, usize, Vec<&'static str>)> {
    let named = |found: &tauscope::diagnosis::Found| {
        let family = found.member.candidate.family();
        let alternatives = found.alternatives.iter().map(|other| other.family.effect);
        (family.effect, family.joint, alternatives.collect())
    };
    diagnosis.found.iter().map(named).collect()
}

fn hidden(effect: &str, joint: usize, parameters: &[f64]) -> Placed {
    Placed { effect: find(effect).unwrap(), joint, parameters: parameters.to_vec() }
}

fn rms(signals: impl Iterator<Item = f64> + Clone) -> f64 {
    (signals.clone().map(|x| x * x).sum::<f64>() / signals.count() as f64).sqrt()
}

fn torques(logs: &[Recording]) -> impl Iterator<Item = f64> + Clone {
    logs.iter().flat_map(|log| log.tau.channel(WRIST)).copied()
}

fn positions(logs: &[Recording]) -> impl Iterator<Item = f64> + Clone {
    logs.iter().flat_map(|log| log.q.channel(WRIST)).copied()
}

/// What of one law is found in logs of a wrist whose drive can do `effort`.
fn named_under(effort: f64, logs: &[Recording], law: &str) -> Vec<(&'static str, usize, Vec<&'static str>)> {
    let mut robot = SETUP.known.clone();
    robot.joints[WRIST].limits.effort = effort;
    names(&diagnosed(&robot, logs, &[law]))
}

/// An offset may have any size: a wrong zero of a torque sensor is no force that a drive could not bear.
#[test]
fn an_offset_larger_than_the_torque_of_a_wrist_is_an_offset() {
    let offset = 0.8 * rms(torques(&logs(&SETUP, 41, 1)));
    let logs = logs(&with(&[hidden("torque_offset", WRIST, &[offset])]), 41, 3);
    assert!(offset > 0.5 * rms(torques(&logs)), "{offset}");
    let named = named_under(10.0 * offset, &logs, "torque_offset");
    assert!(matches!(named[..], [("torque_offset", WRIST, _)]), "{named:?}");
}

/// Hoses do not carry an arm: their torque is at most half of that of their joint, or a tenth of what its drive can do.
#[test]
fn hoses_that_are_most_of_the_torque_of_an_idle_wrist_are_hoses() {
    let quiet = logs(&SETUP, 44, 1);
    let stiffness = 2.0 * rms(torques(&quiet)) / rms(positions(&quiet));
    let logs = logs(&with(&[hidden("joint_spring", WRIST, &[stiffness, 0.0])]), 44, 3);
    let spring = stiffness * rms(positions(&logs));
    assert!(spring > 0.5 * rms(torques(&logs)), "{spring}");
    let limit = 10.0 * spring;
    let named = named_under(1.3 * limit, &logs, "joint_spring");
    assert!(matches!(named[..], [("joint_spring", WRIST, _)]), "{named:?}");
    assert!(named_under(0.7 * limit, &logs, "joint_spring").is_empty());
}

#[test]
fn a_law_with_a_parameter_that_adds_nothing_is_an_alternative_to_the_simpler_one() {
    let laws = ["torque_offset", "friction_asymmetry"];
    let of = |viscous: f64, seed: u64| {
        diagnosed(&SETUP.known, &logs(&with(&[hidden("friction_asymmetry", 1, &[30.0, viscous])]), seed, 3), &laws)
    };
    let constant = names(&of(0.0, 42));
    assert!(
        matches!(&constant[..], [("torque_offset", 1, others)] if others == &["friction_asymmetry"]),
        "{constant:?}"
    );
    let rising = names(&of(40.0, 43));
    assert!(matches!(rising[..], [("friction_asymmetry", 1, _)]), "{rising:?}");
}

/// The joints of `reference/payload` have a ripple of seven periods a turn. On the second the best strut is one that is slack in the balanced
/// pose, against bodies of two hundred kilograms: its torque is more than the joint can have.
#[test]
fn a_strut_without_preload_takes_no_ripple() {
    let file = |name: &str| format!("{}/tests/reference/payload/{name}", env!("CARGO_MANIFEST_DIR"));
    let robot = load(file("arm.urdf"), InertiaCheck::Ignored).unwrap();
    let log = recording::load(file("before.csv"), None).unwrap();
    let diagnosis = Diagnosis::of(&robot).train([&log]).candidates(["gravity_balancer", "torque_ripple"]);
    let diagnosis = answer(diagnosis).into_conclusion().unwrap().diagnosis;
    let found = names(&diagnosis);
    assert!(found.iter().all(|(effect, ..)| *effect == "torque_ripple") && found.len() >= 4, "{found:?}");
    let refused =
        diagnosis.minor.iter().find(|minor| minor.found.member.candidate.family().effect == "gravity_balancer");
    assert_eq!(refused.unwrap().failed.gate, Gate::InProportion);
    assert!(diagnosis.unexplained.iter().all(|left| left.joint == 1), "{:?}", diagnosis.unexplained);
}
