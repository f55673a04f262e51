use super::*;
use crate::channels::Channels;
use crate::identification::regression::joint_regression::JointRegression;
use crate::identification::regression::least_squares::Estimate;
use crate::random;
use rand_distr::{Distribution, StandardNormal};

const TRUTH: [f64; 3] = [2.0, -0.7, 4.0];

/// Two joints whose columns are known: exact ones, those disturbed by `column_noise`, torque by `torque_noise` on joint 2.
fn problem(column_noise: f64, torque_noise: [f64; 2], outliers: bool) -> (Vec<JointRegression>, Vec<JointRegression>) {
    let samples = 4000;
    let mut source = random::stream(5, "estimators", 0);
    let mut normal = || -> f64 { StandardNormal.sample(&mut source) };
    let shapes = [[1.0, 0.31], [0.7, 0.11], [0.4, 0.53]];
    let mut exact = Vec::new();
    let mut measured = Vec::new();
    for (joint, parameters) in [vec![0, 1, 2], vec![1, 2]].into_iter().enumerate() {
        let column = |p: usize| -> Vec<f64> {
            let [size, rate] = shapes[p];
            (0..samples).map(|t| size * ((rate + 0.07 * joint as f64) * t as f64).sin()).collect()
        };
        let columns: Vec<Vec<f64>> = parameters.iter().map(|&p| column(p)).collect();
        let torque: Vec<f64> = (0..samples)
            .map(|t| {
                let clean: f64 = parameters.iter().zip(&columns).map(|(&p, c)| TRUTH[p] * c[t]).sum();
                let far = if outliers && t % 20 == 0 { 30.0 } else { 0.0 };
                clean + torque_noise[joint] * normal() + far
            })
            .collect();
        let noisy: Vec<Vec<f64>> =
            columns.iter().map(|c| c.iter().map(|v| v + column_noise * normal()).collect()).collect();
        let rows = |table: &[Vec<f64>]| JointRegression {
            joint: format!("joint_{}", joint + 1),
            parameters: parameters.clone(),
            columns: Channels::from_vectors(table),
            torque: torque.clone(),
            valid: vec![true; samples],
        };
        exact.push(rows(&columns));
        measured.push(rows(&noisy));
    }
    (exact, measured)
}

/// A simulation that gives the exact columns whatever the parameters.
struct Exact(Vec<JointRegression>);

impl SimulatedRows for Exact {
    fn rows(&self, _beta: &[f64]) -> Result<Vec<JointRegression>> {
        Ok(self.0.clone())
    }
}

fn estimates(exact: Vec<JointRegression>, measured: &[JointRegression]) -> Vec<(&'static str, Estimate)> {
    let names = ["a", "b", "c"].map(str::to_owned);
    let simulated = Exact(exact);
    let data = Data { rows: measured, names: &names, start: &[1.0; 3], simulated: Some(&simulated) };
    ALL.iter().map(|estimator| (estimator.name(), estimator.estimate(&data).unwrap())).collect()
}

fn worst(estimate: &Estimate) -> f64 {
    estimate.beta.iter().zip(TRUTH).map(|(b, t)| ((b - t) / t).abs()).fold(0.0, f64::max)
}

#[test]
fn all_find_the_truth_without_noise() {
    let (exact, measured) = problem(0.0, [0.0; 2], false);
    for (name, estimate) in estimates(exact, &measured) {
        assert!(worst(&estimate) < 1e-8, "{name}: {:?}", estimate.beta);
    }
}

#[test]
fn intervals_of_all_hold_the_truth_under_torque_noise() {
    let (exact, measured) = problem(0.0, [0.1, 3.0], false);
    for (name, estimate) in estimates(exact, &measured) {
        for ((value, truth), std) in estimate.beta.iter().zip(TRUTH).zip(estimate.std()) {
            assert!((value - truth).abs() < 4.0 * std, "{name}: {value} {truth} {std}");
            // The joint with little noise determines each parameter to about noise over column length.
            assert!(name == "ols" || std < 0.02, "{name}: {std}");
        }
    }
}

#[test]
fn noise_in_the_columns_biases_least_squares_and_not_the_estimators_with_a_simulation() {
    let (exact, measured) = problem(0.2, [0.05; 2], false);
    for (name, estimate) in estimates(exact, &measured) {
        let error = worst(&estimate);
        match name {
            // Attenuation of the third column: its power .08 against .04 of noise.
            "ols" | "wls" | "irls" | "lm" => assert!(error > 0.2, "{name}: {error}"),
            "iv" | "didim" => assert!(error < 0.02, "{name}: {error}"),
            _ => {}
        }
    }
}

#[test]
fn outliers_move_the_robust_estimator_least() {
    let (exact, measured) = problem(0.0, [0.1; 2], true);
    let found = estimates(exact, &measured);
    let of = |wanted: &str| worst(&found.iter().find(|(name, _)| *name == wanted).unwrap().1);
    assert!(of("irls") < 0.2 * of("wls"), "{} {}", of("irls"), of("wls"));
}

#[test]
fn names_are_found_and_others_refused_with_a_list() {
    for estimator in ALL {
        assert_eq!(find(estimator.name()).unwrap().name(), estimator.name());
    }
    let Err(error) = find("mle") else { panic!("there is no such estimator") };
    assert!(error.to_string().contains("ols, wls, irls, lm, tls, iv, didim"), "{error}");
}

#[test]
fn estimators_with_a_simulation_refuse_logs_without_one() {
    let (_, measured) = problem(0.0, [0.1; 2], false);
    let names = ["a", "b", "c"].map(str::to_owned);
    let data = Data { rows: &measured, names: &names, start: &[1.0; 3], simulated: None };
    for estimator in ALL.iter().filter(|estimator| estimator.simulates()) {
        assert!(estimator.estimate(&data).unwrap_err().to_string().contains("controller"));
    }
}
