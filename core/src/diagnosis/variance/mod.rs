//! Variance components of the residual: what it follows, joint by joint.
//!
//! In: rows of all logs, the torque, the columns of the model. Out: for every joint, the root mean square of the residual that
//! follows each kind of generic function (position, speed, load, distance since a reversal, slow time, other joints), of
//! spectral lines and of noise, each with a p-value. It needs no law of the library to be right.
//!
//! The model is a linear mixed model per joint, `y = X b + sum_k Z_k u_k + e` with `u_k ~ N(0, s_k^2 I)`: strengths by restricted
//! maximum likelihood (Patterson and Thompson, 1971; fixed point of MacKay, 1992), tests by the score of each component
//! (Lin, 1997) with signs flipped block by block (wild cluster bootstrap: Cameron, Gelbach and Miller, 2008), so that neither
//! the noise's spectrum nor its scale has to be known.

mod design;
mod kinds;
mod laws;
mod lines;
mod map;
mod mixed;
mod sign_flips;

pub use kinds::Kind;
pub(crate) use laws::gain_over_generic_functions;
pub use lines::Line;
pub(crate) use map::torques;
pub use map::{JointMap, Part, ResidualMap};
