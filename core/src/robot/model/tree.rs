//! What makes a robot more than a serial arm: branches, and joints that follow others.

use super::joint::Joint;

/// A moving joint without a coordinate of its own: it follows a coordinate, q = multiplier x + offset. Its friction and
/// rotor are part of that coordinate's drive.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::robot::{self, InertiaCheck};
///
/// // The right finger of this hand mimics the left one. Four joints and one finger have coordinates.
/// let arm = robot::load("../tests/reference/trees/two_finger.urdf", InertiaCheck::Required)?;
/// let follower = &arm.followers()[0];
/// assert_eq!((arm.dof(), arm.bodies(), &follower.joint.name[..]), (5, 6, "finger_right_joint"));
/// assert_eq!(arm.joints[follower.coordinate].name, "finger_left_joint");
/// assert_eq!((follower.multiplier, follower.offset), (1.0, 0.0));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Follower {
    /// The joint and the body it carries.
    pub joint: Joint,
    /// Index of the coordinate that it follows.
    pub coordinate: usize,
    /// dq / dx.
    pub multiplier: f64,
    /// Position at x = 0, rad or m.
    pub offset: f64,
}

/// Structure of a robot that is not a serial chain. Bodies are counted: first one per coordinate, then one per follower.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::robot::{self, InertiaCheck};
///
/// // Both fingers of the hand hang on one body: no chain. A serial arm has no tree.
/// let arm = robot::load("../tests/reference/trees/two_finger.urdf", InertiaCheck::Required)?;
/// let tree = arm.tree.as_ref().expect("it branches at the hand");
/// let finger = arm.joint_index("finger_left_joint")?;
/// assert_eq!(tree.parents[finger], tree.parents[arm.dof()]);
///
/// let arm = robot::load("../urdf/irb1600_6_120.urdf", InertiaCheck::Required)?;
/// assert!(arm.tree.is_none());
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Tree {
    /// Joints that follow coordinates.
    pub followers: Vec<Follower>,
    /// The body that carries each body, none for the base.
    pub parents: Vec<Option<usize>>,
    /// The body that carries the flange.
    pub tip: usize,
}
