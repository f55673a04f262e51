//! Which of the effects found matter.
//!
//! In: the effects that the search found, the logs. Out: those that are reported, with standard deviations that hold their scatter
//! between blocks, and the smaller ones, each with the gate that it failed. Backward elimination: the least of those that fail goes
//! first, and the others are judged again without it.

mod blocks;
mod elimination;
mod fit;
mod gates;

pub use elimination::{Minor, eliminate, with_scatter};
