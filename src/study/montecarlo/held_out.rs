//! Torque error of estimates on the held-out motion, without going through its samples again.

use crate::error::Result;
use crate::identification::model::Model;
use crate::identification::prepare;
use crate::scenario::Setup;
use crate::simulation::Truth;
use nalgebra::{DMatrix, DVector};

/// Every n-th sample of the held-out motion is judged: neighbours hardly differ.
const EVERY: usize = 5;

/// Per joint the covariance, over the samples at which it moves, of its regressor columns and (last) its true torque along
/// the exact held-out motion. The variance of a torque error is a quadratic form in it.
pub(super) struct HeldOut {
    joints: Vec<(Vec<usize>, DMatrix<f64>)>,
}

impl HeldOut {
    /// From the exact held-out run.
    ///
    /// # Errors
    /// Those of the regression.
    pub(super) fn new(setup: &Setup, model: &Model, truth: &Truth) -> Result<Self> {
        let band = setup.scenario.identification.reversal_band_rad_s;
        let rows = prepare::exact(&truth.time, &truth.signals, band).every(EVERY).regression(model)?;
        let joints = rows
            .into_iter()
            .map(|joint| {
                let count = joint.rows().max(1) as f64;
                let columns: Vec<&[f64]> = joint.columns.iter().chain([joint.torque.as_slice()]).collect();
                let centred: Vec<Vec<f64>> = columns
                    .iter()
                    .map(|column| {
                        let mean = column.iter().zip(&joint.valid).filter(|(_, ok)| **ok).map(|(v, _)| v).sum::<f64>();
                        let mean = mean / count;
                        column.iter().zip(&joint.valid).map(|(v, &ok)| if ok { v - mean } else { 0.0 }).collect()
                    })
                    .collect();
                let samples = joint.torque.len();
                let matrix = DMatrix::from_row_slice(centred.len(), samples, &centred.concat());
                (joint.parameters.clone(), &matrix * matrix.transpose() / count)
            })
            .collect();
        Ok(HeldOut { joints })
    }

    /// Standard deviation per joint, N m, of predicted minus true torque: of the simulated plant, or of an arm with the
    /// base parameters `truth` where given.
    pub(super) fn torque_std(&self, beta: &[f64], truth: Option<&[f64]>) -> Vec<f64> {
        self.joints
            .iter()
            .map(|(parameters, covariance)| {
                let weights = parameters.iter().map(|&p| beta[p] - truth.map_or(0.0, |truth| truth[p]));
                let torque = if truth.is_some() { 0.0 } else { -1.0 };
                let weights = DVector::from_iterator(parameters.len() + 1, weights.chain([torque]));
                (covariance * &weights).dot(&weights).max(0.0).sqrt()
            })
            .collect()
    }
}
