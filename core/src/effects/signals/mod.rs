//! What is wrong with the torques and positions as commanded, logged or simulated: gains, offsets, ripples, lags, encoders, the integrator.

mod encoder_eccentricity;
mod encoder_offset;
mod integration_error;
mod time_delay;
mod torque_gain;
mod torque_lag;
mod torque_offset;
mod torque_ripple;
mod torque_saturation;

pub use encoder_eccentricity::EncoderEccentricity;
pub use encoder_offset::EncoderOffset;
pub use integration_error::IntegrationError;
pub use time_delay::TimeDelay;
pub use torque_gain::TorqueGain;
pub use torque_lag::TorqueLag;
pub use torque_offset::TorqueOffset;
pub use torque_ripple::TorqueRipple;
pub use torque_saturation::TorqueSaturation;
