//! The clock of a log, and the rates of its signals.
//!
//! In: columns as the file has them, or a recording. Out: time in seconds, signals at one rate, and notes on what was assumed. A clock
//! may lack its unit, be coarse, overflow, begin anew, run backwards, stamp rows late, or those of two sources; recordings are brought to
//! even steps ([`resample`]).

mod interpolation;
mod late;
mod late_source;
pub(super) mod rates;
pub mod resample;
mod restarts;
pub(super) mod reversed;
mod set;
pub(super) mod stamps;
mod true_gaps;
mod unit;
pub(super) mod unsorted;
mod wrapped;
