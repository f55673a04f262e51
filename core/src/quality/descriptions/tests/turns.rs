//! Logs in which one joint moves at a time, as by a jog.

use super::*;

/// A log of joints that move one after the other, for so many seconds each, and stand at the middle of their way else.
fn in_turns(robot: &Robot, seconds: f64, seed: u64) -> Sieved {
    let mut log = simulated(robot, Oddity::Frictionless, seconds * robot.dof() as f64, seed);
    let mut random = random::stream(seed, "turns", 0);
    let samples = log.recording.samples();
    let mut motion = Motion::zeros(robot.dof(), samples);
    for (joint, spec) in robot.joints.iter().enumerate() {
        let (lower, upper) = (spec.limits.lower.max(-2.0), spec.limits.upper.min(2.0));
        let rest = 0.5 * (lower + upper) + random.random_range(-0.2..0.2);
        let swing = 0.2 * (upper - lower);
        let (first, period) = (samples * joint / robot.dof(), samples / robot.dof());
        motion.q.channel_mut(joint).fill(rest);
        for row in 0..period {
            // Starts and ends at rest.
            let phase = row as f64 / period as f64 * 6.0 * std::f64::consts::TAU;
            let rate = 6.0 * std::f64::consts::TAU / seconds;
            motion.q.channel_mut(joint)[first + row] = rest + swing * (1.0 - phase.cos());
            motion.qd.channel_mut(joint)[first + row] = swing * rate * phase.sin();
            motion.qdd.channel_mut(joint)[first + row] = swing * rate * rate * phase.cos();
        }
    }
    let torque = inverse_dynamics(&Chain::new(robot), &robot.inertial_parameters(), &motion);
    let Recording { q, tau, .. } = &mut log.recording;
    for joint in 0..robot.dof() {
        let size = crate::linear::root_mean_square(torque.channel(joint)).max(0.1);
        for row in 0..samples {
            let noise: [f64; 2] = std::array::from_fn(|_| StandardNormal.sample(&mut random));
            let direction = (motion.qd.channel(joint)[row] / 0.01).tanh();
            q.channel_mut(joint)[row] = motion.q.channel(joint)[row] + 2e-6 * noise[0];
            tau.channel_mut(joint)[row] = torque.channel(joint)[row] + size * (0.15 * direction + 0.01 * noise[1]);
        }
    }
    log
}

/// Each joint moves in a few blocks only, so that free bodies do not show it.
#[test]
fn columns_in_reverse_order_are_found_in_a_jog() {
    let robot = irb();
    let all = vec![Change::JointExchange(0, 5), Change::JointExchange(1, 4), Change::JointExchange(2, 3)];
    for seed in [1, 2] {
        let actual = scales::with_other_masses(&robot, seed);
        let mut log = in_turns(&actual, 7.0, seed);
        let right = accusations(std::slice::from_ref(&log), Some(&robot));
        assert!(right.is_empty(), "{right:?}");
        let wrong = all.iter().fold(Description::as_given(6, robot.gravity), |own, &change| own.with(change));
        wrong.apply(&mut log.recording);
        let verdict = examine_together(&[&log], Some(&robot)).unwrap().verdict.unwrap();
        assert_eq!(verdict.description.changes, all, "{seed}");
    }
}

/// What is found with the mounting in a jog is one of many, of which each explains some of what free bodies lack: the mounting is what all
/// have.
#[test]
fn an_arm_that_hangs_is_that_alone_in_a_jog() {
    let robot = irb();
    for seed in 0..3 {
        let hanging = Robot { gravity: -robot.gravity, ..super::scales::with_other_masses(&robot, seed) };
        let log = in_turns(&hanging, 10.0, seed);
        let verdict = examine_together(&[&log], Some(&robot)).unwrap().verdict.unwrap();
        assert!(matches!(verdict.description.changes[..], [Change::Gravity([_, _, z])] if z > 9.0), "{verdict:?}");
        assert!(verdict.alternatives.is_empty(), "{verdict:?}");
    }
}

/// The last joint is friction for the most part, and moves in few blocks.
#[test]
fn the_sign_of_the_last_torque_is_found_in_a_jog() {
    let robot = irb();
    for seed in [1, 2, 3] {
        let mut log = in_turns(&scales::with_other_masses(&robot, seed), 5.0, seed);
        assert!(accusations(std::slice::from_ref(&log), Some(&robot)).is_empty(), "{seed}");
        log.recording.tau.channel_mut(5).iter_mut().for_each(|torque| *torque = -*torque);
        let verdict = examine_together(&[&log], Some(&robot)).unwrap().verdict.unwrap();
        assert_eq!(verdict.description.changes, [Change::TorqueSign(5)], "{seed}");
    }
}
