//! Identification on the simulated IRB 1600: exact without noise, honest intervals with it, the same by both solvers.

use std::path::PathBuf;
use std::sync::LazyLock;
use tauscope::identification::consistent::consistent;
use tauscope::identification::effect_model::{Preparation, Trust};
use tauscope::identification::equations::observed;
use tauscope::identification::fit::{Logs, fit_effects};
use tauscope::identification::least_squares::weighted_least_squares;
use tauscope::identification::levenberg_marquardt::{Damping, Options, minimize};
use tauscope::identification::linear_problem::LinearProblem;
use tauscope::identification::model::Model;
use tauscope::identification::prepare::Smoothing;
use tauscope::identification::reversals::Band;
use tauscope::recording::Recording;
use tauscope::scenario::{Setup, measure};
use tauscope::study::testbed::{self, Run, Runs, Variant, identify, prepared};

/// The short scenario, simulated once for all tests.
static CASE: LazyLock<(Setup, Model, Runs)> = LazyLock::new(|| {
    let setup =
        Setup::load(PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/scenarios/short.toml"), None).unwrap();
    let model = Model::new(&setup.plant);
    let runs = testbed::record(&setup, &mut |_| {}).unwrap();
    (setup, model, runs)
});

fn names(model: &Model) -> Vec<String> {
    model.base().groupings().iter().map(|g| g.name.clone()).collect()
}

#[test]
fn without_noise_the_base_parameters_are_the_plants() {
    let (setup, model, runs) = &*CASE;
    let scored = identify(setup, model, runs, Variant::Exact).unwrap();
    for (name, error) in names(model).iter().zip(&scored.score.relative_errors) {
        assert!(error.abs() < 1e-6, "{name}: {error:e}");
    }
    for std in scored.score.torque_std_held_out_nm {
        assert!(std < 1e-6);
    }
}

#[test]
fn smoothing_lowers_the_torque_standard_deviation_on_every_joint() {
    let (setup, model, runs) = &*CASE;
    let raw = identify(setup, model, runs, Variant::Raw).unwrap().score;
    let smoothed = identify(setup, model, runs, Variant::SavitzkyGolay).unwrap().score;
    for joint in 0..setup.plant.dof() {
        assert!(smoothed.torque_std_training_nm[joint] < raw.torque_std_training_nm[joint]);
        assert!(smoothed.torque_std_held_out_nm[joint] < raw.torque_std_held_out_nm[joint]);
    }
    assert!(smoothed.d_beta < raw.d_beta);
}

#[test]
fn levenberg_marquardt_agrees_with_weighted_least_squares() {
    let (setup, model, runs) = &*CASE;
    let regression = prepared(setup, &runs.training, Variant::SavitzkyGolay).unwrap().regression(model).unwrap();
    let linear = weighted_least_squares(&regression, &names(model)).unwrap();
    let mut problem = LinearProblem::new(&regression, &linear.sigma, linear.beta.len());
    for damping in [Damping::default(), Damping::Quadratic, Damping::Nielsen] {
        let options = Options { damping, ..Options::default() };
        let fit = minimize(&mut problem, &vec![0.0; linear.beta.len()], &options).unwrap();
        assert!(fit.stop.converged(), "{:?}", fit.stop);
        let mut worst: f64 = 0.0;
        for ((a, b), std) in fit.parameters.iter().zip(&linear.beta).zip(linear.std()) {
            worst = worst.max((a - b).abs() / b.abs().max(std));
        }
        assert!(worst < 1e-9, "{damping:?}: {worst:e}");
    }
}

/// Share of true parameters inside their 95 % intervals over trials that differ in their noise alone.
fn coverage(setup: &Setup, model: &Model, runs: &Runs, trials: u64) -> f64 {
    let truth = model.base().values(&Model::standard_values(&setup.plant));
    let mut inside = 0;
    for trial in 0..trials {
        let recording = measure(setup, &runs.training.truth, 100 + trial).unwrap();
        let run = Run { recording, truth: runs.training.truth.clone() };
        let regression = prepared(setup, &run, Variant::SavitzkyGolay).unwrap().regression(model).unwrap();
        let estimate = weighted_least_squares(&regression, &names(model)).unwrap();
        inside += truth.iter().zip(estimate.intervals()).filter(|(t, i)| i[0] <= **t && **t <= i[1]).count();
    }
    inside as f64 / (trials as usize * truth.len()) as f64
}

#[test]
fn intervals_cover_the_truth_at_95_percent_in_white_and_in_correlated_noise() {
    let (setup, model, runs) = &*CASE;
    for correlation_s in [0.0, 0.05] {
        let mut setup = setup.clone();
        for sensor in &mut setup.sensors {
            sensor.torque_correlation_s = correlation_s;
        }
        let covered = coverage(&setup, model, runs, 100);
        println!("coverage at {correlation_s} s: {covered}");
        // 100 trials of 52 correlated intervals: the standard error is about 0.4 % (measured over seeds).
        assert!((covered - 0.95).abs() < 0.015, "coverage {covered} at a correlation time of {correlation_s} s");
    }
}

#[test]
fn same_seed_same_bytes_other_seed_other_bytes() {
    let (setup, _, runs) = &*CASE;
    let again = testbed::record(setup, &mut |_| {}).unwrap();
    assert_eq!(again.training.recording, runs.training.recording);
    assert_eq!(again.held_out.recording, runs.held_out.recording);
    let other = measure(setup, &runs.training.truth, 99).unwrap();
    assert_ne!(other.tau, runs.training.recording.tau);
}

/// What is found of the arm from `log`, under either trust: residuals of the training log, and notes. Bodies that can exist fit a
/// log that is real as well as any parameters do.
fn left(log: &Recording, trust: Trust, is_real: bool) -> (Vec<f64>, Vec<String>) {
    let (setup, ..) = &*CASE;
    let smoothing = Smoothing::SavitzkyGolay { window: 61, order: 6, decimation: 5 };
    let preparation = Preparation { smoothing, band: Band::OfNoise };
    let logs = Logs { train: &[log], test: &[log] };
    let found = observed(&setup.plant, logs, preparation.clone(), trust).unwrap();
    let fitted = fit_effects(&found.model, trust, logs, preparation.clone(), Vec::new()).unwrap();
    assert!(fitted.fit.estimate.beta.iter().chain(&fitted.fit.estimate.sigma).all(|value| value.is_finite()));
    if trust == Trust::Structure {
        let bodies = consistent(&found.model, logs, preparation, &fitted).unwrap();
        for (plain, own) in fitted.train_rms.iter().zip(&bodies.train_rms).filter(|(plain, _)| plain.is_finite()) {
            assert!(!is_real || *own < 1.05 * plain, "{own} {plain}");
        }
        let arm = bodies.robot(&setup.plant);
        assert!(arm.joints.iter().all(|joint| joint.inertia.physical_fault(0.0).is_none()));
    }
    (fitted.train_rms, found.notes)
}

#[test]
fn a_joint_without_torque_or_motion_is_left_out_with_a_note() {
    let (setup, _, runs) = &*CASE;
    let log = &runs.training.recording;
    let mut silent = log.clone();
    silent.tau.channel_mut(3).fill(f64::NAN);
    let name = setup.plant.joints[3].name.as_str();
    for trust in [Trust::Structure, Trust::Nominal] {
        let (all, notes) = left(log, trust, true);
        assert!(notes.is_empty(), "{notes:?}");
        let (others, notes) = left(&silent, trust, true);
        assert!(notes.len() == 1 && notes[0].contains(name) && notes[0].contains("not logged"), "{notes:?}");
        for joint in 0..6 {
            match joint {
                3 => assert!(others[joint].is_nan()),
                _ => assert!(others[joint] < 1.05 * all[joint], "{joint}: {others:?} {all:?}"),
            }
        }
    }
    let mut held = log.clone();
    held.q.channel_mut(3).fill(0.4);
    held.qd.iter_mut().for_each(|qd| qd.channel_mut(3).fill(0.0));
    let (others, notes) = left(&held, Trust::Structure, false);
    assert!(others[3].is_nan() && notes.len() == 1, "{notes:?}");
    assert!(notes[0].contains(name) && notes[0].contains("0 samples"), "{notes:?}");
}
