//! The triangle R of a tall table X = Q R from blocks of its rows (TSQR, Demmel, Grigori, Hoemmen and Langou 2012): R'R is
//! the Gram matrix, without the squared condition number. The reference for the Gram matrices, and what replaces them
//! where they lose too many digits.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::qr::no_pivoting::factor::{qr_in_place, qr_in_place_scratch, recommended_block_size};
use faer::{Mat, Par};
use nalgebra::DMatrix;

/// Rows that are gathered before they are folded into the triangle.
const GATHERED: usize = 1024;

/// R over the rows seen so far.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::identification::tsqr::Triangle;
///
/// // Rows of a table with two columns come in parts: R'R is the Gram matrix of all of them.
/// let mut triangle = Triangle::new(2);
/// triangle.add(&[1.0, 2.0, 0.0, 1.0], 2);
/// triangle.add(&[2.0, 3.0], 1);
/// let r = triangle.factor();
/// let gram = r.transpose() * &r;
/// let expected = nalgebra::dmatrix![9.0, 8.0; 8.0, 10.0];
/// assert!((gram - expected).amax() < 1e-12);
/// ```
pub struct Triangle {
    columns: usize,
    /// The triangle so far, and below it rows that wait.
    stack: Mat<f64>,
    waiting: usize,
}

impl Triangle {
    /// No rows of a table of so many columns.
    pub fn new(columns: usize) -> Self {
        Triangle { columns, stack: Mat::zeros(columns + GATHERED, columns), waiting: 0 }
    }

    /// Adds `rows` rows given as `[column][row]`.
    ///
    /// # Panics
    /// If the table has another size.
    pub fn add(&mut self, table: &[f64], rows: usize) {
        assert_eq!(table.len(), self.columns * rows, "a table of all columns is wanted");
        let mut done = 0;
        while done < rows {
            let count = (rows - done).min(GATHERED - self.waiting);
            let first = self.columns + self.waiting;
            for (column, values) in table.chunks_exact(rows).enumerate() {
                for (k, &value) in values[done..done + count].iter().enumerate() {
                    self.stack[(first + k, column)] = value;
                }
            }
            done += count;
            self.waiting += count;
            if self.waiting == GATHERED {
                self.fold();
            }
        }
    }

    fn fold(&mut self) {
        let (n, height) = (self.columns, self.columns + self.waiting);
        if n > 0 {
            let block = recommended_block_size::<f64>(height, n);
            let mut householder = Mat::<f64>::zeros(block, n);
            let params = Default::default();
            let mut memory = MemBuffer::new(qr_in_place_scratch::<f64>(height, n, block, Par::Seq, params));
            let part = self.stack.as_mut().subrows_mut(0, height);
            qr_in_place(part, householder.as_mut(), Par::Seq, MemStack::new(&mut memory), params);
        }
        for column in 0..n {
            for row in column + 1..height {
                self.stack[(row, column)] = 0.0;
            }
        }
        self.waiting = 0;
    }

    /// R, upper triangular, as high as it is wide, its diagonal not below zero.
    pub fn factor(mut self) -> DMatrix<f64> {
        self.fold();
        let sign = |row: usize| if self.stack[(row, row)] < 0.0 { -1.0 } else { 1.0 };
        DMatrix::from_fn(self.columns, self.columns, |r, c| if c < r { 0.0 } else { sign(r) * self.stack[(r, c)] })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random;
    use rand::RngExt;

    fn table(columns: usize, rows: usize) -> Vec<f64> {
        let mut source = random::stream(columns as u64, "table", rows as u64);
        (0..columns * rows).map(|_| source.random_range(-1.0..1.0)).collect()
    }

    #[test]
    fn blocks_give_the_triangle_of_the_whole_table() {
        for (columns, rows, block) in [(1, 5, 2), (7, 7, 7), (12, 3000, 128), (40, 5001, 999), (3, 2, 1)] {
            let table = table(columns, rows);
            let mut triangle = Triangle::new(columns);
            for start in (0..rows).step_by(block) {
                let end = rows.min(start + block);
                let part: Vec<f64> = table.chunks_exact(rows).flat_map(|column| column[start..end].to_vec()).collect();
                triangle.add(&part, end - start);
            }
            let r = triangle.factor();
            let x = DMatrix::from_column_slice(rows, columns, &table);
            let full = x.clone().qr().r();
            for row in 0..full.nrows() {
                let sign = if full[(row, row)] < 0.0 { -1.0 } else { 1.0 };
                for column in 0..columns {
                    let difference = r[(row, column)] - sign * full[(row, column)];
                    assert!(difference.abs() < 1e-11, "{columns} x {rows}: {row}, {column}: {difference}");
                }
            }
            assert!((r.transpose() * &r - x.transpose() * x).amax() < 1e-10);
        }
    }

    #[test]
    fn nearly_dependent_columns_keep_their_digits() {
        let rows = 4000;
        let mut x = table(2, rows);
        let (first, second) = x.split_at_mut(rows);
        second.iter_mut().zip(first).for_each(|(y, x)| *y = *x + 1e-9 * *y);
        let mut triangle = Triangle::new(2);
        triangle.add(&x, rows);
        let r = triangle.factor();
        let x = DMatrix::from_column_slice(rows, 2, &x);
        let (one, two) = (x.column(0), x.column(1));
        let rest = two - one * (one.dot(&two) / one.norm_squared());
        assert!((r[(1, 1)] / rest.norm() - 1.0).abs() < 1e-6, "{} {}", r[(1, 1)], rest.norm());
    }
}
