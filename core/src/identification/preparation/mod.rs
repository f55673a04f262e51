//! From logs to regression rows. A recording comes in; smoothed motion, filtered torque and the samples that count go out, the smoothing
//! that suits a log, and rows of equal states in several logs.

mod bridge;
pub(crate) mod equal_states;
pub(crate) mod low_passed;
pub mod prepare;
pub mod reversals;
pub mod smoothing_choice;
