//! Logs as controllers write them: rows that cannot be used are left out and reported, the others are kept, and what has
//! one cause and one cure is corrected.
//!
//! In: one or several files of a log, the joints that are wanted, and names of columns ([`ColumnMap`]). Out: a recording with time in
//! seconds, the rows that were left out ([`Rejected`]), and notes on what was assumed and corrected ([`Sieved`]).

mod join;
mod plausible;
mod read;
mod source;
mod units;

pub use super::cleaning::{Cause, Rejected};
pub use super::columns::{Column, ColumnMap, JointNames};
pub use plausible::DoubtfulUnit;
pub(crate) use read::load_together;
pub use read::{Sieved, joint_names, load, positions};
