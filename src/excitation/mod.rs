//! Excitation: the reference motions an arm is driven along so that its dynamic parameters show up in the torques.
//!
//! | file | motion | unknowns per joint |
//! |---|---|---|
//! | [`freudenstein`] | rest-to-rest moves under the Freudenstein 1-3-5 law | via points and durations |
//! | [`fourier`] | finite Fourier series | sine and cosine coefficients |
//! | [`quintic`] | quintic segments through via points | via points, velocities, accelerations, durations |
//! | [`bspline`] | clamped uniform B-spline | control points |
//!
//! Every motion starts and ends at zero position, velocity and acceleration, by construction, as the constraints
//! (17) of the paper behind [`freudenstein`] ask. All are linear in their unknowns once the durations are fixed, so a motion
//! that is too large for an arm can be scaled down to fit.
//!
//! [`limits`] tells whether a motion keeps inside an arm's limits, at all times and not only on samples. [`encoding`]
//! turns a vector in the box [-1, 1]^n into a motion inside given limits, which is what a search over motions works on;
//! [`random_sequence`] does so for the 1-3-5 law and draws motions at random. [`motion_file`] reads and writes motions.
//!
//! Angles in rad, times in s, one entry per joint from the base outwards.

mod batch;
pub(crate) mod bspline;
pub(crate) mod encoding;
pub(crate) mod fourier;
pub(crate) mod freudenstein;
mod joined;
pub(crate) mod limits;
mod motion;
pub(crate) mod motion_file;
pub(crate) mod peaks;
mod piecewise;
mod polynomial;
pub(crate) mod quintic;
pub mod random_sequence;
mod reference;
#[cfg(test)]
mod testing;
mod timing;

pub use bspline::Bspline;
pub use encoding::Encoding;
pub use fourier::FourierSeries;
pub use freudenstein::FreudensteinSequence;
pub use limits::JointLimits;
pub use motion::Motion;
pub use motion_file::MotionFile;
pub use peaks::Peaks;
pub use quintic::QuinticSequence;
pub use reference::Reference;
