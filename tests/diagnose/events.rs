//! What happens in a part of the logs alone: a contact, and torque that is cut off at its peaks.

use super::{SETUP, diagnosed, logs, with};
use tauscope::diagnosis::{Diagnosis, Verdict};
use tauscope::effects::{Placed, find};
use tauscope::recording::Recording;

/// The only finding, which must be named: name of the effect, its parameters and their standard deviations.
fn only(diagnosis: &Diagnosis) -> (&'static str, &[f64], &[f64]) {
    assert_eq!(diagnosis.verdict, Verdict::Named, "{:?}", diagnosis.rejected);
    let [found] = &diagnosis.found[..] else { panic!("{:?}", diagnosis.found) };
    (found.member.candidate.family().effect, &found.member.placed.parameters, &found.member.std)
}

#[test]
fn a_contact_in_one_log_is_named_with_its_time() {
    let mut contact = Placed::typical(find("external_contact").unwrap(), 0);
    contact.parameters[..5].copy_from_slice(&[60.0, -40.0, 50.0, 4.0, 6.5]);
    let touched = logs(&with(std::slice::from_ref(&contact)), 81, 1).into_iter();
    let all: Vec<Recording> = touched.chain(logs(&SETUP, 81, 3).into_iter().skip(1)).collect();
    let diagnosis = diagnosed(&SETUP.known, &all, &["external_contact", "payload", "torque_offset"]);
    let (effect, values, std) = only(&diagnosis);
    assert_eq!(effect, "external_contact");
    assert!(
        (3..5).all(|k| (0.05..0.15).contains(&std[k])),
        "where an event begins is known to its left-out ends: {std:?}"
    );
    // No joint pays for its ends.
    let errors = &diagnosis.errors;
    let joints = errors.extended_test_rms.iter().zip(&errors.noise_floor);
    assert!(joints.clone().all(|(left, noise)| *left < 1.3 * noise), "{:?}", joints.collect::<Vec<_>>());
    assert_eq!(diagnosis.found[0].member.candidate.log, Some(0));
    for (k, within) in [(0, 10.0), (1, 10.0), (2, 10.0), (3, 0.1), (4, 0.1)] {
        assert!((values[k] - contact.parameters[k]).abs() < within, "{k}: {} for {}", values[k], contact.parameters[k]);
    }
}

#[test]
fn torque_that_is_cut_off_is_named_with_its_level() {
    let plain = logs(&SETUP, 82, 3);
    let largest = plain[..2].iter().flat_map(|log| log.tau.channel(1)).fold(0.0, |most: f64, tau| most.max(tau.abs()));
    let level = 0.8 * largest;
    let saturation = Placed { parameters: vec![level], ..Placed::typical(find("torque_saturation").unwrap(), 1) };
    let diagnosis = diagnosed(&SETUP.known, &logs(&with(&[saturation]), 82, 3), &["torque_saturation", "torque_gain"]);
    let (effect, values, std) = only(&diagnosis);
    assert_eq!(effect, "torque_saturation");
    assert!((values[0] - level).abs() < (4.0 * std[0]).max(0.01 * level), "{} +- {}, truth {level}", values[0], std[0]);
}
