//! Detection of backlash by the impacts it causes.
//!
//! In: logged positions and torque. Out: joints whose gears have play, with the play's size and its p-value.

mod impacts;

pub use impacts::Play;
pub(crate) use impacts::Traces;
