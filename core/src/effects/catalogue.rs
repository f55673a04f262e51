//! The library: every effect there is.

use super::{
    Backlash, BaseTilt, CoulombFriction, Effect, EncoderEccentricity, EncoderOffset, ExternalContact,
    FrictionAsymmetry, FrictionWarmUp, GravityBalancer, IntegrationError, JointCoupling, JointElasticity, JointSpring,
    LinkInertiaError, LoadDependentFriction, NonlinearViscousFriction, Payload, PositionDependentFriction,
    PreslidingHysteresis, RotorInertia, StribeckFriction, TimeDelay, TorqueGain, TorqueLag, TorqueOffset, TorqueRipple,
    TorqueSaturation, ViscousFriction,
};
use crate::error::{Error, Result};

/// All effects, by name. Adding one takes its file, its line here and its scenario.
pub static LIBRARY: &[&dyn Effect] = &[
    &Backlash,
    &BaseTilt,
    &CoulombFriction,
    &EncoderEccentricity,
    &EncoderOffset,
    &ExternalContact,
    &FrictionAsymmetry,
    &FrictionWarmUp,
    &GravityBalancer,
    &IntegrationError,
    &JointCoupling,
    &JointElasticity,
    &JointSpring,
    &LinkInertiaError,
    &LoadDependentFriction,
    &NonlinearViscousFriction,
    &Payload,
    &PositionDependentFriction,
    &PreslidingHysteresis,
    &RotorInertia,
    &StribeckFriction,
    &TimeDelay,
    &TorqueGain,
    &TorqueLag,
    &TorqueOffset,
    &TorqueRipple,
    &TorqueSaturation,
    &ViscousFriction,
];

/// The effect called `name`.
///
/// # Errors
/// Suggests the nearest name there is.
pub fn find(name: &str) -> Result<&'static dyn Effect> {
    LIBRARY.iter().copied().find(|effect| effect.about().name == name).ok_or_else(|| {
        let nearest = LIBRARY
            .iter()
            .map(|effect| effect.about().name)
            .max_by(|a, b| strsim::jaro_winkler(a, name).total_cmp(&strsim::jaro_winkler(b, name)));
        let hint = nearest.map_or(String::new(), |nearest| format!("; did you mean `{nearest}`?"));
        Error::request(
            format!("effect `{name}`"),
            format!("there is no such effect{hint} `tauscope effects` lists them"),
        )
    })
}
