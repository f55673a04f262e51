//! Least squares on whitened columns, with directions that the rows cannot tell left at zero.

use super::column::Column;
use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// Smallest eigenvalue of the scaled normal matrix, over its largest, that still counts.
const SINGULAR: f64 = 1e-12;

/// A least-squares solution.
#[derive(Debug, Clone)]
pub struct Solved {
    /// Factors of the columns.
    pub values: Vec<f64>,
    /// Their standard deviations.
    pub std: Vec<f64>,
}

/// Fits whitened torque by whitened columns; directions that the rows cannot tell are left at zero.
pub fn solve(columns: &[Column], torque: &Column) -> Solved {
    let count = columns.len();
    let norms: Vec<f64> = columns.iter().map(|c| c.dot(c).sqrt()).map(|n| if n > 0.0 { n } else { 1.0 }).collect();
    let mut gram =
        DMatrix::from_fn(
            count,
            count,
            |r, c| {
                if r <= c { columns[r].dot(&columns[c]) / (norms[r] * norms[c]) } else { 0.0 }
            },
        );
    gram.fill_lower_triangle_with_upper_triangle();
    let right = DVector::from_fn(count, |k, _| columns[k].dot(torque) / norms[k]);
    let eigen = SymmetricEigen::new(gram);
    let least = SINGULAR * eigen.eigenvalues.max();
    let inverse = DVector::from_fn(count, |k, _| {
        let value = eigen.eigenvalues[k];
        if value > least { 1.0 / value } else { 0.0 }
    });
    let rotated = eigen.eigenvectors.tr_mul(&right).component_mul(&inverse);
    let values = &eigen.eigenvectors * rotated;
    let variance = |k: usize| -> f64 {
        eigen.eigenvectors.row(k).iter().zip(inverse.iter()).map(|(v, inverse)| v * v * inverse).sum()
    };
    Solved {
        values: values.iter().zip(&norms).map(|(value, norm)| value / norm).collect(),
        std: (0..count).map(|k| variance(k).sqrt() / norms[k]).collect(),
    }
}
