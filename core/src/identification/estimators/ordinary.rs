//! Ordinary least squares.

use super::covariance::assemble;
use super::{Data, Estimator};
use crate::error::Result;
use crate::identification::regression::least_squares::{Estimate, require_rows, weighted_solution};

/// All rows alike, whatever their joint.
#[derive(Debug, Clone, Copy)]
pub(crate) struct OrdinaryLeastSquares;

impl Estimator for OrdinaryLeastSquares {
    fn name(&self) -> &'static str {
        "ols"
    }

    fn title(&self) -> &'static str {
        "ordinary least squares"
    }

    fn estimate(&self, data: &Data) -> Result<Estimate> {
        require_rows(data.rows)?;
        let alike = vec![1.0; data.rows.len()];
        let beta = weighted_solution(data.rows, &alike, data.names)?;
        assemble(data.rows, data.rows, beta, &alike, data.names)
    }
}
