//! How sure one candidate effect is.
//!
//! In: a fit and a candidate. Out: score tests over the grid of shapes, p-values corrected for all tests made, the gain on
//! held-out rows and between blocks, and tests adjusted for slow noise and errors in variables. From the torque at the rate of the
//! logs: gears with play, by their impacts.

mod adjusted;
mod blocks;
mod bounds;
mod cross_validation;
mod flight;
mod generic;
mod held_out;
mod impacts;
mod judging;
mod multiplicity;
mod play;
mod possible;
mod rival_laws;
mod scan;

pub(crate) use adjusted::{against_slow_noise, log_p_adjusted};
pub(crate) use blocks::without_influential_blocks;
pub(crate) use cross_validation::cross_validated_residual;
pub(crate) use generic::{Block, DELAYS_S, Reach, blocks, modulated, slow_cosines};
pub(crate) use held_out::Gains;
pub(crate) use impacts::Traces;
pub(crate) use judging::Judged;
pub(crate) use multiplicity::{Multiplicity, family_wise};
pub use play::Play;
pub use scan::Ranked;
pub(crate) use scan::{Scan, Sensitivity, ranking};
