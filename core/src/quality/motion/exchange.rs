//! Positions of a joint that turns in the column of one that slides.
//!
//! A turn of 1 rad is 1 m there, far beyond the limits, and as 1 mm it would hardly be a motion. No unit is wrong then: the two columns
//! are exchanged. The torques decide, as of all exchanges.

use super::summary::JointSummary;
use crate::robot::{JointKind, Robot};

/// In the other unit, or as those of another joint, position and speed exceed the limits by no more than these factors.
pub(super) const WITHIN: f64 = 1.05;
pub(super) const NOT_FASTER: f64 = 1.5;

/// The joint that turns whose positions `joint`, which slides, may have: each of the two columns is within the limits of the other joint.
pub(super) fn partner(robot: &Robot, summaries: &[JointSummary], joint: usize) -> Option<usize> {
    let kind = |joint: usize| robot.joints[joint].kind;
    if kind(joint) != JointKind::Prismatic {
        return None;
    }
    let fits = |own: usize, at: usize| {
        let limits = robot.joints[at].limits;
        // A column may be off by a little, as a joint at its end stop is.
        let slack = (WITHIN - 1.0) * (limits.upper - limits.lower);
        let [low, high] = summaries[own].range;
        let within = !(low < limits.lower - slack || high > limits.upper + slack);
        within && summaries[own].speed < NOT_FASTER * limits.velocity
    };
    (0..robot.dof()).find(|&other| kind(other) == JointKind::Revolute && fits(joint, other) && fits(other, joint))
}
