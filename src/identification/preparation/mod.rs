//! From logs to regression rows. A recording comes in; smoothed motion, filtered torque and the samples that count go out, and the
//! smoothing that suits a log.

pub mod prepare;
pub mod reversals;
pub mod smoothing_choice;
