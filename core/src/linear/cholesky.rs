//! Cholesky factors by faer, whose blocks are several times faster than nalgebra's columns from about twenty columns on.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{LltRegularization, cholesky_in_place, cholesky_in_place_scratch};
use faer::linalg::cholesky::llt::inverse::{inverse, inverse_scratch};
use faer::linalg::cholesky::llt::solve::solve_in_place;
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::{MatMut, MatRef, Par, Spec};
use nalgebra::{DMatrix, DVector};

/// A positive definite matrix, as its lower triangular factor.
pub(crate) struct Cholesky {
    /// The factor; what is above its diagonal has no meaning.
    lower: DMatrix<f64>,
}

impl Cholesky {
    /// Factors a symmetric matrix, of which only the lower triangle is read; none where it is not positive definite.
    pub(crate) fn new(mut matrix: DMatrix<f64>) -> Option<Cholesky> {
        let size = matrix.nrows();
        let mut memory = MemBuffer::new(cholesky_in_place_scratch::<f64>(size, Par::Seq, Spec::default()));
        let own = MatMut::from_column_major_slice_mut(matrix.as_mut_slice(), size, size);
        let none = LltRegularization::default();
        cholesky_in_place(own, none, Par::Seq, MemStack::new(&mut memory), Spec::default()).ok()?;
        Some(Cholesky { lower: matrix })
    }

    /// What the matrix takes to `right`.
    pub(crate) fn solve(&self, right: &DVector<f64>) -> DVector<f64> {
        let mut solution = right.clone();
        self.solve_in_place(solution.as_mut_slice(), 1);
        solution
    }

    /// What the matrix takes to each column of `right`.
    pub(crate) fn solve_columns(&self, mut right: DMatrix<f64>) -> DMatrix<f64> {
        let columns = right.ncols();
        self.solve_in_place(right.as_mut_slice(), columns);
        right
    }

    fn solve_in_place(&self, right: &mut [f64], columns: usize) {
        let target = MatMut::from_column_major_slice_mut(right, self.lower.nrows(), columns);
        solve_in_place(self.factor(), target, Par::Seq, MemStack::new(&mut []));
    }

    /// What the lower triangular factor takes to each column of `right`.
    pub(crate) fn solve_lower(&self, mut right: DMatrix<f64>) -> DMatrix<f64> {
        let columns = right.ncols();
        let target = MatMut::from_column_major_slice_mut(right.as_mut_slice(), self.lower.nrows(), columns);
        solve_lower_triangular_in_place(self.factor(), target, Par::Seq);
        right
    }

    /// Logarithm of the determinant of the matrix.
    pub(crate) fn log_determinant(&self) -> f64 {
        2.0 * self.lower.diagonal().iter().map(|x| x.ln()).sum::<f64>()
    }

    /// The inverse of the matrix.
    pub(crate) fn inverse(&self) -> DMatrix<f64> {
        inverse_of_factored(&self.lower)
    }

    fn factor(&self) -> MatRef<'_, f64> {
        MatRef::from_column_major_slice(self.lower.as_slice(), self.lower.nrows(), self.lower.ncols())
    }
}

/// The inverse of a matrix of which the `lower` Cholesky factor is known; what is above its diagonal is not read.
pub(crate) fn inverse_of_factored(lower: &DMatrix<f64>) -> DMatrix<f64> {
    let size = lower.nrows();
    let mut out = DMatrix::zeros(size, size);
    let factor = MatRef::from_column_major_slice(lower.as_slice(), size, size);
    let target = MatMut::from_column_major_slice_mut(out.as_mut_slice(), size, size);
    let mut memory = MemBuffer::new(inverse_scratch::<f64>(size, Par::Seq));
    inverse(target, factor, Par::Seq, MemStack::new(&mut memory));
    out.fill_upper_triangle_with_lower_triangle();
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_solution_solves_and_an_inverse_inverts() {
        for size in [0, 1, 2, 7, 40, 90] {
            let half = DMatrix::from_fn(size, size, |r, c| (1 + r * 3 + c * 7) as f64 % 11.0 / 11.0);
            let matrix = half.transpose() * &half + DMatrix::identity(size, size);
            let right = DVector::from_fn(size, |r, _| (r as f64).sin());
            let factored = Cholesky::new(matrix.clone()).unwrap();
            assert!((&matrix * factored.solve(&right) - &right).amax() < 1e-10);
            assert!((&matrix * factored.inverse() - DMatrix::identity(size, size)).amax() < 1e-10);
            assert!((&matrix * factored.solve_columns(half.clone()) - &half).amax() < 1e-10);
            // The factor's solution has the inner products of the inverse.
            let solved = factored.solve_lower(half.clone());
            assert!((solved.tr_mul(&solved) - half.tr_mul(&(factored.inverse() * &half))).amax() < 1e-10);
            assert!((factored.log_determinant() - matrix.determinant().ln()).abs() < 1e-9 * (1.0 + size as f64));
        }
    }

    #[test]
    fn what_is_not_positive_definite_has_no_factor() {
        assert!(Cholesky::new(DMatrix::from_diagonal(&DVector::from_vec(vec![1.0, -1e-9]))).is_none());
        assert!(Cholesky::new(DMatrix::from_element(1, 1, f64::NAN)).is_none());
    }
}
