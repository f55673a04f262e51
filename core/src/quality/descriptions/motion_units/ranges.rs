//! Whether positions are shares of each joint's range from -100 to 100, as LeRobot records them: they look like degrees.

use super::super::change::Description;
use super::super::compare::{EXPLAINED, compare};
use super::super::fitting::{Physics, Rows};
use super::super::shares::WRONG_MASSES;
use super::super::tried::Tried;
use super::scaled::{of_turning, scaled};
use crate::error::Result;
use crate::quality::motion::{Gears, Ranges};
use crate::quality::view::View;
use crate::recording::Recording;
use crate::robot::{JointKind, Robot};

/// The end of a range, and what the digits of a recorder add to it.
const FULL: f64 = 100.0;
const DIGITS: f64 = 0.5;

/// Joints that reach this come to the ends of the ranges within which they were calibrated.
const NEAR_FULL: f64 = 90.0;

/// Whether the positions are shares of ranges: of the limits of the robot's file, where they explain the torques as such and not as degrees;
/// or of ranges that nobody gave, where most joints come to their ends and no unit explains the torques. Where these ranges are alike, a
/// `gear` does, which hardly ends there.
///
/// # Errors
/// Those of the filters.
pub(crate) fn ranges(log: &Recording, robot: &Robot, gear: Option<Gears>) -> Result<Option<Ranges>> {
    let turns: Vec<usize> = (0..robot.dof()).filter(|&joint| robot.joints[joint].kind == JointKind::Revolute).collect();
    let largest = |joint: usize| log.q.channel(joint).iter().fold(0.0f64, |most, q| most.max(q.abs()));
    if turns.len() < 2 || turns.iter().any(|&joint| largest(joint) > FULL + DIGITS) {
        return Ok(None);
    }
    let physics = Physics::free(robot);
    let as_given = Description::as_given(robot.dof(), robot.gravity);
    let rows = |q| -> Result<Option<Rows>> {
        let log = Recording { q, qd: None, qdd: None, ..log.clone() };
        Ok(Rows::new(&[&View::new(&log, Some(robot))?], Some(robot)))
    };
    let tried = |physics: &Physics, rows: &Rows| Tried::new(physics, rows, as_given.clone());
    let Some(in_degrees) = rows(scaled(&log.q, &of_turning(robot, 1f64.to_radians())))? else { return Ok(None) };
    let Some(as_degrees) = tried(&physics, &in_degrees) else { return Ok(None) };
    if let Some(ranges) = of_limits(robot, &turns) {
        let q = log.q.map(|joint, signal| match turns.iter().position(|own| *own == joint) {
            Some(place) => signal.iter().map(|share| ranges[place][0] + share / FULL * ranges[place][1]).collect(),
            None => signal.to_vec(),
        });
        if let Some(rows) = rows(q)?
            && let Some(as_shares) = tried(&physics, &rows)
            && as_shares.share() < EXPLAINED
            && compare(&as_degrees.evaluation, &as_shares.evaluation, &rows.log)
                .is_some_and(|gain| gain.is_better(1, EXPLAINED) && gain.is_large(1))
        {
            let unexplained = [as_degrees.share(), as_shares.share()];
            return Ok(Some(Ranges { of_limits: Some(ranges), unexplained, gear: None }));
        }
    }
    let reach = turns.iter().filter(|&&joint| largest(joint) > NEAR_FULL).count();
    // Each joint's torque may be in a unit of its own.
    let multiples = || Physics::multiples(robot).and_then(|multiples| tried(&multiples, &in_degrees));
    let is_unlike = gear.is_some()
        || (as_degrees.share() >= WRONG_MASSES
            && multiples().is_none_or(|multiples| multiples.share() >= WRONG_MASSES));
    let unexplained = [as_degrees.share(); 2];
    Ok((2 * reach > turns.len() && is_unlike).then_some(Ranges {
        of_limits: None,
        unexplained,
        gear: gear.map(|gear| gear.ratio),
    }))
}

/// Middle and half of the range of the joints that turn, where all have one.
fn of_limits(robot: &Robot, turns: &[usize]) -> Option<Vec<[f64; 2]>> {
    let of = |&joint: &usize| {
        let limits = robot.joints[joint].limits;
        let own = [0.5 * (limits.lower + limits.upper), 0.5 * (limits.upper - limits.lower)];
        (own.iter().all(|value| value.is_finite()) && own[1] > 0.0).then_some(own)
    };
    turns.iter().map(of).collect()
}
