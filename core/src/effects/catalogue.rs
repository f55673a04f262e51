//! The library: every effect there is.

use super::{
    Backlash, BaseTilt, CoulombFriction, Effect, EncoderEccentricity, EncoderOffset, ExternalContact,
    FrictionAsymmetry, FrictionWarmUp, GravityBalancer, IntegrationError, JointCoupling, JointElasticity, JointSpring,
    LinkInertiaError, LoadDependentFriction, NonlinearViscousFriction, OneSidedSpring, Payload,
    PositionDependentFriction, PreslidingHysteresis, RotorInertia, StribeckFriction, TimeDelay, TorqueGain, TorqueLag,
    TorqueOffset, TorqueRipple, TorqueSaturation, ViscousFriction,
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
    &OneSidedSpring,
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

/// The law of gears that have play, which impacts show.
pub(crate) fn play() -> &'static dyn Effect {
    &Backlash
}

/// The law that moves all torques in time.
pub(crate) fn delay() -> &'static dyn Effect {
    &TimeDelay
}

/// The law of a link's inertia, which stands for the inertias of a description as a whole where all are wrong.
pub(crate) fn wrong_inertia() -> &'static dyn Effect {
    &LinkInertiaError
}

/// Least similarity (Jaro-Winkler) of a name that is suggested in place of another.
const SIMILAR: f64 = 0.75;

/// A question for the name most like `name`, as the end of a sentence; a semicolon where none is like it.
#[doc(hidden)]
pub fn did_you_mean(name: &str, names: impl Iterator<Item = &'static str>) -> String {
    let each = names.map(|other| (strsim::jaro_winkler(other, name), other));
    match each.max_by(|a, b| a.0.total_cmp(&b.0)) {
        Some((similarity, nearest)) if similarity >= SIMILAR => format!("; did you mean `{nearest}`?"),
        _ => ";".to_owned(),
    }
}

/// The effect called `name`.
///
/// # Errors
/// Suggests the nearest name there is.
pub fn find(name: &str) -> Result<&'static dyn Effect> {
    LIBRARY.iter().copied().find(|effect| effect.about().name == name).ok_or_else(|| {
        let hint = did_you_mean(name, LIBRARY.iter().map(|effect| effect.about().name));
        Error::request(
            format!("effect `{name}`"),
            format!("there is no such effect{hint} `tauscope effects` lists them"),
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_name_that_is_like_it_is_suggested() {
        let hint = |name: &str| did_you_mean(name, LIBRARY.iter().map(|effect| effect.about().name));
        assert_eq!(hint("stribek_friction"), "; did you mean `stribeck_friction`?");
        assert_eq!(hint("foo"), ";");
    }
}
