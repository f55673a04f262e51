//! Load-dependent friction: dry friction in proportion to the torque that the gear passes on.

use crate::effects::{About, Effect, Hidden, Instant, Nature, Parameter, Rival, Role, Scope, Site};
use crate::robot::Unit;

/// mu |tau_load| sign(v).
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::effects::{Effect, Instant, LoadDependentFriction};
/// # use tauscope::{dynamics::Chain, robot::{self, InertiaCheck}};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Required)?;
/// # let (chain, zero) = (Chain::new(&robot), &[0.0][..]);
/// # let at_rest = Instant {
/// #     t: 0.0, started: 0.0, q: zero, qd: zero, qdd: zero, direction: zero, load: zero,
/// #     robot: &robot, chain: &chain, frames: None,
/// # };
///
/// // 8 % of a load of 50 N m, against the motion whatever the sign of the load.
/// let moving = Instant { qd: &[0.5], direction: &[1.0], load: &[-50.0], ..at_rest };
/// let mut torque = [0.0];
/// LoadDependentFriction.torque(&[0.08], 0, &moving, &[], &mut torque);
/// assert_eq!(torque, [4.0]);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct LoadDependentFriction;

static ABOUT: About = About {
    name: "load_dependent_friction",
    equation: "tau = mu |tau_load| sign(v)",
    explanation: "The harder the teeth are pressed together, the more they rub: friction grows with the weight and the \
                  acceleration the gear has to carry.",
    reference: "Hamon, Gautier, Garrec (2010), Dynamic identification of robots with a dry friction model depending on load \
                and velocity, IEEE/RSJ IROS",
    rivals: &[
        Rival {
            name: "position_dependent_friction",
            how_to_tell: "gravity loads go with position: repeat the motion with a payload or at another pace, and see whether \
                          friction at one position changes",
        },
        Rival {
            name: "nonlinear_viscous_friction",
            how_to_tell: "fast motions are loaded motions: compare one speed under different loads",
        },
        Rival {
            name: "time_delay",
            how_to_tell: "a delay scales with how fast the load torque changes; run the motion at half the pace",
        },
    ],
    site: Site::Joint,
    scope: Scope::Joint,
    dry: true,
    uses_acceleration: true,
    nature: Nature::Lasting,
    hidden_by_base_parameters: Hidden::No,
};

static PARAMETERS: [Parameter; 1] = [Parameter {
    name: "coefficient",
    symbol: "mu",
    unit: Unit::One,
    role: Role::Amplitude,
    lower: 0.0,
    // Half of the load lost each way: a gear worse than that locks itself.
    upper: 0.5,
    typical: 0.08,
}];

impl Effect for LoadDependentFriction {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn parameters(&self) -> &'static [Parameter] {
        &PARAMETERS
    }

    fn torque(&self, p: &[f64], joint: usize, x: &Instant, _: &[f64], out: &mut [f64]) {
        out[joint] += p[0] * x.load[joint].abs() * x.direction[joint];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::testing::{at, torque_at};

    #[test]
    fn by_hand() {
        // The load is 12 N m: 0.25 * 12, against the motion.
        assert_eq!(torque_at(&LoadDependentFriction, &[0.25], 0.2, -0.5), -3.0);
        assert_eq!(torque_at(&LoadDependentFriction, &[0.25], 0.2, 0.5), 3.0);
        assert_eq!(torque_at(&LoadDependentFriction, &[0.0], 0.2, 0.5), 0.0);
    }

    #[test]
    fn the_sign_of_the_load_does_not_matter() {
        let torque = at(0.2, 0.5, |x| {
            let mut out = [0.0];
            LoadDependentFriction.torque(&[0.25], 0, &Instant { load: &[-12.0], ..*x }, &[], &mut out);
            out[0]
        });
        assert_eq!(torque, 3.0);
    }
}
