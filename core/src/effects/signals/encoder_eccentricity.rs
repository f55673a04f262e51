//! Encoder eccentricity: the logged position errs once per revolution, as with a disc mounted off its centre.

use crate::effects::{About, Effect, Hidden, Limit, Nature, Parameter, Rival, Role, Scope, Site};
use crate::robot::{Robot, Unit};

/// Logged position = q + e sin(q - phi), as q + s sin q + c cos q with s = e cos phi, c = -e sin phi.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use std::f64::consts::FRAC_PI_2;
/// use tauscope::effects::{Effect, EncoderEccentricity};
///
/// // s = 8 mrad, c = -6 mrad: the error goes round once with the joint.
/// let mut logged = [0.0, FRAC_PI_2, 2.0 * FRAC_PI_2];
/// EncoderEccentricity.distort_position(&[0.008, -0.006], &mut logged);
/// let errors = [logged[0], logged[1] - FRAC_PI_2, logged[2] - 2.0 * FRAC_PI_2];
/// assert!(errors.iter().zip([-0.006, 0.008, 0.006]).all(|(error, expected)| (error - expected).abs() < 1e-12));
/// ```
#[derive(Debug, Clone, Copy)]
pub struct EncoderEccentricity;

static ABOUT: About = About {
    name: "encoder_eccentricity",
    equation: "q_logged = q + s sin(q) + c cos(q) = q + e sin(q - phi); e = hypot(s, c), phi = atan2(-c, s)",
    explanation: "The encoder disc or the gear wheel runs off its centre: the angle reads ahead on one half of the turn \
                  and behind on the other.",
    reference: "Judd and Knasinski (1990), A technique to calibrate industrial robots with experimental verification, \
                IEEE Transactions on Robotics and Automation 6(1)",
    rivals: &[
        Rival {
            name: "encoder_offset",
            how_to_tell: "an offset is the same at every angle; a joint that turns through a small part of a revolution \
                          cannot show the difference",
        },
        Rival {
            name: "torque_ripple",
            how_to_tell: "ripple adds a torque; an eccentric disc bends gravity, velocity and acceleration",
        },
        Rival {
            name: "position_dependent_friction",
            how_to_tell: "friction flips with the direction of motion, an error of the angle does not",
        },
    ],
    site: Site::Sensor,
    scope: Scope::Joint,
    dry: false,
    uses_acceleration: false,
    nature: Nature::LikePlay,
    hidden_by_base_parameters: Hidden::No,
};

const fn part(name: &'static str, symbol: &'static str, typical: f64) -> Parameter {
    Parameter { name, symbol, unit: Unit::Position, role: Role::Departure, lower: -0.2, upper: 0.2, typical }
}

/// An encoder that works: a disc of 10 mm radius that runs 0.5 mm off its centre.
static LIMITS: [Limit; 1] = [Limit::most("eccentricity, the root of sine^2 + cosine^2, rad or m", 0.05)];

static PARAMETERS: [Parameter; 2] = [part("sine", "s", 0.008), part("cosine", "c", -0.006)];

impl Effect for EncoderEccentricity {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn parameters(&self) -> &'static [Parameter] {
        &PARAMETERS
    }

    fn limits(&self) -> &'static [Limit] {
        &LIMITS
    }

    fn over_limit(&self, p: &[f64], _: usize, _: &Robot) -> f64 {
        LIMITS[0].over(p[0].hypot(p[1]))
    }

    /// No position below the noise of the encoder is known.
    fn least_size(&self, position_noise: f64) -> f64 {
        position_noise
    }

    fn distort_position(&self, p: &[f64], signal: &mut [f64]) {
        for value in signal {
            let (sine, cosine) = value.sin_cos();
            *value += p[0] * sine + p[1] * cosine;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_6};

    #[test]
    fn by_hand() {
        // At 0 the cosine part alone, at 90 degrees the sine part alone, at 30 degrees 0.5 * 0.02 + 0.866025403784439 * 0.01.
        let mut position = [0.0, FRAC_PI_2, FRAC_PI_6];
        EncoderEccentricity.distort_position(&[0.02, 0.01], &mut position);
        let errors = [position[0], position[1] - FRAC_PI_2, position[2] - FRAC_PI_6];
        for (error, expected) in errors.iter().zip([0.01, 0.02, 0.01866025403784439]) {
            assert!((error - expected).abs() < 1e-15);
        }
    }

    #[test]
    fn amplitude_and_phase_as_the_catalogue_says() {
        // e = 0.01 and phi = 0.6435011087932844 (cos 0.8, sin 0.6) give s = 0.008 and c = -0.006: no error at q = phi.
        let phi = 0.643_501_108_793_284_4;
        let mut position = [phi, phi + FRAC_PI_2];
        EncoderEccentricity.distort_position(&[0.008, -0.006], &mut position);
        assert!((position[0] - phi).abs() < 1e-15);
        assert!((position[1] - phi - FRAC_PI_2 - 0.01).abs() < 1e-15);
    }

    #[test]
    fn absent_it_changes_nothing() {
        let mut position = [0.3, -2.0];
        EncoderEccentricity.distort_position(&[0.0, 0.0], &mut position);
        assert_eq!(position, [0.3, -2.0]);
    }
}
