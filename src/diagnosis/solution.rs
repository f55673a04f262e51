//! Least squares on whitened columns, with directions that the rows cannot tell left at zero.

use super::column::Column;
use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// Smallest eigenvalue of the scaled normal matrix, over its largest, that still counts.
const SINGULAR: f64 = 1e-12;

/// Share of a factor in directions that the rows cannot tell from which it is not told.
const UNTOLD: f64 = 1e-6;

/// A least-squares solution.
#[derive(Debug, Clone)]
pub struct Solved {
    /// Factors of the columns.
    pub values: Vec<f64>,
    /// Their standard deviations; infinite where the rows do not tell a factor from those of other columns, or at all.
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
        let shares: Vec<f64> = eigen.eigenvectors.row(k).iter().map(|v| v * v).collect();
        let of =
            |weight: &dyn Fn(f64) -> f64| -> f64 { shares.iter().zip(&inverse).map(|(s, &i)| s * weight(i)).sum() };
        let untold = of(&|inverse| if inverse == 0.0 { 1.0 } else { 0.0 });
        if untold > UNTOLD { f64::INFINITY } else { of(&|inverse| inverse) }
    };
    Solved {
        values: values.iter().zip(&norms).map(|(value, norm)| value / norm).collect(),
        std: (0..count).map(|k| variance(k).sqrt() / norms[k]).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_rows_do_not_tell_has_no_finite_deviation() {
        // The second and third column are one, the fourth is nothing.
        let columns = [vec![2.0, 0.0], vec![0.0, 1.0], vec![0.0, 1.0], vec![0.0, 0.0]].map(|v| Column::on(0, v));
        let solved = solve(&columns, &Column::on(0, vec![4.0, 3.0]));
        let expected = [2.0, 1.5, 1.5, 0.0];
        assert!(solved.values.iter().zip(expected).all(|(value, expected)| (value - expected).abs() < 1e-12));
        assert!((solved.std[0] - 0.5).abs() < 1e-12);
        assert!(solved.std[1..].iter().all(|std| *std == f64::INFINITY), "{:?}", solved.std);
    }
}
