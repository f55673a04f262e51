//! Whether positions are in turns, from the torques of gravity: they look like those of an arm that hardly moves.

use super::super::change::Description;
use super::super::compare::{EXPLAINED, compare};
use super::super::fitting::{Physics, Rows};
use super::super::tried::Tried;
use super::scaled::{of_turning, scaled, scaled_motion};
use crate::error::Result;
use crate::quality::view::View;
use crate::recording::Recording;
use crate::robot::{JointKind, Robot};
use std::f64::consts::TAU;

/// Positions exceed the limits by no more than this factor.
const WITHIN: f64 = 1.05;

/// Whether free bodies explain the torques clearly better where the positions of joints that turn are taken for turns, which are then
/// within their limits.
///
/// # Errors
/// Those of the filters.
pub(crate) fn are_turns(log: &Recording, robot: &Robot) -> Result<bool> {
    let turns = |joint: usize| robot.joints[joint].kind == JointKind::Revolute;
    let fits = |joint: usize| {
        let limits = robot.joints[joint].limits;
        let bound = limits.lower.abs().max(limits.upper.abs());
        !turns(joint) || log.q.channel(joint).iter().all(|q| TAU * q.abs() < WITHIN * bound)
    };
    if !(0..robot.dof()).all(fits) || !(0..robot.dof()).any(turns) {
        return Ok(false);
    }
    let converted = Recording { q: scaled(&log.q, &of_turning(robot, TAU)), ..log.clone() };
    explains_better(&converted, robot, &of_turning(robot, 1.0 / TAU))
}

/// Whether free bodies explain the torques clearly better with the positions of a log than with those that are so many times larger.
///
/// # Errors
/// Those of the filters.
pub(super) fn explains_better(log: &Recording, robot: &Robot, factors: &[f64]) -> Result<bool> {
    let Some(mut rows) = Rows::new(&[&View::new(log, Some(robot))?], Some(robot)) else { return Ok(false) };
    let physics = Physics::free(robot);
    let tried = |rows: &Rows| Tried::new(&physics, rows, Description::as_given(robot.dof(), robot.gravity));
    let Some(with) = tried(&rows) else { return Ok(false) };
    rows.motion = scaled_motion(&rows.motion, factors);
    let Some(without) = tried(&rows) else { return Ok(false) };
    let explained = with.explains_half();
    let gain = compare(&without.evaluation, &with.evaluation, &rows.log);
    Ok(explained && gain.is_some_and(|gain| gain.is_better(1, EXPLAINED) && gain.is_large(1)))
}
