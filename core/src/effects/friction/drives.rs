//! The friction that the description of an arm gives its drives.

use super::{CoulombFriction, ViscousFriction};
use crate::effects::Placed;
use crate::robot::Robot;

/// The friction of an arm's drives as effects; what is not above zero is left out.
pub fn drive_friction(robot: &Robot) -> Vec<Placed> {
    robot
        .joints
        .iter()
        .enumerate()
        .flat_map(|(joint, spec)| {
            [
                Placed { effect: &ViscousFriction, joint, parameters: vec![spec.drive.viscous] },
                Placed { effect: &CoulombFriction, joint, parameters: vec![spec.drive.coulomb] },
            ]
        })
        .filter(|placed| placed.parameters[0] > 0.0)
        .collect()
}
