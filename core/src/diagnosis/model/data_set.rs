//! The training or the held-out logs with what every fit needs of them.

use super::arm_columns::Moved;
use super::effect_columns::EffectColumns;
use super::known::Known;
use crate::diagnosis::logs::Rows;
use crate::diagnosis::regression::Column;
use crate::effects::Placed;
use crate::error::Result;
use crate::identification::effect_model::Arm;
use crate::identification::model::Model;
use std::sync::Arc;

/// A data set, training or held-out, with all that is the same for every fit.
#[derive(Debug, Clone)]
pub struct DataSet {
    /// The rows.
    pub rows: Rows,
    /// Columns of the baseline.
    pub baseline: Vec<Column>,
    /// How many of the last of these are derivatives to parameters of known effects.
    pub known: usize,
    /// Measured torque less that which is known; differences from that before a change where its rows are such.
    pub torque: Column,
    /// Torque of what the positions hold in the bands, which is motion in part and noise in part.
    pub bands: Vec<Column>,
    /// Whether it is the training set.
    pub training: bool,
    /// Columns of effects worked out so far.
    pub(crate) effects: EffectColumns,
}

impl DataSet {
    /// Rows with what is `known` taken off.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub fn new(model: &Model, known: &Known, rows: Rows, training: bool) -> Result<Self> {
        let mut torque = Column::new(rows.torque.iter().cloned());
        torque.add(-1.0, &known.arm.described_torque(&rows));
        torque.add(-1.0, &known.torque(&rows)?);
        let mut baseline = known.arm.baseline(model, &rows);
        let derivatives = known.derivatives(&rows)?;
        let known = derivatives.len();
        baseline.extend(derivatives);
        Ok(DataSet { baseline, known, torque, rows, bands: Vec::new(), training, effects: EffectColumns::default() })
    }

    /// Columns of placed effects, one group each, of which each acts in one log only, or in all.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub(crate) fn columns(
        &self,
        arm: &Arm,
        log: Option<usize>,
        placed: &[Placed],
        moved: Moved,
    ) -> Result<Vec<Arc<Vec<Column>>>> {
        self.effects.get(arm, &self.rows, log, placed, moved)
    }

    /// Torque less `columns` with their `values`.
    pub fn residual(&self, columns: &[Column], values: &[f64]) -> Column {
        let mut residual = self.torque.clone();
        columns.iter().zip(values).for_each(|(column, value)| residual.add(-value, column));
        residual
    }

    /// These logs, and those of another data set after them.
    pub fn and(&self, other: &DataSet) -> DataSet {
        let lengths = [self.rows.len(), other.rows.len()];
        let joined = |own: &[Column], others: &[Column]| -> Vec<Column> {
            own.iter().zip(others).map(|(own, other)| own.then(other, lengths)).collect()
        };
        DataSet {
            baseline: joined(&self.baseline, &other.baseline),
            known: self.known,
            bands: joined(&self.bands, &other.bands),
            torque: self.torque.then(&other.torque, lengths),
            rows: self.rows.and(&other.rows),
            training: self.training,
            effects: EffectColumns::default(),
        }
    }
}
