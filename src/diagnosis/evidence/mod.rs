//! How sure one candidate effect is.
//!
//! In: a fit and a candidate. Out: score tests over the grid of shapes, p-values corrected for all tests made, the gain on
//! held-out rows and between blocks, and tests adjusted for slow noise and errors in variables.

mod adjusted;
mod blocks;
mod bounds;
mod cross_validation;
mod generic;
mod held_out;
mod judging;
mod multiplicity;
mod scan;

pub use adjusted::{against_slow_noise, log_p_adjusted};
pub use blocks::without_influential_blocks;
pub use cross_validation::cross_validated_residual;
pub use generic::{Block, DELAYS_S, Reach, blocks, modulated, slow_cosines};
pub use held_out::Gains;
pub use judging::Judged;
pub use multiplicity::{Multiplicity, family_wise};
pub use scan::{Ranked, Scan, ranking};
