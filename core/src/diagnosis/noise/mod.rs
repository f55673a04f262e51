//! The noise model of each joint.
//!
//! In: residuals of a rich regression. Out: a whitener per joint: an autoregression of the noise with its one-step
//! innovations, and the noise spectrum in the residual of a regression.

mod innovations;
mod joint_whitener;
mod memory;
mod noise_spectrum;
mod whitening;

pub(crate) use joint_whitener::rich;
pub(crate) use memory::NoiseMemory;
pub use whitening::Whitener;
