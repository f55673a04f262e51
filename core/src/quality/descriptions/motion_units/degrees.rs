//! Whether positions are in degrees that would be within the limits in rad too, from the torques under the described bodies: a motion of a
//! few degrees looks like one of a few radians.
//!
//! Free bodies do not show it: over so small a motion the torque is linear in the positions, which heavier bodies make up for.

use super::super::change::Description;
use super::super::compare::{EXPLAINED, compare};
use super::super::fitting::{Fit, Physics, Rows};
use super::super::shares::WRONG_MASSES;
use super::super::tried::Tried;
use super::scaled::{of_turning, scaled_motion};
use crate::error::Result;
use crate::quality::view::View;
use crate::recording::Recording;
use crate::robot::Robot;

/// Described bodies leave no more than so many times what free ones do: those whose torques hardly change over a motion 57 times smaller
/// leave all that changes.
const LIKE_FREE: f64 = 2.0;

/// .. or this share of the torques, which free ones take up: nothing of a large change is left then.
const LITTLE: f64 = 0.05;

/// Constants of the drives are less than this share of the torques: a larger one takes off the weight of the bodies, which torques of
/// another scale, or without gravity, do not have.
const CONSTANT: f64 = 0.5;

/// Whether the described bodies explain the torques clearly better where the positions of joints that turn are taken for degrees.
///
/// # Errors
/// Those of the filters.
pub(crate) fn are_degrees(log: &Recording, robot: &Robot) -> Result<bool> {
    let Some(bodies) = Physics::described(robot) else { return Ok(false) };
    let Some(rows) = Rows::new(&[&View::new(log, Some(robot))?], Some(robot)) else { return Ok(false) };
    Ok(explain_in_degrees(robot, &bodies, rows).unwrap_or(false))
}

fn explain_in_degrees(robot: &Robot, bodies: &Physics, mut rows: Rows) -> Option<bool> {
    let as_given = Description::as_given(robot.dof(), robot.gravity);
    let under = |physics: &Physics, rows: &Rows| Tried::new(physics, rows, as_given.clone());
    let before = under(bodies, &rows)?;
    if before.share() < WRONG_MASSES {
        return Some(false);
    }
    rows.motion = scaled_motion(&rows.motion, &of_turning(robot, 1f64.to_radians()));
    let after = under(bodies, &rows)?;
    let free = under(&Physics::free(robot), &rows)?.share();
    if after.share() >= WRONG_MASSES || after.share() > LITTLE.max(LIKE_FREE * free) {
        return Some(false);
    }
    let gain = compare(&before.evaluation, &after.evaluation, &rows.log)?;
    let constants = Fit::new(&bodies.tables(&rows, &as_given), &rows, &as_given).constants()?;
    let are_small = constants.iter().all(|&(joint, constant)| constant.abs() < CONSTANT * rows.size[joint]);
    Some(gain.is_better(1, EXPLAINED) && gain.is_large(1) && are_small)
}
