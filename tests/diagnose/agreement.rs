//! `identify --effect` and `diagnose` estimate the same sizes from the same logs, and right ones.

use super::{SETUP, diagnosed, logs, with};
use tauscope::effects::{Placed, find};
use tauscope::identification::effect_model::{Preparation, Trust};
use tauscope::identification::fit::{Logs, fit_effects};
use tauscope::identification::model::Model;
use tauscope::recording::Recording;

/// Standard deviations, of the two estimates together or of one, within which two numbers are the same.
const SAME: f64 = 3.5;

/// Values and standard deviations of an effect's parameters by the fit of `identify` and by the diagnosis.
fn estimates(truth: &Placed, seed: u64) -> [Vec<(f64, f64)>; 2] {
    let all = logs(&with(std::slice::from_ref(truth)), seed, 3);
    let diagnosis = diagnosed(&SETUP.known, &all, &[truth.effect.about().name]);
    let [found] = &diagnosis.found[..] else {
        panic!("{}: {:?}, {:?}", truth.effect.about().name, diagnosis.found, (&diagnosis.minor, &diagnosis.rejected))
    };
    let [a, b, held_out] = &all[..] else { panic!() };
    let (train, test): ([&Recording; 2], [&Recording; 1]) = ([a, b], [held_out]);
    let placed = vec![Placed::typical(truth.effect, truth.joint)];
    let (model, logs) = (Model::new(&SETUP.known), Logs { train: &train, test: &test });
    let fitted = fit_effects(&model, Trust::Structure, logs, Preparation::usual(a), placed).unwrap().fit;
    let (values, std) = (&fitted.estimate.beta, fitted.estimate.std());
    let count = truth.parameters.len();
    // A form is chosen, not estimated.
    let of_fit = |parameter: usize| match fitted.places.iter().position(|place| *place == Some((0, parameter))) {
        Some(place) => (values[place], std[place]),
        None => (truth.parameters[parameter], 0.0),
    };
    let of_diagnosis = |parameter: usize| (found.member.placed.parameters[parameter], found.member.std[parameter]);
    [(0..count).map(of_fit).collect(), (0..count).map(of_diagnosis).collect()]
}

#[test]
fn identify_and_diagnose_estimate_the_same() {
    for (seed, name, joint, parameters) in [
        (71, "stribeck_friction", 1, vec![25.0, 0.15]),
        (72, "joint_spring", 2, vec![20.0, 5.0]),
        (73, "torque_offset", 3, vec![1.5]),
        // Large enough to be in the arm as found before it is named.
        (74, "torque_gain", 2, vec![0.3]),
        (75, "joint_elasticity", 1, vec![]),
    ] {
        let mut truth = Placed::typical(find(name).unwrap(), joint);
        truth.parameters[..parameters.len()].copy_from_slice(&parameters);
        let [of_fit, of_diagnosis] = estimates(&truth, seed);
        let mut compared = 0;
        for (k, ((fit, fit_std), (diagnosis, std))) in of_fit.into_iter().zip(of_diagnosis).enumerate() {
            if std == 0.0 || fit_std == 0.0 {
                continue;
            }
            compared += 1;
            let text = format!("{name} {k}: {fit} +- {fit_std}, {diagnosis} +- {std}, truth {}", truth.parameters[k]);
            assert!((fit - diagnosis).abs() < SAME * fit_std.hypot(std), "{text}");
            assert!((fit - truth.parameters[k]).abs() < SAME * fit_std, "{text}");
            assert!((diagnosis - truth.parameters[k]).abs() < SAME * std, "{text}");
        }
        assert!(compared > 0, "{name}: no parameter was estimated by both");
    }
}
