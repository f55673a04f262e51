//! Arms whose axes are tilted a little, as rounded angles and measured geometry tilt them: the same parameters are found at every tilt.

use nalgebra::{Rotation3, Vector3};
use std::path::Path;
use std::sync::{Arc, LazyLock};
use tauscope::channels::Channels;
use tauscope::dynamics::{Chain, Motion, inverse_dynamics};
use tauscope::identification::effect_model::{Preparation, Trust};
use tauscope::identification::fit::{Fitted, Logs, fit_effects};
use tauscope::identification::model::Model;
use tauscope::identification::prepare::Smoothing;
use tauscope::identification::reversals::Band;
use tauscope::robot::Robot;
use tauscope::scenario::{Setup, measure};
use tauscope::simulation::Truth;
use tauscope::study::testbed::{self, Runs};

/// The short scenario, simulated once for all tests.
static CASE: LazyLock<(Setup, Runs)> = LazyLock::new(|| {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/scenarios/short.toml");
    let setup = Setup::load(path, None).unwrap();
    let runs = testbed::record(&setup, &mut |_| {}).unwrap();
    (setup, runs)
});

/// Tilts of an axis, rad: from below what counts to above what any rounding leaves.
const TILTS: [f64; 11] = [0.0, 1e-7, 1e-6, 3e-6, 1e-5, 2e-5, 5e-5, 1e-4, 2e-4, 5e-4, 1e-3];

/// Tilt of a vertical axis, rad, from which the logs show gravity on it: a thousandth of g on a hundred kilograms at half a metre is half a
/// newton metre.
const LEAST_SHOWN: f64 = 1e-3;

/// The arm with the axis of a joint tilted about both others.
fn tilted(robot: &Robot, joint: usize, tilt: f64) -> Robot {
    let mut robot = robot.clone();
    let turn = Rotation3::from_scaled_axis(tilt * Vector3::new(1.0, 0.5, 0.7));
    let origin = &mut robot.joints[joint].origin.rotation;
    *origin = turn.matrix() * *origin;
    robot
}

/// The motion of `truth` with the torque of another arm.
fn moved(truth: &Truth, before: &Robot, after: &Robot) -> Truth {
    let signals = &truth.signals;
    let motion = Motion { q: signals.q.clone(), qd: signals.qd.clone(), qdd: signals.qdd.clone() };
    // Friction and rotors are the same.
    let torque =
        |robot: &Robot| -> Channels { inverse_dynamics(&Chain::new(robot), &robot.inertial_parameters(), &motion) };
    let mut changed = (**signals).clone();
    let (before, after) = (torque(before), torque(after));
    for (value, (before, after)) in
        changed.tau.as_mut_slice().iter_mut().zip(before.as_slice().iter().zip(after.as_slice()))
    {
        *value += after - before;
    }
    Truth { signals: Arc::new(changed), ..truth.clone() }
}

/// What is found from noisy logs of an arm, whose description has other bodies.
fn identified(setup: &Setup, runs: &Runs, robot: &Robot) -> (Model, Fitted) {
    let logs = [&runs.training.truth, &runs.held_out.truth]
        .map(|truth| measure(setup, &moved(truth, &setup.plant, robot), 7).unwrap());
    let mut described = robot.clone();
    for (k, joint) in described.joints.iter_mut().enumerate() {
        joint.inertia.0 = joint.inertia.0.map(|value| value * (0.6 + 0.1 * k as f64));
    }
    let model = Model::new(&described);
    let smoothing = Smoothing::SavitzkyGolay { window: 61, order: 6, decimation: 5 };
    let preparation = Preparation { smoothing, band: Band::OfNoise };
    let logs = Logs { train: &[&logs[0]], test: &[&logs[1]] };
    let fitted = fit_effects(&model, Trust::Structure, logs, preparation, Vec::new()).unwrap();
    (model, fitted)
}

/// The parameters that are not merged, by the standard parameter that leads each, with their standard deviations.
fn separate(model: &Model, fitted: &Fitted) -> Vec<(usize, f64, f64)> {
    let base = model.base();
    let std = fitted.fit.estimate.std();
    let own = (0..base.len()).filter(|&b| base.merged(b).is_empty() && !fitted.fit.undetermined[b]);
    own.map(|b| (base.kept()[b], fitted.fit.estimate.beta[b], std[b])).collect()
}

fn sweep(joint: usize) {
    let (setup, runs) = &*CASE;
    let (straight, reference) = identified(setup, runs, &setup.plant);
    let expected = separate(&straight, &reference);
    assert_eq!(straight.base().len(), expected.len());
    for tilt in TILTS {
        let (model, fitted) = identified(setup, runs, &tilted(&setup.plant, joint, tilt));
        let base = model.base();
        let merged: Vec<usize> = (0..base.len()).filter(|&b| !base.merged(b).is_empty()).collect();
        println!(
            "joint {joint} tilt {tilt:e}: {} parameters, merged {:?}, held {:?}, condition {:.1}",
            base.len(),
            merged.iter().map(|&b| &base.groupings()[b].name).collect::<Vec<_>>(),
            (0..base.len()).filter(|&b| fitted.fit.undetermined[b]).collect::<Vec<_>>(),
            fitted.fit.estimate.condition_number
        );
        // The torque of the other motion is predicted as that of the straight arm is.
        for (own, straight) in fitted.test_rms.iter().zip(&reference.test_rms) {
            assert!((own / straight - 1.0).abs() < 0.03, "{tilt:e}: {own} {straight}");
        }
        // The same parameters, as sure and of the same value within that.
        let found = separate(&model, &fitted);
        let more: Vec<_> = found.iter().filter(|(own, ..)| expected.iter().all(|(leader, ..)| leader != own)).collect();
        for (leader, straight, before) in &expected {
            let name = &model.names()[*leader];
            let own = found.iter().find(|(own, ..)| own == leader);
            let (_, value, std) = own.unwrap_or_else(|| panic!("{tilt:e}: {name} is not fitted"));
            // What is fitted in addition shares its part of the motion.
            let less_sure = if more.is_empty() { 1.05 } else { 1.4 };
            assert!((0.95..less_sure).contains(&(std / before)), "{tilt:e} {name}: std {std} {before}");
            let tolerance = 3.0 * before + 3.0 * tilt * straight.abs().max(1.0);
            assert!((value - straight).abs() < tolerance, "{tilt:e} {name}: {value} {straight} of std {before}");
        }
        // Gravity acts on an axis as soon as it is not vertical, and logs show it from some tilt on: what they show is true.
        let truth = base.values(&Model::standard_values(&setup.plant));
        for (leader, value, std) in &more {
            let truth = truth[base.kept().iter().position(|own| own == leader).unwrap()];
            let name = &model.names()[*leader];
            assert!((value - truth).abs() < 4.0 * std, "{tilt:e} {name}: {value} {truth} of std {std}");
        }
        let shown = [!more.is_empty(), tilt >= LEAST_SHOWN];
        assert!(if joint == 0 { shown[0] == shown[1] } else { !shown[0] }, "{tilt:e}: {more:?}");
        assert!(base.regrouping().iter().all(|share| share.abs() < 20.0), "{tilt:e}: {}", base.regrouping().amax());
    }
}

#[test]
fn an_axis_that_is_nearly_parallel_to_the_one_before() {
    sweep(2);
}

#[test]
fn an_axis_that_is_nearly_vertical() {
    sweep(0);
}

#[test]
fn an_axis_that_is_nearly_at_right_angles() {
    sweep(4);
}
