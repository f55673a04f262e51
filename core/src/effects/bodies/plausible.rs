//! What is known of the bodies of an arm before they are measured: the order of their masses and sizes.
//!
//! A link that differs from its description is still about that link: its mass of the same order, its centre of mass within
//! its length. Without that a wrong link explains what a balancer or a spring does, by a mass behind the joint.

use crate::effects::Limit;
use crate::robot::{Inertia, Robot};

/// Shortest length that counts for a link, m.
const SHORTEST_M: f64 = 0.1;

/// How many times its mass a link may weigh more than described, and how far from its joint its centre of mass may lie.
pub(super) static LIMITS_OF_LINK: [Limit; 2] = [
    Limit::most("mass added, over that of the description", 3.0),
    Limit::most("distance of the centre of mass from the joint, over the length of the link", 1.25),
];

/// Least mass of a link over that of the arm, and of an arm, kg.
const LIGHTEST_SHARE: f64 = 0.01;
const LIGHTEST_ARM_KG: f64 = 1.0;

/// Prior standard deviations of the ten parameters of a body of some mass, kg, and length, m.
pub(super) fn spread(mass: f64, length: f64) -> Vec<f64> {
    let of = |k: usize| match k {
        0 => mass,
        1..=3 => mass * length,
        _ => mass * length * length,
    };
    (0..10).map(of).collect()
}

/// The mass that a link `after` a change has more than before, or the distance of its centre of mass, over their limits; infinite without
/// mass.
pub(super) fn over_limit(after: &Inertia, robot: &Robot, joint: usize) -> f64 {
    if after.mass() > 0.0 {
        let [heavier, reach] = &LIMITS_OF_LINK;
        let added = (after.mass() - robot.joints[joint].inertia.mass()) / mass(robot, joint);
        let distance = after.first_moment().norm() / after.mass();
        heavier.over(added).max(reach.over(distance / length(robot, joint)))
    } else {
        f64::INFINITY
    }
}

/// Mass that a link may be taken for, kg; one that is described as next to nothing is a part of the arm all the same.
pub(super) fn mass(robot: &Robot, joint: usize) -> f64 {
    robot.joints[joint].inertia.mass().max(LIGHTEST_SHARE * arm_mass(robot))
}

/// Mass of all links, kg.
pub(super) fn arm_mass(robot: &Robot) -> f64 {
    robot.joints.iter().map(|joint| joint.inertia.mass()).sum::<f64>().max(LIGHTEST_ARM_KG)
}

/// Length of a link: how far the next joint or its own centre of mass lies from its joint, m.
pub(super) fn length(robot: &Robot, joint: usize) -> f64 {
    let next = robot.joints.get(joint + 1).map_or(0.0, |next| next.origin.translation.norm());
    let inertia = &robot.joints[joint].inertia;
    let center = if inertia.mass() > 0.0 { inertia.first_moment().norm() / inertia.mass() } else { 0.0 };
    next.max(center).max(SHORTEST_M)
}

#[cfg(test)]
mod tests {
    use super::{LIMITS_OF_LINK, length};
    use crate::effects::{Placed, find};
    use crate::robot::{InertiaCheck, Robot, load};

    fn arm() -> Robot {
        load(concat!(env!("CARGO_MANIFEST_DIR"), "/../urdf/irb1600_6_120.urdf"), InertiaCheck::Required).unwrap()
    }

    #[test]
    fn a_balancer_is_no_link() {
        let robot = arm();
        let mut error = Placed::typical(find("link_inertia_error").unwrap(), 1).absent();
        let over_limit = |error: &Placed| error.effect.over_limit(&error.parameters, error.joint, &robot);
        assert!(over_limit(&error) <= 1.0);
        error.parameters[1] = 0.1;
        assert!(over_limit(&error) <= 1.0);
        // A centre of mass two metres behind the joint.
        error.parameters[1] = -2.0 * robot.joints[1].inertia.mass() - robot.joints[1].inertia.first_moment().x;
        let reach = LIMITS_OF_LINK[1].over(2.0 / length(&robot, 1));
        assert!(over_limit(&error) >= reach && reach > 1.0);
        // Three times its mass more is the most; without mass there is no link.
        let masses = |change: f64| vec![change, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        error.parameters = masses((1.0 + 1e-9) * 3.0 * robot.joints[1].inertia.mass());
        assert!((over_limit(&error) - 1.0).abs() < 1e-8 && over_limit(&error) > 1.0);
        error.parameters = masses(-1e3);
        assert_eq!(over_limit(&error), f64::INFINITY);
    }

    #[test]
    fn an_encoder_errs_by_degrees_at_most() {
        let eccentricity = find("encoder_eccentricity").unwrap();
        let over_limit = |sine: f64, cosine: f64| eccentricity.over_limit(&[sine, cosine], 1, &arm());
        assert!(over_limit(0.03, -0.0399) < 1.0 && over_limit(0.03, -0.0401) > 1.0);
    }

    #[test]
    fn play_below_the_noise_of_encoders_is_none() {
        let over_limit = |half_gap: f64| find("backlash").unwrap().over_limit(&[half_gap], 1, &arm());
        assert_eq!([over_limit(5e-6), over_limit(1e-5), over_limit(0.0)], [1.0, 0.5, f64::INFINITY]);
        assert!(over_limit(4.99e-6) > 1.0);
    }

    #[test]
    fn hoses_do_not_carry_the_arm() {
        assert!(find("joint_spring").unwrap().largest_share().unwrap() < 1.0);
        assert!(find("gravity_balancer").unwrap().largest_share().unwrap() > 1.0);
    }

    #[test]
    fn priors_scale_with_the_link() {
        let robot = arm();
        let spread = find("link_inertia_error").unwrap().prior(2, &robot).unwrap();
        assert_eq!(spread[0], robot.joints[2].inertia.mass());
        assert!((spread[4] * spread[0] / spread[1].powi(2) - 1.0).abs() < 1e-12);
        assert_eq!(find("torque_gain").unwrap().prior(2, &robot), None);
    }
}
