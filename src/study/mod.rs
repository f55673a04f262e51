//! Studies on simulated arms, where the truth is known.

pub mod blind;
pub(crate) mod check;
pub mod closed_loop;
pub(crate) mod measured;
pub mod montecarlo;
pub mod replay;
pub(crate) mod score;
pub mod testbed;
