//! Studies on simulated arms, where the truth is known.

pub mod blind;
pub mod check;
pub mod closed_loop;
pub mod measured;
pub mod montecarlo;
pub mod replay;
pub mod score;
pub mod testbed;
