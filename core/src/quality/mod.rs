//! What a measured log is worth: every fault found in it, where it is, and what to do about it.
//!
//! Checks of single channels need nothing but the log. Those of torque fit a model to every joint: with a URDF the base
//! parameters that act there, without one gravity, rotor and friction of the joint alone.

mod channels;
pub mod descriptions;
mod examination;
mod finding;
mod lost_signs;
mod motion;
mod named_units;
mod places;
mod rates;
mod reading;
mod report;
mod statistics;
pub(crate) mod torque;
mod unit_changes;
mod units;
mod velocity;
mod view;

pub(crate) use channels::{NO_PIECE, Usable, usable};
pub use channels::{clipping, is_saturated};
pub use examination::{examine, examine_together, inspect};
pub(crate) use finding::alike_together;
pub use finding::{Finding, Kind, Severity, standing_together, with_logs};
pub use motion::{Constant, JointSummary, OtherUnit};
pub(crate) use named_units::settle as settle_named_units;
pub use report::{Report, Together};
pub use unit_changes::{OtherRate, UnitChanges};
pub(crate) use units::examine_in_own_units;

#[cfg(test)]
mod every_kind;
#[cfg(test)]
mod tests;
