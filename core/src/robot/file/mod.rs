//! Files of robots: URDF and MuJoCo's MJCF.
//!
//! In: a file, whose content decides what it is. Out: its [`Description`](super::description::Description), with notes on units other
//! than SI, rounded angles and whatever else was read otherwise than it is written. Robots are written as either.

mod kind;
mod mjcf;
mod rounding;
mod urdf;
mod xml;

pub use kind::{parse, read};
pub use mjcf::to_mjcf;
pub(crate) use urdf::{looks, pose_of};
pub use urdf::{to_urdf, with_parameters};
