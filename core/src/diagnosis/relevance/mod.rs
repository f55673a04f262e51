//! Which of the effects found matter.
//!
//! In: the effects that the search found, the logs. Out: those that are reported, with standard deviations that hold their scatter
//! between blocks, and the smaller ones, each with the gate that it failed. Backward elimination: the least of those that fail goes
//! first, and the others are judged again without it. Parameters of those that stay which the logs do not determine are held.

mod blocks;
mod determined;
mod elimination;
mod fit;
mod gates;

pub(crate) use determined::hold_undetermined;
pub use elimination::Minor;
pub(crate) use elimination::{eliminate, nearest, with_scatter};
