//! Laws that the library does not have, near ones that it has: none is named, and the structure is reported.

use super::{SETUP, logs, with};
use tauscope::diagnosis::{Diagnosis, Verdict};
use tauscope::effects::{Placed, find};
use tauscope::recording::Recording;

const JOINT: usize = 1;

fn diagnosed(logs: &[Recording], candidate: &str) -> Diagnosis {
    super::diagnosed(&SETUP.known, logs, &[candidate])
}

/// The log with its torque of one joint as a function of that and of the position.
fn distorted(mut log: Recording, law: impl Fn(f64, f64) -> f64) -> Recording {
    let q = log.q.channel(JOINT).to_vec();
    log.tau = log.tau.map(|joint, tau| {
        let of = |(tau, q): (&f64, &f64)| if joint == JOINT { law(*tau, *q) } else { *tau };
        tau.iter().zip(&q).map(of).collect()
    });
    log
}

fn largest(logs: &[Recording]) -> f64 {
    logs.iter().flat_map(|log| log.tau.channel(JOINT)).fold(0.0, |most, tau| most.max(tau.abs()))
}

fn told(diagnosis: &Diagnosis) -> Vec<(usize, &'static str)> {
    diagnosis.unexplained.iter().map(|left| (left.joint, left.structure)).collect()
}

#[test]
fn cogging_that_grows_with_the_load_is_no_ripple() {
    let logs: Vec<Recording> = logs(&SETUP, 31, 3);
    let largest = largest(&logs);
    let cogging = |tau: f64, q: f64| tau + 20.0 * (1.0 + 2.0 * tau / largest) * (20.0 * q).cos();
    let logs: Vec<Recording> = logs.into_iter().map(|log| distorted(log, cogging)).collect();
    let diagnosis = diagnosed(&logs, "torque_ripple");
    let verdicts: Vec<Verdict> = diagnosis.found.iter().map(|found| found.verdict).collect();
    assert_eq!(verdicts, [Verdict::Unexplained]);
    assert!(told(&diagnosis).iter().any(|(joint, _)| *joint == JOINT), "{:?}", told(&diagnosis));
}

#[test]
fn a_ripple_of_one_strength_keeps_its_name() {
    let ripple = Placed { parameters: vec![20.0, 0.0, 20.0], ..Placed::typical(find("torque_ripple").unwrap(), JOINT) };
    let diagnosis = diagnosed(&logs(&with(&[ripple]), 32, 3), "torque_ripple");
    let verdicts: Vec<Verdict> = diagnosis.found.iter().map(|found| found.verdict).collect();
    assert_eq!(verdicts, [Verdict::Named], "{:?}", told(&diagnosis));
}

#[test]
fn a_motor_that_saturates_is_no_gain() {
    let logs: Vec<Recording> = logs(&SETUP, 33, 3);
    let largest = largest(&logs);
    let saturating = |tau: f64, _: f64| tau * (1.0 - 0.1 * (tau / largest).powi(2));
    let logs: Vec<Recording> = logs.into_iter().map(|log| distorted(log, saturating)).collect();
    let diagnosis = diagnosed(&logs, "torque_gain");
    assert!(diagnosis.found.iter().all(|found| found.verdict != Verdict::Named), "{:?}", diagnosis.found);
    assert!(told(&diagnosis).iter().any(|(joint, _)| *joint == JOINT), "{:?}", told(&diagnosis));
}

/// Generic functions of the position explain what an offset leaves, and with that the offset too.
#[test]
fn an_offset_keeps_its_name_where_torque_follows_the_position_a_little() {
    for (structure, is_named) in [(3.0, true), (12.0, false)] {
        let law = |tau: f64, q: f64| tau + 15.0 + structure * (5.0 * q).sin();
        let logs: Vec<Recording> = logs(&SETUP, 35, 3).into_iter().map(|log| distorted(log, law)).collect();
        let diagnosis = diagnosed(&logs, "torque_offset");
        let named = diagnosis.found.iter().filter(|found| found.verdict == Verdict::Named).count();
        assert_eq!(named == 1, is_named, "{structure}: {:?} {:?}", diagnosis.found, told(&diagnosis));
        assert!(told(&diagnosis).iter().any(|(joint, _)| *joint == JOINT), "{structure}: {:?}", told(&diagnosis));
    }
}

/// A first axis along gravity does not feel the moments of what it carries until the base is tilted: their error is no part of the tilt.
#[test]
fn wrong_moments_of_the_first_link_do_not_change_a_tilt() {
    let truth = [0.05, -0.04];
    let tilt = Placed { effect: find("base_tilt").unwrap(), joint: 0, parameters: truth.to_vec() };
    let mut setup = with(&[tilt]);
    setup.plant.joints[0].inertia.0.iter_mut().for_each(|value| *value *= 2.0);
    let diagnosis = super::diagnosed(&SETUP.known, &logs(&setup, 31, 3), &["base_tilt", "torque_offset"]);
    let [found] = &diagnosis.found[..] else { panic!("{} found", diagnosis.found.len()) };
    for (k, truth) in truth.into_iter().enumerate() {
        let (value, std) = (found.member.placed.parameters[k], found.member.std[k]);
        assert!((value - truth).abs() < 4.0 * std && std < 0.002, "{value} +- {std}, truth {truth}");
    }
}
