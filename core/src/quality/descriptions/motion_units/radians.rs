//! Whether positions are in rad of which the names say degrees, from the torques of gravity.

use super::turns::explains_better;
use crate::error::Result;
use crate::recording::Recording;
use crate::robot::Robot;

/// Positions leave the limits by no more than this, rad.
const BEYOND: f64 = 0.05;

/// Whether free bodies explain the torques clearly better with positions in rad, as `log` has them, than with these in degrees. Positions
/// beyond the limits are not in rad.
///
/// # Errors
/// Those of the filters.
pub(crate) fn are_radians(log: &Recording, robot: &Robot) -> Result<bool> {
    let is_within = |joint: usize| robot.joints[joint].limits.left_by(log.q.channel(joint)) < BEYOND;
    if !(0..robot.dof()).all(is_within) {
        return Ok(false);
    }
    explains_better(log, robot, &vec![1f64.to_radians(); robot.dof()])
}
