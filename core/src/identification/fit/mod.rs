//! Fits on demand. An arm, training logs and held-out logs come in; the arm's parameters, those of named effects and both residuals
//! go out, and the joints that have an equation.

mod between_blocks;
mod between_logs;
mod blocks;
mod constants;
pub mod equations;
mod fitted;
mod reversals;
mod separable;

pub use between_logs::{Agreement, BetweenLogs};
pub use constants::Constant;
pub(in crate::identification) use fitted::fit_effects_until;
pub use fitted::{Fitted, Logs, Rows, fit_effects};
pub use separable::EffectFit;
