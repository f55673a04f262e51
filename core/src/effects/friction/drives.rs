//! The friction that the description of an arm gives its drives.

use super::{CoulombFriction, ViscousFriction};
use crate::effects::{Effect, Placed};
use crate::robot::Robot;

/// The laws of a drive's friction: viscous and Coulomb.
pub(crate) fn laws_of_drive() -> [&'static dyn Effect; 2] {
    [&ViscousFriction, &CoulombFriction]
}

/// The friction of an arm's drives as effects; what is not above zero is left out.
pub fn drive_friction(robot: &Robot) -> Vec<Placed> {
    robot
        .joints
        .iter()
        .enumerate()
        .flat_map(|(joint, spec)| {
            let coefficients = [spec.drive.viscous, spec.drive.coulomb];
            let laws = laws_of_drive().into_iter().zip(coefficients);
            laws.map(move |(effect, coefficient)| Placed { effect, joint, parameters: vec![coefficient] })
        })
        .filter(|placed| placed.parameters[0] > 0.0)
        .collect()
}
