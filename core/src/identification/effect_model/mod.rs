//! The torque model extended by effects: base parameters and amplitudes are linear, shapes and departures are not.
//!
//! For given nonlinear parameters the model is a linear regression. Its rows are made the way the log was made: positions
//! as the encoders would have had to read without their errors, links behind their gears, torques at the joints, and then
//! what the torque sensors make of them; every column goes through the same sensors and filter as the torque.

mod arm;
mod arm_parameters;
mod links;
mod parts;
mod rows;
mod sensing;
mod signals;
mod state;

pub(crate) use arm::{Arm, Laws, law_sites};
pub use arm_parameters::Trust;
pub(crate) use links::Geared;
pub(in crate::identification) use state::goes_on;
pub use state::{EffectModel, Place, Preparation};
