//! Torques of another scale, which all joints share though described bodies are wrong.

use super::super::fitting::{Physics, Rows};
use super::super::search::is_beyond_position;
use super::super::tried::Tried;
use super::*;
use crate::quality::Severity;

/// The arm with other bodies: masses between 0.8 and 1.25 times those described.
pub(super) fn with_other_masses(robot: &Robot, seed: u64) -> Robot {
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
    let said = findings(&verdict, &irb().joint_names(), None);
    assert!(said.len() == 1 && said[0].text.contains("N mm"), "{said:?}");
}

/// Shares of rated torques, by their names, are compared with no body: whose arm they are of is not known by their sizes.
#[test]
fn shares_of_rated_torques_are_not_those_of_another_robot() {
    let is_another = |of_rated: bool| {
        let factors = [1e-4, 5e-5, 3e-4, 2e-2, 1e-2, 3e-2];
        let log = Sieved { of_rated, ..scaled(&irb(), factors) };
        examine_together(&[&log], Some(&irb())).unwrap().reports[0].is_of_another_robot()
    };
    assert_eq!([false, true].map(is_another), [true, false]);
}

/// Joints whose torque has a factor of its own, as found, with the factors.
fn of_single(verdict: &Verdict) -> Vec<(usize, f64)> {
    let own = |change: &Change| match change {
        Change::JointScale(joint, factor) => Some((*joint, *factor)),
        _ => None,
    };
    verdict.description.changes.iter().filter_map(own).collect()
}

#[test]
fn the_factor_of_one_torque_is_found_from_twice_on_though_masses_are_wrong() {
    for (joint, factor) in [(1, 1.0 / 80.0), (2, 160.0), (4, 0.2), (1, 1.0 / 3.0), (2, 3.0)] {
        let mut factors = [1.0; 6];
        factors[joint] = factor;
        let verdict = judged(&scaled(&with_other_masses(&irb(), 3), factors)).unwrap();
        let found = of_single(&verdict);
        let [(own, times)] = found[..] else { panic!("{joint} {factor}: {verdict:?}") };
        assert!(own == joint && (times * factor).ln().abs() < 0.1 && !verdict.beyond_doubt, "{found:?} {factor}");
    }
    for factor in [1.8, 0.55] {
        let mut factors = [1.0; 6];
        factors[1] = factor;
        let verdict = judged(&scaled(&with_other_masses(&irb(), 3), factors));
        assert!(verdict.as_ref().is_none_or(|verdict| of_single(verdict).is_empty()), "{factor}: {verdict:?}");
    }
}

/// A strut that carries half of the weight on the second joint makes its torque too small, which a factor of two does too: the one is
/// a matter of position, the other is not.
#[test]
fn a_balancer_is_no_factor() {
    let robot = irb();
    let is_factor = |change: &dyn Fn(&mut Recording)| {
        let mut log = simulated(&robot, Oddity::None, 15.0, 4);
        change(&mut log.recording);
        let view = View::new(&log.recording, Some(&robot)).unwrap();
        let rows = Rows::new(&[&view], Some(&robot)).unwrap();
        let description = Description::as_given(6, robot.gravity).with(Change::JointScale(1, 2.0));
        let found = Tried::new(&Physics::bodies(&robot).unwrap(), &rows, description).unwrap();
        is_beyond_position(&robot, &rows, &found)
    };
    assert!(is_factor(&|log| log.tau.channel_mut(1).iter_mut().for_each(|torque| *torque *= 0.5)));
    assert!(!is_factor(&|log| {
        let q = log.q.channel(1).to_vec();
        // The weight on the joint takes 610 N m times the sine of its position.
        log.tau.channel_mut(1).iter_mut().zip(q).for_each(|(torque, q)| *torque += 305.0 * q.sin());
    }));
}

/// Free bodies do not see the factor of the last torque, and a small one may be friction for the most part: then it is no other change.
#[test]
fn the_factor_of_any_torque_is_that_or_nothing() {
    for joint in [0, 3, 4, 5] {
        for factor in [0.01, 30.0] {
            let mut factors = [1.0; 6];
            factors[joint] = factor;
            let Some(verdict) = judged(&scaled(&with_other_masses(&irb(), 3), factors)) else { continue };
            let found = of_single(&verdict);
            let [(own, times)] = found[..] else { panic!("{joint} {factor}: {verdict:?}") };
            assert!(own == joint && (times * factor).ln().abs() < 0.5 && !verdict.beyond_doubt, "{found:?} {factor}");
        }
    }
}

/// The verdict on torques with these factors, each found to a factor of two: the last joints' torque is mostly friction, and a load makes
/// up for much of the rest.
fn with_factors_known_to_two(factors: [f64; 6]) -> Verdict {
    let verdict = judged(&scaled(&with_other_masses(&irb(), 3), factors)).unwrap();
    assert_eq!(verdict.factors.len(), 6, "{verdict:?}");
    let near = |(found, factor): (&Option<f64>, &f64)| found.is_some_and(|found| (found / factor).ln().abs() < 0.69);
    assert!(verdict.factors.iter().zip(&factors).all(near), "{:?}", verdict.factors);
    verdict
}

#[test]
fn shares_of_the_rated_torque_are_a_factor_for_each_joint() {
    let verdict = with_factors_known_to_two([0.1, 0.12, 0.3, 3.0, 3.5, 6.0]);
    let said = findings(&verdict, &irb().joint_names(), None);
    assert!(said.len() == 1 && said[0].text.contains("differs from joint to joint"), "{said:?}");
}

/// Factors of which none is beyond what wrong masses explain.
#[test]
fn shares_of_the_rated_torque_are_found_by_what_differs() {
    with_factors_known_to_two([0.3, 0.3, 0.67, 1.8, 1.8, 2.5]);
    // Up to twice from joint to joint nothing is said.
    let alike = judged(&scaled(&with_other_masses(&irb(), 3), [0.7, 0.8, 0.9, 1.1, 1.2, 1.3]));
    assert!(alike.is_none(), "{alike:?}");
}

/// Torques at the motor side of gears, all of them with the other sign.
#[test]
fn a_scale_is_found_with_the_sign_of_all_torques() {
    let verdict = judged(&scaled(&irb(), [-1.0 / 90.0; 6])).unwrap();
    let [Change::AllTorqueSigns, Change::TorqueScale(factor)] = verdict.description.changes[..] else {
        panic!("{verdict:?}")
    };
    assert!((factor / 90.0 - 1.0).abs() < 0.3 && !verdict.beyond_doubt, "{factor}");
}

/// Torques at the motor side of gears, one of them with the other sign, two of them exchanged, or of an arm that hangs or is on a wall.
#[test]
fn a_scale_is_found_with_one_more_fault() {
    let robot = irb();
    let other = with_other_masses(&robot, 3);
    let gears = [121.0, 161.0, 101.0, 81.0, 100.0, 51.0];
    let hanging = Change::Gravity([0.0, 0.0, 9.81]);
    let wall = Change::Gravity([0.0, -9.81, 0.0]);
    let mut wrong = Vec::new();
    for change in [Change::TorqueSign(3), Change::TorqueExchange(1, 2), hanging, wall] {
        let given = Description::as_given(6, robot.gravity).with(change);
        let mounted = Robot { gravity: given.gravity, ..other.clone() };
        let mut log = simulated(&mounted, Oddity::None, 15.0, 4);
        let torques = log.recording.tau.clone();
        for (joint, gear) in gears.into_iter().enumerate() {
            let from = torques.channel(given.torque_of[joint]).iter();
            let own: Vec<f64> = from.map(|torque| given.torque_sign[joint] * torque / gear).collect();
            log.recording.tau.channel_mut(joint).copy_from_slice(&own);
        }
        let verdict = judged(&log);
        let holds = verdict.as_ref().is_some_and(|verdict| verdict.description.changes.contains(&change));
        let is_possible = |factor: &Option<f64>| factor.is_none_or(|factor| (1e-3..1.0).contains(&factor.abs()));
        let possible = verdict.as_ref().is_some_and(|verdict| verdict.factors.iter().all(is_possible));
        if !(holds && possible && !verdict.as_ref().is_some_and(|verdict| verdict.beyond_doubt)) {
            wrong.push(format!(
                "{change:?}: {:?}",
                verdict.map(|v| (v.description.changes, v.factors, v.before, v.after))
            ));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The sign of the first torque changes little of what free bodies share with the other joints: it is looked for once the factor is known.
#[test]
fn the_factor_of_one_torque_is_found_with_the_sign_of_another() {
    let verdict = judged(&scaled(&with_other_masses(&irb(), 3), [-1.0, 1.0, 0.02, 1.0, 1.0, 1.0])).unwrap();
    let found = of_single(&verdict);
    assert!(matches!(found[..], [(2, times)] if (times * 0.02).ln().abs() < 0.1), "{verdict:?}");
    assert!(verdict.description.changes.contains(&Change::TorqueSign(0)) && !verdict.beyond_doubt, "{verdict:?}");
}

/// Gears that differ by no more than masses do: free bodies show their ratios.
#[test]
fn gears_that_differ_are_a_factor_for_each_joint() {
    let gears = [160.0, 100.0, 70.0, 100.0, 80.0, 80.0];
    let verdict = judged(&scaled(&irb(), gears.map(|gear| 1.0 / gear))).unwrap();
    assert_eq!(verdict.factors.len(), 6, "{verdict:?}");
    for (factor, gear) in verdict.factors.iter().zip(gears) {
        assert!(factor.is_none_or(|factor| (factor * gear).ln().abs() < 0.3), "{:?}", verdict.factors);
    }
}

/// A factor that leaves much of the torques is one of several causes.
#[test]
fn a_factor_that_leaves_much_is_not_certain() {
    let mut verdict = judged(&scaled(&irb(), [1e-2; 6])).unwrap();
    assert!(!verdict.leaves_much(), "{}", verdict.after);
    verdict.after = 0.29;
    let said = findings(&verdict, &irb().joint_names(), None);
    assert!(verdict.leaves_much() && said[0].text.contains("nothing of this is certain"), "{said:?}");
}

/// Gravity hides the factors of single torques of an arm that hangs, and they hide it.
#[test]
fn factors_of_two_torques_and_a_mounting_are_found_together() {
    for (gravity, factors) in [
        ([0.0, 0.0, 9.81], [1.0, 1.0 / 100.0, 1.0, 1.0 / 20.0, 1.0, 1.0]),
        ([0.0, 0.0, 9.81], [1.0, 1.0, 1.0 / 50.0, 1.0, 1.0 / 90.0, 1.0]),
        ([9.81, 0.0, 0.0], [1.0, 1.0 / 100.0, 1.0 / 30.0, 1.0, 1.0, 1.0]),
    ] {
        let mounted = Robot { gravity: gravity.into(), ..irb() };
        let verdict = judged(&scaled(&mounted, factors)).unwrap();
        let found = verdict.description.gravity;
        assert!(found.angle(&mounted.gravity).to_degrees() < 5.0, "{gravity:?}: {:?}", verdict.description.changes);
        for (scale, factor) in verdict.description.torque_scale.iter().zip(factors) {
            assert!(factor == 1.0 || (scale * factor).ln().abs() < 0.4, "{factor}: {:?}", verdict.description);
        }
    }
}

/// A sign that is wrong besides shows once the factors are known, which described bodies show before free ones.
#[test]
fn a_sign_besides_factors_of_two_torques_is_found() {
    let mut log = scaled(&irb(), [1.0, 1.0 / 50.0, 1.0, 1.0 / 120.0, 1.0, 1.0]);
    log.recording.tau.channel_mut(2).iter_mut().for_each(|torque| *torque = -*torque);
    let verdict = judged(&log).unwrap();
    let signs: Vec<f64> = verdict.description.torque_sign.clone();
    assert_eq!(signs, [1.0, 1.0, -1.0, 1.0, 1.0, 1.0], "{:?}", verdict.description.changes);
    assert!((verdict.description.torque_scale[1] / 50.0).ln().abs() < 0.2, "{:?}", verdict.description);
}

/// Currents of motors whose torque constants differ, and which may have another sign on one joint: the constants come from the bodies.
#[test]
fn currents_have_the_torque_constants_of_their_motors_and_are_no_fault() {
    let constants = [12.0, 9.0, 9.0, 1.5, 1.2, 0.8];
    let factors = constants.map(f64::recip);
    for joint in [None, Some(2)] {
        let mut log = Sieved { currents: true, ..scaled(&irb(), factors) };
        if let Some(joint) = joint {
            log.recording.tau.channel_mut(joint).iter_mut().for_each(|current| *current = -*current);
        }
        let together = examine_together(&[&log], Some(&irb())).unwrap();
        let verdict = together.verdict.unwrap();
        assert!(verdict.currents && verdict.factors.len() == 6, "{verdict:?}");
        for (own, constant) in verdict.factors.iter().zip(constants) {
            let found = own.map(f64::recip);
            assert!(found.is_none_or(|found| (found / constant).ln().abs() < 0.1), "{verdict:?}");
        }
        // Gravity makes the torques of these.
        assert!([1, 2].iter().all(|&joint| verdict.factors[joint].is_some()), "{verdict:?}");
        let findings = &together.reports[0].findings;
        let warned: Vec<&str> =
            findings.iter().filter(|own| own.severity > Severity::Note).map(|own| own.place.as_str()).collect();
        assert_eq!(warned.len(), usize::from(joint.is_some()), "{findings:?}");
        assert!(warned.iter().all(|place| place.starts_with("tau3")), "{findings:?}");
        let note = findings.iter().find(|own| own.kind == Kind::TorqueUnit).unwrap();
        assert!(note.text.contains("motor currents") && note.text.contains("9.0"), "{}", note.text);
    }
}

/// A log of another robot stays that, whatever its torques are called.
#[test]
fn currents_of_another_robot_are_none_of_this() {
    let other = arm("tests/reference/payload/arm.urdf");
    let log = Sieved { currents: true, ..simulated(&other, Oddity::None, 15.0, 4) };
    let mut robot = other.clone();
    robot.joints.reverse();
    let verdict = examine_together(&[&log], Some(&robot)).unwrap().verdict;
    assert!(verdict.is_none_or(|verdict| !verdict.currents));
}
