//! Excitation: the reference motions an arm is driven along so that its dynamic parameters show up in the torques.
//!
//! | motion | what it is | unknowns per joint |
//! |---|---|---|
//! | [`FreudensteinSequence`] | rest-to-rest moves under the Freudenstein 1-3-5 law | via points and durations |
//! | [`FourierSeries`] | finite Fourier series | sine and cosine coefficients |
//! | [`QuinticSequence`] | quintic segments through via points | via points, velocities, accelerations, durations |
//! | [`Bspline`] | clamped uniform B-spline | control points |
//!
//! Every motion starts and ends at zero position, velocity and acceleration, by construction, as the constraints
//! (17) of the paper behind [`FreudensteinSequence`] ask. All are linear in their unknowns once the durations are fixed, so a motion
//! that is too large for an arm can be scaled down to fit.
//!
//! [`limits`] checks whether a motion keeps inside an arm's limits, at all times and not only on samples. [`encoding`]
//! turns a vector in the box [-1, 1]^n into a motion inside given limits, which is what a search over motions works on;
//! [`random_sequence`] does so for the 1-3-5 law and draws motions at random. [`motion_file`] reads and writes motions.
//!
//! Imports run one way: the files of this room use `trajectories`, these use `primitives`.
//!
//! Angles in rad, times in s, one entry per joint from the base outwards.

pub(crate) mod encoding;
pub(crate) mod limits;
pub(crate) mod motion_file;
mod primitives;
pub mod random_sequence;
#[cfg(test)]
mod testing;
mod trajectories;

pub use encoding::Encoding;
pub use limits::JointLimits;
pub use motion_file::MotionFile;
pub use primitives::{Peaks, Reference};
pub use trajectories::{Bspline, FourierSeries, FreudensteinSequence, Motion, QuinticSequence};
pub(crate) use trajectories::{bspline, freudenstein};
