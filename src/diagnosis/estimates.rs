//! All parameters of the model with the effects found, fitted at once, with their covariance.

use super::column::Column;
use super::session::{Member, Session};
use super::whitening::Whitener;
use crate::error::Result;
use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// Smallest eigenvalue of the scaled normal matrix, over its largest, that still counts.
const SINGULAR: f64 = 1e-12;

/// The least-squares estimate on whitened training rows, in the order of [`Session::all_columns`].
#[derive(Debug, Clone)]
pub struct Estimates {
    /// Values of all parameters.
    pub values: Vec<f64>,
    /// Their covariance.
    pub covariance: DMatrix<f64>,
}

impl Estimates {
    /// Fits the model with `members`.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub fn new(session: &Session, members: &[Member], whitener: &Whitener) -> Result<Self> {
        let columns = whitener.apply_all(&session.all_columns(&session.train, members)?);
        let torque = whitener.apply(&session.train.torque);
        let right = DVector::from_iterator(columns.len(), columns.iter().map(|column| column.dot(&torque)));
        let covariance = inverse(gram(&columns));
        Ok(Estimates { values: (&covariance * right).as_slice().to_vec(), covariance })
    }
}

/// Inner products of all columns.
pub fn gram(columns: &[Column]) -> DMatrix<f64> {
    let mut gram = DMatrix::zeros(columns.len(), columns.len());
    for (r, one) in columns.iter().enumerate() {
        for (c, other) in columns.iter().enumerate().skip(r) {
            gram[(r, c)] = one.dot(other);
        }
    }
    gram.fill_lower_triangle_with_upper_triangle();
    gram
}

/// The inverse of a normal matrix; directions that it does not tell are left out.
fn inverse(gram: DMatrix<f64>) -> DMatrix<f64> {
    let scale: Vec<f64> = gram.diagonal().iter().map(|&v| if v > 0.0 { v.sqrt() } else { 1.0 }).collect();
    let unit = DMatrix::from_fn(gram.nrows(), gram.ncols(), |r, c| gram[(r, c)] / (scale[r] * scale[c]));
    let eigen = SymmetricEigen::new(unit);
    let least = SINGULAR * eigen.eigenvalues.max();
    let weights = eigen.eigenvalues.map(|value| if value > least { 1.0 / value } else { 0.0 });
    let unit = &eigen.eigenvectors * DMatrix::from_diagonal(&weights) * eigen.eigenvectors.transpose();
    DMatrix::from_fn(unit.nrows(), unit.ncols(), |r, c| unit[(r, c)] / (scale[r] * scale[c]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverse_leaves_out_what_is_not_told() {
        // The second and third column are one.
        let columns = [vec![2.0, 0.0], vec![0.0, 1.0], vec![0.0, 1.0]].map(|values| Column::on(0, values));
        let inverse = inverse(gram(&columns));
        let expected = [[0.25, 0.0, 0.0], [0.0, 0.25, 0.25], [0.0, 0.25, 0.25]];
        for (r, row) in expected.iter().enumerate() {
            for (c, value) in row.iter().enumerate() {
                assert!((inverse[(r, c)] - value).abs() < 1e-12, "{inverse}");
            }
        }
    }
}
