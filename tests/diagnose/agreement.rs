//! `identify --effect` and `diagnose` estimate the same sizes from the same logs, and right ones; `identify --as-diagnose` the same numbers.

use super::{SETUP, diagnosed, logs, with};
use std::sync::LazyLock;
use tauscope::diagnosis::{Diagnosis, Estimated, Member, NamedParameter};
use tauscope::effects::{Placed, find};
use tauscope::identification::effect_model::{Preparation, Trust};
use tauscope::identification::fit::{Logs, fit_effects};
use tauscope::identification::model::Model;
use tauscope::recording::Recording;

/// Standard deviations, of the two estimates together or of one, within which two numbers are the same.
const SAME: f64 = 3.5;

/// Relative difference of numbers that one code works out from the same start.
const ROUNDING: f64 = 1e-9;

/// An arm with one hidden effect: its logs, the last of which is held out, and their diagnosis.
struct Case {
    truth: Placed,
    logs: Vec<Recording>,
    diagnosis: Diagnosis,
}

static CASES: LazyLock<Vec<Case>> = LazyLock::new(|| {
    let cases = [
        (71, "stribeck_friction", 1, vec![25.0, 0.15]),
        (72, "joint_spring", 2, vec![20.0, 5.0]),
        (73, "torque_offset", 3, vec![1.5]),
        // Large enough to be in the arm as found before it is named.
        (74, "torque_gain", 2, vec![0.3]),
        (75, "joint_elasticity", 1, vec![]),
    ];
    let case = |(seed, name, joint, parameters): (u64, &str, usize, Vec<f64>)| {
        let mut truth = Placed::typical(find(name).unwrap(), joint);
        truth.parameters[..parameters.len()].copy_from_slice(&parameters);
        let logs = logs(&with(std::slice::from_ref(&truth)), seed, 3);
        // A constant torque among all effects of the library: the others play no part where they are not found.
        let candidates = if name == "torque_offset" { &[][..] } else { &[name] };
        let diagnosis = diagnosed(&SETUP.known, &logs, candidates);
        Case { truth, logs, diagnosis }
    };
    cases.into_iter().map(case).collect()
});

/// Values and standard deviations of an effect's parameters by the fit of `identify` and by the diagnosis.
fn estimates(Case { truth, logs: all, diagnosis }: &Case) -> [Vec<(f64, f64)>; 2] {
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
    for case in CASES.iter() {
        let Case { truth, .. } = case;
        let name = truth.effect.about().name;
        let [of_fit, of_diagnosis] = estimates(case);
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

/// The same preparation, model and noise, and the same start of the shapes: only the search is left out.
#[test]
fn given_effects_are_estimated_as_those_that_a_diagnosis_finds() {
    for Case { truth, logs, diagnosis } in CASES.iter() {
        let name = truth.effect.about().name;
        let (test, train) = logs.split_last().unwrap();
        let question = Diagnosis::of(&SETUP.known).train(train).test([test]);
        let estimated: Estimated = question.estimate([truth.clone()]).unwrap();
        assert!(estimated.left_out.is_empty(), "{name}: {:?}", estimated.left_out);
        let ([one], [found]) = (&estimated.effects[..], &diagnosis.found[..]) else { panic!("{name}: {estimated:?}") };
        let Member { placed, std: deviations, .. } = &found.member;
        assert!(!one.parameters.is_empty());
        for NamedParameter { name: parameter, value, std, .. } in &one.parameters {
            let k = truth.effect.parameters().iter().position(|own| own.name == *parameter).unwrap();
            for (own, of_diagnosis) in [(value, placed.parameters[k]), (std, deviations[k])] {
                let text = format!("{name} {parameter}: {value} +- {std}, {of_diagnosis}");
                assert!((own - of_diagnosis).abs() < ROUNDING * of_diagnosis.abs(), "{text}");
            }
        }
        let errors = &diagnosis.errors;
        let rms = [
            (&estimated.test_rms_nm, &errors.extended_test_rms),
            (&estimated.test_rms_without_nm, &errors.baseline_rms[1]),
        ];
        for (own, of_diagnosis) in rms.into_iter().flat_map(|(own, of_diagnosis)| own.iter().zip(of_diagnosis)) {
            assert!((own - of_diagnosis).abs() < ROUNDING * of_diagnosis, "{name}: {own} {of_diagnosis}");
        }
    }
}
