//! Total least squares: errors in the columns as well as in the torque (Golub and Van Loan 1980; Van Huffel and Vandewalle,
//! "The total least squares problem", 1991).

use super::covariance::assemble;
use super::{Data, Estimator};
use crate::error::{Error, Result};
use crate::identification::regression::joint_regression::JointRegression;
use crate::identification::regression::least_squares::{Estimate, weighted_least_squares};
use nalgebra::{DMatrix, SymmetricEigen};

/// The smallest singular direction of rows and torque side by side, rows weighted as weighted least squares does and
/// columns scaled to unit length, since what errors the columns have is not known.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TotalLeastSquares;

impl Estimator for TotalLeastSquares {
    fn name(&self) -> &'static str {
        "tls"
    }

    fn title(&self) -> &'static str {
        "total least squares"
    }

    fn estimate(&self, data: &Data) -> Result<Estimate> {
        let weighted = weighted_least_squares(data.rows, data.names)?;
        let gram = augmented(data.rows, &weighted.sigma, data.names.len());
        let last = gram.nrows() - 1;
        let scale = gram.diagonal().map(|d| 1.0 / d.sqrt());
        let unit = DMatrix::from_fn(last + 1, last + 1, |r, c| gram[(r, c)] * scale[r] * scale[c]);
        let eigen = SymmetricEigen::new(unit);
        let smallest = eigen.eigenvectors.column(eigen.eigenvalues.imin());
        let torque = smallest[last] * scale[last];
        let beta: Vec<f64> = (0..last).map(|k| -smallest[k] * scale[k] / torque).collect();
        if beta.iter().any(|value| !value.is_finite()) {
            let problem =
                "the columns nearly depend on each other, so that errors in them explain all; use a richer motion";
            return Err(Error::request(self.name(), problem));
        }
        assemble(data.rows, data.rows, beta, &weighted.sigma, data.names)
    }
}

/// Gram matrix of the weighted rows with the torque as one more column.
fn augmented(rows: &[JointRegression], sigma: &[f64], parameters: usize) -> DMatrix<f64> {
    let mut gram = DMatrix::zeros(parameters + 1, parameters + 1);
    for (joint, s) in rows.iter().zip(sigma) {
        let mut with_torque = joint.clone();
        with_torque.append(parameters, &joint.torque, 0.0);
        with_torque.add_gram(1.0 / (s * s), &mut gram);
    }
    gram
}
