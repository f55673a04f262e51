//! Experiment design: which motion holds most information on the parameters of an arm, inside all of its limits; problem (16)-(17)
//! of the paper behind [`crate::excitation::freudenstein`].
//!
//! | file | what |
//! |---|---|
//! | [`information`] | information of a torque log along a motion: the information matrix of the base parameters |
//! | [`criterion`] | one number from it: condition number, D, Hadamard's ratio, worst standard deviation |
//! | [`envelope`] | limits beyond the joints' own: torque, floor, the column around the base |
//! | [`problem`] | criterion and limits together, as a function of a motion |
//! | [`search`] | CMA-ES with several starts, stoppable at any time |
//! | [`families`] | the parametrisations at a given length, as encodings to search in |
//! | [`excite`] | the whole job: checks, search, long motions put together from blocks |
//! | [`comparison`] | all of them side by side, with random motions and a single move |
//!
//! Position, velocity and acceleration limits are kept by construction, through [`crate::excitation::encoding`]. The
//! others enter the search as penalties on a coarse grid with a margin; what is returned was checked at 10 kHz.

pub(crate) mod comparison;
pub mod criterion;
pub(crate) mod envelope;
pub(crate) mod excite;
pub(crate) mod families;
pub mod information;
pub(crate) mod problem;
pub(crate) mod search;
#[cfg(test)]
mod tests;

pub use criterion::Criterion;
pub use envelope::{Envelope, Workspace};
pub use information::{Experiment, Information};
pub use problem::Problem;
