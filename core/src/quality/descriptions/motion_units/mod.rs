//! Units of the motion that show in the torques alone: the clock's second, and positions in turns.
//!
//! In: one log and the arm. Out: the factor of its clock, or whether its positions are in turns.

mod clock;
mod turns;

pub(crate) use clock::{clock_factor, clock_text};
pub(crate) use turns::are_turns;
