//! Logs of joints whose zero is another than that of the description.

use super::*;
use crate::quality::Severity;
use crate::quality::descriptions::fitting::{Physics, Rows};
use crate::quality::descriptions::search::{are_of_bodies, opposite_zeros};
use crate::quality::descriptions::tried::Tried;

/// The offsets of a verdict, degrees, by joint.
fn offsets(verdict: &Verdict) -> Vec<f64> {
    verdict.description.position_offset.iter().map(|offset| offset.to_degrees()).collect()
}

/// Whether the changes of a verdict are offsets like the wanted ones, which the logs lack, and none else.
fn are(verdict: &Option<Verdict>, wanted: &[(usize, f64)]) -> bool {
    let Some(verdict) = verdict else { return wanted.is_empty() };
    let of = |joint: usize| -wanted.iter().find(|(own, _)| *own == joint).map_or(0.0, |(_, degrees)| *degrees);
    let turned = |(joint, found): (usize, f64)| (found - of(joint) + 180.0).rem_euclid(360.0) - 180.0;
    verdict.description.changes.len() == wanted.len()
        && offsets(verdict).into_iter().enumerate().all(|each| turned(each).abs() < 4.0)
}

fn with_zeros(robot: &Robot, oddity: Oddity, zeros: &[(usize, f64)]) -> Option<Verdict> {
    let changes: Vec<Change> =
        zeros.iter().map(|&(joint, degrees)| Change::ZeroOffset(joint, degrees.to_radians())).collect();
    found(robot, oddity, &changes).1
}

#[test]
fn a_wrong_zero_is_found_alone_or_with_a_second() {
    let robot = irb();
    let mut wrong = Vec::new();
    for (oddity, zeros) in [
        (Oddity::None, &[(1, 90.0)][..]),
        (Oddity::None, &[(2, -45.0)]),
        (Oddity::None, &[(3, 90.0)]),
        (Oddity::None, &[(4, -20.0)]),
        (Oddity::Payload(5.0), &[(1, -90.0)]),
        (Oddity::Stribeck, &[(2, 30.0)]),
        (Oddity::None, &[(1, 90.0), (2, -90.0)]),
        (Oddity::None, &[(2, 90.0), (3, 90.0)]),
        (Oddity::None, &[(1, 35.0), (2, -120.0)]),
        (Oddity::None, &[(1, -45.0), (2, 45.0)]),
    ] {
        let verdict = with_zeros(&robot, oddity, zeros);
        if !are(&verdict, zeros) {
            let told = verdict.map(|v| (v.description.changes, v.before, v.after, v.alternatives));
            wrong.push(format!("{oddity:?} {zeros:?}: {told:?}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// A zero that was found before another change is fitted again together with it, and none is added to make up for it.
#[test]
fn a_zero_is_found_together_with_a_sign_and_nothing_else() {
    let robot = irb();
    for (joint, degrees, sign) in [(1, 90.0, 2), (2, 50.0, 5), (1, -50.0, 4)] {
        let changes = [Change::ZeroOffset(joint, f64::to_radians(degrees)), Change::TorqueSign(sign)];
        let verdict = found(&robot, Oddity::None, &changes).1.unwrap();
        let own = &verdict.description;
        let others: Vec<Change> =
            own.changes.iter().filter(|change| !matches!(change, Change::ZeroOffset(..))).copied().collect();
        let wanted = |own: usize| if own == joint { -degrees } else { 0.0 };
        let near = offsets(&verdict).into_iter().enumerate().all(|(own, found)| (found - wanted(own)).abs() < 3.0);
        assert!(others == [Change::TorqueSign(sign)] && near, "{joint} {degrees}: {:?}", own.changes);
    }
}

/// A zero within 8 degrees of a convention is that where the logs do not tell it from the fitted one, and what it is where they do.
#[test]
fn a_zero_near_a_convention_is_what_it_is() {
    let robot = irb();
    for degrees in [50.0, 45.0, -84.0] {
        let verdict = with_zeros(&robot, Oddity::None, &[(2, degrees)]).unwrap();
        assert!((offsets(&verdict)[2] + degrees).abs() < 2.0, "{degrees}: {:?}", verdict.description.changes);
    }
}

/// The joints beyond two parallel axes stay where they are, so that no single offset helps.
#[test]
fn zeros_that_make_up_for_each_other_are_seen_by_described_bodies() {
    let robot = irb();
    let as_given = Description::as_given(6, robot.gravity);
    let of = |degrees: f64| {
        let angle = degrees.to_radians();
        let wrong = as_given.with(Change::ZeroOffset(1, -angle)).with(Change::ZeroOffset(2, angle));
        let mut log = simulated(&scales::with_other_masses(&robot, 3), Oddity::None, 15.0, 7);
        wrong.apply(&mut log.recording);
        let view = crate::quality::view::View::new(&log.recording, Some(&robot)).unwrap();
        let rows = Rows::new(&[&view], Some(&robot)).unwrap();
        let bodies = Physics::bodies(&robot).unwrap();
        let before = Tried::new(&bodies, &rows, as_given.clone()).unwrap();
        let found = opposite_zeros(&bodies, &Physics::free(&robot), &rows, &before)?;
        Some([1, 2].map(|joint| found.best.description.position_offset[joint].to_degrees()))
    };
    let [second, third] = of(120.0).unwrap();
    assert!((second - 120.0).abs() < 4.0 && (third + 120.0).abs() < 4.0, "{second} {third}");
    assert_eq!(of(0.0), None);
}

#[test]
fn zeros_that_described_bodies_show_need_these_to_be_right() {
    let robot = irb();
    let as_given = Description::as_given(6, robot.gravity);
    let (free, bodies) = (Physics::free(&robot), Physics::bodies(&robot).unwrap());
    let pair = |degrees: f64| {
        let angle = f64::to_radians(degrees);
        as_given.clone().with(Change::ZeroOffset(1, angle)).with(Change::ZeroOffset(2, -angle))
    };
    let trusted = |own: &Robot, description: Description| {
        let mut log = simulated(own, Oddity::None, 15.0, 7);
        pair(-120.0).apply(&mut log.recording);
        let view = crate::quality::view::View::new(&log.recording, Some(&robot)).unwrap();
        let rows = Rows::new(&[&view], Some(&robot)).unwrap();
        are_of_bodies((&robot, &bodies, &free), &rows, &as_given, &Tried::new(&bodies, &rows, description).unwrap())
    };
    assert!(trusted(&robot, pair(120.0)));
    let mut heavier = robot.clone();
    heavier.joints.iter_mut().skip(2).for_each(|joint| joint.inertia.0.iter_mut().for_each(|value| *value *= 1.5));
    assert!(!trusted(&heavier, pair(120.0)));
    // What is no zero is not asked.
    assert!(trusted(&heavier, as_given.clone()));
}

/// A torque that is less than the weight which its joint carries makes at 1 cm may come from a centre of mass that is off.
#[test]
fn a_light_torque_shows_no_zero() {
    let trusted = |robot: &Robot| {
        let as_given = Description::as_given(6, robot.gravity);
        let (free, bodies) = (Physics::free(robot), Physics::bodies(robot).unwrap());
        let mut log = simulated(robot, Oddity::None, 15.0, 7);
        as_given.clone().with(Change::ZeroOffset(4, -0.5)).apply(&mut log.recording);
        let view = crate::quality::view::View::new(&log.recording, Some(robot)).unwrap();
        let rows = Rows::new(&[&view], Some(robot)).unwrap();
        let description = as_given.clone().with(Change::ZeroOffset(4, 0.5));
        are_of_bodies((robot, &bodies, &free), &rows, &as_given, &Tried::new(&bodies, &rows, description).unwrap())
    };
    assert!(trusted(&irb()));
    // Much more mass on the axis of the hand, which changes nothing of its own torque.
    let mut heavy = irb();
    heavy.joints[4].inertia.0[0] += 500.0;
    assert!(!trusted(&heavy));
}

#[test]
fn a_small_offset_is_left_to_the_diagnosis() {
    let robot = irb();
    assert!(are(&with_zeros(&robot, Oddity::None, &[(2, 4.0)]), &[]));
}

/// A load that the bodies lack turns the last joint too.
#[test]
fn the_zero_of_the_last_joint_is_not_seen() {
    let robot = arm("tests/reference/skew7.urdf");
    let last = robot.dof() - 1;
    assert!(are(&with_zeros(&robot, Oddity::None, &[(last, 90.0)]), &[]));
}

/// Another arm may have other zeros and nothing else in common.
#[test]
fn a_zero_is_not_applied_where_the_bodies_are_others() {
    let robot = irb();
    let mut other = robot.clone();
    other.joints.iter_mut().rev().take(3).for_each(|joint| joint.inertia.0[..].iter_mut().for_each(|v| *v *= 30.0));
    let wrong = Description::as_given(6, robot.gravity).with(Change::ZeroOffset(1, 1.5));
    for (described, applied) in [(&robot, true), (&other, false)] {
        let mut logs = [7, 8].map(|seed| simulated(&robot, Oddity::None, 15.0, seed));
        logs.iter_mut().for_each(|log| wrong.apply(&mut log.recording));
        let verdict = examine_together(&[&logs[0], &logs[1]], Some(described)).unwrap().verdict.unwrap();
        assert_eq!(verdict.beyond_doubt, applied, "{verdict:?}");
        // Where the log may be another arm's, that is said first, and a zero is a possibility.
        let report = &examine_together(&[&logs[0], &logs[1]], Some(described)).unwrap().reports[0];
        let zero = report.findings.iter().find(|finding| finding.kind == Kind::PositionZero).unwrap();
        let another = report.findings.iter().any(|f| f.kind == Kind::OtherRobot && f.severity > Severity::Note);
        assert_eq!(zero.severity > Severity::Note, !(another && verdict.unlike_bodies), "{:?}", report.findings);
        // Bodies that are too heavy are also torques that are too small; either is reported.
        let of_scale = report.findings.iter().any(|f| f.kind == Kind::TorqueUnit && f.severity > Severity::Note);
        assert!(applied || another || of_scale, "{:?}", report.findings);
    }
}

#[test]
fn half_a_turn_keeps_the_joint_within_its_limits() {
    let robot = irb();
    let limits = robot.joints[4].limits;
    let verdict = with_zeros(&robot, Oddity::None, &[(4, 180.0)]).unwrap();
    assert!(are(&Some(verdict.clone()), &[(4, 180.0)]), "{verdict:?}");
    let log = simulated(&robot, Oddity::None, 15.0, 7).recording;
    let mut logged = log.q.clone();
    logged.channel_mut(4).iter_mut().for_each(|q| *q += std::f64::consts::PI);
    let positions = verdict.description.positions(&logged);
    assert!(positions.channel(4).iter().all(|q| (limits.lower..limits.upper).contains(q)));
}
