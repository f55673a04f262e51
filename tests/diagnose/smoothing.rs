//! Positions are smoothed as each encoder and the torque ask for.

use super::{SETUP, logs};
use tauscope::identification::effect_model::Trust;
use tauscope::identification::model::Model;
use tauscope::recording::Recording;
use tauscope_core::internal::diagnosis::Session;

/// Cut-offs of the joints from logs of which the encoder of joint 1 has steps of `step`, rad; zero for that of the scenario.
fn cutoffs(step: f64) -> Vec<f64> {
    let coarse = |mut log: Recording| {
        let steps = |q: &f64| if step > 0.0 { (q / step).round() * step } else { *q };
        log.q = log.q.map(|joint, q| if joint == 0 { q.iter().map(steps).collect() } else { q.to_vec() });
        log
    };
    let logs: Vec<Recording> = logs(&SETUP, 31, 2).into_iter().map(coarse).collect();
    Session::new(&Model::new(&SETUP.known), Trust::Structure, &[&logs[0]], &[&logs[1]]).unwrap().logs.cutoffs_hz
}

#[test]
fn a_coarse_encoder_is_smoothed_more_than_the_others() {
    let (fine, coarse) = (cutoffs(0.0), cutoffs(3e-3));
    assert!(coarse[0] < fine[0], "{coarse:?} {fine:?}");
    let others = coarse[1..].iter().copied().fold(0.0, f64::max);
    assert!(coarse[0] < others, "{coarse:?}");
}
