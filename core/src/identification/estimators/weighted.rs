//! Weighted least squares, the estimator of the main job.

use super::{Data, Estimator};
use crate::error::Result;
use crate::identification::regression::least_squares::{Estimate, weighted_least_squares};

/// Rows weighted by the standard deviation of their joint's residual (Gautier 1997).
#[derive(Debug, Clone, Copy)]
pub(crate) struct WeightedLeastSquares;

impl Estimator for WeightedLeastSquares {
    fn name(&self) -> &'static str {
        "wls"
    }

    fn title(&self) -> &'static str {
        "weighted least squares"
    }

    fn estimate(&self, data: &Data) -> Result<Estimate> {
        weighted_least_squares(data.rows, data.names)
    }
}
