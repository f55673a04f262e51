//! Logs to rows.
//!
//! In: recordings of the arm, training, held-out and reference. Out: screened logs, smoothed motion, the low-pass each
//! joint's positions went through, and rows (means over 20 ms) with the samples that are valid.

mod admission;
mod cutoffs;
mod given;
mod input;
mod log;
mod low_pass;
mod rows;
mod screening;

pub(crate) use admission::{check_held_out, check_length, refuse_twice};
pub(crate) use cutoffs::{CUTOFFS_HZ, cutoff, cutoffs_up_to, inner_power, typical_power, widest};
pub use given::GivenLog;
pub use input::CleanLogs;
pub(crate) use input::Input;
pub(crate) use input::split;
pub(crate) use log::Log;
pub use low_pass::LowPass;
pub(crate) use rows::Rows;
pub(crate) use rows::{FEWEST_ROWS, FEWEST_TEST_ROWS};
pub use screening::{Consequence, DataFault, Screened, screen};
pub(crate) use screening::{all_faults, correct, screen_all, screen_in_own_units, shared_verdict, still_joints};
