//! Encoder offset: the logged position is shifted by a constant.

use crate::effects::{About, Effect, Hidden, Nature, Parameter, Rival, Role, Scope, Site};
use crate::robot::Unit;

/// Logged position = q + d.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::effects::{Effect, EncoderOffset};
///
/// let mut logged = [0.0, 0.5];
/// EncoderOffset.distort_position(&[0.25], &mut logged);
/// assert_eq!(logged, [0.25, 0.75]);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct EncoderOffset;

static ABOUT: About = About {
    name: "encoder_offset",
    equation: "q_logged = q + d",
    explanation: "The joint's zero is not where the encoder reads zero, as after a motor was changed without calibration: \
                  gravity pulls from another angle than the model thinks.",
    reference: "Hollerbach, Khalil and Gautier (2008), Model identification, chapter 14 of the Springer Handbook of \
                Robotics",
    rivals: &[
        Rival {
            name: "payload",
            how_to_tell: "on the last joint torque cannot separate it from a load on the flange; of other joints it turns \
                          all that hangs on the joint",
        },
        Rival {
            name: "link_inertia_error",
            how_to_tell: "a turned link keeps its mass and moments (overlap .85 to .93); trusted inertias or a mark on the \
                          joint settle it",
        },
        Rival { name: "encoder_eccentricity", how_to_tell: "an eccentric disc's error changes with position" },
        Rival { name: "base_tilt", how_to_tell: "a tilt turns gravity for joint 1 too" },
    ],
    site: Site::Sensor,
    scope: Scope::Joint,
    dry: false,
    uses_acceleration: false,
    nature: Nature::LikePlay,
    hidden_by_base_parameters: Hidden::InPart,
};

static PARAMETERS: [Parameter; 1] = [Parameter {
    name: "offset",
    symbol: "d",
    unit: Unit::Position,
    role: Role::Departure,
    lower: -0.5,
    upper: 0.5,
    typical: 0.01,
}];

impl Effect for EncoderOffset {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn parameters(&self) -> &'static [Parameter] {
        &PARAMETERS
    }

    /// No position below the noise of the encoder is known.
    fn least_size(&self, position_noise: f64) -> f64 {
        position_noise
    }

    /// An eccentricity of a joint that turns little is an offset.
    fn indistinguishable_from(&self) -> Option<&'static str> {
        Some("encoder_eccentricity")
    }

    fn distort_position(&self, p: &[f64], signal: &mut [f64]) {
        for value in signal {
            *value += p[0];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn by_hand() {
        let mut position = [1.0, -0.25];
        EncoderOffset.distort_position(&[0.125], &mut position);
        assert_eq!(position, [1.125, -0.125]);
    }
}
