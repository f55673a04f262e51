//! tauscope: a physics-simulator-in-the-loop testbed for robot-arm identification.
//!
//! ```text
//! scenario -> excitation -> plant (rapier + effects + controller) -> sensors -> recording
//!     -> filter -> regressor -> estimate -> score -> report
//! ```
//!
//! # Conventions
//! - SI units and radians inside; units are in the names of file keys and columns (`step_s`, `torque_noise_nm`).
//! - `tau` is what the motor delivers at the joint. An effect's torque is what the motor must add because of it.
//! - Inertial parameters in the order m, mx, my, mz, Ixx, Ixy, Iyy, Ixz, Iyz, Izz about the joint frame (Pinocchio's).
//! - Batched signals are laid out `[channel][time]` ([`channels::Channels`]).
//! - Every random number comes from a recorded seed through a named stream ([`random`]).
//!
//! # Example
//! ```no_run
//! use tauscope::diagnosis::{Diagnosis, Verdict};
//! use tauscope::scenario::Setup;
//! use tauscope::study::testbed;
//!
//! // Two motions of an arm with Stribeck friction on joint 2, which its description does not have.
//! let setup = Setup::load("scenarios/effects/stribeck_friction.toml", None)?;
//! let logs = testbed::record(&setup, &mut |_| ())?;
//!
//! let answer = Diagnosis::of(&setup.known)
//!     .train([&logs.training.recording])
//!     .test([&logs.held_out.recording])
//!     .candidates(["stribeck_friction", "torque_offset"])
//!     .run()?;
//!
//! assert_eq!(answer.verdict(), Verdict::Named);
//! let finding = &answer.findings()[0];
//! assert_eq!((finding.effect, &finding.joints[..]), ("stribeck_friction", &["joint_2".to_owned()][..]));
//! # Ok::<(), tauscope::error::Error>(())
//! ```
//!
//! # Rooms
//! Robots, dynamics, identification and diagnosis are in the crate `tauscope-core`, which needs no simulator, and are
//! found here under the same names.
//!
//! Imports run one way: a room may use the rooms below it in this list and none above, [`cli`] all of them. Inside a room
//! its files import each other without a circle. A test holds both, here and in `tauscope-core`.

pub mod cli;

pub mod report;

pub(crate) mod paper;

pub mod study;

pub mod scenario;

pub mod simulation;

pub(crate) mod output;

#[doc(inline)]
pub use tauscope_core::{
    Log, channels, dataset, design, diagnosis, dynamics, effects, error, excitation, identification, lane, payload,
    quality, random, recording, robot, signal,
};

pub(crate) use tauscope_core::internal;
