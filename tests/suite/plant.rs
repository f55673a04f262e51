//! The simulated arm: what it logs satisfies the laws, friction really sticks, native stepping is first order.

use std::path::PathBuf;
use tauscope::dynamics::{Chain, Motion, inverse_dynamics};
use tauscope::excitation::Reference;
use tauscope::robot::{self, InertiaCheck, Robot};
use tauscope::scenario::{Setup, simulate};
use tauscope::simulation::Truth;
use tauscope::simulation::integrator::{Integrator, Run};
use tauscope::simulation::plant::{Controller, Plant, State};

fn short() -> Setup {
    Setup::load(PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/scenarios/short.toml"), None).unwrap()
}

/// Motor torque minus what rigid bodies, rotors and friction need, over the largest torque of the joint; friction of a
/// joint at rest is taken from the log after checking that it is within its bounds.
fn law_violation(robot: &Robot, truth: &Truth) -> f64 {
    let s = &truth.signals;
    let motion = Motion { q: s.q.clone(), qd: s.qd.clone(), qdd: s.qdd.clone() };
    let rigid = inverse_dynamics(&Chain::new(robot), &robot.inertial_parameters(), &motion);
    let mut worst: f64 = 0.0;
    for (j, joint) in robot.joints.iter().enumerate() {
        let drive = joint.drive;
        let largest = s.tau.channel(j).iter().fold(0.0f64, |m, v| m.max(v.abs()));
        for k in 0..s.q.samples() {
            let (v, a, logged) = (s.qd.channel(j)[k], s.qdd.channel(j)[k], truth.friction.channel(j)[k]);
            let friction = if v == 0.0 {
                assert!(logged.abs() <= drive.coulomb * (1.0 + 1e-9), "joint {j} sample {k}: {logged}");
                logged
            } else {
                drive.viscous * v + drive.coulomb * v.signum()
            };
            let needed = rigid.channel(j)[k] + drive.armature * a + friction;
            worst = worst.max((needed - s.tau.channel(j)[k]).abs() / largest);
        }
    }
    worst
}

#[test]
fn the_log_satisfies_inverse_dynamics_and_friction_laws() {
    let setup = short();
    let truth = simulate(&setup, &setup.motion, &mut |_| {}).unwrap();
    let violation = law_violation(&setup.plant, &truth);
    assert!(violation < 1e-12, "{violation:e}");
    let resting: usize = truth.signals.qd.iter().map(|v| v.iter().filter(|v| **v == 0.0).count()).sum();
    assert!(resting > 50, "joints must stick at the ends of their moves: {resting} samples at rest");
}

#[test]
fn the_arm_follows_its_reference_with_an_error_as_a_real_one_does() {
    let setup = short();
    let truth = simulate(&setup, &setup.motion, &mut |_| {}).unwrap();
    let (mut q, mut qd, mut qdd) = (vec![0.0; 6], vec![0.0; 6], vec![0.0; 6]);
    let mut worst = [0.0f64; 6];
    for (k, &t) in truth.time.iter().enumerate() {
        setup.motion.at(t, &mut q, &mut qd, &mut qdd);
        for j in 0..6 {
            worst[j] = worst[j].max((truth.signals.q.channel(j)[k] - q[j]).abs());
        }
    }
    for (j, error) in worst.iter().enumerate() {
        assert!((1e-4..0.1).contains(error), "joint {j}: tracking error {error}");
    }
}

/// Motor torque that does nothing.
struct Limp;

impl Controller for Limp {
    fn torque(&self, _: f64, _: &[f64], _: &[f64], tau: &mut [f64]) {
        tau.fill(0.0);
    }
}

/// Mechanical energy of the arm without friction.
fn energy(robot: &Robot, state: &State) -> f64 {
    let chain = Chain::new(robot);
    let mut mass = tauscope::dynamics::mass_matrix(&chain, &robot.inertial_parameters(), &state.q);
    for (j, joint) in robot.joints.iter().enumerate() {
        mass[(j, j)] += joint.drive.armature;
    }
    let v = nalgebra::DVector::from_column_slice(&state.qd);
    let kinetic = 0.5 * (v.transpose() * mass * &v)[0];
    let frames = robot.frames(&state.q);
    let potential: f64 = robot
        .joints
        .iter()
        .zip(&frames)
        .map(|(joint, frame)| {
            let center = frame.rotation * joint.inertia.center_of_mass() + frame.translation;
            -joint.inertia.mass() * robot.gravity.dot(&center)
        })
        .sum();
    kinetic + potential
}

/// State after `duration` of falling freely, and the energy that came or went.
fn fall(robot: &Robot, integrator: Integrator, step: f64, duration: f64) -> (State, f64) {
    let mut plant = Plant::new(robot, Vec::new()).unwrap();
    let start = State::new(vec![0.3, -0.4, 0.5, 0.2, -0.6, 0.1], vec![0.5, -0.3, 0.4, 1.0, -0.5, 0.7]);
    let before = energy(robot, &start);
    let mut run = Run::new(&mut plant, &Limp, start);
    let steps = (duration / step).round() as usize;
    for k in 1..=steps {
        let response = run.response();
        run.advance(integrator, &response, k as f64 * step);
    }
    let end = run.state().clone();
    let drift = energy(robot, &end) - before;
    (end, drift)
}

fn distance(a: &State, b: &State) -> f64 {
    a.q.iter().zip(&b.q).fold(0.0, |m, (x, y)| m.max((x - y).abs()))
}

fn light_arm() -> Robot {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("urdf/irb1600_6_120.urdf");
    robot::load(path, InertiaCheck::Required).unwrap()
}

#[test]
fn runge_kutta_is_fourth_order_and_native_stepping_first() {
    let robot = light_arm();
    let (exact, drift) = fall(&robot, Integrator::Rk4, 2.5e-4, 0.5);
    assert!(drift.abs() < 1e-6, "energy drift {drift:e} J");
    let order = |integrator, coarse: f64| {
        let error = |step| distance(&fall(&robot, integrator, step, 0.5).0, &exact);
        (error(coarse) / error(coarse / 2.0)).log2()
    };
    let native = order(Integrator::RapierNative, 2e-3);
    assert!((native - 1.0).abs() < 0.15, "native order {native}");
    let runge_kutta = order(Integrator::Rk4, 5e-2);
    assert!((runge_kutta - 4.0).abs() < 0.6, "Runge-Kutta order {runge_kutta}");
}

#[test]
fn dry_friction_holds_without_creep_and_lets_go_beyond_its_level() {
    let setup = short();
    /// A push on joint 1, whose axis gravity does not load.
    struct Push(f64);
    impl Controller for Push {
        fn torque(&self, t: f64, _: &[f64], _: &[f64], tau: &mut [f64]) {
            tau.fill(0.0);
            tau[0] = self.0 * (20.0 * t).sin().abs();
        }
    }
    let mut robot = setup.plant.clone();
    robot.gravity = nalgebra::Vector3::zeros();
    let coulomb = robot.joints[0].drive.coulomb;
    for (push, moves) in [(0.99 * coulomb, false), (1.05 * coulomb, true)] {
        let mut plant = Plant::new(&robot, setup.effects.clone()).unwrap();
        let push = Push(push);
        let mut run = Run::new(&mut plant, &push, State::new(vec![0.0; 6], vec![0.0; 6]));
        for k in 1..=1000 {
            let response = run.response();
            run.advance(Integrator::Rk4, &response, k as f64 * 1e-3);
        }
        assert_eq!(run.state().q[0] != 0.0, moves, "q = {:e}", run.state().q[0]);
    }
}
