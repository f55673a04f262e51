//! Joint coupling: a pair of axes of which one motor also turns the gear of the other, as in many wrists.
//!
//! On the wrist of the Staubli TX and RX arms the second motor turns with the sum of both joint velocities. Its friction
//! and rotor therefore load both joints with terms in qd_a + qd_b and qdd_a + qdd_b. What these add on a joint's own
//! velocity and acceleration is part of that joint's Fv and Ia; the law holds the cross terms and the Coulomb friction of
//! the sum. Energy is lost for sure, and the mass matrix positive definite, as long as Fvc and Iac are no larger than
//! the Fv and Ia of both joints.

use crate::effects::{About, Effect, Hidden, Instant, Nature, Parameter, Rival, Role, Scope, Site, direction};
use crate::robot::Unit;

/// Fvc v_other + Fcc sign(v_a + v_b) + Iac a_other on both joints of the pair.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::effects::{Effect, Instant, JointCoupling};
/// # use tauscope::{dynamics::Chain, robot::{self, InertiaCheck}};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Required)?;
/// # let (chain, zero) = (Chain::new(&robot), &[0.0][..]);
/// # let at_rest = Instant {
/// #     t: 0.0, started: 0.0, q: zero, qd: zero, qdd: zero, direction: zero, load: zero,
/// #     robot: &robot, chain: &chain, frames: None,
/// # };
///
/// // Only the first axis of the pair moves, at 1 rad/s, and the second takes torque too: Fvc v + Fcc.
/// let (one_moves, still) = ([1.0, 0.0], [0.0, 0.0]);
/// let moving = Instant { q: &still, qd: &one_moves, qdd: &still, direction: &one_moves, load: &still, ..at_rest };
/// let mut torque = [0.0, 0.0];
/// JointCoupling.torque(&[1.5, 2.0, 0.3, 0.02], 0, &moving, &[], &mut torque);
/// assert_eq!(torque, [2.0, 3.5]);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct JointCoupling;

static ABOUT: About = About {
    name: "joint_coupling",
    equation: "tau of either = Fvc v_other + Fcc sign(v_a + v_b) + Iac a_other",
    explanation: "Two wrist axes share a gear train: moving one axis alone already takes torque on the other.",
    reference: "Janot, Vandanjon, Gautier (2014), A generic instrumental variable approach for industrial robot \
                identification, IEEE Transactions on Control Systems Technology 22(1) (Staubli TX40, joints 5 and 6)",
    rivals: &[
        Rival {
            name: "link_inertia_error",
            how_to_tell: "coupling by the bodies changes with the pose and has no friction: move one axis at constant speed \
                          and watch the other's torque",
        },
        Rival { name: "rotor_inertia", how_to_tell: "a rotor loads its own joint only" },
        Rival {
            name: "viscous_friction",
            how_to_tell: "if both axes always move together in proportion, nothing separates them: move them one by one",
        },
    ],
    site: Site::Joint,
    scope: Scope::Pair,
    dry: false,
    uses_acceleration: true,
    nature: Nature::Lasting,
    hidden_by_base_parameters: Hidden::No,
};

static PARAMETERS: [Parameter; 4] = [
    Parameter {
        name: "viscous",
        symbol: "Fvc",
        unit: Unit::Damping,
        role: Role::Amplitude,
        lower: 0.0,
        upper: f64::INFINITY,
        typical: 1.5,
    },
    Parameter {
        name: "coulomb",
        symbol: "Fcc",
        unit: Unit::Effort,
        role: Role::Amplitude,
        lower: 0.0,
        upper: f64::INFINITY,
        typical: 2.0,
    },
    Parameter {
        name: "inertia",
        symbol: "Iac",
        unit: Unit::Inertia,
        role: Role::Amplitude,
        lower: 0.0,
        upper: f64::INFINITY,
        typical: 0.3,
    },
    // The sum has no contact of its own that could stick, so its sign is smoothed.
    Parameter {
        name: "width",
        symbol: "w",
        unit: Unit::Velocity,
        role: Role::Held,
        lower: 1e-3,
        upper: 0.5,
        typical: 0.02,
    },
];

impl Effect for JointCoupling {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn parameters(&self) -> &'static [Parameter] {
        &PARAMETERS
    }

    fn torque(&self, p: &[f64], joint: usize, x: &Instant, _: &[f64], out: &mut [f64]) {
        let [viscous, coulomb, inertia, width] = [p[0], p[1], p[2], p[3]];
        let (a, b) = (joint, joint + 1);
        let dry = coulomb * direction(x.qd[a] + x.qd[b], width);
        out[a] += viscous * x.qd[b] + dry + inertia * x.qdd[b];
        out[b] += viscous * x.qd[a] + dry + inertia * x.qdd[a];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::testing::at;

    /// Torque on a pair at velocities `qd` and accelerations (1, 2) rad/s2.
    fn torque(p: &[f64], qd: [f64; 2]) -> [f64; 2] {
        at(0.0, 0.0, |x| {
            let mut out = [0.0; 2];
            JointCoupling.torque(p, 0, &Instant { qd: &qd, qdd: &[1.0, 2.0], ..*x }, &[], &mut out);
            out
        })
    }

    #[test]
    fn by_hand() {
        // The sum 0.3 rad/s is 15 widths: sign 1. First: 2 * -0.2 + 3 + 0.25 * 2; second: 2 * 0.5 + 3 + 0.25 * 1.
        let [first, second] = torque(&[2.0, 3.0, 0.25, 0.02], [0.5, -0.2]);
        assert!((first - 3.1).abs() < 1e-9, "{first}");
        assert!((second - 4.25).abs() < 1e-9, "{second}");
        assert_eq!(torque(&[0.0, 0.0, 0.0, 0.02], [0.5, -0.2]), [0.0, 0.0]);
    }

    #[test]
    fn opposed_motion_leaves_the_shared_motor_at_rest() {
        // Dry friction follows the sum, which is zero.
        assert_eq!(torque(&[0.0, 3.0, 0.0, 0.02], [0.5, -0.5]), [0.0, 0.0]);
    }
}
