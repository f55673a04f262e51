//! The meaning of a column's name: which quantity of which joint, or time. Programs that write logs have their own ways;
//! these are theirs.
//!
//! In: the name of a column. Out: all ways to understand it, the most likely first ([`meanings`]), or what part of time it holds
//! ([`time()`]).

mod meaning;
mod quantity;
mod scattered;
#[cfg(test)]
mod tests;
mod time;
mod translated;
mod unit;
mod vocabulary;
mod words;

pub(crate) use meaning::{Joint, Meaning, meanings, prefix_of, unknown_unit, with_joint};
pub(crate) use quantity::{ACCELERATION, POSITION, QUANTITIES, Quantity, TORQUE, TRUE, VELOCITY};
pub(crate) use scattered::scattered;
pub(crate) use time::{INDEX, OWN_TIME, Part, Time, are_seconds_and_rest, time};
pub(crate) use unit::{Unit, is_unit};
pub(crate) use vocabulary::{is_external_torque, is_measured_at_joint, is_of_motor};
pub(crate) use words::{unit_of, without_unit_of};
