//! The normal equations of a regression with every column at unit length: which parameters are separable, and the solution.

use super::spectrum::Spectrum;
use crate::error::{Error, Result};
use crate::linear::inverse_of_factored;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn, SymmetricEigen};

/// Smallest eigenvalue of the scaled normal matrix, over its largest, that still counts as identifiable.
const SINGULAR: f64 = 1e-13;

/// The same for the singular values of a triangle, which are the eigenvalues' roots.
const SINGULAR_OF_TRIANGLE: f64 = 1e-8;

/// The first few of many names.
fn listed(names: &[&str]) -> String {
    const MOST: usize = 4;
    match names.len().checked_sub(MOST) {
        None | Some(0) => names.join("; "),
        Some(more) => format!("{}; and {more} more", names[..MOST].join("; ")),
    }
}

/// Normal matrix with unit diagonal, factored; the square root of its condition number is the regressor's.
pub(in crate::identification) struct ScaledNormal {
    scale: DVector<f64>,
    factor: Cholesky<f64, Dyn>,
    pub(in crate::identification) condition_number: f64,
}

impl ScaledNormal {
    pub(in crate::identification) fn new(normal: &DMatrix<f64>, names: &[String]) -> Result<Self> {
        let scale = unit_scale(normal.diagonal(), names)?;
        let mut unit = DMatrix::from_fn(normal.nrows(), normal.ncols(), |r, c| normal[(r, c)] * scale[r] * scale[c]);
        unit.fill_upper_triangle_with_lower_triangle();
        let [low, high] = Spectrum::of(&unit).ends();
        if low < SINGULAR * high {
            let eigen = SymmetricEigen::new(unit);
            return Err(tied(eigen.eigenvectors.column(eigen.eigenvalues.imin()).as_slice(), names));
        }
        let factor = Cholesky::new(unit)
            .ok_or_else(|| Error::request("normal equations", "not positive definite; use a richer motion"))?;
        Ok(ScaledNormal { scale, factor, condition_number: (high / low).sqrt() })
    }

    /// From the triangle R of the weighted rows, R'R = X'WX, which knows small singular values to more digits.
    ///
    /// # Errors
    /// Names the parameters that the motion does not separate.
    pub(in crate::identification) fn from_triangle(triangle: &DMatrix<f64>, names: &[String]) -> Result<Self> {
        let squares = DVector::from_iterator(names.len(), triangle.column_iter().map(|column| column.norm_squared()));
        let scale = unit_scale(squares, names)?;
        let unit = DMatrix::from_fn(names.len(), names.len(), |r, c| triangle[(r, c)] * scale[c]);
        let svd = unit.clone().svd(false, true);
        let (low, high) = (svd.singular_values.min(), svd.singular_values.max());
        if low < SINGULAR_OF_TRIANGLE * high {
            let weakest = svd.v_t.map(|v| v.row(svd.singular_values.imin()).transpose()).unwrap_or_default();
            return Err(tied(weakest.as_slice(), names));
        }
        Ok(ScaledNormal { scale, factor: Cholesky::pack_dirty(unit.transpose()), condition_number: high / low })
    }

    pub(in crate::identification) fn solve(&self, right: &DVector<f64>) -> DVector<f64> {
        self.factor.solve(&right.component_mul(&self.scale)).component_mul(&self.scale)
    }

    pub(in crate::identification) fn inverse(&self) -> DMatrix<f64> {
        let unit = inverse_of_factored(self.factor.l_dirty());
        DMatrix::from_fn(unit.nrows(), unit.ncols(), |r, c| unit[(r, c)] * self.scale[r] * self.scale[c])
    }
}

/// What brings columns of the given squared lengths to unit length.
fn unit_scale(squares: DVector<f64>, names: &[String]) -> Result<DVector<f64>> {
    let scale = squares.map(|d| if d > 0.0 { 1.0 / d.sqrt() } else { 0.0 });
    let still: Vec<&str> = scale.iter().zip(names).filter(|(s, _)| **s == 0.0).map(|(_, name)| name.as_str()).collect();
    if still.is_empty() {
        return Ok(scale);
    }
    Err(Error::request(listed(&still), "the motion does not excite this at all; move that joint"))
}

/// The error that the parameters of a `weakest` direction are not separable.
fn tied(weakest: &[f64], names: &[String]) -> Error {
    let mut order: Vec<usize> = (0..names.len()).collect();
    order.sort_by(|&a, &b| weakest[b].abs().total_cmp(&weakest[a].abs()));
    let tied: Vec<&str> = order
        .iter()
        .take_while(|&&i| weakest[i].abs() > 0.1 * weakest[order[0]].abs())
        .map(|&i| names[i].as_str())
        .collect();
    Error::request(
        listed(&tied),
        "the motion does not separate these parameters; use a richer motion (each joint with durations of its own)",
    )
}

/// Lower Cholesky factor of a matrix, found on its version with a unit diagonal.
pub(in crate::identification) fn unit_cholesky(matrix: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let size = matrix.diagonal().map(f64::sqrt);
    if size.iter().any(|s| !(s.is_finite() && *s > 0.0)) {
        return None;
    }
    let unit = DMatrix::from_fn(size.len(), size.len(), |i, j| matrix[(i, j)] / (size[i] * size[j]));
    Some(DMatrix::from_diagonal(&size) * unit.cholesky()?.l())
}
