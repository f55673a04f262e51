//! Studies on simulated arms, where the truth is known.

pub mod score;
pub mod testbed;
