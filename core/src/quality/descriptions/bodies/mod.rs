//! What the described bodies indicate where they do not explain the torques as described.
//!
//! | question | module |
//! |---|---|
//! | whether torques are those of gravity alone | `at_rest` |
//! | whether the log is of another robot | `disagreement` |
//! | whether the lengths of the arm are not those of the file | `lengths` |
//! | whether a controller takes off the gravity of the described bodies | `compensation` |
//! | which torque constants make torques of motor currents | `currents` |

pub(super) mod at_rest;
pub(super) mod compensation;
pub(super) mod currents;
mod disagreement;
mod lengths;

pub(crate) use disagreement::finding;
