//! Products of tall matrices. nalgebra works out `A^T B` as one inner product after the other, which runs at the speed of the memory;
//! faer's blocked product is several times faster.

use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};
use nalgebra::DMatrix;

/// `A^T B` of two matrices.
///
/// # Panics
/// If the numbers of rows differ.
pub(crate) fn transposed_product(a: &DMatrix<f64>, b: &DMatrix<f64>) -> DMatrix<f64> {
    assert_eq!(a.nrows(), b.nrows(), "matrices of as many rows are wanted");
    product_of(a.as_slice(), b.as_slice(), a.nrows(), [a.ncols(), b.ncols()])
}

/// The same of matrices of `rows` rows and so many `columns`, whose values are held one column after the other.
///
/// # Panics
/// If there are not as many values.
pub(crate) fn product_of(a: &[f64], b: &[f64], rows: usize, columns: [usize; 2]) -> DMatrix<f64> {
    let [left, right] = columns;
    let mut product = DMatrix::zeros(left, right);
    let out = MatMut::from_column_major_slice_mut(product.as_mut_slice(), left, right);
    let [a, b] = [(a, left), (b, right)].map(|(values, own)| MatRef::from_column_major_slice(values, rows, own));
    matmul(out, Accum::Replace, a.transpose(), b, 1.0, Par::Seq);
    product
}

/// Takes `A B` from `target`, both of `rows` rows and held one column after the other.
///
/// # Panics
/// If there are not as many values.
pub(crate) fn subtract_product(target: &mut [f64], a: &[f64], rows: usize, b: &DMatrix<f64>) {
    let out = MatMut::from_column_major_slice_mut(target, rows, b.ncols());
    let a = MatRef::from_column_major_slice(a, rows, b.nrows());
    let b = MatRef::from_column_major_slice(b.as_slice(), b.nrows(), b.ncols());
    matmul(out, Accum::Add, a, b, -1.0, Par::Seq);
}

/// The Gram matrix `A^T A`.
pub(crate) fn gram_matrix(a: &DMatrix<f64>) -> DMatrix<f64> {
    transposed_product(a, a)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_are_sums_over_the_rows() {
        for (rows, left, right) in [(1, 1, 1), (5, 3, 2), (40, 7, 19), (0, 2, 3)] {
            let a = DMatrix::from_fn(rows, left, |r, c| (1 + r * 3 + c * 7) as f64 % 11.0);
            let b = DMatrix::from_fn(rows, right, |r, c| (2 + r * 5 + c * 2) as f64 % 13.0);
            let product = transposed_product(&a, &b);
            // Sums of whole numbers are exact.
            let expected = DMatrix::from_fn(left, right, |i, k| (0..rows).map(|r| a[(r, i)] * b[(r, k)]).sum::<f64>());
            assert_eq!(product, expected);
            assert_eq!(gram_matrix(&b), transposed_product(&b, &b));
            let mut target = &a * &product;
            subtract_product(target.as_mut_slice(), a.as_slice(), rows, &product);
            assert_eq!(target, DMatrix::zeros(rows, right));
        }
    }
}
