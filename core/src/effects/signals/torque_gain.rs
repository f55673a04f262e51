//! Torque gain error: the logged torque is too large or too small by a factor.

use crate::effects::{About, Effect, Hidden, Nature, Parameter, Rival, Role, Scope, Site};
use crate::robot::Unit;

/// Logged torque = (1 + e) tau.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::effects::{Effect, TorqueGain};
///
/// // Logged 25 % too large.
/// let mut logged = [100.0, -40.0];
/// TorqueGain.distort_torque(&[0.25], &mut logged, 0.01);
/// assert_eq!(logged, [125.0, -50.0]);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct TorqueGain;

static ABOUT: About = About {
    name: "torque_gain",
    equation: "tau_logged = (1 + e) tau",
    explanation: "The motor's torque constant or the gear ratio is not what the log was computed with, so every torque of \
                  the joint is off by the same percentage.",
    reference: "Gautier and Briot (2014), Global identification of joint drive gains and dynamic parameters of robots, \
                ASME Journal of Dynamic Systems, Measurement, and Control 136(5)",
    rivals: &[
        Rival {
            name: "link_inertia_error",
            how_to_tell: "a gain scales friction and gravity of one joint alike; a heavier link loads the joints before it \
                          too and leaves friction as it is (overlap .85 to .93)",
        },
        Rival {
            name: "joint_spring",
            how_to_tell: "a gain scales gravity and friction, a spring knows only the position (overlap up to .78)",
        },
        Rival { name: "torque_saturation", how_to_tell: "saturation changes the largest torques only" },
    ],
    site: Site::Sensor,
    scope: Scope::Joint,
    dry: false,
    uses_acceleration: false,
    nature: Nature::Lasting,
    hidden_by_base_parameters: Hidden::InPart,
};

static PARAMETERS: [Parameter; 1] = [Parameter {
    name: "error",
    symbol: "e",
    unit: Unit::One,
    role: Role::Departure,
    lower: -0.9,
    upper: 2.0,
    typical: 0.05,
}];

impl Effect for TorqueGain {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn is_asked_about(&self) -> bool {
        true
    }

    fn parameters(&self) -> &'static [Parameter] {
        &PARAMETERS
    }

    fn distort_torque(&self, p: &[f64], signal: &mut [f64], _: f64) {
        for value in signal {
            *value *= 1.0 + p[0];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn by_hand() {
        let mut torque = [200.0, -40.0, 0.0];
        TorqueGain.distort_torque(&[0.25], &mut torque, 0.002);
        assert_eq!(torque, [250.0, -50.0, 0.0]);
    }

    #[test]
    fn absent_it_changes_nothing() {
        let mut torque = [0.1, -0.7];
        TorqueGain.distort_torque(&[0.0], &mut torque, 0.002);
        assert_eq!(torque, [0.1, -0.7]);
    }
}
