//! Variance components of the residual: what it follows, joint by joint.
//!
//! In: rows of all logs, the torque, the columns of the model. Out: for every joint, the root mean square of the residual that follows each
//! kind of generic function (position, speed, load, distance since a reversal, slow time, other joints), of spectral lines and of noise, each
//! with a p-value. It needs no law of the library to be right.

mod design;
mod kinds;
mod laws;
mod lines;
mod map;
mod mixed;
mod random_effects;
mod sign_flips;

pub use kinds::Kind;
pub(crate) use laws::gain_over_generic_functions;
pub use lines::Line;
pub(crate) use map::torques;
pub use map::{JointMap, Part, ResidualMap};
pub(crate) use random_effects::random_effects;
