//! The model of a robot: rigid bodies on joints.
//!
//! A [`Robot`] has a coordinate per joint, in the order from base to flange; each [`Joint`] carries one rigid body ([`Inertia`]). Joints
//! that mimic others follow a coordinate ([`Follower`]); where the arm branches, a [`Tree`] gives the body that carries each.

mod actuator;
mod addresses;
mod arm;
mod bodies;
mod constants;
mod coupling;
mod inertia;
mod joint;
mod placeholders;
mod pose;
mod tree;
mod unit;
mod units;

pub use actuator::Actuator;
pub use addresses::Addresses;
pub use arm::Robot;
pub(crate) use arm::TEXT;
pub use constants::{GRAVITY, LARGEST, LARGEST_GRAVITY};
pub use coupling::{Coupling, LinearMap};
pub use inertia::{Inertia, PARAMETERS, SYMBOLS, UNITS};
pub use joint::{Drive, Joint, JointKind, Limits};
pub use pose::Pose;
pub use tree::{Follower, Tree};
pub use unit::Unit;
