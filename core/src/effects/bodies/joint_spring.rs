//! Joint spring: hoses and dress packs that are bent or twisted as the joint turns.
//!
//! k (q - q0) is written with the torque at zero position, -k q0, so that both parameters enter linearly.

use crate::effects::{About, Effect, Hidden, Instant, Nature, Parameter, Rival, Role, Scope, Site};
use crate::robot::Unit;

/// k q + t0 = k (q - q0) with t0 = -k q0.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::effects::{Effect, Instant, JointSpring};
/// # use tauscope::{dynamics::Chain, robot::{self, InertiaCheck}};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Required)?;
/// # let (chain, zero) = (Chain::new(&robot), &[0.0][..]);
/// # let at_rest = Instant {
/// #     t: 0.0, started: 0.0, q: zero, qd: zero, qdd: zero, direction: zero, load: zero,
/// #     robot: &robot, chain: &chain, frames: None,
/// # };
///
/// // 60 N m/rad with a preload of -15 N m: slack at 0.25 rad.
/// for (q, expected) in [(0.25, 0.0), (1.25, 60.0)] {
///     let mut torque = [0.0];
///     JointSpring.torque(&[60.0, -15.0], 0, &Instant { q: &[q], ..at_rest }, &[], &mut torque);
///     assert_eq!(torque, [expected]);
/// }
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct JointSpring;

static ABOUT: About = About {
    name: "joint_spring",
    equation: "tau = k (q - q0) = k q + t0 with t0 = -k q0",
    explanation: "Hoses, cables or a dress pack pull the joint back to where they are relaxed.",
    reference: "Wang, Gondokaryono, Munawar, Fischer (2019), A convex optimization-based dynamic model identification package \
                for the da Vinci Research Kit, IEEE Robotics and Automation Letters 4(4)",
    rivals: &[
        Rival {
            name: "torque_offset",
            how_to_tell: "an offset has no slope over the position: use the whole range of the joint",
        },
        Rival {
            name: "gravity_balancer",
            how_to_tell: "a strut's torque bends like a sine over the position; a short range of motion does not separate them",
        },
        Rival {
            name: "torque_gain",
            how_to_tell: "a gain scales with the load: repeat the motion with a payload, the spring stays",
        },
        Rival { name: "time_delay", how_to_tell: "a delay vanishes in slow motion, the spring stays" },
    ],
    site: Site::Joint,
    scope: Scope::Joint,
    dry: false,
    uses_acceleration: false,
    nature: Nature::Lasting,
    hidden_by_base_parameters: Hidden::No,
};

static PARAMETERS: [Parameter; 2] = [
    Parameter {
        name: "stiffness",
        symbol: "k",
        unit: Unit::Stiffness,
        role: Role::Amplitude,
        lower: 0.0,
        upper: f64::INFINITY,
        typical: 60.0,
    },
    Parameter {
        name: "preload",
        symbol: "t0",
        unit: Unit::Effort,
        role: Role::Amplitude,
        lower: f64::NEG_INFINITY,
        upper: f64::INFINITY,
        typical: -15.0,
    },
];

impl Effect for JointSpring {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn parameters(&self) -> &'static [Parameter] {
        &PARAMETERS
    }

    /// Hoses and cables do not carry an arm: what does is a balancer.
    fn largest_share(&self) -> Option<f64> {
        Some(0.5)
    }

    fn torque(&self, p: &[f64], joint: usize, x: &Instant, _: &[f64], out: &mut [f64]) {
        out[joint] += p[0] * x.q[joint] + p[1];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::testing::torque_at;

    #[test]
    fn by_hand() {
        // 40 N m/rad relaxed at 0.25 rad, so t0 = -10: at 0.75 rad it takes 40 * 0.5 to hold it there.
        assert_eq!(torque_at(&JointSpring, &[40.0, -10.0], 0.75, -0.5), 20.0);
        assert_eq!(torque_at(&JointSpring, &[40.0, -10.0], 0.25, -0.5), 0.0);
        assert_eq!(torque_at(&JointSpring, &[0.0, 0.0], 0.75, -0.5), 0.0);
    }
}
