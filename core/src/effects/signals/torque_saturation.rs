//! Torque saturation: the logged torque is cut off at a level.

use crate::effects::{About, Effect, Hidden, Nature, Parameter, Rival, Role, Scope, Search, Site};
use crate::robot::Unit;

/// Logged torque = tau clipped to +- L.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::effects::{Effect, TorqueSaturation};
///
/// let mut logged = [80.0, 120.0, -300.0];
/// TorqueSaturation.distort_torque(&[100.0], &mut logged, 0.01);
/// assert_eq!(logged, [80.0, 100.0, -100.0]);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct TorqueSaturation;

static ABOUT: About = About {
    name: "torque_saturation",
    equation: "tau_logged = min(max(tau, -L), L); L = 0 stands for no limit",
    explanation: "The log, or the drive's current measurement, ends at a largest value: peaks are cut off flat.",
    reference: "Bernstein and Michel (1995), A chronological bibliography on saturating actuators, International Journal \
                of Robust and Nonlinear Control 5(5)",
    rivals: &[
        Rival {
            name: "torque_gain",
            how_to_tell: "a gain error shows at every torque, saturation only beyond its level, where the log is flat",
        },
        Rival {
            name: "torque_lag",
            how_to_tell: "a lag rounds peaks after every quick change, saturation cuts them all at one level",
        },
    ],
    site: Site::Sensor,
    scope: Scope::Joint,
    dry: false,
    uses_acceleration: false,
    nature: Nature::Level,
    hidden_by_base_parameters: Hidden::No,
};

static PARAMETERS: [Parameter; 1] = [Parameter {
    name: "level",
    symbol: "L",
    unit: Unit::Effort,
    role: Role::Departure,
    lower: 0.0,
    upper: f64::INFINITY,
    typical: 500.0,
}];

impl Effect for TorqueSaturation {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn parameters(&self) -> &'static [Parameter] {
        &PARAMETERS
    }

    fn search(&self, _: usize) -> Search {
        Search::Level
    }

    fn distort_torque(&self, p: &[f64], signal: &mut [f64], _: f64) {
        if p[0] > 0.0 {
            for value in signal {
                *value = value.clamp(-p[0], p[0]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn by_hand() {
        let mut torque = [120.0, -30.0, -101.0, 100.0];
        TorqueSaturation.distort_torque(&[100.0], &mut torque, 0.002);
        assert_eq!(torque, [100.0, -30.0, -100.0, 100.0]);
    }

    #[test]
    fn a_level_of_zero_is_no_limit() {
        let mut torque = [120.0, -30.0];
        TorqueSaturation.distort_torque(&[0.0], &mut torque, 0.002);
        assert_eq!(torque, [120.0, -30.0]);
    }
}
