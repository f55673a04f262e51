//! Logs made ready to be fitted.

use super::data_set::DataSet;
use crate::diagnosis::logs::LowPass;
use crate::diagnosis::regression::Column;
use std::ops::Range;

/// Logs that every model is fitted to and judged by. Who reads them changes nothing; the session that holds them does, by its methods
/// (`session/changes`) alone. It leaves out rows near the ends of an event or near impacts of gears, takes other low-passes, other roundings
/// of friction and the bands of the encoders' noise. A search that finds gears with play, or a tilted base that shows moments of the first
/// body, goes on with others, which have more columns in the baselines ([`PreparedLogs::with`]).
#[derive(Debug, Clone)]
pub struct PreparedLogs {
    /// Training logs.
    pub train: DataSet,
    /// Held-out logs.
    pub test: DataSet,
    /// Places of the columns in the baselines of torque that the noise of encoders makes: of the band of each joint, and what its controller
    /// answers to.
    pub bands: Range<usize>,
    /// Whether the held-out logs are others than those identified from.
    pub(in crate::diagnosis) apart: bool,
    /// Cut-off of the low-pass of each joint's positions, Hz.
    pub cutoffs_hz: Vec<f64>,
    /// The low-pass that torque went through before it was logged, if any.
    pub passband: Option<LowPass>,
}

impl PreparedLogs {
    /// White noise of the measured torque of a joint over a row, of the noisiest log of either kind, N m.
    pub(crate) fn sensor_noise(&self, joint: usize) -> f64 {
        self.train.rows.sensor_noise(joint, 1).max(self.test.rows.sensor_noise(joint, 1))
    }

    /// The same with more columns in the baselines of the training and of the held-out logs, the first at a place.
    pub(crate) fn with(mut self, place: usize, columns: &[Vec<Column>; 2]) -> Self {
        for (data, columns) in [&mut self.train, &mut self.test].into_iter().zip(columns) {
            data.baseline.splice(place..place, columns.iter().cloned());
        }
        self
    }

    /// The same with all logs to identify from.
    pub(crate) fn pooled(&self) -> Self {
        PreparedLogs {
            train: self.train.and(&self.test),
            test: self.test.clone(),
            bands: self.bands.clone(),
            apart: false,
            cutoffs_hz: self.cutoffs_hz.clone(),
            passband: self.passband,
        }
    }
}
