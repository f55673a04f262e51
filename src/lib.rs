//! tauscope: a physics-simulator-in-the-loop testbed for robot-arm identification.

pub mod channels;
pub mod dynamics;
pub mod effects;
pub mod error;
pub mod output;
pub mod random;
pub mod recording;
pub mod robot;
pub mod simulation;
