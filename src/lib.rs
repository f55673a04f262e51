//! tauscope: a physics-simulator-in-the-loop testbed for robot-arm identification.

pub mod error;
pub mod identification;
pub mod random;
