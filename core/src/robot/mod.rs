//! A robot arm: joints from base to flange, each carrying one rigid body; a tree of them where it branches.
//!
//! In: a URDF or a MuJoCo model. Out: a [`description`], the tree of links and joints as the file has it, and from it a [`Robot`] whose
//! joints under study have a coordinate ([`Choice`]); [`visuals`] for viewers. Identified parameters go back into a URDF
//! ([`with_parameters`], [`to_urdf`], [`to_mjcf`]).

mod assembly;
pub mod description;
mod file;
mod model;
pub mod visuals;

pub(crate) use assembly::shortened;
pub use assembly::{Choice, InertiaCheck, load};
pub use file::{to_mjcf, to_urdf, with_parameters};
pub use model::{
    Actuator, Addresses, Coupling, Drive, Follower, GRAVITY, Inertia, Joint, JointKind, LARGEST, LARGEST_GRAVITY,
    Limits, LinearMap, PARAMETERS, Pose, Robot, SYMBOLS, Tree, UNITS, Unit,
};
