//! A log as regression rows: states, torque, and the columns of the arm and of the load.

use super::load_columns::LoadColumns;
use crate::channels::Channels;
use crate::error::Result;
use crate::identification::effect_model::Preparation;
use crate::identification::equal_states::States;
use crate::identification::joint_regression::JointRegression;
use crate::identification::model::Model;
use crate::identification::prepare;
use crate::recording::Recording;
use crate::signal::downsample;

/// The rows of one log.
#[derive(Debug)]
pub(super) struct LogRows {
    /// Time of every row, s.
    pub time: Vec<f64>,
    /// Positions and velocities.
    pub states: States,
    /// Columns of the base parameters, with torque and the valid rows.
    pub arm: Vec<JointRegression>,
    /// Columns of the load, `[parameter][row]` per joint.
    pub load: Vec<Channels>,
}

impl LogRows {
    /// The rows of a log at even steps, smoothed over the usual window.
    ///
    /// # Errors
    /// If the log is too short for the window.
    pub(super) fn new(log: &Recording, model: &Model, load: &LoadColumns) -> Result<Self> {
        let Preparation { smoothing, band } = Preparation::usual(log);
        let decimation = smoothing.decimation();
        let prepared = prepare::measured(log, &smoothing, band)?;
        let thinned = |table: &Channels| -> Result<Channels> {
            let channels = table.iter().map(|channel| downsample(channel, decimation)).collect::<Result<Vec<_>>>()?;
            Ok(Channels::from_vectors(&channels))
        };
        let mut arm = prepared.regression(model)?;
        for (joint, rows) in arm.iter_mut().enumerate() {
            let has_equation = model.has_equation(joint);
            rows.valid.iter_mut().zip(&rows.torque).for_each(|(ok, torque)| *ok &= has_equation && torque.is_finite());
        }
        Ok(LogRows {
            time: downsample(&prepared.time, decimation)?,
            states: States { q: thinned(&prepared.motion.q)?, qd: thinned(&prepared.motion.qd)? },
            arm,
            load: prepared.regression(load)?.into_iter().map(|joint| joint.columns).collect(),
        })
    }

    /// The block of a row, counted from the beginning of the log.
    pub(super) fn block(&self, row: usize, block_s: f64) -> usize {
        ((self.time[row] - self.time[0]) / block_s).floor() as usize
    }
}
