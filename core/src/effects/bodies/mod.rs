//! Bodies and what pulls at them: masses and inertias that the model lacks, gravity, springs, balancers, contacts.

mod base_tilt;
mod external_contact;
mod gravity_balancer;
mod joint_spring;
mod link_inertia_error;
mod one_sided_spring;
mod payload;
mod plausible;
mod rotor_inertia;

pub use base_tilt::BaseTilt;
pub use external_contact::ExternalContact;
pub use gravity_balancer::GravityBalancer;
pub use joint_spring::JointSpring;
pub use link_inertia_error::LinkInertiaError;
pub use one_sided_spring::OneSidedSpring;
pub use payload::Payload;
pub(crate) use payload::seen_from_parent;
pub use rotor_inertia::RotorInertia;
