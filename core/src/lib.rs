//! What the model of a robot arm misses, from its logs: the part of tauscope that needs no simulator.
//!
//! ```text
//! logs -> recording -> quality -> filter -> regressor -> estimate -> diagnosis
//! ```
//!
//! Programs use it through the crate `tauscope`, which has all of it under the same paths and adds simulator, studies,
//! reports and the command. Conventions are written down there.
//!
//! # From arrays to an answer
//! ```
//! # extern crate tauscope_core as tauscope;
//! use tauscope::Log;
//! use tauscope::diagnosis::Diagnosis;
//! use tauscope::identification::Identification;
//! use tauscope::robot::Robot;
//! # use tauscope::error::Result;
//!
//! # fn question(urdf: &str, t: &[f64], q: &[Vec<f64>], qd: &[Vec<f64>], tau: &[Vec<f64>]) -> Result<()> {
//! // Times, s; positions, velocities and torques, one array per joint: rad, rad/s, N m.
//! let robot = Robot::from_urdf_str(urdf)?;
//! let log = Log::new(&robot, t, q, tau)?.velocities(qd)?;
//!
//! // What does the model of the arm miss?
//! let answer = Diagnosis::of(&robot).train([&log]).run()?;
//! println!("{:?}", answer.verdict());
//!
//! // Its parameters, with the friction of joint j2 that falls with speed.
//! let found = Identification::of(&robot).train([&log]).effects(["stribeck_friction:j2"]).run()?;
//! println!("{} {:?}", found.joints[1], found.robot.joints[1].drive);
//! # Ok(())
//! # }
//! ```
//!
//! Logs as Parquet files and as ROS 2 bags are read and written with the features `parquet` and `bags`. A simulator takes
//! part through [`diagnosis::Simulator`].
//!
//! # What is public
//! What users call is public where it is defined and documented. What only `tauscope` calls is no part of that: functions,
//! types and constants of this kind are listed in `internal` and nowhere else, and methods are `#[doc(hidden)]`.
//!
//! Imports run one way: a room may use the rooms below it in this list and none above. Inside a room its files import each
//! other without a circle. A test of `tauscope` holds both.

#[doc(hidden)]
pub mod internal;

pub mod dataset;

pub mod diagnosis;

pub mod payload;

pub mod quality;

pub mod design;

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

#[doc(no_inline)]
pub use recording::Log;
