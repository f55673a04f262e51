//! Structure in the residual that no effect of the library explains.
//!
//! In: residuals of the extended model. Out: per joint what the residual still follows (generic functions of the state,
//! spectral lines, disagreement of the logs), with size and p-value.

mod above_noise;
mod condensed;
mod disagreement;
mod harmonics;
mod mapped;
mod reported;
mod structure;
mod unexplained;

pub(crate) use above_noise::{above_noise, not_separated};
pub use disagreement::LOGS_DISAGREE;
pub(crate) use disagreement::disagreement;
pub(crate) use mapped::mapped;
pub(crate) use reported::Structure;
pub use reported::{RejectedStructure, Replaced, Unexplained};
pub(crate) use unexplained::unexplained;
