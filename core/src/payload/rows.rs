//! A log as regression rows: states, torque, and the columns of the arm and of the load.

use super::load_columns::LoadColumns;
use crate::channels::Channels;
use crate::error::Result;
use crate::identification::equal_states::States;
use crate::identification::joint_regression::JointRegression;
use crate::identification::model::Model;
use crate::identification::prepare::{self, Smoothing};
use crate::identification::reversals::Band;
use crate::identification::smoothing_choice::{USUAL_ORDER, usual_window};
use crate::recording::Recording;
use crate::signal::downsample;

/// Rows in a smoothing window: the next row adds little that the filter has not mixed into this one.
const ROWS_IN_A_WINDOW: usize = 12;

/// The rows of one log.
#[derive(Debug)]
pub(super) struct LogRows {
    /// Time of every row, s.
    pub time: Vec<f64>,
    /// Positions and velocities.
    pub states: States,
    /// Columns of the base parameters, with torque and the rows that count.
    pub arm: Vec<JointRegression>,
    /// Columns of the load, `[parameter][row]` per joint.
    pub load: Vec<Channels>,
}

impl LogRows {
    /// Of a log at even steps, smoothed over the usual window.
    ///
    /// # Errors
    /// If the log is too short for the window.
    pub(super) fn new(log: &Recording, model: &Model, load: &LoadColumns) -> Result<Self> {
        let window = usual_window(log.rate_hz());
        let decimation = (window / ROWS_IN_A_WINDOW).max(1);
        let smoothing = Smoothing::SavitzkyGolay { window, order: USUAL_ORDER, decimation };
        let prepared = prepare::measured(log, smoothing, Band::OfNoise)?;
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
