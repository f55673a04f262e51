//! The arm as its description has it, against the held-out logs.

use crate::diagnosis::model::Session;
use crate::diagnosis::regression::{Column, combined};
use crate::effects::Placed;
use crate::error::Result;
use crate::identification::effect_model::{Arm, Trust};
use crate::identification::model::Model;
use crate::robot::Robot;

/// Residual of the arm as described, with the effects that the simulation has, on the held-out logs.
pub(super) fn as_described(session: &Session, present: &[Placed]) -> Result<Column> {
    let (rows, robot) = (&session.logs.test.rows, session.model.base.robot());
    let mut residual = Column::new(rows.torque.iter().cloned());
    let described = Arm::new(robot, Trust::Nominal);
    residual.add(-1.0, &described.described_torque(rows));
    let baseline = described.baseline(session.model.base, rows);
    residual.add(-1.0, &combined(&baseline, &drives(session.model.base, robot)));
    for torque in described.added_throughout(present, rows)? {
        residual.add(-1.0, &torque);
    }
    Ok(residual)
}

/// Friction and rotors of the URDF in the order of a trusted arm's baseline.
fn drives(model: &Model, robot: &Robot) -> Vec<f64> {
    let standard = Model::standard_values(robot);
    let friction = (0..model.base().len()).filter(|&b| model.is_friction(b)).map(|b| standard[model.base().kept()[b]]);
    let rotors = robot.joints.iter().enumerate().filter(|(joint, _)| model.has_equation(*joint));
    friction.chain(rotors.map(|(_, joint)| joint.drive.armature)).collect()
}
