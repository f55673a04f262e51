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

pub use admission::{check_held_out, check_length, refuse_twice};
pub use cutoffs::{CUTOFFS_HZ, ORDER, cutoff, cutoffs_up_to, inner_power, passes_all, widest};
pub use given::GivenLog;
pub use input::{CleanLogs, Input, split};
pub use log::Log;
pub use low_pass::LowPass;
pub use rows::{FEWEST_ROWS, FEWEST_TEST_ROWS, Rows};
pub use screening::{
    Consequence, DataFault, Screened, all_faults, correct, screen, screen_all, screen_in_own_units, shared_verdict,
    still_joints,
};
