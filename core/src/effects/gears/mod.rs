//! What lies between motor and link: play, compliance, couplings between joints.

mod backlash;
mod joint_coupling;
mod joint_elasticity;

pub use backlash::Backlash;
pub use joint_coupling::JointCoupling;
pub use joint_elasticity::JointElasticity;
