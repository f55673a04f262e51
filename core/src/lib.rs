//! What the model of a robot arm misses, from its logs: the part of tauscope that needs no simulator.
//!
//! ```text
//! logs -> recording -> quality -> filter -> regressor -> estimate -> diagnosis
//! ```
//!
//! Programs use it through the crate `tauscope`, which has all of it under the same paths and adds simulator, studies,
//! reports and the command. Conventions are written down there.
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
