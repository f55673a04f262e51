//! Studies on simulated arms, where the truth is known.

pub mod blind;
pub mod measured;
pub mod paper;
pub mod score;
pub mod testbed;
