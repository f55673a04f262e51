//! The torques of single bodies, whose masses may be others than those described.
//!
//! A mass that is described wrongly changes gravity and inertia of its body by one factor. So these columns keep the ratio of both, and
//! with it the second of a clock, whatever the masses are.

use crate::channels::Channels;
use crate::dynamics::{Chain, Motion, inverse_dynamics};
use crate::robot::{PARAMETERS, Robot};

/// The torque that each body makes as described, `[body][joint][row]`.
pub(crate) fn torques(robot: &Robot, gravity: [f64; 3], motion: &Motion) -> Vec<Channels> {
    let chain = Chain::new(robot).with_gravity(gravity);
    let all = robot.inertial_parameters();
    let of = |body: usize| {
        let mut own = vec![0.0; all.len()];
        let parameters = body * PARAMETERS..(body + 1) * PARAMETERS;
        own[parameters.clone()].copy_from_slice(&all[parameters]);
        inverse_dynamics(&chain, &own, motion)
    };
    (0..robot.bodies()).map(of).collect()
}

/// The torque that a controller takes off which knows the bodies as described: that of their gravity, with the opposite sign.
pub(super) fn compensation(robot: &Robot, motion: &Motion) -> Channels {
    let at_rest = Motion::at_rest(motion.q.clone());
    let gravity = inverse_dynamics(&Chain::new(robot), &robot.inertial_parameters(), &at_rest);
    gravity.map(|_, torque| torque.iter().map(|v| -v).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::{InertiaCheck, load};

    #[test]
    fn the_bodies_together_make_the_torque_of_the_arm() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../urdf/irb1600_6_120.urdf");
        let robot = load(path, InertiaCheck::Required).unwrap();
        let wave = |rate: f64| Channels::from_vectors(&vec![(0..9).map(|k| (rate * f64::from(k)).sin()).collect(); 6]);
        let motion = Motion { q: wave(0.4), qd: wave(0.7), qdd: wave(1.1) };
        let whole = inverse_dynamics(&Chain::new(&robot), &robot.inertial_parameters(), &motion);
        let each = torques(&robot, robot.gravity.into(), &motion);
        for (place, torque) in whole.as_slice().iter().enumerate() {
            let sum: f64 = each.iter().map(|own| own.as_slice()[place]).sum();
            assert!((sum - torque).abs() < 1e-9 * (1.0 + torque.abs()), "{sum} {torque}");
        }
        let at_rest = Motion::at_rest(motion.q.clone());
        let gravity = inverse_dynamics(&Chain::new(&robot), &robot.inertial_parameters(), &at_rest);
        let taken = compensation(&robot, &motion);
        assert!(gravity.as_slice().iter().zip(taken.as_slice()).all(|(gravity, taken)| gravity + taken == 0.0));
    }
}
