//! Recordings: the sensor signals of an arm over time, from a file or from a simulation.
//!
//! In: logs, as files of many formats, in memory ([`memory`]) or as arrays ([`Log::new`](Recording::new)). Out: a [`Recording`], positions
//! and torques of all joints over time in SI units, velocities and accelerations where they were measured. [`load`] and [`save`] take
//! complete logs; [`lenient`] takes them as controllers write them, and reports what it left out and corrected. [`resample`] brings a
//! recording to even steps.

mod arrays;
mod cleaning;
mod columns;
mod files;
mod formats;
pub mod lenient;
pub mod memory;
mod once;
#[cfg(test)]
mod samples;
mod sampling;
mod signals;

pub use arrays::{JointArrays, Joints};
pub(crate) use cleaning::unwrap;
pub(crate) use columns::names::{ACCELERATION, POSITION, TORQUE, Unit, VELOCITY};
pub use files::{load, save, writable};
pub use formats::csv;
#[cfg(feature = "parquet")]
pub use formats::parquet;
pub(crate) use once::Once;
pub use sampling::resample;
pub use signals::{Log, Recording, Signals};
