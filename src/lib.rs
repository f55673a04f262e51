//! tauscope: a physics-simulator-in-the-loop testbed for robot-arm identification.

pub mod channels;
pub mod design;
pub mod dynamics;
pub mod effects;
pub mod error;
pub mod excitation;
pub mod identification;
pub mod random;
pub mod recording;
pub mod robot;
pub mod scenario;
pub mod signal;
pub mod simulation;
pub mod study;
