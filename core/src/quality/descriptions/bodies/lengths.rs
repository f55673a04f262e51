//! Lengths of the arm that are not those of its file: another size of the robot, or one wrong link.
//!
//! Free bodies take up any masses, but the distances between axes are those of the file. A wrong one leaves a part of the torques that
//! looks like a gain, an eccentric encoder or a balancer. So each distance, and all together, are tried at other sizes under free
//! bodies. A factor of one torque, which is the nearest other cause, is tried in their place.

use super::super::change::{Change, Description};
use super::super::compare::{Comparison, EXPLAINED, compare};
use super::super::fitting::{Physics, Rows};
use super::super::sizes::scale::{best, merit};
use super::super::tried::Tried;
use crate::robot::Robot;

/// Free bodies that leave less of the torques, as a geometric mean, have the lengths of the arm: noise and friction of right logs leave as
/// much.
const RIGHT: f64 = 0.01;

/// Distances below it are offsets of a wrist, of which torques show little, m.
const SHORTEST_M: f64 = 0.05;

/// Sizes are tried up to so many times larger and smaller: models of one family differ by less.
const WIDEST: f64 = 2.5;

/// Distances within this of that of the file are not named: tolerances and other conventions of frames make them.
const REPORTED: f64 = 1.05;

/// Other lengths of the arm.
pub(super) struct Lengths {
    /// Those that explain the torques best; none for all of them.
    pub joint: Option<usize>,
    /// How many times as long as described.
    pub factor: f64,
    /// Joints to which other distances explain the torques about as well.
    pub rivals: Vec<usize>,
    /// Share of the torques that stays unexplained with them.
    pub share: f64,
}

/// Lengths under which free bodies explain the torques clearly better than under those of the file, and than by a factor of one torque.
/// The clock is known where velocities were logged.
pub(super) fn other(
    robot: &Robot,
    rows: &Rows,
    description: &Description,
    free: &Tried,
    clock_is_known: bool,
) -> Option<Lengths> {
    if free.share() < RIGHT {
        return None;
    }
    let whole = rows.whole();
    let length = |joint: usize| robot.joints[joint].origin.translation.norm();
    // The place of the first joint has no part in the torques.
    let single = (1..robot.dof()).filter(|&joint| length(joint) > SHORTEST_M).map(Some);
    let candidates: Vec<Option<usize>> = single.chain([None]).collect();
    let tried = |joint: &Option<usize>| {
        let merit_of = |factor: f64| {
            let physics = Physics::free(&with(robot, *joint, factor));
            merit(&physics.tables(&whole, description), &whole, description)
        };
        let factor = best(1.0, WIDEST, merit_of)?;
        let tried = Tried::new(&Physics::free(&with(robot, *joint, factor)), rows, description.clone())?;
        tracing::debug!(?joint, factor, share = tried.share(), "other lengths");
        Some((*joint, factor, tried))
    };
    let mut each: Vec<(Option<usize>, f64, Tried)> = candidates.iter().filter_map(tried).collect();
    each.sort_by(|a, b| a.2.share().total_cmp(&b.2.share()));
    let gain = |from: &Tried, to: &Tried| compare(&from.evaluation, &to.evaluation, &rows.log);
    let (joint, factor, own) = each.first()?;
    let is_clear = |gain: Comparison| gain.is_better(candidates.len(), EXPLAINED) && gain.is_large(1);
    if factor.ln().abs() < REPORTED.ln() || !gain(free, own).is_some_and(is_clear) {
        return None;
    }
    // A gain of one torque, as of a wrong torque constant.
    let tables = Physics::free(robot);
    let tables = (tables.tables(&whole, description), tables);
    let scaled = |joint: usize| {
        let with = |scale: f64| description.with(Change::JointScale(joint, scale));
        let scale = best(1.0, WIDEST, |scale| merit(&tables.0, &whole, &with(scale)))?;
        Tried::new(&tables.1, rows, with(scale))
    };
    let denies = |other: Tried| gain(&other, own).is_some_and(|gain| gain.is_distinct());
    if !(0..robot.dof()).filter_map(scaled).all(denies) {
        return None;
    }
    let is_rival = |other: &&(Option<usize>, f64, Tried)| !gain(&other.2, own).is_some_and(|gain| gain.is_distinct());
    let rivals: Vec<Option<usize>> = each[1..].iter().filter(is_rival).map(|(joint, ..)| *joint).collect();
    // All lengths are a factor of the clock, which is looked for by itself.
    if !clock_is_known && (joint.is_none() || rivals.contains(&None)) {
        return None;
    }
    let rivals = rivals.into_iter().flatten().collect();
    Some(Lengths { joint: *joint, factor: *factor, rivals, share: own.share() })
}

/// The robot with the distance to one joint so many times as long, or all of them.
fn with(robot: &Robot, joint: Option<usize>, factor: f64) -> Robot {
    let mut other = robot.clone();
    let own = other.joints.iter_mut().enumerate().filter(|(place, _)| joint.is_none_or(|joint| joint == *place));
    own.for_each(|(_, own)| own.origin.translation *= factor);
    other
}

impl Lengths {
    /// What is said of them.
    pub(super) fn text(&self, robot: &Robot, before: f64, changed: &str) -> String {
        let percent = |share: f64| format!("{:.1} %", 100.0 * share);
        let name = |joint: usize| robot.joints[joint].name.as_str();
        let times = format!("{:.2}", self.factor);
        let which = match self.joint {
            None => format!("all lengths about {times} times those of the file"),
            Some(joint) => {
                let described = robot.joints[joint].origin.translation.norm();
                format!(
                    "{} about {:.3} m from the joint before it, where the file has {described:.3} m",
                    name(joint),
                    self.factor * described
                )
            }
        };
        let rivals = match self.rivals[..] {
            [] => String::new(),
            _ => format!(
                " (other distances to {} explain them about as well)",
                self.rivals.iter().map(|&joint| name(joint)).collect::<Vec<_>>().join(", ")
            ),
        };
        format!(
            "the torques are not those of an arm with the lengths of the file{changed}: with {which}{rivals}, {} stay unexplained on parts held out \
             instead of {}, whatever the bodies weigh. The log may be that of another size of this robot, or a length of the file is wrong: check the \
             file against the arm. What a diagnosis names under wrong lengths is in doubt",
            percent(self.share),
            percent(before)
        )
    }
}
