//! Nonlinear viscous friction: a power of speed other than the first.
//!
//! Below one, the power has an infinite slope at standstill; the law is written with |v| rounded off at `width`, so that it
//! passes through zero straight and no faster than an integrator can follow.

use crate::effects::{About, Effect, Hidden, Instant, Nature, Parameter, Rival, Role, Scope, Search, Site};
use crate::robot::Unit;

/// F |v|^alpha sign(v), rounded off at standstill.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::effects::{Effect, Instant, NonlinearViscousFriction};
/// # use tauscope::{dynamics::Chain, robot::{self, InertiaCheck}};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Required)?;
/// # let (chain, zero) = (Chain::new(&robot), &[0.0][..]);
/// # let at_rest = Instant {
/// #     t: 0.0, started: 0.0, q: zero, qd: zero, qdd: zero, direction: zero, load: zero,
/// #     robot: &robot, chain: &chain, frames: None,
/// # };
///
/// // F = 60, alpha = 1/2: four times the speed, twice the torque.
/// for (speed, expected) in [(0.25, 30.0), (1.0, 60.0)] {
///     let moving = Instant { qd: &[speed], direction: &[1.0], ..at_rest };
///     let mut torque = [0.0];
///     NonlinearViscousFriction.torque(&[60.0, 0.5, 1e-4], 0, &moving, &[], &mut torque);
///     assert!((torque[0] - expected).abs() < 1e-3);
/// }
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct NonlinearViscousFriction;

static ABOUT: About = About {
    name: "nonlinear_viscous_friction",
    equation: "tau = F |v|^alpha sign(v), as F v (v^2 + w^2)^((alpha - 1)/2)",
    explanation: "Lubricant losses that do not grow in step with speed: grease thins as it is sheared (alpha < 1), churning \
                  oil and ventilation grow faster than speed (alpha > 1).",
    reference: "Olsson, Astrom, Canudas de Wit, Gafvert, Lischinsky (1998), Friction models and friction compensation, \
                European Journal of Control 4(3)",
    rivals: &[
        Rival {
            name: "viscous_friction",
            how_to_tell: "the same at alpha = 1; only curvature of friction over speed separates them: use the whole speed range",
        },
        Rival {
            name: "stribeck_friction",
            how_to_tell: "the Stribeck rise is confined to low speed; a power bends at all speeds",
        },
        Rival {
            name: "load_dependent_friction",
            how_to_tell: "repeat the motion with a payload: losses that follow speed alone stay the same",
        },
    ],
    site: Site::Joint,
    scope: Scope::Joint,
    dry: false,
    uses_acceleration: false,
    nature: Nature::OfSpeed,
    hidden_by_base_parameters: Hidden::No,
};

static PARAMETERS: [Parameter; 3] = [
    Parameter {
        name: "coefficient",
        symbol: "F",
        unit: Unit::PowerDamping,
        role: Role::Amplitude,
        lower: 0.0,
        upper: f64::INFINITY,
        typical: 60.0,
    },
    Parameter {
        name: "exponent",
        symbol: "alpha",
        unit: Unit::One,
        role: Role::Shape,
        lower: 0.1,
        upper: 3.0,
        typical: 0.5,
    },
    Parameter {
        name: "width",
        symbol: "w",
        unit: Unit::Velocity,
        role: Role::Held,
        lower: 1e-4,
        upper: 0.1,
        typical: 0.01,
    },
];

impl Effect for NonlinearViscousFriction {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn parameters(&self) -> &'static [Parameter] {
        &PARAMETERS
    }

    fn search(&self, index: usize) -> Search {
        match index {
            1 => Search::PowerOfSpeed,
            _ => Search::Bounds,
        }
    }

    fn torque(&self, p: &[f64], joint: usize, x: &Instant, _: &[f64], out: &mut [f64]) {
        let [coefficient, exponent, width] = [p[0], p[1], p[2]];
        let velocity = x.qd[joint];
        out[joint] += coefficient * velocity * velocity.hypot(width).powf(exponent - 1.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::testing::torque_at;

    #[test]
    fn by_hand() {
        // v^2 + w^2 = 0.09 + 0.16 = 0.5^2; to the first power: 30 * -0.3 * 0.5.
        let torque = torque_at(&NonlinearViscousFriction, &[30.0, 2.0, 0.4], 0.2, -0.3);
        assert!((torque + 4.5).abs() < 1e-12, "{torque}");
        // Far above the width: 40 * sqrt(2.25).
        let torque = torque_at(&NonlinearViscousFriction, &[40.0, 0.5, 1e-4], 0.2, 2.25);
        assert!((torque - 60.0).abs() < 1e-6, "{torque}");
        assert_eq!(torque_at(&NonlinearViscousFriction, &[0.0, 0.5, 0.01], 0.2, 2.25), 0.0);
    }

    #[test]
    fn passes_through_zero_straight() {
        // Slope F w^(alpha - 1) = 40 / sqrt(0.01) = 400.
        assert_eq!(torque_at(&NonlinearViscousFriction, &[40.0, 0.5, 0.01], 0.2, 0.0), 0.0);
        let torque = torque_at(&NonlinearViscousFriction, &[40.0, 0.5, 0.01], 0.2, 1e-6);
        assert!((torque / 1e-6 - 400.0).abs() < 1e-4, "{torque}");
    }
}
