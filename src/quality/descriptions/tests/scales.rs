//! Torques of another scale, which all joints share though described bodies are wrong.

use super::*;

/// The arm with other bodies: masses between 0.8 and 1.25 times those described.
pub fn with_other_masses(robot: &Robot, seed: u64) -> Robot {
    let mut random = random::stream(seed, "other_bodies", 0);
    let mut other = robot.clone();
    for joint in &mut other.joints {
        let factor = random.random_range(0.8..1.25);
        joint.inertia.0.iter_mut().for_each(|value| *value *= factor);
    }
    other
}

fn scaled(robot: &Robot, factors: [f64; 6]) -> Sieved {
    let mut log = simulated(robot, Oddity::None, 15.0, 4);
    for (joint, factor) in factors.into_iter().enumerate() {
        log.recording.tau.channel_mut(joint).iter_mut().for_each(|torque| *torque *= factor);
    }
    log
}

fn judged(log: &Sieved) -> Option<Verdict> {
    examine_together(&[log], Some(&irb())).unwrap().verdict
}

#[test]
fn a_unit_is_one_factor_of_all_joints_though_masses_are_wrong() {
    let verdict = judged(&scaled(&with_other_masses(&irb(), 3), [1000.0; 6])).unwrap();
    let [Some(factor)] = verdict.factors[..] else { panic!("{verdict:?}") };
    assert!((0.8..1.25).contains(&(factor / 1000.0)), "{factor}");
    let said = findings(&verdict, &irb().joint_names());
    assert!(said.len() == 1 && said[0].text.contains("N mm"), "{said:?}");
}
