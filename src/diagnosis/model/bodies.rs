//! Plausibility: prior spreads of the parameters of bodies, whether an estimate leaves a link that can be, and how hard
//! hoses can pull.
//!
//! Where the URDF is trusted, a link that differs from it is still about that link: its mass of the same order, its centre
//! of mass within its length. Without that a wrong link explains what a balancer or a spring does, by a mass behind the
//! joint.

use super::roles::linear;
use crate::effects::{Placed, Site};
use crate::robot::{Inertia, Robot};

/// Spread of what a tool and its load may weigh, over the mass of the arm, and how far out they may reach, m.
const PAYLOAD_SHARE: f64 = 0.2;
const PAYLOAD_REACH_M: f64 = 0.3;

/// Shortest length that counts for a link, m.
const SHORTEST_M: f64 = 0.1;

/// How far from its joint the centre of mass of a link may lie, over the link's length.
const REACH: f64 = 1.25;

/// How many times its mass a link may weigh more than described.
const HEAVIER: f64 = 3.0;

/// Largest shares of a joint's torque that what is not meant to carry takes.
const PARASITES: [(&str, f64); 4] =
    [("joint_spring", 0.5), ("torque_offset", 0.5), ("friction_asymmetry", 0.5), ("torque_ripple", 0.3)];

/// Least mass of a link over that of the arm, and of an arm, kg.
const LIGHTEST_SHARE: f64 = 0.01;
const LIGHTEST_ARM_KG: f64 = 1.0;

/// Prior standard deviations of an effect's amplitudes and departures in the order of their columns; infinite where nothing
/// is known beforehand.
pub fn inertial_prior(robot: &Robot, placed: &Placed) -> Vec<f64> {
    let of_body = |mass: f64, length: f64| -> Vec<f64> {
        (0..10)
            .map(|k| match k {
                0 => mass,
                1..=3 => mass * length,
                _ => mass * length * length,
            })
            .collect()
    };
    match placed.effect.about().name {
        "link_inertia_error" => of_body(mass(robot, placed.joint), length(robot, placed.joint)),
        "payload" => of_body(PAYLOAD_SHARE * arm_mass(robot), PAYLOAD_REACH_M),
        _ => vec![f64::INFINITY; linear(placed.effect).len()],
    }
}

/// Whether a link changed by `placed` is one that can be; true of effects that do not change one link.
pub fn is_believable(robot: &Robot, placed: &Placed) -> bool {
    if placed.effect.about().site != Site::Body || placed.effect.about().name != "link_inertia_error" {
        return true;
    }
    let mut changed = robot.clone();
    placed.effect.alter(&placed.parameters, placed.joint, &mut changed);
    let (before, after): (&Inertia, &Inertia) =
        (&robot.joints[placed.joint].inertia, &changed.joints[placed.joint].inertia);
    after.mass() > 0.0
        && after.mass() <= before.mass() + HEAVIER * mass(robot, placed.joint)
        && after.first_moment().norm() <= REACH * length(robot, placed.joint) * after.mass()
}

/// Mass that a link may be taken for, kg; one that is described as next to nothing is a part of the arm all the same.
fn mass(robot: &Robot, joint: usize) -> f64 {
    robot.joints[joint].inertia.mass().max(LIGHTEST_SHARE * arm_mass(robot))
}

fn arm_mass(robot: &Robot) -> f64 {
    robot.joints.iter().map(|joint| joint.inertia.mass()).sum::<f64>().max(LIGHTEST_ARM_KG)
}

/// Largest share of its joint's torque, in root mean square, that an effect can have, if there is one: hoses, teeth and
/// amplifiers do not carry an arm, what does is a balancer.
pub fn largest_share(placed: &Placed) -> Option<f64> {
    let name = placed.effect.about().name;
    PARASITES.iter().find(|(parasite, _)| *parasite == name).map(|(_, share)| *share)
}

/// Length of a link: how far the next joint or its own centre of mass lies from its joint, m.
fn length(robot: &Robot, joint: usize) -> f64 {
    let next = robot.joints.get(joint + 1).map_or(0.0, |next| next.origin.translation.norm());
    let inertia = &robot.joints[joint].inertia;
    let center = if inertia.mass() > 0.0 { inertia.first_moment().norm() / inertia.mass() } else { 0.0 };
    next.max(center).max(SHORTEST_M)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::find;
    use crate::robot::{InertiaCheck, load};

    fn arm() -> Robot {
        load(concat!(env!("CARGO_MANIFEST_DIR"), "/urdf/irb1600_6_120.urdf"), InertiaCheck::Required).unwrap()
    }

    #[test]
    fn a_balancer_is_no_link() {
        let robot = arm();
        let mut error = Placed::typical(find("link_inertia_error").unwrap(), 1).absent();
        assert!(is_believable(&robot, &error));
        error.parameters[1] = 0.1;
        assert!(is_believable(&robot, &error));
        // A centre of mass two metres behind the joint.
        error.parameters[1] = -2.0 * robot.joints[1].inertia.mass() - robot.joints[1].inertia.first_moment().x;
        assert!(!is_believable(&robot, &error));
        error.parameters = vec![-1e3, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        assert!(!is_believable(&robot, &error));
    }

    #[test]
    fn hoses_do_not_carry_the_arm() {
        assert!(largest_share(&Placed::typical(find("joint_spring").unwrap(), 1)).unwrap() < 1.0);
        assert_eq!(largest_share(&Placed::typical(find("gravity_balancer").unwrap(), 1)), None);
    }

    #[test]
    fn priors_scale_with_the_link() {
        let robot = arm();
        let spread = inertial_prior(&robot, &Placed::typical(find("link_inertia_error").unwrap(), 2));
        assert_eq!(spread[0], robot.joints[2].inertia.mass());
        assert!((spread[4] * spread[0] / spread[1].powi(2) - 1.0).abs() < 1e-12);
        assert_eq!(inertial_prior(&robot, &Placed::typical(find("torque_gain").unwrap(), 2)), [f64::INFINITY]);
    }
}
