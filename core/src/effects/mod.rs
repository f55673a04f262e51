//! Physical effects: each law is written once, in one file, and serves the plant, the identification model, the diagnosis,
//! the report and the catalogue.
//!
//! An effect acts at one or more places: on the robot's bodies ([`Effect::alter`]), as a torque at the joints
//! ([`Effect::torque`]), inside the gear ([`Effect::gear`]), or in the sensors ([`Effect::distort_torque`],
//! [`Effect::distort_position`]). Its parameters play one of four roles ([`Role`]).
//!
//! Sign convention: an effect's torque is what the motor must add because of it. Positions, velocities and accelerations
//! are the motor's, seen at the joint side of the gear.
//!
//! | question | module |
//! |---|---|
//! | what an effect is: where it acts, its parameters, its rivals | `about` |
//! | what a law does | `law` |
//! | how a fit searches its parameters, and what is known of them beforehand | `search` |
//! | the values at which it does so | `grid` |
//! | what a machine can have of it | `limit` |
//! | an effect on a joint | `placed` |
//! | all effects by name | `catalogue` |
//! | the laws | `friction`, `bodies`, `gears`, `signals` |
//! | torque along a motion that is known | `along` |
//! | positions behind encoders' errors | `encoder` |
//! | motion of the links behind gears | `gear_train` |

mod about;
mod along;
mod bodies;
mod by_sample;
mod catalogue;
mod encoder;
mod friction;
mod gear;
mod gear_train;
mod gears;
mod grid;
mod law;
mod limit;
mod placed;
mod rounding;
mod search;
mod signals;
#[cfg(test)]
mod testing;

pub use about::{About, Hidden, Nature, Parameter, Rival, Role, Scope, Site};
pub use along::{Along, Contribution, contribution, contributions, direction};
pub(crate) use along::{Poses, of_law};
pub(crate) use bodies::seen_from_parent;
pub use bodies::{
    BaseTilt, ExternalContact, GravityBalancer, JointSpring, LinkInertiaError, OneSidedSpring, Payload, RotorInertia,
};
pub(crate) use by_sample::BySample;
pub use catalogue::{LIBRARY, did_you_mean, find};
pub(crate) use catalogue::{delay, play, wrong_inertia};
pub(crate) use encoder::behind_encoder;
pub(crate) use friction::laws_of_drive;
pub use friction::{
    CoulombFriction, FrictionAsymmetry, FrictionWarmUp, LoadDependentFriction, NonlinearViscousFriction,
    PositionDependentFriction, PreslidingHysteresis, StribeckFriction, ViscousFriction, drive_friction,
};
pub use gear::Gear;
pub(crate) use gear_train::{GearTrain, behind_gears, sharp};
pub use gears::{Backlash, JointCoupling, JointElasticity};
pub(crate) use grid::{Extent, as_size, inside, moved};
pub use law::{Effect, Instant};
pub use limit::Limit;
pub use placed::{Placed, joint};
pub use rounding::Rounding;
pub(crate) use search::varies_by_factors;
pub use search::{Derived, DriveParameter, Search};
pub use signals::{
    EncoderEccentricity, EncoderOffset, IntegrationError, TimeDelay, TorqueGain, TorqueLag, TorqueOffset, TorqueRipple,
    TorqueSaturation,
};
