//! The arm in the loop: rapier as forward dynamics, friction and drives, controller, sensors.

pub mod rapier_arm;
