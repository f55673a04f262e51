//! Integration error: what rapier's own time step gets wrong against exact dynamics.

use crate::dynamics::inverse_dynamics_at;
use crate::effects::{About, Effect, Hidden, Instant, Nature, Parameter, Rival, Role, Scope, Site};
use crate::robot::{JointKind, Robot, Unit};
use nalgebra::Vector3;

/// Rapier solves (M + h D) a = tau - n(q, v) with the step h and D = dn/dv, n the velocity torques, and steps
/// v+ = v + h a, q+ = q + h v+ (semi-implicit Euler). Velocity taken from the logged positions is therefore v + h a / 2,
/// half a step ahead of what n and the friction saw, so that half of h D a is left: h B(v, a), with
/// B(v, a) = (n(v + a) - n(v - a)) / 4; and friction has seen less speed: -h Fv a / 2.
///
/// One term of rapier's D takes the child's angular velocity where the parent's is meant (a slide's velocity three times
/// instead of twice); `misplaced` adds what comes of it. The rest is of second order in the step.
///
/// Velocity and acceleration are to be derivatives of the logged position: a log of the exact acceleration at each state
/// shows nothing of it, a tachometer twice B.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::effects::{Effect, Instant, IntegrationError};
/// # use tauscope::{dynamics::Chain, robot::{self, InertiaCheck}};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Required)?;
/// # let (chain, zero) = (Chain::new(&robot), &[0.0][..]);
/// # let at_rest = Instant {
/// #     t: 0.0, started: 0.0, q: zero, qd: zero, qdd: zero, direction: zero, load: zero,
/// #     robot: &robot, chain: &chain, frames: None,
/// # };
///
/// // One joint has no velocity torques, so that -h Fv a / 2 remains: Fv of the pendulum is 0.4 N m s/rad.
/// let accelerating = Instant { qd: &[2.0], qdd: &[5.0], direction: &[1.0], ..at_rest };
/// let mut torque = [0.0];
/// IntegrationError.torque(&[0.01], 0, &accelerating, &[], &mut torque);
/// assert!((torque[0] + 0.01).abs() < 1e-12);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct IntegrationError;

static ABOUT: About = About {
    name: "integration_error",
    equation: "tau = h (B(v, a) + E(v) a - Fv a / 2); B: velocity torques made bilinear, E: a misplaced term of rapier's",
    explanation: "The log is of a simulation with a step too long for its first-order integrator, not of an arm.",
    reference: "Hairer, Lubich and Wanner (2006), Geometric Numerical Integration, Springer, chapter IX (modified equations \
                of the semi-implicit Euler method)",
    rivals: &[
        Rival {
            name: "rotor_inertia",
            how_to_tell: "its friction part -h Fv a / 2 is that of a rotor with less inertia; its main part grows with \
                          velocity times acceleration and couples the joints",
        },
        Rival {
            name: "time_delay",
            how_to_tell: "a delay shifts gravity and friction too; it is not in proportion to velocity times acceleration",
        },
        Rival {
            name: "link_inertia_error",
            how_to_tell: "a wrong inertia shows at constant speed and at the start of motion as well",
        },
    ],
    site: Site::Integrator,
    scope: Scope::Arm,
    dry: false,
    uses_acceleration: true,
    nature: Nature::Lasting,
    hidden_by_base_parameters: Hidden::No,
};

static PARAMETERS: [Parameter; 1] = [Parameter {
    name: "step",
    symbol: "h",
    unit: Unit::Time,
    role: Role::Amplitude,
    lower: 0.0,
    upper: 0.05,
    typical: 0.001,
}];

impl Effect for IntegrationError {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn parameters(&self) -> &'static [Parameter] {
        &PARAMETERS
    }

    fn torque(&self, p: &[f64], _: usize, x: &Instant, _: &[f64], out: &mut [f64]) {
        let step = p[0];
        if step == 0.0 {
            return;
        }
        let (inertial, zeros) = (x.robot.inertial_parameters(), vec![0.0; out.len()]);
        let with = |sign: f64| {
            let velocity: Vec<f64> = x.qd.iter().zip(x.qdd).map(|(v, a)| v + sign * a).collect();
            inverse_dynamics_at(x.chain, &inertial, x.q, &velocity, &zeros)
        };
        let (ahead, behind) = (with(1.0), with(-1.0));
        let misplaced = misplaced(x.robot, x.q, x.qd, x.qdd);
        for (joint, torque) in out.iter_mut().enumerate() {
            let friction = 0.5 * x.robot.joints[joint].drive.viscous * x.qdd[joint];
            *torque += step * ((ahead[joint] - behind[joint]) / 4.0 + misplaced[joint] - friction);
        }
    }
}

/// E(v) a: the torque of accelerations alpha_parent x (omega_joint x s) too many, with s from the parent's centre of mass to
/// the joint, handed on to all links behind it (rapier 0.36, `Multibody::update_mass_matrix`).
fn misplaced(robot: &Robot, q: &[f64], qd: &[f64], qdd: &[f64]) -> Vec<f64> {
    let frames = robot.frames(q);
    let axes: Vec<Vector3<f64>> = robot.joints.iter().zip(&frames).map(|(j, f)| f.rotation * j.axis).collect();
    let mut torque = vec![0.0; robot.dof()];
    // Rapier has no joints that follow others, and so no error with them.
    if !robot.followers().is_empty() {
        return torque;
    }
    // Angular acceleration, acceleration too many and centre of mass of every body.
    let mut carried = vec![[Vector3::zeros(); 3]; robot.dof()];
    for link in robot.outwards() {
        let (joint, frame) = (&robot.joints[link], &frames[link]);
        let [mut alpha, mut extra, parent_center] =
            robot.parent(link).map_or_else(Default::default, |parent| carried[parent]);
        let turn = axes[link] * qd[link];
        // The first link hangs on the fixed base, whose alpha is zero.
        match joint.kind {
            JointKind::Revolute => {
                extra += alpha.cross(&turn.cross(&(frame.translation - parent_center)));
                alpha += axes[link] * qdd[link];
            }
            JointKind::Prismatic => extra += alpha.cross(&turn),
        }
        let center = frame.rotation * joint.inertia.center_of_mass() + frame.translation;
        let force = joint.inertia.mass() * extra;
        let mut at = Some(link);
        while let Some(before) = at {
            let column = match robot.joints[before].kind {
                JointKind::Revolute => axes[before].cross(&(center - frames[before].translation)),
                JointKind::Prismatic => axes[before],
            };
            torque[before] += column.dot(&force);
            at = robot.parent(before);
        }
        carried[link] = [alpha, extra, center];
    }
    torque
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::Chain;
    use crate::effects::testing::{at, pendulum, torque_at};

    #[test]
    fn a_double_pendulum_by_hand() {
        // Two links of 1 m with 2 kg in their middle, axes parallel: with k = 2 * 1 * 0.5 = 1 and s = sin 30 deg = 0.5,
        // n1 = -k s (2 v1 v2 + v2^2) and n2 = k s v1^2, so with v = (2, 3), a = (4, -1):
        // B1 = -0.5 (v1 a2 + v2 a1 + v2 a2) = -0.5 (-2 + 12 - 3) = -3.5 and B2 = 0.5 v1 a1 = 4.
        // Misplaced: an acceleration a1 v2 * 0.5 m of the second mass towards the first axis, which both joints feel as
        // 2 kg * (4 * 3 * 0.5) * 0.5 m * s = 3. Friction of 10 N m s/rad on joint 1: -10 * 4 / 2 = -20.
        let mut robot = pendulum();
        let mut second = robot.joints[0].clone();
        second.origin.translation = Vector3::x();
        robot.joints.push(second);
        robot.joints[0].drive.viscous = 10.0;
        let q = [0.7, std::f64::consts::FRAC_PI_6];
        let mut torque = [0.0; 2];
        at(0.0, 0.0, |x| {
            let chain = Chain::new(&robot);
            let x = Instant { q: &q, qd: &[2.0, 3.0], qdd: &[4.0, -1.0], robot: &robot, chain: &chain, ..*x };
            IntegrationError.torque(&[0.002], 0, &x, &[], &mut torque);
        });
        for (value, expected) in torque.iter().zip([0.002 * (-3.5 + 3.0 - 20.0), 0.002 * (4.0 + 3.0)]) {
            assert!((value - expected).abs() < 1e-14, "{value} {expected}");
        }
    }

    #[test]
    fn one_joint_alone_has_no_velocity_torque() {
        assert!(torque_at(&IntegrationError, &[0.01], 0.3, 2.0).abs() < 1e-15);
    }

    #[test]
    fn absent_it_adds_nothing() {
        assert_eq!(torque_at(&IntegrationError, &[0.0], 0.3, 2.0), 0.0);
    }
}
