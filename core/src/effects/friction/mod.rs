//! Friction of joints: its level, how it changes with speed, load, position and time, and what it does after a reversal.

mod coulomb_friction;
mod drives;
mod friction_asymmetry;
mod friction_warm_up;
mod load_dependent_friction;
mod nonlinear_viscous_friction;
mod position_dependent_friction;
mod presliding_hysteresis;
mod stribeck_friction;
mod viscous_friction;

pub use coulomb_friction::CoulombFriction;
pub use drives::drive_friction;
pub(crate) use drives::laws_of_drive;
pub use friction_asymmetry::FrictionAsymmetry;
pub use friction_warm_up::FrictionWarmUp;
pub use load_dependent_friction::LoadDependentFriction;
pub use nonlinear_viscous_friction::NonlinearViscousFriction;
pub use position_dependent_friction::PositionDependentFriction;
pub use presliding_hysteresis::PreslidingHysteresis;
pub use stribeck_friction::StribeckFriction;
pub use viscous_friction::ViscousFriction;
