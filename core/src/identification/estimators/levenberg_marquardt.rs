//! The weighted regression by Levenberg-Marquardt steps from a start, as the paper's equations (11)-(12) have it.

use super::covariance::assemble;
use super::{Data, Estimator};
use crate::error::{Error, Result};
use crate::identification::levenberg_marquardt::{Options, minimize};
use crate::identification::regression::least_squares::{Estimate, REWEIGHTINGS, require_rows, residual_sigma};
use crate::identification::regression::linear_problem::LinearProblem;

/// The minimum that weighted least squares names in one step, reached by damped steps from the start.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LevenbergMarquardt;

impl Estimator for LevenbergMarquardt {
    fn name(&self) -> &'static str {
        "lm"
    }

    fn title(&self) -> &'static str {
        "Levenberg-Marquardt on the weighted regression"
    }

    fn estimate(&self, data: &Data) -> Result<Estimate> {
        require_rows(data.rows)?;
        let mut sigma = vec![1.0; data.rows.len()];
        let mut beta = data.start.to_vec();
        for round in 0..=REWEIGHTINGS {
            let mut problem = LinearProblem::new(data.rows, &sigma, beta.len());
            let fit = minimize(&mut problem, &beta, &Options::default())?;
            if !fit.stop.converged() {
                let problem = format!("has not converged after {} steps ({:?})", fit.iterations, fit.stop);
                return Err(Error::request(self.name(), problem));
            }
            beta = fit.parameters;
            if round < REWEIGHTINGS {
                sigma = residual_sigma(data.rows, &beta);
            }
        }
        assemble(data.rows, data.rows, beta, &sigma, data.names)
    }
}
