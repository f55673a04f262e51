//! Torques of another scale: one that all joints share, or factors of single joints; described bodies may be wrong.

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

#[test]
fn a_factor_of_one_joint_is_found_beside_the_others() {
    for robot in [irb(), with_other_masses(&irb(), 5)] {
        for (joint, factor) in [(1, 0.012), (2, 0.2), (3, 5.0)] {
            let mut factors = [1.0; 6];
            factors[joint] = factor;
            let verdict = judged(&scaled(&robot, factors)).unwrap();
            let [Change::JointScale(found, times)] = verdict.description.changes[..] else { panic!("{verdict:?}") };
            assert!(found == joint && (times * factor).ln().abs() < 0.3, "{found} {times}, {joint} {factor}");
            assert!(!verdict.beyond_doubt);
            let said = findings(&verdict, &irb().joint_names());
            assert!(said.len() == 1 && said[0].place.starts_with(&format!("tau{}", joint + 1)), "{said:?}");
        }
        // Half a torque may be a wrong drive, gear or body.
        assert_eq!(judged(&scaled(&robot, [1.0, 0.6, 1.0, 1.0, 1.0, 1.0])), None);
    }
}

#[test]
fn per_cent_of_rated_torques_are_factors_of_single_joints() {
    let factors = [0.15, 0.2, 0.3, 1.0, 1.5, 3.0];
    let verdict = judged(&scaled(&irb(), factors)).unwrap();
    let changes = &verdict.description.changes;
    for (joint, factor) in factors.into_iter().enumerate().filter(|(_, factor)| !(0.4..2.4).contains(factor)) {
        let found = changes.iter().find_map(|change| match change {
            Change::JointScale(own, times) if *own == joint => Some(times * factor),
            _ => None,
        });
        assert!(found.is_some_and(|found| found.ln().abs() < 0.3), "{joint}: {changes:?}");
    }
}
