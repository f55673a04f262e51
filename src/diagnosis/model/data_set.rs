//! One kind of logs with what every fit needs of them.

use super::errors_in_variables::{ErrorsOfMotion, Nuisances};
use super::known::Known;
use super::roles::is_shift;
use crate::diagnosis::logs::Rows;
use crate::diagnosis::regression::Column;
use crate::effects::Placed;
use crate::error::Result;
use crate::identification::model::Model;

/// One kind of logs with all that is the same for every fit.
#[derive(Debug, Clone)]
pub struct Side {
    /// The rows.
    pub rows: Rows,
    /// Columns of the baseline.
    pub baseline: Vec<Column>,
    /// Measured torque less what is believed.
    pub torque: Column,
    /// What errors of the positions put into the torque of the arm as last settled.
    pub errors: ErrorsOfMotion,
    /// What the positions hold above the cut-offs that make the torque likeliest, which is motion in part and noise in part.
    pub bands: Vec<Column>,
    /// Whether it is identified from.
    pub training: bool,
}

impl Side {
    /// Rows with what is `known` taken off.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub fn new(model: &Model, known: &Known, rows: Rows, training: bool) -> Result<Self> {
        let mut torque = Column::new(rows.torque.iter().cloned());
        torque.add(-1.0, &known.arm.believed(&rows));
        torque.add(-1.0, &known.torque(&rows)?);
        let mut baseline = known.arm.baseline(model, &rows);
        baseline.extend(known.derivatives(&rows)?);
        Ok(Side { baseline, torque, rows, errors: ErrorsOfMotion::default(), bands: Vec::new(), training })
    }

    /// Columns of errors of the positions that stand beside an effect: beside what shifts torque in time also the bands, since the noise
    /// in them is in the torque against the accelerations.
    pub fn errors_beside(&self, placed: &Placed) -> Nuisances {
        let mut errors = self.errors.beside(placed, &self.rows);
        if is_shift(placed.effect) {
            errors.add(&self.bands, f64::INFINITY);
        }
        errors
    }

    /// These logs, and those of another kind after them.
    pub fn and(&self, other: &Side) -> Side {
        let lengths = [self.rows.len(), other.rows.len()];
        let joined = |own: &[Column], others: &[Column]| -> Vec<Column> {
            own.iter().zip(others).map(|(own, other)| own.then(other, lengths)).collect()
        };
        Side {
            baseline: joined(&self.baseline, &other.baseline),
            bands: joined(&self.bands, &other.bands),
            torque: self.torque.then(&other.torque, lengths),
            rows: self.rows.and(&other.rows),
            errors: ErrorsOfMotion::default(),
            training: self.training,
        }
    }
}
