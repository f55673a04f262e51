//! Torques of a model, in which no joint has friction, against measured ones.

use super::*;
use crate::quality::view::View;

/// A log with friction of so much of the torque, and noise of the positions that makes accelerations uncertain.
fn with_friction(robot: &Robot, friction: f64, noise: f64, seed: u64) -> Sieved {
    let mut log = simulated(robot, Oddity::Frictionless, 20.0, seed);
    let mut random = random::stream(seed, "noise of positions", 0);
    for joint in 0..robot.dof() {
        let Recording { q, tau, .. } = &mut log.recording;
        let size = crate::linear::root_mean_square(tau.channel(joint));
        let clean = q.channel(joint).to_vec();
        for i in 1..clean.len() {
            tau.channel_mut(joint)[i] += friction * size * (clean[i] - clean[i - 1]).signum();
            let own: f64 = StandardNormal.sample(&mut random);
            q.channel_mut(joint)[i] += noise * own;
        }
    }
    log
}

/// Whether the torques of a log whose description is right are those of a model.
fn is_of_a_model(robot: &Robot, log: &Sieved) -> bool {
    is_modelled(&[&View::new(&log.recording, Some(robot)).unwrap()], Some(robot), None)
}

/// The same as it is reported to a user.
fn is_reported(robot: &Robot, log: &Sieved) -> bool {
    let report = examine_together(&[log], Some(robot)).unwrap().reports.remove(0);
    report.findings.iter().any(|finding| finding.kind == Kind::ModelTorque)
}

/// No measured torque is taken for that of a model, and models are recognised; noise may hide one in ten.
#[test]
fn torques_without_friction_are_those_of_a_model() {
    let (mut accused, mut missed, mut models) = (Vec::new(), Vec::new(), 0);
    for robot in [irb(), arm("tests/reference/skew7.urdf"), arm("tests/reference/pendulum.urdf")] {
        for seed in 0..4 {
            for (friction, noise) in [(0.0, 0.0), (0.0, 5e-5), (0.03, 0.0), (0.06, 5e-5), (0.2, 0.0)] {
                let found = is_of_a_model(&robot, &with_friction(&robot, friction, noise, seed));
                let case = format!("{}, {seed}: friction {friction}, noise {noise}", robot.name);
                models += usize::from(friction == 0.0);
                match (found, friction == 0.0) {
                    (true, false) => accused.push(case),
                    (false, true) => missed.push(case),
                    _ => {}
                }
            }
        }
    }
    assert!(accused.is_empty(), "{}", accused.join("\n"));
    assert!(10 * missed.len() <= models, "{}", missed.join("\n"));
}

/// As a desired torque that leaves gravity to the drives.
#[test]
fn a_model_that_lacks_gravity_is_a_model() {
    let robot = irb();
    let without = Robot { gravity: nalgebra::Vector3::zeros(), ..irb() };
    let log = with_friction(&without, 0.0, 0.0, 3);
    assert!(is_reported(&robot, &log));
    assert!(!is_reported(&robot, &with_friction(&without, 0.1, 0.0, 3)));
}
