//! Friction asymmetry: Coulomb and viscous friction of different size in the two directions.
//!
//! The law holds the difference only: the baseline has the mean of the two directions, this the half difference, so a
//! joint needs Fc >= |dFc| and Fv >= |dFv| to take energy in both directions.

use crate::effects::{About, Effect, Hidden, Instant, Nature, Parameter, Rival, Role, Scope, Site};
use crate::robot::Unit;

/// dFc |sign v| + dFv |v|.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::effects::{Effect, FrictionAsymmetry, Instant};
/// # use tauscope::{dynamics::Chain, robot::{self, InertiaCheck}};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Required)?;
/// # let (chain, zero) = (Chain::new(&robot), &[0.0][..]);
/// # let at_rest = Instant {
/// #     t: 0.0, started: 0.0, q: zero, qd: zero, qdd: zero, direction: zero, load: zero,
/// #     robot: &robot, chain: &chain, frames: None,
/// # };
///
/// // 10 N m and 10 N m s/rad, with the same sign in both directions: more friction in one, less in the other.
/// for direction in [-1.0, 1.0] {
///     let moving = Instant { qd: &[0.5 * direction], direction: &[direction], ..at_rest };
///     let mut torque = [0.0];
///     FrictionAsymmetry.torque(&[10.0, 10.0], 0, &moving, &[], &mut torque);
///     assert_eq!(torque, [15.0]);
/// }
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct FrictionAsymmetry;

static ABOUT: About = About {
    name: "friction_asymmetry",
    equation: "tau = dFc |sign(v)| + dFv |v|",
    explanation: "The joint turns harder one way than the other: a preloaded gear, a seal lip or a worn tooth flank.",
    reference: "Armstrong-Helouvry (1991), Control of Machines with Friction, Kluwer; Corke (2011), Robotics, Vision and \
                Control, Springer, chapter 9 (Coulomb friction of its own for each direction)",
    rivals: &[
        Rival {
            name: "torque_offset",
            how_to_tell: "identical while the joint moves at dFv = 0: at standstill an offset stays, asymmetry does not; \
                          a torque sensor that reads the same without the arm settles it",
        },
        Rival { name: "coulomb_friction", how_to_tell: "Coulomb friction flips its sign with the direction" },
        Rival { name: "joint_spring", how_to_tell: "a spring's torque changes with the position" },
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
        name: "coulomb",
        symbol: "dFc",
        unit: Unit::Effort,
        role: Role::Amplitude,
        lower: f64::NEG_INFINITY,
        upper: f64::INFINITY,
        typical: 10.0,
    },
    Parameter {
        name: "viscous",
        symbol: "dFv",
        unit: Unit::Damping,
        role: Role::Amplitude,
        lower: f64::NEG_INFINITY,
        upper: f64::INFINITY,
        typical: 10.0,
    },
];

impl Effect for FrictionAsymmetry {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn parameters(&self) -> &'static [Parameter] {
        &PARAMETERS
    }

    /// It is a part of friction, which does not carry an arm.
    fn largest_share(&self) -> Option<f64> {
        Some(0.5)
    }

    fn torque(&self, p: &[f64], joint: usize, x: &Instant, _: &[f64], out: &mut [f64]) {
        out[joint] += p[0] * x.direction[joint].abs() + p[1] * x.qd[joint].abs();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::testing::torque_at;

    #[test]
    fn by_hand() {
        // 6 + 10 * 0.5 either way; with Fc = 20 and Fv = 30 forward friction would be 26 + 40 v, backward -14 + 20 v.
        assert_eq!(torque_at(&FrictionAsymmetry, &[6.0, 10.0], 0.2, -0.5), 11.0);
        assert_eq!(torque_at(&FrictionAsymmetry, &[6.0, 10.0], 0.2, 0.5), 11.0);
        assert_eq!(torque_at(&FrictionAsymmetry, &[0.0, 0.0], 0.2, 0.5), 0.0);
    }

    #[test]
    fn nothing_at_standstill() {
        assert_eq!(torque_at(&FrictionAsymmetry, &[6.0, 10.0], 0.2, 0.0), 0.0);
    }
}
