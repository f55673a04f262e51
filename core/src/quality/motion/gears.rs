//! Gears between the motors that were logged and their joints.

/// Gears that all joints which turn share.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Gears {
    /// Turns of the motor per turn of the joint.
    pub ratio: f64,
    /// Whether some motors turn the other way than their joints.
    pub some_reversed: bool,
}
