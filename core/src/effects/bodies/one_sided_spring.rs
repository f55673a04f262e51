//! One-sided spring: a hose, cable or bumper that pulls tight, or is pressed, on one side of a position.
//!
//! Stiffness is constant on either side of the position at which it is slack (piecewise linear, "bilinear" spring). A hose has hardly any
//! on the side on which it hangs loose; where both are the same it is a joint spring.

use crate::effects::{About, Effect, Hidden, Instant, Nature, Parameter, Rival, Role, Scope, Search, Site};
use crate::robot::Unit;
use std::f64::consts::TAU;

/// ka (q - qs) above qs, kb (q - qs) below it.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::effects::{Effect, Instant, OneSidedSpring};
/// # use tauscope::{dynamics::Chain, robot::{self, InertiaCheck}};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Required)?;
/// # let (chain, zero) = (Chain::new(&robot), &[0.0][..]);
/// # let at_rest = Instant {
/// #     t: 0.0, started: 0.0, q: zero, qd: zero, qdd: zero, direction: zero, load: zero,
/// #     robot: &robot, chain: &chain, frames: None,
/// # };
///
/// // A hose that hangs loose up to 0.5 rad and pulls with 60 N m/rad beyond.
/// for (q, expected) in [(-1.0, 0.0), (0.5, 0.0), (1.0, 30.0)] {
///     let mut torque = [0.0];
///     OneSidedSpring.torque(&[60.0, 0.0, 0.5], 0, &Instant { q: &[q], ..at_rest }, &[], &mut torque);
///     assert_eq!(torque, [expected]);
/// }
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct OneSidedSpring;

static ABOUT: About = About {
    name: "one_sided_spring",
    equation: "tau = ka (q - qs) for q > qs, kb (q - qs) for q < qs",
    explanation: "A hose, cable or dress pack hangs loose on one side of a position and is pulled tight on the other, or the joint \
                  runs against a soft stop.",
    reference: "Shaw, Holmes (1983), A periodically forced piecewise linear oscillator, Journal of Sound and Vibration 90(1)",
    rivals: &[
        Rival {
            name: "joint_spring",
            how_to_tell: "a spring has the same slope over the whole range: move through all of it, slowly",
        },
        Rival {
            name: "gravity_balancer",
            how_to_tell: "a strut's torque bends smoothly and on both sides, a hose's at one position",
        },
        Rival { name: "torque_offset", how_to_tell: "an offset is there in all poses" },
        Rival {
            name: "link_inertia_error",
            how_to_tell: "a weight follows the sine of the pose; re-identified inertias hide a part of a spring",
        },
    ],
    site: Site::Joint,
    scope: Scope::Joint,
    dry: false,
    uses_acceleration: false,
    nature: Nature::Lasting,
    hidden_by_base_parameters: Hidden::InPart,
};

static PARAMETERS: [Parameter; 3] = [
    Parameter {
        name: "above",
        symbol: "ka",
        unit: Unit::Stiffness,
        role: Role::Amplitude,
        lower: 0.0,
        upper: f64::INFINITY,
        typical: 80.0,
    },
    Parameter {
        name: "below",
        symbol: "kb",
        unit: Unit::Stiffness,
        role: Role::Amplitude,
        lower: 0.0,
        upper: f64::INFINITY,
        typical: 0.0,
    },
    Parameter {
        name: "slack_at",
        symbol: "qs",
        unit: Unit::Position,
        role: Role::Shape,
        lower: -TAU,
        upper: TAU,
        typical: 0.3,
    },
];

impl Effect for OneSidedSpring {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn parameters(&self) -> &'static [Parameter] {
        &PARAMETERS
    }

    fn search(&self, index: usize) -> Search {
        if PARAMETERS[index].role == Role::Shape { Search::Position } else { Search::Bounds }
    }

    /// As of a joint spring: hoses and cables do not carry an arm.
    fn largest_share(&self) -> Option<f64> {
        Some(0.5)
    }

    fn torque(&self, p: &[f64], joint: usize, x: &Instant, _: &[f64], out: &mut [f64]) {
        let [above, below, slack_at] = [p[0], p[1], p[2]];
        let away = x.q[joint] - slack_at;
        out[joint] += if away > 0.0 { above } else { below } * away;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::testing::torque_at;

    #[test]
    fn by_hand() {
        // 40 N m/rad above 0.25 rad and 8 below it: 0.5 rad above takes 20 N m, 0.5 rad below -4.
        assert_eq!(torque_at(&OneSidedSpring, &[40.0, 8.0, 0.25], 0.75, -0.5), 20.0);
        assert_eq!(torque_at(&OneSidedSpring, &[40.0, 8.0, 0.25], -0.25, -0.5), -4.0);
        assert_eq!(torque_at(&OneSidedSpring, &[40.0, 8.0, 0.25], 0.25, -0.5), 0.0);
        assert_eq!(torque_at(&OneSidedSpring, &[0.0, 0.0, 0.25], 0.75, -0.5), 0.0);
    }
}
