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
//! Imports run one way, from the top of this list downwards: [`cli`] and [`report`] know everything, [`robot`],
//! [`channels`], [`lane`] and [`linear`] know nothing.

pub mod cli;
pub mod report;

pub mod study;

pub mod dataset;

pub mod diagnosis;
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

pub mod channels;
pub mod error;
pub mod lane;
pub mod linear;
pub mod output;
pub mod random;
