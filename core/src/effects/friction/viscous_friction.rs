//! Viscous friction: torque proportional to speed.

use crate::effects::{About, DriveParameter, Effect, Hidden, Instant, Nature, Parameter, Rival, Role, Scope, Site};
use crate::robot::Unit;

/// Fv v.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::effects::{Effect, Instant, ViscousFriction};
/// # use tauscope::{dynamics::Chain, robot::{self, InertiaCheck}};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Required)?;
/// # let (chain, zero) = (Chain::new(&robot), &[0.0][..]);
/// # let at_rest = Instant {
/// #     t: 0.0, started: 0.0, q: zero, qd: zero, qdd: zero, direction: zero, load: zero,
/// #     robot: &robot, chain: &chain, frames: None,
/// # };
///
/// // 20 N m s/rad at 0.5 rad/s.
/// let moving = Instant { qd: &[0.5], direction: &[1.0], ..at_rest };
/// let mut torque = [0.0];
/// ViscousFriction.torque(&[20.0], 0, &moving, &[], &mut torque);
/// assert_eq!(torque, [10.0]);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct ViscousFriction;

static ABOUT: About = About {
    name: "viscous_friction",
    equation: "tau = Fv v",
    explanation: "Lubricant and drive losses that grow in proportion to speed.",
    reference: "Armstrong-Helouvry, Dupont, Canudas de Wit (1994), A survey of models, analysis tools and compensation \
                methods for the control of machines with friction, Automatica 30(7)",
    rivals: &[Rival {
        name: "nonlinear_viscous_friction",
        how_to_tell: "only a law that is not straight leaves a residual that bends with speed",
    }],
    site: Site::Joint,
    scope: Scope::Joint,
    dry: false,
    uses_acceleration: false,
    nature: Nature::Baseline,
    hidden_by_base_parameters: Hidden::No,
};

static PARAMETERS: [Parameter; 1] = [Parameter {
    name: "coefficient",
    symbol: "Fv",
    unit: Unit::Damping,
    role: Role::Amplitude,
    lower: 0.0,
    upper: f64::INFINITY,
    typical: 20.0,
}];

impl Effect for ViscousFriction {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn parameters(&self) -> &'static [Parameter] {
        &PARAMETERS
    }

    fn of_drive(&self) -> Option<DriveParameter> {
        Some(DriveParameter::Viscous)
    }

    fn torque(&self, p: &[f64], joint: usize, x: &Instant, _: &[f64], out: &mut [f64]) {
        out[joint] += p[0] * x.qd[joint];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::testing::torque_at;

    #[test]
    fn by_hand() {
        // At -0.5 rad/s.
        assert_eq!(torque_at(&ViscousFriction, &[40.0], 0.2, -0.5), -20.0);
    }
}
