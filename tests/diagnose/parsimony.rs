//! Of laws that explain the same, the simplest is named, and none is that is best at a bound of itself.

use super::{SETUP, answer, logs, with};
use tauscope::diagnosis::Diagnosis;
use tauscope::effects::{Placed, find};
use tauscope::recording::Recording;

const WRIST: usize = 5;

fn diagnosed(logs: &[Recording], candidates: &[&str]) -> Diagnosis {
    let (test, train) = logs.split_last().unwrap();
    let diagnosis = Diagnosis::of(&SETUP.known).train(train).test([test]).candidates(candidates.iter().copied());
    answer(diagnosis).into_conclusion().unwrap().diagnosis
}

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

fn rms(logs: &[Recording], joint: usize) -> f64 {
    let torques = || logs.iter().flat_map(|log| log.tau.channel(joint));
    (torques().map(|tau| tau * tau).sum::<f64>() / torques().count() as f64).sqrt()
}

/// A wrist that carries next to nothing: its sensor's offset is most of its torque, and no strut is on it.
#[test]
fn an_offset_larger_than_the_torque_of_an_idle_wrist_is_an_offset() {
    let offset = 0.8 * rms(&logs(&SETUP, 41, 1), WRIST);
    let logs = logs(&with(&[hidden("torque_offset", WRIST, &[offset])]), 41, 3);
    let largest = rms(&logs, WRIST);
    assert!(offset > 0.5 * largest && offset < 0.05 * SETUP.known.joints[WRIST].limits.effort, "{offset} {largest}");
    let diagnosis = diagnosed(&logs, &["torque_offset", "joint_spring", "gravity_balancer"]);
    let names = names(&diagnosis);
    assert!(matches!(names[..], [("torque_offset", WRIST, _)]), "{names:?}");
}

#[test]
fn a_law_with_a_parameter_that_adds_nothing_is_an_alternative_to_the_simpler_one() {
    let laws = ["torque_offset", "friction_asymmetry"];
    let of = |viscous: f64, seed: u64| {
        diagnosed(&logs(&with(&[hidden("friction_asymmetry", 1, &[30.0, viscous])]), seed, 3), &laws)
    };
    let constant = names(&of(0.0, 42));
    assert!(
        matches!(&constant[..], [("torque_offset", 1, others)] if others == &["friction_asymmetry"]),
        "{constant:?}"
    );
    let rising = names(&of(40.0, 43));
    assert!(matches!(rising[..], [("friction_asymmetry", 1, _)]), "{rising:?}");
}
