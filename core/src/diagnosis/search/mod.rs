//! Forward selection of effects with backward re-selection.
//!
//! In: prepared logs, the model of the arm, candidates. Out: the effects found, each with its family-wise p-value, its alternatives and its
//! held-out gain, under a controlled family-wise error.

mod acceptance;
mod all_logs;
mod comparison;
mod eligible;
mod events;
mod exchange;
mod found;
mod pairs;
mod parsimony;
mod play;
mod reselection;
mod round;
mod selection;
mod verdict;

#[cfg(test)]
pub(crate) use acceptance::Accepted;
pub(crate) use found::members;
pub use found::{Alternative, Found, Rejected};
pub(crate) use round::{converged, settled};
pub(crate) use selection::{Given, Selection, select, take};
pub use verdict::Verdict;
