//! A motion in other units.

use crate::channels::Channels;
use crate::dynamics::Motion;
use crate::robot::{Joint, JointKind, Robot};

/// A factor for every joint that turns, and one for those that slide.
pub(super) fn of_turning(robot: &Robot, factor: f64) -> Vec<f64> {
    let of = |joint: &Joint| if joint.kind == JointKind::Revolute { factor } else { 1.0 };
    robot.joints.iter().map(of).collect()
}

/// Signals of which each is so many times larger.
pub(super) fn scaled(signals: &Channels, factors: &[f64]) -> Channels {
    signals.map(|joint, signal| signal.iter().map(|value| factors[joint] * value).collect())
}

/// A motion of which each joint's is so many times larger.
pub(super) fn scaled_motion(motion: &Motion, factors: &[f64]) -> Motion {
    Motion { q: scaled(&motion.q, factors), qd: scaled(&motion.qd, factors), qdd: scaled(&motion.qdd, factors) }
}
