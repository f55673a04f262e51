//! Coulomb friction: torque of one size against the direction of motion; at standstill anything up to that size.

use crate::effects::{About, DriveParameter, Effect, Hidden, Instant, Nature, Parameter, Rival, Role, Scope, Site};
use crate::robot::Unit;

/// Fc sign(v).
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::effects::{CoulombFriction, Effect, Instant};
/// # use tauscope::{dynamics::Chain, robot::{self, InertiaCheck}};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Required)?;
/// # let (chain, zero) = (Chain::new(&robot), &[0.0][..]);
/// # let at_rest = Instant {
/// #     t: 0.0, started: 0.0, q: zero, qd: zero, qdd: zero, direction: zero, load: zero,
/// #     robot: &robot, chain: &chain, frames: None,
/// # };
///
/// // 20 N m against the motion, at any speed.
/// let moving = Instant { qd: &[-0.5], direction: &[-1.0], ..at_rest };
/// let mut torque = [0.0];
/// CoulombFriction.torque(&[20.0], 0, &moving, &[], &mut torque);
/// assert_eq!(torque, [-20.0]);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct CoulombFriction;

static ABOUT: About = About {
    name: "coulomb_friction",
    equation: "tau = Fc sign(v); |tau| <= Fc at standstill",
    explanation: "Dry friction of gears, seals and bearings: the same size at every speed, it flips with the direction.",
    reference: "Armstrong-Helouvry, Dupont, Canudas de Wit (1994), A survey of models, analysis tools and compensation \
                methods for the control of machines with friction, Automatica 30(7)",
    rivals: &[Rival {
        name: "friction_asymmetry",
        how_to_tell: "asymmetry differs in size between the two directions",
    }],
    site: Site::Joint,
    scope: Scope::Joint,
    dry: true,
    uses_acceleration: false,
    nature: Nature::Baseline,
    hidden_by_base_parameters: Hidden::No,
};

static PARAMETERS: [Parameter; 1] = [Parameter {
    name: "level",
    symbol: "Fc",
    unit: Unit::Effort,
    role: Role::Amplitude,
    lower: 0.0,
    upper: f64::INFINITY,
    typical: 20.0,
}];

impl Effect for CoulombFriction {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn parameters(&self) -> &'static [Parameter] {
        &PARAMETERS
    }

    fn of_drive(&self) -> Option<DriveParameter> {
        Some(DriveParameter::Coulomb)
    }

    fn torque(&self, p: &[f64], joint: usize, x: &Instant, _: &[f64], out: &mut [f64]) {
        out[joint] += p[0] * x.direction[joint];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::testing::torque_at;

    #[test]
    fn by_hand() {
        // At -0.5 rad/s.
        assert_eq!(torque_at(&CoulombFriction, &[30.0], 0.2, -0.5), -30.0);
    }
}
