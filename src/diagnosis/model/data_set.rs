//! The training or the held-out logs with what every fit needs of them.

use super::errors_in_variables::{ErrorsInVariables, Nuisances};
use super::known::Known;
use super::roles::is_shift;
use crate::diagnosis::logs::Rows;
use crate::diagnosis::regression::Column;
use crate::effects::Placed;
use crate::error::Result;
use crate::identification::model::Model;

/// A data set, training or held-out, with all that is the same for every fit.
#[derive(Debug, Clone)]
pub struct DataSet {
    /// The rows.
    pub rows: Rows,
    /// Columns of the baseline.
    pub baseline: Vec<Column>,
    /// Measured torque less that which is known.
    pub torque: Column,
    /// Errors in variables: torque from errors of the positions, for the arm as last settled.
    pub errors: ErrorsInVariables,
    /// Torque of what the positions hold above the likeliest cut-offs, which is motion in part and noise in part.
    pub bands: Vec<Column>,
    /// Whether it is the training set.
    pub training: bool,
}

impl DataSet {
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
        Ok(DataSet { baseline, torque, rows, errors: ErrorsInVariables::default(), bands: Vec::new(), training })
    }

    /// Nuisance regressors that a test of an effect is adjusted for: for one that shifts torque in time also the bands, since the noise
    /// in them is in the torque against the accelerations.
    pub fn errors_with(&self, placed: &Placed) -> Nuisances {
        let mut errors = self.errors.of_effect(placed, &self.rows);
        if is_shift(placed.effect) {
            errors.add(&self.bands, f64::INFINITY);
        }
        errors
    }

    /// These logs, and those of another data set after them.
    pub fn and(&self, other: &DataSet) -> DataSet {
        let lengths = [self.rows.len(), other.rows.len()];
        let joined = |own: &[Column], others: &[Column]| -> Vec<Column> {
            own.iter().zip(others).map(|(own, other)| own.then(other, lengths)).collect()
        };
        DataSet {
            baseline: joined(&self.baseline, &other.baseline),
            bands: joined(&self.bands, &other.bands),
            torque: self.torque.then(&other.torque, lengths),
            rows: self.rows.and(&other.rows),
            errors: ErrorsInVariables::default(),
            training: self.training,
        }
    }
}
