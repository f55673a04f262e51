//! Of laws that explain the same, the simplest is named, and none is that is best at a bound of itself.

use super::{SETUP, diagnosed, logs, with};
use tauscope::diagnosis::Diagnosis;
use tauscope::effects::{Placed, find};
use tauscope::recording::Recording;

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

fn rms(logs: &[Recording], joint: usize) -> f64 {
    let torques = || logs.iter().flat_map(|log| log.tau.channel(joint));
    (torques().map(|tau| tau * tau).sum::<f64>() / torques().count() as f64).sqrt()
}

/// An offset that is most of a wrist's torque can be that of a drive that could do much more, and not of one that works near its limit.
#[test]
fn an_offset_larger_than_the_torque_of_an_idle_wrist_is_an_offset() {
    let offset = 0.8 * rms(&logs(&SETUP, 41, 1), WRIST);
    let logs = logs(&with(&[hidden("torque_offset", WRIST, &[offset])]), 41, 3);
    assert!(offset > 0.5 * rms(&logs, WRIST), "{offset}");
    let of = |effort: f64| {
        let mut robot = SETUP.known.clone();
        robot.joints[WRIST].limits.effort = effort;
        names(&diagnosed(&robot, &logs, &["torque_offset"]))
    };
    // Half of a tenth of the limit, which is a third more or less than the offset.
    let limit = 20.0 * offset;
    let named = of(1.3 * limit);
    assert!(matches!(named[..], [("torque_offset", WRIST, _)]), "{named:?}");
    assert!(of(0.7 * limit).is_empty());
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
