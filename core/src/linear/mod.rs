//! Linear algebra that several rooms share: an orthonormal basis of columns in their order, products of tall matrices, Cholesky factors.

mod cholesky;
mod product;

pub(crate) use cholesky::{Cholesky, inverse_of_factored};
pub(crate) use product::{gram_matrix, product_of, subtract_product, transposed_product};

use faer::linalg::solvers::Qr;
use faer::{Mat, MatRef};
use nalgebra::DMatrix;

/// An orthonormal basis of the span of some columns, by Householder's QR of columns of unit length.
#[derive(Debug, Clone)]
pub(crate) struct OrthonormalBasis {
    /// The columns that are kept, ascending: those of which more than a share is left over the ones kept before.
    pub kept: Vec<usize>,
    /// A direction for each of them, as long as the columns: that of what is left of the column.
    pub directions: Vec<Vec<f64>>,
    /// For each of them its part along every direction up to its own, whose part is positive; in units of the column's length.
    pub along: Vec<Vec<f64>>,
}

impl OrthonormalBasis {
    /// The basis of `columns` of one length, taken in their order: a column of which no more than `share` of its length is left over those
    /// kept before it is left out, and one that is zero or not finite.
    ///
    /// # Panics
    /// If the columns are not of one length.
    pub(crate) fn new(columns: &[&[f64]], share: f64) -> Self {
        let rows = columns.first().map_or(0, |column| column.len());
        assert!(columns.iter().all(|column| column.len() == rows), "columns of one length are wanted");
        let lengths: Vec<f64> = columns.iter().map(|column| length(column)).collect();
        let nonzero = |&k: &usize| lengths[k] > 0.0 && lengths[k].is_finite();
        let candidates: Vec<usize> = (0..columns.len()).filter(nonzero).collect();
        let factored = |chosen: &[usize]| {
            let unit = Mat::from_fn(rows, chosen.len(), |row, k| columns[chosen[k]][row] / lengths[chosen[k]]);
            Qr::new(unit.as_ref())
        };
        let mut qr = factored(&candidates);
        let kept: Vec<usize> = independent(qr.thin_R(), share).into_iter().map(|k| candidates[k]).collect();
        if kept.len() < candidates.len() {
            // The directions of columns that were left out are rounding.
            qr = factored(&kept);
        }
        let (q, r) = (qr.compute_thin_Q(), qr.thin_R());
        let sign = |k: usize| if r[(k, k)] < 0.0 { -1.0 } else { 1.0 };
        OrthonormalBasis {
            directions: (0..kept.len()).map(|k| (0..rows).map(|row| sign(k) * q[(row, k)]).collect()).collect(),
            along: (0..kept.len()).map(|k| (0..=k).map(|row| sign(row) * r[(row, k)]).collect()).collect(),
            kept,
        }
    }

    /// What the directions leave of a signal as long as the columns.
    pub(crate) fn residual(&self, signal: &[f64]) -> Vec<f64> {
        let mut rest = signal.to_vec();
        for direction in &self.directions {
            let along = inner_product(direction, &rest);
            rest.iter_mut().zip(direction).for_each(|(x, d)| *x -= along * d);
        }
        rest
    }
}

/// Householder's QR of columns with so many `rows`, held one after the other: orthonormal directions, held likewise, and the parts of the
/// columns along them, `[direction][column]`. There are as many directions as columns, or as rows where these are fewer.
///
/// # Panics
/// If the columns are not whole.
pub(crate) fn thin_qr(columns: &[f64], rows: usize) -> (Vec<f64>, DMatrix<f64>) {
    let count = columns.len().checked_div(rows).unwrap_or(0);
    if count == 0 {
        return (Vec::new(), DMatrix::zeros(0, 0));
    }
    let qr = Qr::new(MatRef::from_column_major_slice(columns, rows, count));
    let (q, r) = (qr.compute_thin_Q(), qr.thin_R());
    let directions = (0..q.ncols()).flat_map(|k| q.col(k).iter().copied().collect::<Vec<f64>>()).collect();
    (directions, DMatrix::from_fn(r.nrows(), count, |row, k| if row <= k { r[(row, k)] } else { 0.0 }))
}

/// The inner product, in several sums at once so that none waits for itself.
pub(crate) fn inner_product(a: &[f64], b: &[f64]) -> f64 {
    const TOGETHER: usize = 8;
    let (mut xs, mut ys) = (a.chunks_exact(TOGETHER), b.chunks_exact(TOGETHER));
    let mut sums = [0.0; TOGETHER];
    for (x, y) in (&mut xs).zip(&mut ys) {
        for (k, sum) in sums.iter_mut().enumerate() {
            *sum += x[k] * y[k];
        }
    }
    let rest: f64 = xs.remainder().iter().zip(ys.remainder()).map(|(x, y)| x * y).sum();
    sums.iter().sum::<f64>() + rest
}

/// Root mean square; zero of nothing.
pub fn root_mean_square(values: &[f64]) -> f64 {
    (values.iter().fold(0.0, |sum, x| sum + x * x) / values.len().max(1) as f64).sqrt()
}

/// Root of the sum of the squares.
pub(crate) fn length(signal: &[f64]) -> f64 {
    inner_product(signal, signal).sqrt()
}

/// The columns of a `triangle` of unit columns that have more than `share` beyond those before them that have it too.
fn independent(triangle: MatRef<f64>, share: f64) -> Vec<usize> {
    let mut rest = triangle.to_owned();
    let mut kept = Vec::new();
    // Column 0 of `rest` is column `column`, without its parts along the kept ones.
    for column in 0..triangle.ncols() {
        if rest.nrows() == 0 {
            break;
        }
        // `rest` is a triangle here, so that its first column has its length in the first place.
        let tail = rest.submatrix(0, 1, rest.nrows(), rest.ncols() - 1).to_owned();
        rest = if rest[(0, 0)].abs() > share {
            kept.push(column);
            tail.submatrix(1, 0, tail.nrows() - 1, tail.ncols()).to_owned()
        } else {
            // Without the column the others are one row from a triangle.
            Qr::new(tail.as_ref()).thin_R().to_owned()
        };
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random;
    use rand::RngExt;

    fn random_columns(count: usize, rows: usize) -> Vec<Vec<f64>> {
        let mut source = random::stream(11, "basis", count as u64);
        (0..count).map(|_| (0..rows).map(|_| source.random_range(-1.0..1.0)).collect()).collect()
    }

    fn basis(columns: &[Vec<f64>], share: f64) -> OrthonormalBasis {
        OrthonormalBasis::new(&columns.iter().map(Vec::as_slice).collect::<Vec<_>>(), share)
    }

    #[test]
    fn directions_are_orthonormal_and_give_the_columns_back() {
        for (count, rows) in [(1, 1), (7, 7), (20, 300)] {
            let columns = random_columns(count, rows);
            let basis = basis(&columns, 1e-8);
            assert_eq!(basis.kept.len(), count);
            for (i, a) in basis.directions.iter().enumerate() {
                for (j, b) in basis.directions.iter().enumerate() {
                    let expected = if i == j { 1.0 } else { 0.0 };
                    assert!((inner_product(a, b) - expected).abs() < 1e-13);
                }
                assert!(basis.along[i][i] > 0.0);
                assert!(length(&basis.residual(&columns[i])) < 1e-13 * length(&columns[i]));
                let made = basis.along[i].iter().zip(&basis.directions).fold(vec![0.0; rows], |mut sum, (part, d)| {
                    sum.iter_mut().zip(d).for_each(|(x, d)| *x += part * d);
                    sum
                });
                let size = length(&columns[i]);
                assert!(made.iter().zip(&columns[i]).all(|(made, x)| (made * size - x).abs() < 1e-13 * size));
            }
        }
    }

    #[test]
    fn thin_factors_give_the_columns_back() {
        for (count, rows) in [(0, 5), (3, 3), (4, 2), (20, 300)] {
            let columns = random_columns(count, rows).concat();
            let (directions, triangle) = thin_qr(&columns, rows);
            let kept = count.min(rows);
            assert_eq!((directions.len(), triangle.shape()), (kept * rows, (kept, count)));
            let q = DMatrix::from_vec(rows, kept, directions);
            assert!((q.tr_mul(&q) - DMatrix::identity(kept, kept)).amax() < 1e-13);
            assert!((q * triangle - DMatrix::from_vec(rows, count, columns)).amax() < 1e-13);
        }
    }

    #[test]
    fn dependent_columns_are_left_out_in_their_order() {
        let mut columns = random_columns(6, 200);
        let sum = |a: &[f64], b: &[f64], share: f64| a.iter().zip(b).map(|(a, b)| a + share * b).collect::<Vec<f64>>();
        // Multiples, sums, zero, not a number, and nearly dependent ones on either side of the share.
        columns.insert(1, columns[0].iter().map(|x| -3.0 * x).collect());
        columns.insert(3, sum(&columns[0], &columns[2], 2.0));
        columns.insert(4, vec![0.0; 200]);
        columns.insert(5, vec![f64::NAN; 200]);
        columns.insert(6, sum(&columns[2], &columns[9], 1e-7));
        columns.push(sum(&columns[0], &random_columns(3, 200)[2], 1e-5));
        let found = basis(&columns, 1e-6);
        assert_eq!(found.kept, [0, 2, 7, 8, 9, 10, 11]);
        for column in columns.iter().filter(|column| length(column).is_finite()) {
            assert!(length(&found.residual(column)) <= 1e-6 * length(column));
        }
    }

    #[test]
    fn no_more_directions_than_rows() {
        let found = basis(&random_columns(5, 3), 1e-9);
        assert_eq!(found.kept, [0, 1, 2]);
        assert!(basis(&[], 1e-9).kept.is_empty() && basis(&[vec![]], 1e-9).kept.is_empty());
        assert!(basis(&[vec![0.0; 4]], 1e-9).kept.is_empty());
    }
}
