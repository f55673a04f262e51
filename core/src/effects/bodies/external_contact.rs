//! External contact: something pushes the tool for a part of the run.

use crate::effects::{About, Effect, Hidden, Instant, Nature, Parameter, Rival, Role, Scope, Search, Site};
use crate::robot::{JointKind, Unit};
use nalgebra::Vector3;

/// tau = -J(q)' f between two times.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::dynamics::{Chain, Motion};
/// use tauscope::effects::{Along, ExternalContact, Placed, contribution};
/// use tauscope::robot::{self, InertiaCheck};
///
/// // Someone pulls the flange to the side with 10 N from 1 s to 2 s. Joint 1 turns about z: it must hold against x f.
/// let arm = robot::load("../urdf/irb1600_6_120.urdf", InertiaCheck::Required)?;
/// let pull = Placed { effect: &ExternalContact, joint: 0, parameters: vec![0.0, 10.0, 0.0, 1.0, 2.0, 0.1] };
/// let (chain, still) = (Chain::new(&arm), Motion::zeros(6, 3));
/// let torque = contribution(&[pull], &Along::new(&arm, &chain, &[0.5, 1.5, 2.5], &still, 0.0));
/// let x = arm.frames(&[0.0; 6])[6].translation.x;
/// let expected = [0.0, -10.0 * x, 0.0];
/// assert!(torque.channel(0).iter().zip(expected).all(|(torque, expected)| (torque - expected).abs() < 1e-9));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct ExternalContact;

static ABOUT: About = About {
    name: "external_contact",
    equation: "tau = -J(q)' f between start and end; f: force of the surroundings on the flange, base axes",
    explanation: "The arm touches something, is pulled by a cable or pushed by a person for a while.",
    reference: "De Luca, Albu-Schaffer, Haddadin and Hirzinger (2006), Collision detection and safe reaction with the \
                DLR-III lightweight manipulator arm, IEEE/RSJ International Conference on Intelligent Robots and Systems",
    rivals: &[
        Rival {
            name: "payload",
            how_to_tell: "a payload pulls down for the whole run and resists acceleration; a contact begins, ends and \
                          points anywhere",
        },
        Rival {
            name: "friction_warm_up",
            how_to_tell: "warm-up fades through the whole run and flips with the direction of motion",
        },
    ],
    site: Site::Joint,
    scope: Scope::Arm,
    dry: false,
    uses_acceleration: false,
    nature: Nature::Event,
    hidden_by_base_parameters: Hidden::No,
};

/// Shortest contact, s: what is shorter is a knock, and its column singles out a row or two, which anything can fill.
const SHORTEST_S: f64 = 0.3;

const fn force(name: &'static str, typical: f64) -> Parameter {
    Parameter {
        name,
        symbol: name,
        unit: Unit::Force,
        role: Role::Amplitude,
        lower: f64::NEG_INFINITY,
        upper: f64::INFINITY,
        typical,
    }
}

const fn instant(name: &'static str, symbol: &'static str, typical: f64) -> Parameter {
    Parameter { name, symbol, unit: Unit::Time, role: Role::Shape, lower: 0.0, upper: 1e5, typical }
}

static PARAMETERS: [Parameter; 6] = [
    force("fx", 60.0),
    force("fy", -40.0),
    force("fz", 50.0),
    instant("start", "t1", 2.0),
    instant("end", "t2", 5.0),
    // Contacts build up; an edge of some width also lets a fit move it.
    Parameter { name: "rise", symbol: "w", unit: Unit::Time, role: Role::Held, lower: 1e-3, upper: 10.0, typical: 0.1 },
];

impl Effect for ExternalContact {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn parameters(&self) -> &'static [Parameter] {
        &PARAMETERS
    }

    fn move_between(&self, from: f64, to: f64, p: &mut [f64]) {
        (p[3], p[4]) = (from, to);
    }

    fn is_sensible(&self, p: &[f64]) -> bool {
        p[4] - p[3] >= SHORTEST_S
    }

    fn search(&self, index: usize) -> Search {
        match index {
            3 | 4 => Search::Instant,
            _ => Search::Bounds,
        }
    }

    fn uses_frames(&self) -> bool {
        true
    }

    fn acts_between(&self, p: &[f64]) -> [f64; 2] {
        [p[3] - 0.5 * p[5], p[4] + 0.5 * p[5]]
    }

    fn torque(&self, p: &[f64], _: usize, x: &Instant, _: &[f64], out: &mut [f64]) {
        let share = edge((x.t - p[3]) / p[5]) * edge((p[4] - x.t) / p[5]);
        let force = share * Vector3::new(p[0], p[1], p[2]);
        if force == Vector3::zeros() {
            return;
        }
        let own = if x.frames.is_none() { x.robot.frames(x.q) } else { Vec::new() };
        let frames = x.frames.unwrap_or(&own);
        let tool = frames[x.robot.bodies()].translation;
        let mut at = Some(x.robot.tip());
        while let Some(body) = at {
            let (joint, frame, coupling) = (x.robot.body(body), &frames[body], x.robot.coupling(body));
            at = x.robot.parent(body);
            let axis = frame.rotation * joint.axis;
            let column = match joint.kind {
                JointKind::Revolute => axis.cross(&(tool - frame.translation)),
                JointKind::Prismatic => axis,
            };
            out[coupling.coordinate] -= coupling.multiplier * column.dot(&force);
        }
    }
}

/// From 0 at x = -1/2 to 1 at x = 1/2, without a kink.
fn edge(x: f64) -> f64 {
    let s = (x + 0.5).clamp(0.0, 1.0);
    s * s * (3.0 - 2.0 * s)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::Chain;
    use crate::effects::testing::{at, pendulum, torque_at};
    use crate::robot::{Joint, Pose, Robot};

    #[test]
    fn by_hand() {
        // The pendulum's flange is 1 m out along x and turns about y; at q = 0 pushing it up (+z) with 30 N is a moment
        // of -30 N m about y, so the motor must add +30. A push along x goes through the axis. Full size at t = 2 s.
        let p = |f: [f64; 3], start: f64, end: f64| [f[0], f[1], f[2], start, end, 0.1];
        assert_eq!(torque_at(&ExternalContact, &p([0.0, 0.0, 30.0], 1.0, 3.0), 0.0, 0.0), 30.0);
        assert_eq!(torque_at(&ExternalContact, &p([30.0, 7.0, 0.0], 1.0, 3.0), 0.0, 0.0), 0.0);
        // Half of it at the very start, a quarter of the way up 3/16 - 2/64 = 0.15625 of it, nothing outside.
        assert_eq!(torque_at(&ExternalContact, &p([0.0, 0.0, 30.0], 2.0, 3.0), 0.0, 0.0), 15.0);
        let early = torque_at(&ExternalContact, &p([0.0, 0.0, 30.0], 2.025, 3.0), 0.0, 0.0);
        assert!((early - 30.0 * 0.15625).abs() < 1e-9);
        for (start, end) in [(2.1, 3.0), (1.0, 1.9), (3.0, 1.0)] {
            assert_eq!(torque_at(&ExternalContact, &p([0.0, 0.0, 30.0], start, end), 0.0, 0.0), 0.0);
        }
    }

    #[test]
    fn absent_it_adds_nothing() {
        assert_eq!(torque_at(&ExternalContact, &[0.0, 0.0, 0.0, 1.0, 3.0, 0.1], 0.4, 1.0), 0.0);
    }

    /// The pendulum with a slide along z and a second turn, about a skew axis, behind it.
    fn skew_arm() -> Robot {
        let mut robot = pendulum();
        let shift = |x: f64, y: f64, z: f64| Pose { translation: Vector3::new(x, y, z), ..Pose::identity() };
        let first = robot.joints[0].clone();
        let slide =
            Joint { kind: JointKind::Prismatic, axis: Vector3::z(), origin: shift(0.3, 0.1, 0.0), ..first.clone() };
        let axis = Vector3::new(1.0, 2.0, -2.0) / 3.0;
        let turn = Joint { axis, origin: shift(-0.2, 0.4, 0.5), ..first };
        robot.joints.extend([slide, turn]);
        robot
    }

    #[test]
    fn virtual_work() {
        // The motors' torque does the work that the force takes: tau . dq = -f . d(tool).
        let (robot, force) = (skew_arm(), Vector3::new(12.0, -31.0, 8.0));
        let q = [0.4, -0.15, 1.1];
        let mut torque = [0.0; 3];
        at(0.0, 0.0, |x| {
            let x = Instant { q: &q, robot: &robot, chain: &Chain::new(&robot), ..*x };
            ExternalContact.torque(&[force.x, force.y, force.z, 1.0, 3.0, 0.1], 0, &x, &[], &mut torque);
        });
        let step = 1e-6;
        for joint in 0..3 {
            let tool = |by: f64| {
                let mut moved = q;
                moved[joint] += by;
                robot.frames(&moved)[3].translation
            };
            let work = -force.dot(&(tool(step) - tool(-step))) / (2.0 * step);
            assert!((torque[joint] - work).abs() < 1e-7, "joint {joint}: {} {work}", torque[joint]);
        }
    }

    /// A fit once ended a contact before it began: within its rise a row was left, which took up whatever was wrong there.
    #[test]
    fn a_contact_lasts() {
        let p = |start: f64, end: f64| [1.0, 0.0, 0.0, start, end, 0.1];
        assert!(ExternalContact.is_sensible(&p(2.0, 2.3 + 1e-9)) && !ExternalContact.is_sensible(&p(2.0, 2.29)));
        assert!(!ExternalContact.is_sensible(&p(19.59, 19.56)));
        let mut moved = p(0.0, 1.0);
        ExternalContact.move_between(4.0, 5.5, &mut moved);
        assert_eq!(moved, p(4.0, 5.5));
    }
}
