//! Samples that cannot be used, and values that are not those of a sensor.
//!
//! In: columns as the file has them, or a recording in seconds. Out: numbers that stand for a missing value, the columns without values,
//! the rows without those that are not finite, absurd or out of order ([`Rejected`]), torques without those that never change, positions
//! without jumps by whole turns.

mod blank;
pub(super) mod missing;
pub(super) mod sentinel;
mod sieve;
mod unwrap;

pub(crate) use sieve::Rows;
pub use sieve::{Cause, Rejected};
pub(crate) use unwrap::unwrap;
