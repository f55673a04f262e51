//! From the description of a file to a robot.
//!
//! In: a [`Description`](super::description::Description) and a [`Choice`] of the joints under study. Out: a robot in which these have a
//! coordinate each, joints that mimic them follow, and all others are held, with what they carry welded to the link that carries
//! them.

mod bodies;
mod choice;
mod flange;
mod lifted;
mod load;
mod places;

pub use choice::{Choice, InertiaCheck};
pub use load::load;
pub(crate) use places::shortened;
