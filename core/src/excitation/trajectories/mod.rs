//! The parametrisations of a motion. Unknowns of each joint come in; a motion that starts and ends at rest at zero goes out.

pub(crate) mod bspline;
pub(super) mod fourier;
pub(crate) mod freudenstein;
mod joined;
mod motion;
pub(super) mod quintic;

pub use bspline::Bspline;
pub use fourier::FourierSeries;
pub use freudenstein::FreudensteinSequence;
pub use motion::Motion;
pub use quintic::QuinticSequence;
