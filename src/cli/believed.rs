//! The arm of a URDF, as far as its inertias are believed.

use crate::error::{Error, Result};
use crate::identification::effect_model::Trust;
use crate::robot::{self, InertiaCheck, Robot};
use std::path::Path;

/// Share of the heaviest mass down to which one below zero is rounding of what wrote the file.
const ROUNDING: f64 = 1e-9;

/// Reads the arm. Believed inertias that no body has are reported and taken as they are: their torque is well defined.
///
/// # Errors
/// Those of [`robot::load`]; if inertias are to be believed and a mass is below zero, or there is none.
pub(super) fn load(path: &Path, trust: Trust) -> Result<Robot> {
    if trust == Trust::Structure {
        return robot::load(path, InertiaCheck::Ignored);
    }
    let robot = match robot::load(path, InertiaCheck::Required) {
        Ok(robot) => robot,
        Err(problem) => {
            let robot = robot::load(path, InertiaCheck::Ignored)?;
            let heaviest = robot.joints.iter().map(|joint| joint.inertia.mass()).fold(0.0, f64::max);
            if robot.joints.iter().any(|joint| joint.inertia.mass() < -ROUNDING * heaviest) {
                return Err(problem);
            }
            tracing::warn!("{problem}; they are taken as they are");
            robot
        }
    };
    if robot.joints.iter().all(|joint| joint.inertia.mass() == 0.0) {
        let problem = "no link that moves has a mass to trust; describe the inertias, or use --trust structure";
        return Err(Error::input(path, None, "inertial", problem));
    }
    Ok(robot)
}
