//! Positions are smoothed as each encoder and the torque ask for.

use super::{SETUP, diagnosed, logs};
use std::sync::LazyLock;
use tauscope::diagnosis::Verdict;
use tauscope::identification::effect_model::Trust;
use tauscope::identification::model::Model;
use tauscope::recording::Recording;
use tauscope::signal::ZeroPhaseLowPass;
use tauscope_core::internal::diagnosis::Session;

/// Steps of an encoder, rad, that are coarse for this arm.
const COARSE: f64 = 3e-3;
const MILLIRADIAN: f64 = 1e-3;

/// A log of which the encoder of joint 1 has steps of `step`, rad; zero for that of the scenario.
fn with_steps(step: f64, mut log: Recording) -> Recording {
    let steps = |q: &f64| if step > 0.0 { (q / step).round() * step } else { *q };
    log.q = log.q.map(|joint, q| if joint == 0 { q.iter().map(steps).collect() } else { q.to_vec() });
    log
}

/// A log whose torque went through a zero-phase low-pass.
fn filtered(hz: f64, mut log: Recording) -> Recording {
    let low_pass = ZeroPhaseLowPass::new(5, hz, log.rate_hz()).unwrap();
    log.tau = log.tau.map(|_, tau| {
        let mut tau = tau.to_vec();
        low_pass.apply_in_place(&mut tau).unwrap();
        tau
    });
    log
}

static MODEL: LazyLock<Model> = LazyLock::new(|| Model::new(&SETUP.known));

/// A session of logs after `change`.
fn opened(change: impl Fn(Recording) -> Recording) -> Session<'static> {
    let logs: Vec<Recording> = logs(&SETUP, 31, 2).into_iter().map(change).collect();
    Session::new(&MODEL, Trust::Structure, &[&logs[0]], &[&logs[1]]).unwrap()
}

/// How many joints have a band in which what positions hold may be noise of the encoder.
fn bands(session: &Session) -> usize {
    let logs = &session.logs;
    logs.train.baseline[logs.bands.clone()].iter().filter(|column| !column.parts.is_empty()).count()
}

#[test]
fn torque_that_was_filtered_shows_no_band_above_its_low_pass() {
    let plain = opened(|log| with_steps(COARSE, log));
    assert!(plain.logs.passband.is_none() && bands(&plain) > 0, "{:?}", plain.logs.cutoffs_hz);
    let filtered = opened(|log| filtered(1.5, with_steps(COARSE, log)));
    let passband = filtered.logs.passband.expect("the low-pass of the torque is found");
    assert!((passband.hz - 1.5).abs() < 0.3, "{passband:?}");
    assert_eq!(bands(&filtered), 0, "{:?}", filtered.logs.cutoffs_hz);
}

#[test]
fn a_coarse_encoder_is_smoothed_more_than_the_others() {
    let [fine, coarse] = [0.0, COARSE].map(|step| opened(|log| with_steps(step, log)).logs.cutoffs_hz.clone());
    assert!(coarse[0] < fine[0], "{coarse:?} {fine:?}");
    let others = coarse[1..].iter().copied().fold(0.0, f64::max);
    assert!(coarse[0] < others, "{coarse:?}");
}

/// A log of which all encoders have steps of a milliradian, and whose controllers take the errors of reading for errors of the position: they answer with
/// torque, `stiffness` N m/rad.
fn answered(stiffness: f64, log: Recording) -> Recording {
    let read = log.q.map(|_, q| q.iter().map(|q| (q / MILLIRADIAN).round() * MILLIRADIAN).collect());
    let tau = log.tau.map(|joint, tau| {
        let errors = read.channel(joint).iter().zip(log.q.channel(joint)).map(|(read, q)| read - q);
        tau.iter().zip(errors).map(|(tau, error)| tau - stiffness * error).collect()
    });
    Recording { q: read, qd: None, tau, ..log }
}

/// Encoders' noise that comes back as torque goes with all that is worked out from positions.
#[test]
fn torque_that_answers_to_noise_of_encoders_is_noise() {
    const STIFFNESS: f64 = 6e3;
    let logs: Vec<Recording> = logs(&SETUP, 33, 3).into_iter().map(|log| answered(STIFFNESS, log)).collect();
    let diagnosis = diagnosed(&SETUP.known, &logs, &["time_delay", "joint_elasticity", "stribeck_friction"]);
    assert_eq!(diagnosis.verdict, Verdict::None, "{:?} {:?}", diagnosis.found, diagnosis.unexplained);
    // Errors of reading are spread evenly over a step; ten samples make a row. A part of that torque is seen in the positions.
    let answer = STIFFNESS * MILLIRADIAN / 12f64.sqrt() / 10f64.sqrt();
    let left = &diagnosis.errors.extended_test_rms;
    assert!(left[3..].iter().all(|rms| *rms < 0.9 * answer), "{left:?} of {answer}");
}
