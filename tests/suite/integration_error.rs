//! Rapier's own time step against the law that says what it gets wrong.

use std::path::PathBuf;
use tauscope::dynamics::{Chain, Motion, inverse_dynamics, inverse_dynamics_at};
use tauscope::effects::{Along, Effect, Instant, IntegrationError, Placed, contribution};
use tauscope::robot::{self, InertiaCheck, Robot};
use tauscope::scenario::{Setup, simulate};
use tauscope::signal::{first_derivative, second_derivative};
use tauscope::simulation::integrator::Integrator;
use tauscope::simulation::rapier_arm::RapierArm;

fn path(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(name)
}

/// Largest torque that inverse dynamics along a natively made step leaves unexplained, without the law and with it.
fn unexplained(robot: &Robot, step: f64) -> (f64, f64) {
    let dof = robot.dof();
    let spread =
        |scale: f64, phase: f64| -> Vec<f64> { (0..dof).map(|j| scale * (1.3 * j as f64 + phase).sin()).collect() };
    let (q, qd, tau) = (spread(0.8, 0.3), spread(1.0, 1.1), spread(20.0, 2.3));
    let (mut moved, mut faster) = (q.clone(), qd.clone());
    let qdd = RapierArm::new(robot).unwrap().native_step(&mut moved, &mut faster, &tau, step);
    // What central differences of the logged positions say.
    let seen: Vec<f64> = qd.iter().zip(&faster).map(|(before, after)| 0.5 * (before + after)).collect();
    let chain = Chain::new(robot);
    let needed = inverse_dynamics_at(&chain, &robot.inertial_parameters(), &q, &seen, &qdd);
    let rest: Vec<f64> = (0..dof).map(|j| tau[j] - needed[j] - robot.joints[j].drive.armature * qdd[j]).collect();
    let mut law = vec![0.0; dof];
    let zeros = vec![0.0; dof];
    let x = Instant {
        t: 0.0,
        started: 0.0,
        q: &q,
        qd: &seen,
        qdd: &qdd,
        direction: &zeros,
        load: &zeros,
        robot,
        chain: &chain,
        frames: None,
    };
    IntegrationError.torque(&[step], 0, &x, &[], &mut law);
    let size = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0f64, |m, v| m.max(v.abs()));
    (size(&mut rest.iter().copied()), size(&mut rest.iter().zip(&law).map(|(r, l)| r - l)))
}

#[test]
fn the_law_leaves_only_what_is_of_second_order_in_the_step() {
    for file in ["urdf/irb1600_6_120.urdf", "tests/reference/skew7.urdf"] {
        let mut robot = robot::load(path(file), InertiaCheck::Required).unwrap();
        for joint in &mut robot.joints {
            joint.drive.viscous = 0.0;
        }
        let ((coarse, coarse_rest), (fine, fine_rest)) = (unexplained(&robot, 1e-4), unexplained(&robot, 5e-5));
        assert!((coarse / fine - 2.0).abs() < 0.05, "{file}: first order without the law, {coarse:e} {fine:e}");
        let ratio = coarse_rest / fine_rest;
        assert!((ratio - 4.0).abs() < 0.2, "{file}: second order with it, {coarse_rest:e} {fine_rest:e}");
        assert!(coarse_rest < 0.01 * coarse, "{file}: {coarse_rest:e} of {coarse:e}");
    }
}

#[test]
fn a_natively_stepped_run_shows_its_step() {
    let mut setup = Setup::load(path("tests/scenarios/short.toml"), None).unwrap();
    setup.scenario.plant.integrator = Integrator::RapierNative;
    // Every step logged, so that the differences' own error does not mix in.
    setup.scenario.sensors.rate_hz = 1.0 / setup.scenario.plant.step_s;
    let truth = simulate(&setup, &setup.motion, &mut |_| {}).unwrap();
    let period = 1.0 / setup.scenario.sensors.rate_hz;
    let q = truth.signals.q.clone();
    let differentiated = |differentiate: fn(&[f64], f64, &mut [f64]) -> tauscope::error::Result<()>| {
        q.map(|_, signal| {
            let mut out = vec![0.0; signal.len()];
            differentiate(signal, period, &mut out).unwrap();
            out
        })
    };
    let (qd, qdd) = (differentiated(first_derivative), differentiated(second_derivative));
    let motion = Motion { q: q.clone(), qd, qdd };
    let chain = Chain::new(&setup.plant);
    let rigid = inverse_dynamics(&chain, &setup.plant.inertial_parameters(), &motion);
    let along = Along::new(&setup.plant, &chain, &truth.time, &motion, 0.0);
    let unit = Placed { effect: &IntegrationError, joint: 0, parameters: vec![1.0] };
    let column = contribution(&[unit], &along);
    let (mut cross, mut square, mut total) = (0.0, 0.0, 0.0);
    for sample in 2..motion.samples() - 2 {
        // A joint that comes to rest within a step shakes all others.
        if motion.qd.iter().any(|v| v[sample].abs() < 0.03) {
            continue;
        }
        for (j, joint) in setup.plant.joints.iter().enumerate() {
            let (v, a) = (motion.qd.channel(j)[sample], motion.qdd.channel(j)[sample]);
            let drive = joint.drive.armature * a + joint.drive.viscous * v + joint.drive.coulomb * v.signum();
            let rest = truth.signals.tau.channel(j)[sample] - rigid.channel(j)[sample] - drive;
            let x = column.channel(j)[sample];
            (cross, square, total) = (cross + x * rest, square + x * x, total + rest * rest);
        }
    }
    let step = cross / square;
    let explained = cross * step / total;
    assert!((step / setup.scenario.plant.step_s - 1.0).abs() < 1e-3, "step {step}");
    assert!(explained > 0.9999, "explains {explained}");
}
