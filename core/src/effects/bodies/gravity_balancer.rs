//! Gravity balancer: a spring, gas or hydro-pneumatic strut that pulls a link towards the balanced pose.
//!
//! The strut runs from a point on the link at radius a from the joint axis to a point on the frame at radius b. Its length
//! is l = sqrt(a^2 + b^2 - 2 a b cos(q - phi)), shortest at q = phi, and its pull F0 + k (l - l0). The motor must add
//! the pull times dl/dq = a b sin(q - phi) / l. (A strut that pushes has a negative F0 and its angle half a turn away.)
//!
//! Torque does not determine all of a, b, F0, l0, k and phi: only four numbers of them enter. With s = sqrt(a^2 + b^2), the length
//! at which both radii are at right angles, geometry g = 2 a b / s^2, r = l/s = sqrt(1 - g cos(q - phi)), and r0 =
//! sqrt(1 - g), which is r at the shortest,
//!
//! tau = (M + K (r - r0)) g sin(q - phi) / (2 r),
//!
//! where M = s (F0 + k (s r0 - l0)) is the moment of the pull at the shortest length, and K = k s^2 that of the stiffness.
//! M and K enter linearly. The part K g sin(q - phi) / 2 is the torque of a weight, so that only the curvature of 1/r separates a
//! balancer from gravity.
//!
//! The bounds are those of any strut: one that pulls does so at its shortest too (M >= 0), and more the longer it is
//! (K >= 0); from end to end it no more than triples its length, (1 + g)/(1 - g) <= 9, and its points of attachment are no further than
//! ten to one from the axis, g >= 0.2. Without them a motion over a small range is fitted best by struts that hardly have a length and
//! jerk through it, or whose pull is tens of times the torque that they make, and does not hold in other poses. A strut that pushes from half a turn away is nearly one that pulls.

use crate::effects::{About, Effect, Hidden, Instant, Limit, Nature, Parameter, Rival, Role, Scope, Search, Site};
use crate::robot::{JointKind, Robot, Unit};

/// (M + K (r - r0)) g sin(q - phi) / (2 r).
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::effects::{Effect, GravityBalancer, Instant};
/// # use tauscope::{dynamics::Chain, robot::{self, InertiaCheck}};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Required)?;
/// # let (chain, zero) = (Chain::new(&robot), &[0.0][..]);
/// # let at_rest = Instant {
/// #     t: 0.0, started: 0.0, q: zero, qd: zero, qdd: zero, direction: zero, load: zero,
/// #     robot: &robot, chain: &chain, frames: None,
/// # };
///
/// // The strut pulls towards phi = 0.1 rad: the motor must deliver torque to leave it, and none there.
/// for (q, sign) in [(-0.4, -1.0), (0.6, 1.0)] {
///     let pose = Instant { q: &[q], ..at_rest };
///     let mut torque = [0.0];
///     GravityBalancer.torque(&[700.0, 600.0, 0.7, 0.1], 0, &pose, &[], &mut torque);
///     assert!(torque[0] * sign > 100.0);
/// }
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct GravityBalancer;

static ABOUT: About = About {
    name: "gravity_balancer",
    equation: "tau = (M + K (r - r0)) g sin(q - phi) / (2 r), r = sqrt(1 - g cos(q - phi)), r0 = sqrt(1 - g)",
    explanation: "A spring or gas strut along the lower arm carries part of its weight; the motor works with it or against \
                  it.",
    reference: "Klimchik, Wu, Dumas, Caro, Furet, Pashkevich (2013), Modelling of the gravity compensators in robotic \
                manufacturing cells, IFAC Conference on Manufacturing Modelling, Management and Control, arXiv:1311.6674",
    rivals: &[
        Rival {
            name: "joint_spring",
            how_to_tell: "a spring is straight over the position; only a wide range of motion shows the strut's sine",
        },
        Rival {
            name: "link_inertia_error",
            how_to_tell: "a wrong weight also acts when the arm accelerates, a strut does not; re-identified inertias hide most \
                          of it",
        },
        Rival { name: "torque_offset", how_to_tell: "an offset is the same in all poses" },
        Rival { name: "payload", how_to_tell: "a payload loads the other joints too" },
    ],
    site: Site::Joint,
    scope: Scope::Joint,
    dry: false,
    uses_acceleration: false,
    nature: Nature::Lasting,
    hidden_by_base_parameters: Hidden::InPart,
};

/// Springs are wound so that they never come loose, and gas struts gain a half at the most. A strut that is slack in the balanced pose
/// balances nothing: its torque is the cube of the angle, as of a hose that hardens.
static LIMITS: [Limit; 1] = [Limit::most("pull at the greatest length over that at the shortest, 1", 10.0)];

static PARAMETERS: [Parameter; 4] = [
    Parameter {
        name: "preload",
        symbol: "M",
        unit: Unit::Effort,
        role: Role::Amplitude,
        lower: 0.0,
        upper: f64::INFINITY,
        typical: 700.0,
    },
    Parameter {
        name: "stiffness",
        symbol: "K",
        unit: Unit::Effort,
        role: Role::Amplitude,
        lower: 0.0,
        upper: f64::INFINITY,
        typical: 600.0,
    },
    // At 0.2 the radii are as ten to one; at 0.8 the strut triples its length, at 1 it would shrink to nothing.
    Parameter {
        name: "geometry",
        symbol: "g",
        unit: Unit::One,
        role: Role::Shape,
        lower: 0.2,
        upper: 0.8,
        typical: 0.7,
    },
    Parameter {
        name: "angle",
        symbol: "phi",
        unit: Unit::Position,
        role: Role::Shape,
        lower: -std::f64::consts::PI,
        upper: std::f64::consts::PI,
        typical: 0.1,
    },
];

impl Effect for GravityBalancer {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn parameters(&self) -> &'static [Parameter] {
        &PARAMETERS
    }

    fn limits(&self) -> &'static [Limit] {
        &LIMITS
    }

    fn over_limit(&self, p: &[f64], _: usize, _: &Robot) -> f64 {
        let [preload, stiffness, geometry] = [p[0], p[1], p[2]];
        let longer = (1.0 + geometry).sqrt() - (1.0 - geometry).sqrt();
        // A preload below zero is beyond its bound, as far as it is known.
        if preload < 0.0 || stiffness == 0.0 { 0.0 } else { LIMITS[0].over(1.0 + stiffness * longer / preload) }
    }

    fn search(&self, index: usize) -> Search {
        if PARAMETERS[index].name == "angle" { Search::Angle } else { Search::Bounds }
    }

    /// It balances gravity, which an axis that is vertical in every pose does not feel, and has a lever on a joint that turns.
    fn can_be_on(&self, joint: usize, robot: &Robot) -> bool {
        robot.joints[joint].kind == JointKind::Revolute && robot.feels_gravity(joint)
    }

    /// The pull of a balancer is that of a link of another first moment.
    fn indistinguishable_from(&self) -> Option<&'static str> {
        Some("link_inertia_error")
    }

    /// It balances no more than what the drive has to carry, or could. A strut many times that is a difference of two: bodies would have to
    /// weigh as much more.
    fn largest_share(&self) -> Option<f64> {
        Some(10.0)
    }

    fn torque(&self, p: &[f64], joint: usize, x: &Instant, _: &[f64], out: &mut [f64]) {
        let [preload, stiffness, geometry, angle] = [p[0], p[1], p[2], p[3]];
        let (sine, cosine) = (x.q[joint] - angle).sin_cos();
        let length = (1.0 - geometry * cosine).sqrt();
        let shortest = (1.0 - geometry).sqrt();
        out[joint] += (preload + stiffness * (length - shortest)) * geometry * sine / (2.0 * length);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::testing::{pendulum, torque_at};

    /// Where cosine is 0.6 and sine 0.8.
    const ANGLE: f64 = 0.927_295_218_001_612_2;

    #[test]
    fn by_hand() {
        // g = 0.6: r = sqrt(1 - 0.36) = 0.8, r0 = sqrt(0.4) = 0.632455532034: (1000 + 500 * 0.167544467966) * 0.3.
        let torque = torque_at(&GravityBalancer, &[1000.0, 500.0, 0.6, 0.1], ANGLE + 0.1, -0.5);
        assert!((torque - 325.131_670_195).abs() < 1e-8, "{torque}");
        // It takes torque to move away on either side.
        let torque = torque_at(&GravityBalancer, &[1000.0, 500.0, 0.6, 0.1], 0.1 - ANGLE, -0.5);
        assert!((torque + 325.131_670_195).abs() < 1e-8, "{torque}");
        assert_eq!(torque_at(&GravityBalancer, &[0.0, 0.0, 0.6, 0.1], ANGLE, -0.5), 0.0);
    }

    #[test]
    fn a_strut_that_is_slack_in_the_balanced_pose_is_none() {
        // g = 0.6: longer by sqrt(1.6) - sqrt(0.4) = 0.632455532034.
        let over_limit =
            |preload: f64, stiffness: f64| GravityBalancer.over_limit(&[preload, stiffness, 0.6, 0.0], 0, &pendulum());
        let nine = 9.0 * 100.0 / 0.632_455_532_034;
        assert!(over_limit(100.0, 0.999 * nine) < 1.0 && over_limit(100.0, 1.001 * nine) > 1.0);
        assert_eq!([over_limit(0.0, 1.0), over_limit(0.0, 0.0), over_limit(-1.0, 5.0)], [f64::INFINITY, 0.0, 0.0]);
    }

    #[test]
    fn stands_where_there_is_something_to_balance() {
        let mut arm = pendulum();
        assert!(GravityBalancer.can_be_on(0, &arm));
        arm.joints[0].kind = JointKind::Prismatic;
        assert!(!GravityBalancer.can_be_on(0, &arm));
        arm.joints[0].kind = JointKind::Revolute;
        arm.gravity = 9.81 * arm.joints[0].axis;
        assert!(!GravityBalancer.can_be_on(0, &arm));
    }

    #[test]
    fn is_the_strut_it_stands_for() {
        // Radii 0.2 and 0.6 m (s^2 = 0.4 m2, g = 0.6), 1250 N/m, slack at 0.3 m: at its shortest, 0.4 m, it pulls with
        // 125 N, M = 0.632455532034 * 125 = 79.056941504 and K = 500.
        // At cosine 0.6: l = sqrt(0.4 - 0.144) = 0.505964425627 m, pull 1250 * 0.205964425627 = 257.455532034 N,
        // lever arm 0.12 * 0.8 / 0.505964425627 = 0.189736659610 m: 48.848752654 N m.
        let torque = torque_at(&GravityBalancer, &[79.056_941_504, 500.0, 0.6, 0.0], ANGLE, 0.0);
        assert!((torque - 48.848_752_654).abs() < 1e-6, "{torque}");
    }
}
