//! A torque that its drive cannot make, of a joint whose rotor takes up any factor.
//!
//! The inertia of a carriage on a level slide and that of its rotor are one column: a force in another unit only makes the rotor
//! heavy. So the factor is that of the bodies without a rotor, and counts where the force is beyond the drive besides.

use super::super::change::{Change, Description};
use super::super::fitting::{Physics, Rows};
use super::super::verdict::Shown;
use super::scale::{PLAUSIBLE, factor_without_rotor};
use crate::signal::size_quantile;

/// A twentieth of the samples is beyond this many times the effort limit: a drive exceeds it by less, and for a moment.
const BEYOND: f64 = 2.0;
const QUANTILE: f64 = 0.95;

/// Half of the joints stay within their limits, which are placeholders else.
const WITHIN: f64 = 1.0;

/// The description with a factor for the one torque that is beyond its limit of effort, with what shows it.
pub(crate) fn of_one_joint(bodies: &Physics, rows: &Rows, start: &Description) -> Option<(Description, Shown)> {
    let Physics::Bodies(robot) = bodies else { return None };
    let largest = |joint: usize| size_quantile(rows.tau.channel(start.torque_of[joint]).iter().copied(), QUANTILE);
    let limit = |joint: usize| robot.joints.get(joint).map_or(f64::INFINITY, |joint| joint.limits.effort);
    let measured: Vec<usize> = (0..start.dof()).filter(|&joint| rows.measured[start.torque_of[joint]]).collect();
    let within = measured.iter().filter(|&&joint| largest(joint) < WITHIN * limit(joint)).count();
    let mut beyond = measured.iter().copied().filter(|&joint| largest(joint) > BEYOND * limit(joint));
    let (Some(joint), None) = (beyond.next(), beyond.next()) else { return None };
    if 2 * within < measured.len() {
        return None;
    }
    let tables = bodies.tables(rows, start);
    let factor = factor_without_rotor(&tables.joints[joint], start.torque_of[joint], rows)?;
    let shown = Shown::Effort { joint, largest: largest(joint), limit: limit(joint) };
    (factor > PLAUSIBLE).then(|| (start.with(Change::JointScale(joint, 1.0 / factor)), shown))
}
