//! What books write in several forms, and what sampling does, are no second effect.

use super::{SETUP, logs, with};
use tauscope::diagnosis::Diagnosis;
use tauscope::effects::{Placed, Rounding, find};
use tauscope::recording::Recording;
use tauscope::scenario::Setup;

fn diagnosed(logs: &[Recording], candidates: &[&str]) -> Diagnosis {
    super::diagnosed(&SETUP.known, logs, candidates)
}

fn families(diagnosis: &Diagnosis) -> Vec<(&'static str, usize)> {
    let families = diagnosis.found.iter().map(|found| found.member.candidate.family());
    families.map(|family| (family.effect, family.joint)).collect()
}

#[test]
fn an_exponential_stribeck_curve_is_one_finding() {
    let tustin = Placed { effect: find("stribeck_friction").unwrap(), joint: 1, parameters: vec![120.0, 0.1, 1.0] };
    let logs = logs(&with(&[tustin]), 21, 3);
    let speed_laws = ["stribeck_friction", "nonlinear_viscous_friction", "presliding_hysteresis"];
    let diagnosis = diagnosed(&logs, &speed_laws);
    assert_eq!(families(&diagnosis), [("stribeck_friction", 1)]);
    let found = &diagnosis.found[0];
    assert_eq!(found.member.placed.parameters[2], 1.0);
    for (value, std, truth) in
        [(0, 120.0), (1, 0.1)].map(|(k, truth)| (found.member.placed.parameters[k], found.member.std[k], truth))
    {
        assert!((value - truth).abs() < 4.0 * std, "{value} +- {std}, truth {truth}");
    }
}

#[test]
fn a_part_of_a_sample_of_delay_is_no_finding() {
    let late = |mut log: Recording, samples: f64| {
        log.tau = log.tau.map(|_, tau| {
            let before = |k: usize| tau[k.saturating_sub(1)];
            (0..tau.len()).map(|k| tau[k] - samples * (tau[k] - before(k))).collect()
        });
        log
    };
    let period = 1.0 / SETUP.scenario.sensors.rate_hz;
    let later = |setup: &Setup, samples: f64| -> Vec<Recording> {
        logs(setup, 22, 3).into_iter().map(|log| late(log, samples)).collect()
    };
    let diagnosis = diagnosed(&later(&SETUP, 0.1), &["time_delay"]);
    assert_eq!(families(&diagnosis), []);
    let [delay, std] = diagnosis.of_sampling[0].seconds;
    assert!((delay - 0.1 * period).abs() < 4.0 * std, "{delay} +- {std}");
    // A longer one is; a part of a sample is not, however little noise there is.
    assert_eq!(families(&diagnosed(&later(&SETUP, 1.3), &["time_delay"])), [("time_delay", 0)]);
    let mut precise = with(&[]);
    precise.sensors.iter_mut().for_each(|sensor| sensor.torque_noise *= 0.1);
    let diagnosis = diagnosed(&later(&precise, 0.4), &["time_delay"]);
    assert_eq!(families(&diagnosis), []);
    let [delay, std] = diagnosis.of_sampling[0].seconds;
    assert!((delay - 0.4 * period).abs() < 4.0 * std, "{delay} +- {std}");
}

/// Simulators round dry friction near standstill, which looks like two laws of low speed on every joint.
#[test]
fn friction_that_turns_over_some_speed_is_no_finding() {
    let speed_laws = ["stribeck_friction", "nonlinear_viscous_friction", "presliding_hysteresis"];
    for rounding in [Rounding::Tanh(0.03), Rounding::Ramp(0.08), Rounding::Constraint(0.5), Rounding::Root(0.02)] {
        let smooth = |mut log: Recording| {
            let truth = log.truth.as_ref().unwrap();
            let (qd, qdd) = (truth.qd.clone(), truth.qdd.clone());
            log.tau = log.tau.map(|joint, tau| {
                let dry = SETUP.plant.joints[joint].drive.coulomb;
                let moving = qd.channel(joint).iter().zip(qdd.channel(joint));
                let turned = moving.map(|(&v, &a)| dry * (rounding.direction(v, a) - v.signum()));
                tau.iter().zip(turned).map(|(tau, turned)| tau + turned).collect()
            });
            log
        };
        let logs: Vec<Recording> = logs(&SETUP, 25, 3).into_iter().map(smooth).collect();
        let diagnosis = diagnosed(&logs, &speed_laws);
        assert_eq!(families(&diagnosis), [], "{rounding:?}");
        let found = &diagnosis.logs.coulomb_rounding;
        let is_close = |own: &&Rounding| {
            let same_form = std::mem::discriminant(*own) == std::mem::discriminant(&rounding);
            same_form && (own.width() / rounding.width() - 1.0).abs() < 0.4
        };
        assert!(found.iter().filter(is_close).count() >= 4, "{rounding:?}: {found:?}");
    }
    // A law of one joint is not taken for the friction of all.
    let concave =
        Placed { effect: find("nonlinear_viscous_friction").unwrap(), joint: 1, parameters: vec![60.0, 0.3, 0.01] };
    let diagnosis = diagnosed(&super::logs(&with(&[concave]), 25, 3), &speed_laws);
    assert_eq!(families(&diagnosis), [("nonlinear_viscous_friction", 1)]);
    assert_eq!(diagnosis.logs.coulomb_rounding, [Rounding::Sharp; 6]);
}

#[test]
fn a_joint_without_torque_is_left_out_and_the_others_are_diagnosed() {
    let tustin = Placed { effect: find("stribeck_friction").unwrap(), joint: 1, parameters: vec![120.0, 0.1, 1.0] };
    let mut logs = logs(&with(&[tustin]), 21, 3);
    logs.iter_mut().for_each(|log| log.tau.channel_mut(5).fill(f64::NAN));
    let diagnosis = diagnosed(&logs, &["stribeck_friction"]);
    assert_eq!(families(&diagnosis), [("stribeck_friction", 1)]);
    assert_eq!(diagnosis.logs.equations, [true, true, true, true, true, false]);
    let all = diagnosis
        .errors
        .noise_floor
        .iter()
        .chain(&diagnosis.errors.extended_test_rms)
        .chain(&diagnosis.errors.baseline_rms[1]);
    assert!(all.copied().all(f64::is_finite));
}
