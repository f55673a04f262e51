//! Torque offset: the logged torque is shifted by a constant.

use crate::effects::{About, Effect, Hidden, Nature, Parameter, Rival, Role, Scope, Site};
use crate::robot::Unit;

/// Logged torque = tau + o.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::effects::{Effect, TorqueOffset};
///
/// let mut logged = [20.0, -20.0];
/// TorqueOffset.distort_torque(&[5.0], &mut logged, 0.01);
/// assert_eq!(logged, [25.0, -15.0]);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct TorqueOffset;

static ABOUT: About = About {
    name: "torque_offset",
    equation: "tau_logged = tau + o",
    explanation: "The current amplifier or torque sensor does not read zero at zero torque.",
    reference: "Janot, Vandanjon and Gautier (2014), A generic instrumental variable approach for industrial robot \
                identification, IEEE Transactions on Control Systems Technology 22(1)",
    rivals: &[
        Rival {
            name: "friction_asymmetry",
            how_to_tell: "identical to one-sided Coulomb friction while the joint moves; only a joint at rest without load, \
                          or another drive on the same joint, separates them",
        },
        Rival { name: "gravity_balancer", how_to_tell: "an offset does not change with position" },
        Rival {
            name: "joint_spring",
            how_to_tell: "an offset does not change with position; a spring far from its rest position looks like one",
        },
    ],
    site: Site::Sensor,
    scope: Scope::Joint,
    dry: false,
    uses_acceleration: false,
    nature: Nature::Lasting,
    hidden_by_base_parameters: Hidden::No,
};

static PARAMETERS: [Parameter; 1] = [Parameter {
    name: "offset",
    symbol: "o",
    unit: Unit::Effort,
    role: Role::Amplitude,
    lower: f64::NEG_INFINITY,
    upper: f64::INFINITY,
    typical: 5.0,
}];

impl Effect for TorqueOffset {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn parameters(&self) -> &'static [Parameter] {
        &PARAMETERS
    }

    fn is_constant(&self) -> bool {
        true
    }

    /// A constant torque is friction of one size in both directions, and an asymmetry that is not there.
    fn indistinguishable_from(&self) -> Option<&'static str> {
        Some("friction_asymmetry")
    }

    fn distort_torque(&self, p: &[f64], signal: &mut [f64], _: f64) {
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
        let mut torque = [100.0, -3.0];
        TorqueOffset.distort_torque(&[-7.0], &mut torque, 0.002);
        assert_eq!(torque, [93.0, -10.0]);
    }
}
