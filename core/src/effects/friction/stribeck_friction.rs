//! Stribeck friction: the rise of dry friction towards standstill, where the lubricant film is squeezed out.

use crate::effects::{About, Effect, Hidden, Instant, Nature, Parameter, Rival, Role, Scope, Search, Site};
use crate::robot::Unit;

/// (Fs - Fc) exp(-(|v|/vs)^delta) sign(v).
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::effects::{Effect, Instant, StribeckFriction};
/// # use tauscope::{dynamics::Chain, robot::{self, InertiaCheck}};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Required)?;
/// # let (chain, zero) = (Chain::new(&robot), &[0.0][..]);
/// # let at_rest = Instant {
/// #     t: 0.0, started: 0.0, q: zero, qd: zero, qdd: zero, direction: zero, load: zero,
/// #     robot: &robot, chain: &chain, frames: None,
/// # };
///
/// // A rise of 25 N m at low speed, with vs = 0.15 rad/s and Armstrong-Helouvry's exponent 2.
/// for (speed, share) in [(1e-6, 1.0), (0.15, 0.368), (0.6, 0.0)] {
///     let moving = Instant { qd: &[speed], direction: &[1.0], ..at_rest };
///     let mut torque = [0.0];
///     StribeckFriction.torque(&[25.0, 0.15, 2.0], 0, &moving, &[], &mut torque);
///     assert!((torque[0] / 25.0 - share).abs() < 1e-3);
/// }
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct StribeckFriction;

static ABOUT: About = About {
    name: "stribeck_friction",
    equation: "tau = (Fs - Fc) exp(-(|v|/vs)^delta) sign(v)",
    explanation: "Friction rises as the joint slows down: at crawling speed metal meets metal, faster the lubricant carries.",
    reference: "Bo, Pavelescu (1982), The friction-speed relation and its influence on the critical velocity of stick-slip \
                motion, Wear 82(3)",
    rivals: &[
        Rival {
            name: "nonlinear_viscous_friction",
            how_to_tell: "a power of speed keeps bending at all speeds, the Stribeck rise is gone above a few vs",
        },
        Rival {
            name: "presliding_hysteresis",
            how_to_tell: "hysteresis depends on the distance since the last reversal, not on speed: creep slowly, far, one way",
        },
        Rival {
            name: "coulomb_friction",
            how_to_tell: "a smeared sign near standstill leaves a residual within the smearing width only",
        },
    ],
    site: Site::Joint,
    scope: Scope::Joint,
    dry: true,
    uses_acceleration: false,
    nature: Nature::OfSpeed,
    hidden_by_base_parameters: Hidden::No,
};

static PARAMETERS: [Parameter; 3] = [
    Parameter {
        name: "rise",
        symbol: "Fs - Fc",
        unit: Unit::Effort,
        role: Role::Amplitude,
        lower: 0.0,
        upper: f64::INFINITY,
        typical: 25.0,
    },
    Parameter {
        name: "velocity",
        symbol: "vs",
        unit: Unit::Velocity,
        role: Role::Shape,
        lower: 1e-3,
        upper: 3.0,
        typical: 0.15,
    },
    Parameter {
        name: "exponent",
        symbol: "delta",
        unit: Unit::One,
        role: Role::Held,
        lower: 0.5,
        upper: 4.0,
        typical: 2.0,
    },
];

impl Effect for StribeckFriction {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn is_asked_about(&self) -> bool {
        true
    }

    fn parameters(&self) -> &'static [Parameter] {
        &PARAMETERS
    }

    /// Tustin's exponential (1) and Armstrong-Helouvry's Gaussian (2).
    fn forms(&self, index: usize) -> &'static [f64] {
        if index == 2 { &[1.0, 2.0] } else { &[] }
    }

    fn search(&self, index: usize) -> Search {
        match index {
            1 => Search::LowSpeed,
            _ => Search::Bounds,
        }
    }

    fn torque(&self, p: &[f64], joint: usize, x: &Instant, _: &[f64], out: &mut [f64]) {
        let [rise, velocity, exponent] = [p[0], p[1], p[2]];
        out[joint] += rise * (-(x.qd[joint].abs() / velocity).powf(exponent)).exp() * x.direction[joint];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::testing::torque_at;

    #[test]
    fn by_hand() {
        // |v|/vs = 2, squared 4, exp(-4) = 0.018315638889; at vs itself 1/e = 0.367879441171.
        let torque = torque_at(&StribeckFriction, &[25.0, 0.1, 2.0], 0.2, -0.2);
        assert!((torque + 25.0 * 0.018_315_638_889).abs() < 1e-9, "{torque}");
        let torque = torque_at(&StribeckFriction, &[25.0, 0.1, 2.0], 0.2, 0.1);
        assert!((torque - 25.0 * 0.367_879_441_171).abs() < 1e-9, "{torque}");
        assert_eq!(torque_at(&StribeckFriction, &[0.0, 0.1, 2.0], 0.2, 0.1), 0.0);
    }

    #[test]
    fn breakaway_is_the_whole_rise() {
        let torque = torque_at(&StribeckFriction, &[25.0, 0.1, 2.0], 0.2, 1e-9);
        assert!((torque - 25.0).abs() < 1e-9, "{torque}");
    }

    #[test]
    fn books_write_it_in_two_forms() {
        assert!(StribeckFriction.forms(2).contains(&PARAMETERS[2].typical) && StribeckFriction.forms(2).len() == 2);
        assert!(StribeckFriction.forms(0).is_empty() && StribeckFriction.forms(1).is_empty());
    }
}
