//! What the described bodies indicate where they do not explain the torques as described.
//!
//! | question | module |
//! |---|---|
//! | whether the log is of another robot | `disagreement` |
//! | whether a controller takes off the gravity of the described bodies | `compensation` |

pub(super) mod compensation;
mod disagreement;

pub(crate) use disagreement::finding;
