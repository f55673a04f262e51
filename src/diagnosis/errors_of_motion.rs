//! What errors of the positions put into the torque of every joint: columns that stand beside what is tested.

use super::arm::Arm;
use super::column::Column;
use super::roles::is_level;
use super::rows::Rows;
use crate::effects::Placed;
use crate::error::Result;

/// Columns of the errors of one kind of logs, for the arm as found. None before anything was fitted.
#[derive(Debug, Clone, Default)]
pub struct ErrorsOfMotion {
    /// The error of the smoothing, on each joint.
    pub smoothing: Vec<Column>,
    /// What the positions hold beyond what is smooth, on each joint; none where no less would do.
    pub beyond: Vec<Column>,
    /// The second derivative of the torque, on each joint: what shifts or spreads torque in time holds it, and the noise of the
    /// encoders is in it always the same way as in the torque (errors in variables: Fuller, Measurement Error Models, 1987).
    pub bend: Vec<Column>,
}

impl ErrorsOfMotion {
    /// Along the motion of `rows`.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub fn new(arm: &Arm, rows: &Rows) -> Result<Self> {
        let is_smoother = rows.logs.iter().any(|log| log.whole.is_some());
        Ok(ErrorsOfMotion {
            smoothing: of_joints(arm.smoothing_error(rows)?),
            beyond: if is_smoother { of_joints(arm.beyond_smoothing(rows)) } else { Vec::new() },
            bend: of_joints(arm.bend(rows)?),
        })
    }

    /// All of them.
    pub fn all(&self) -> Vec<Column> {
        self.smoothing.iter().chain(&self.beyond).chain(&self.bend).cloned().collect()
    }

    /// Those that stand beside an effect: none where torque is cut off, since the smoothing errs there too; not the second
    /// derivative of the torque beside an elastic gear, whose column that is.
    pub fn beside(&self, placed: &Placed) -> Vec<Column> {
        if is_level(placed.effect) {
            Vec::new()
        } else if placed.effect.gear(&placed.parameters).is_some() {
            self.smoothing.iter().chain(&self.beyond).cloned().collect()
        } else {
            self.all()
        }
    }
}

fn of_joints(column: Column) -> Vec<Column> {
    column.parts.into_iter().map(|(joint, signal)| Column::on(joint, signal)).collect()
}
