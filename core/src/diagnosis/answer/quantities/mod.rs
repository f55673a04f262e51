//! Numbers of an answer that follow from its fits.
//!
//! In: members of the model, rows, residuals. Out: derived quantities of an effect, share of the gap to the noise that is closed,
//! what a residual correlates with, the residuals that an answer is shown by, and least sizes of effects that would have been found.

mod derived;
mod gap;
mod not_found;
mod residual_structure;
mod traces;

pub use derived::Derived;
pub(super) use derived::derived;
pub(super) use gap::Residuals;
pub use gap::Share;
pub use not_found::NotFound;
pub(super) use not_found::{not_found, refused};
pub(super) use residual_structure::residual_structure;
pub use residual_structure::{Follows, ResidualStructure, Worst};
pub use traces::Evidence;
