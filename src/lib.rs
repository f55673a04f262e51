//! tauscope: a physics-simulator-in-the-loop testbed for robot-arm identification.
//!
//! ```text
//! scenario -> excitation -> plant (rapier + effects + controller) -> sensors -> recording -> filter -> regressor -> estimate -> score -> report
//! ```
//!
//! # Conventions
//! - SI units and radians inside; units are in the names of file keys and columns (`step_s`, `torque_noise_nm`).
//! - `tau` is what the motor delivers at the joint. An effect's torque is what the motor must add because of it.
//! - Inertial parameters in the order m, mx, my, mz, Ixx, Ixy, Iyy, Ixz, Iyz, Izz about the joint frame (Pinocchio's).
//! - Batched signals are laid out `[channel][time]` ([`channels::Channels`]).
//! - Every random number comes from a recorded seed through a named stream ([`random`]).
//!
//! Imports run one way: a room may use the rooms below it in this list and none above, [`cli`] all of them and [`error`]
//! none. Inside a room its files import each other without a circle. A test holds both.

pub mod cli;

pub mod report;

pub(crate) mod paper;

pub mod study;

pub mod dataset;

pub mod diagnosis;

pub mod payload;

pub mod quality;

pub mod scenario;

pub mod design;

pub mod simulation;

pub mod identification;

pub mod effects;

pub mod dynamics;

pub mod excitation;

pub mod recording;

pub mod signal;

pub mod robot;

pub(crate) mod linear;

pub(crate) mod output;

pub mod random;

pub mod lane;

pub mod channels;

pub mod error;
