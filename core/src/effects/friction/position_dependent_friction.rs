//! Position-dependent friction: dry friction that swells and shrinks once per turn of the joint.
//!
//! The law holds the variation only. Together with Coulomb friction the joint always loses energy as long as
//! A = sqrt(Ac^2 + As^2) <= Fc; a larger A would push the joint along where cos(q - phi) is negative.

use crate::effects::{About, Effect, Hidden, Instant, Nature, Parameter, Rival, Role, Scope, Site};
use crate::robot::Unit;

/// A cos(q - phi) sign(v) = (Ac cos q + As sin q) sign(v).
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::effects::{Effect, Instant, PositionDependentFriction};
/// # use tauscope::{dynamics::Chain, robot::{self, InertiaCheck}};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Required)?;
/// # let (chain, zero) = (Chain::new(&robot), &[0.0][..]);
/// # let at_rest = Instant {
/// #     t: 0.0, started: 0.0, q: zero, qd: zero, qdd: zero, direction: zero, load: zero,
/// #     robot: &robot, chain: &chain, frames: None,
/// # };
///
/// // Ac = 20 N m, As = 10 N m: at q = 0 only the cosine acts, and its sign is that of the motion.
/// for direction in [-1.0, 1.0] {
///     let moving = Instant { qd: &[direction], direction: &[direction], ..at_rest };
///     let mut torque = [0.0];
///     PositionDependentFriction.torque(&[20.0, 10.0], 0, &moving, &[], &mut torque);
///     assert_eq!(torque, [20.0 * direction]);
/// }
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct PositionDependentFriction;

static ABOUT: About = About {
    name: "position_dependent_friction",
    equation: "tau = A cos(q - phi) sign(v) = (Ac cos q + As sin q) sign(v), A <= Fc",
    explanation: "Friction differs over the range of the joint: a bearing or gear out of round or out of line, or worn where \
                  it works most.",
    reference: "Popovic, Goldenberg (1998), Modeling of friction using spectral analysis, IEEE Transactions on Robotics and \
                Automation 14(1)",
    rivals: &[
        Rival {
            name: "load_dependent_friction",
            how_to_tell: "gravity loads go with position too: only a payload or another pace changes friction that depends on \
                          load",
        },
        Rival {
            name: "torque_ripple",
            how_to_tell: "ripple has the same sign in both directions; friction flips: pass one position both ways",
        },
        Rival { name: "coulomb_friction", how_to_tell: "a joint that moves over a small range shows no variation" },
    ],
    site: Site::Joint,
    scope: Scope::Joint,
    dry: true,
    uses_acceleration: false,
    nature: Nature::Lasting,
    hidden_by_base_parameters: Hidden::No,
};

static PARAMETERS: [Parameter; 2] = [
    Parameter {
        name: "cosine",
        symbol: "Ac",
        unit: Unit::Effort,
        role: Role::Amplitude,
        lower: f64::NEG_INFINITY,
        upper: f64::INFINITY,
        typical: 20.0,
    },
    Parameter {
        name: "sine",
        symbol: "As",
        unit: Unit::Effort,
        role: Role::Amplitude,
        lower: f64::NEG_INFINITY,
        upper: f64::INFINITY,
        typical: 10.0,
    },
];

impl Effect for PositionDependentFriction {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn parameters(&self) -> &'static [Parameter] {
        &PARAMETERS
    }

    fn torque(&self, p: &[f64], joint: usize, x: &Instant, _: &[f64], out: &mut [f64]) {
        let (sine, cosine) = x.q[joint].sin_cos();
        out[joint] += (p[0] * cosine + p[1] * sine) * x.direction[joint];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::testing::torque_at;

    #[test]
    fn by_hand() {
        // cos(pi/3) = 0.5, sin(pi/3) = 0.866025403784: 12 * 0.5 + 10 * 0.866025403784 = 14.66025403784.
        let q = std::f64::consts::FRAC_PI_3;
        let torque = torque_at(&PositionDependentFriction, &[12.0, 10.0], q, -0.5);
        assert!((torque + 14.660_254_037_84).abs() < 1e-10, "{torque}");
        let torque = torque_at(&PositionDependentFriction, &[12.0, 10.0], q, 0.5);
        assert!((torque - 14.660_254_037_84).abs() < 1e-10, "{torque}");
        assert_eq!(torque_at(&PositionDependentFriction, &[0.0, 0.0], q, 0.5), 0.0);
    }
}
