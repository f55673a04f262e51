//! Payload: a body on the flange that the model does not know.

use super::plausible::{arm_mass, spread};
use crate::effects::{About, Derived, Effect, Hidden, Nature, Parameter, Rival, Role, Scope, Site};
use crate::robot::{Inertia, Pose, Robot, Unit};
use nalgebra::Matrix3;

/// Ten inertial parameters, about the flange frame, added to the last link.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::effects::{Effect, Payload, Placed};
/// use tauscope::robot::{self, InertiaCheck, Unit};
///
/// // The typical payload weighs 6 kg; its centre of mass is 0.12 m in front of the flange.
/// let mut arm = robot::load("../urdf/irb1600_6_120.urdf", InertiaCheck::Required)?;
/// let (payload, before) = (Placed::typical(&Payload, 0), arm.joints[5].inertia.mass());
/// Payload.alter(&payload.parameters, 0, &mut arm);
/// assert!((arm.joints[5].inertia.mass() - before - 6.0).abs() < 1e-12);
///
/// let derived = Payload.derived(&payload.parameters, 0, &arm);
/// assert_eq!((derived[3].name, derived[3].unit), ("center_z", Unit::Length));
/// assert!((derived[3].value - 0.12).abs() < 1e-12);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Payload;

static ABOUT: About = About {
    name: "payload",
    equation: "tau = Y(q, v, a) (m, mx, my, mz, Ixx, Ixy, Iyy, Ixz, Iyz, Izz) of a body fixed to the flange",
    explanation: "The arm carries a tool or load that the model lacks or describes wrongly.",
    reference: "Atkeson, An and Hollerbach (1986), Estimation of inertial parameters of manipulator loads and links, \
                International Journal of Robotics Research 5(3)",
    rivals: &[
        Rival {
            name: "link_inertia_error",
            how_to_tell: "on the last link they are the same; on another link the torque does not depend on the joints \
                          behind it",
        },
        Rival {
            name: "encoder_offset",
            how_to_tell: "torque cannot separate it from an offset of the last joint; take the tool off and compare",
        },
        Rival {
            name: "external_contact",
            how_to_tell: "a payload stays for the whole run and its pull keeps to gravity and acceleration",
        },
    ],
    site: Site::Body,
    scope: Scope::Arm,
    dry: false,
    uses_acceleration: false,
    nature: Nature::Lasting,
    hidden_by_base_parameters: Hidden::Wholly,
};

const fn amplitude(name: &'static str, unit: Unit, lower: f64, typical: f64) -> Parameter {
    Parameter { name, symbol: name, unit, role: Role::Amplitude, lower, upper: f64::INFINITY, typical }
}

/// Prior spread of what a tool and its load may weigh, over the mass of the arm, and how far out they may reach, m.
const SHARE: f64 = 0.2;
const REACH_M: f64 = 0.3;

const ANY: f64 = f64::NEG_INFINITY;

// A body of 6 kg with its centre of mass at (0.05, -0.03, 0.12) m.
static PARAMETERS: [Parameter; 10] = [
    amplitude("m", Unit::Mass, 0.0, 6.0),
    amplitude("mx", Unit::FirstMoment, ANY, 0.3),
    amplitude("my", Unit::FirstMoment, ANY, -0.18),
    amplitude("mz", Unit::FirstMoment, ANY, 0.72),
    amplitude("Ixx", Unit::MomentOfInertia, 0.0, 0.132),
    amplitude("Ixy", Unit::MomentOfInertia, ANY, 0.009),
    amplitude("Iyy", Unit::MomentOfInertia, 0.0, 0.142),
    amplitude("Ixz", Unit::MomentOfInertia, ANY, -0.036),
    amplitude("Iyz", Unit::MomentOfInertia, ANY, 0.022),
    amplitude("Izz", Unit::MomentOfInertia, 0.0, 0.041),
];

impl Effect for Payload {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn headline(&self) -> &'static [&'static str] {
        &["mass", "first_moment_x"]
    }

    fn is_asked_about(&self) -> bool {
        true
    }

    fn parameters(&self) -> &'static [Parameter] {
        &PARAMETERS
    }

    fn prior(&self, _: usize, robot: &Robot) -> Option<Vec<f64>> {
        Some(spread(SHARE * arm_mass(robot), REACH_M))
    }

    fn is_load(&self) -> bool {
        true
    }

    fn derived(&self, p: &[f64], _: usize, robot: &Robot) -> Vec<Derived> {
        p.try_into().map_or(Vec::new(), |body| load(&Inertia(body), &Pose::identity(), robot.reach()))
    }

    fn alter(&self, p: &[f64], _: usize, robot: &mut Robot) {
        let flange = robot.flange;
        let tip = robot.tip();
        if let Ok(body) = p.try_into() {
            let last = robot.body_mut(tip);
            last.inertia = last.inertia.welded_to(&seen_from_parent(&Inertia(body), &flange));
        }
    }
}

/// Mass, and centre of mass in `frame`, of a load about the frame that `frame` is given in. Where the centre is beyond the `reach` of the
/// arm, m, the load hangs on another link: these joints show its first moment, and its mass does not pull on them.
pub(super) fn load(body: &Inertia, frame: &Pose, reach: f64) -> Vec<Derived> {
    let center = frame.rotation.transpose() * (body.center_of_mass() - frame.translation);
    if center.norm() > reach {
        let first = frame.rotation.transpose() * (body.first_moment() - body.mass() * frame.translation);
        let named = [("first_moment_x", first.x), ("first_moment_y", first.y), ("first_moment_z", first.z)];
        let of = |(name, value)| Derived { name, unit: Unit::FirstMoment, value, of_the_first: false };
        return named.map(of).to_vec();
    }
    let named = [
        ("mass", Unit::Mass, body.mass()),
        ("center_x", Unit::Length, center.x),
        ("center_y", Unit::Length, center.y),
        ("center_z", Unit::Length, center.z),
    ];
    let of = |(k, (name, unit, value)): (usize, (&'static str, Unit, f64))| Derived {
        name,
        unit,
        value,
        of_the_first: k > 0,
    };
    named.into_iter().enumerate().map(of).collect()
}

/// Parallel-axis theorem without the centre of mass, so that it is linear and holds for parameters that have a first
/// moment but no mass.
pub(crate) fn seen_from_parent(body: &Inertia, frame: &Pose) -> Inertia {
    let Pose { rotation, translation: t } = frame;
    let first = rotation * body.first_moment();
    let moment = first + body.mass() * t;
    let mixed = first * t.transpose() + t * moment.transpose();
    let tensor = rotation * body.tensor() * rotation.transpose()
        + Matrix3::identity() * (first.dot(t) + t.dot(&moment))
        - 0.5 * (mixed + mixed.transpose());
    Inertia([
        body.mass(),
        moment.x,
        moment.y,
        moment.z,
        tensor[(0, 0)],
        tensor[(0, 1)],
        tensor[(1, 1)],
        tensor[(0, 2)],
        tensor[(1, 2)],
        tensor[(2, 2)],
    ])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::{Chain, inverse_dynamics_at};
    use crate::effects::testing::pendulum;
    use nalgebra::{Rotation3, Vector3};

    fn torque(robot: &Robot, q: f64, qdd: f64) -> f64 {
        inverse_dynamics_at(&Chain::new(robot), &robot.inertial_parameters(), &[q], &[0.0], &[qdd])[0]
    }

    #[test]
    fn six_kilograms_on_the_pendulum() {
        // The flange is 1 m out along x, the axis is y: at q = 0 holding 6 kg takes 6 * 9.81 * 1 = 58.86 N m more,
        // against gravity, which is -y; accelerating it by 2 rad/s2 takes 6 * 1^2 * 2 = 12 N m more.
        let mut robot = pendulum();
        let before = [torque(&robot, 0.0, 0.0), torque(&robot, 0.0, 2.0)];
        Payload.alter(&[6.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], 0, &mut robot);
        assert!((torque(&robot, 0.0, 0.0) - before[0] + 58.86).abs() < 1e-12);
        assert!((torque(&robot, 0.0, 2.0) - before[1] + 58.86 - 12.0).abs() < 1e-12);
    }

    #[test]
    fn parallel_axis_by_hand() {
        // 2 kg at z = 0.5 of a flange at x = 1: about the joint c = (1, 0, 0.5), so Ixx = 2 * 0.25, Iyy = 2 * 1.25,
        // Izz = 2 * 1, Ixz = -2 * 1 * 0.5; added to the pendulum's 2 kg at x = 0.5.
        let mut robot = pendulum();
        Payload.alter(&[2.0, 0.0, 0.0, 1.0, 0.5, 0.0, 0.5, 0.0, 0.0, 0.0], 0, &mut robot);
        assert_eq!(robot.joints[0].inertia.0, [4.0, 3.0, 0.0, 1.0, 0.5, 0.0, 3.0, -1.0, 0.0, 2.5]);
    }

    /// 0.05 kg m on an arm of 2 m: a load of 5 g would be 10 m out, one of 0.5 kg is 0.1 m out.
    #[test]
    fn a_load_beyond_the_reach_is_a_first_moment() {
        let names = |mass: f64| {
            let body = Inertia([mass, 0.0, 0.0, 0.05, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
            load(&body, &Pose::identity(), 2.0).iter().map(|one| (one.name, one.value)).collect::<Vec<_>>()
        };
        assert_eq!(names(0.005), [("first_moment_x", 0.0), ("first_moment_y", 0.0), ("first_moment_z", 0.05)]);
        assert_eq!(names(0.5)[..1], [("mass", 0.5)]);
        assert_eq!([names(0.0251)[0].0, names(0.0249)[0].0], ["mass", "first_moment_x"]);
    }

    #[test]
    fn agrees_with_the_route_over_the_centre_of_mass() {
        let frame = Pose {
            rotation: Rotation3::from_euler_angles(0.3, -0.7, 1.9).into_inner(),
            translation: Vector3::new(0.2, -0.1, 0.4),
        };
        let body = Inertia(std::array::from_fn(|i| PARAMETERS[i].typical));
        assert_eq!(body.physical_fault(1e-9), None, "the typical payload must be a possible body");
        let expected = body.seen_from_parent(&frame.rotation, &frame.translation);
        for (value, expected) in seen_from_parent(&body, &frame).0.iter().zip(expected.0) {
            assert!((value - expected).abs() < 1e-14);
        }
    }

    #[test]
    fn a_first_moment_without_mass_counts() {
        let mut robot = pendulum();
        Payload.alter(&[0.0, 3.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], 0, &mut robot);
        assert_eq!(robot.joints[0].inertia.0[1], 1.0 + 3.0);
    }

    #[test]
    fn absent_it_changes_nothing() {
        let mut robot = pendulum();
        Payload.alter(&[0.0; 10], 0, &mut robot);
        assert_eq!(robot, pendulum());
    }
}
