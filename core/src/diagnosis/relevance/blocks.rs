//! Least squares block by block: estimates without each block, for the jackknife.

use crate::diagnosis::logs::Rows;
use crate::diagnosis::noise::Whitener;
use crate::diagnosis::regression::{Column, Solved, solve_normal};
use crate::linear::gram_matrix;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use std::collections::BTreeMap;

/// Rows in a block (one second), longer than noise and filters remember; in short logs less, for enough blocks.
const LONGEST: usize = 50;
const SHORTEST: usize = 12;
const BLOCKS: usize = 30;

/// Fewest blocks whose scatter estimates a variance: with fewer the t statistic has no power at the strict level, and the gate on strength
/// is not asked. It belongs to the statistic, as the length of the blocks does.
const FEWEST: usize = 8;

/// Added to the diagonal of the normal matrix of columns of unit length: directions that no row determines stay at zero.
const RIDGE: f64 = 1e-10;

/// Inner products of whitened columns and torque, over all rows and over each block of them.
#[derive(Debug)]
pub(super) struct BlockProducts {
    /// Lengths of the columns; one where a column is zero.
    norms: Vec<f64>,
    all: Products,
    blocks: Vec<Products>,
}

/// Inner products of columns of unit length over some rows.
#[derive(Debug, Clone)]
struct Products {
    gram: DMatrix<f64>,
    right: DVector<f64>,
}

/// Estimates of some columns' factors.
#[derive(Debug)]
pub(super) struct Estimates {
    /// The factors, in the order of the columns asked for.
    pub values: DVector<f64>,
    /// The same without each block; empty where there are too few.
    without: Vec<DVector<f64>>,
}

impl BlockProducts {
    /// The blocks of whitened `columns` and `torque` over the rows that `whitener` keeps of `rows`.
    pub(super) fn new(rows: &Rows, whitener: &Whitener, columns: &[Column], torque: &Column) -> Self {
        let norms: Vec<f64> = columns.iter().map(|column| column.dot(column).sqrt()).collect();
        let norms: Vec<f64> = norms.into_iter().map(|norm| if norm > 0.0 { norm } else { 1.0 }).collect();
        let count = columns.len();
        let empty = || Products { gram: DMatrix::zeros(count, count), right: DVector::zeros(count) };
        let block_of = block_of_rows(rows);
        let mut blocks: BTreeMap<usize, Products> = BTreeMap::new();
        for (joint, measured) in &torque.parts {
            let own: Vec<(usize, &[f64])> =
                columns.iter().enumerate().filter_map(|(place, column)| Some((place, column.part(*joint)?))).collect();
            let places = whitener.places(*joint);
            let mut start = 0;
            while start < places.len() {
                let block = block_of[places[start]];
                let end = start + places[start..].iter().take_while(|&&place| block_of[place] == block).count();
                let matrix = DMatrix::from_fn(end - start, own.len(), |row, k| own[k].1[start + row] / norms[own[k].0]);
                let torque = DVector::from_column_slice(&measured[start..end]);
                let (gram, right) = (gram_matrix(&matrix), matrix.tr_mul(&torque));
                let products = blocks.entry(block).or_insert_with(empty);
                for (r, &(row, _)) in own.iter().enumerate() {
                    products.right[row] += right[r];
                    for (c, &(column, _)) in own.iter().enumerate() {
                        products.gram[(row, column)] += gram[(r, c)];
                    }
                }
                start = end;
            }
        }
        let mut all = empty();
        for products in blocks.values() {
            all.gram += &products.gram;
            all.right += &products.right;
        }
        BlockProducts { norms, all, blocks: blocks.into_values().collect() }
    }

    /// Estimates of the factors of the columns at `kept`, by all rows, and without each block.
    pub(super) fn estimates(&self, kept: &[usize]) -> Estimates {
        let part = |products: &Products| Products {
            gram: products.gram.select_rows(kept).select_columns(kept),
            right: products.right.select_rows(kept),
        };
        let all = part(&self.all);
        let norms = DVector::from_iterator(kept.len(), kept.iter().map(|&place| self.norms[place]));
        let solve = |products: Products| match factored(products.gram) {
            Some(factor) => factor.solve(&products.right).component_div(&norms),
            None => DVector::from_element(kept.len(), f64::NAN),
        };
        let without = if self.blocks.len() >= FEWEST {
            let rest = |block: &Products| {
                let own = part(block);
                solve(Products { gram: &all.gram - own.gram, right: &all.right - own.right })
            };
            self.blocks.iter().map(rest).collect()
        } else {
            Vec::new()
        };
        Estimates { values: solve(all), without }
    }

    /// Covariance of the estimates of the factors of the columns at `kept`, where the torque has white errors of this variance and independent
    /// standard normal multiples of others, whose inner products with these columns are `errors`, a column each.
    pub(super) fn covariance(&self, kept: &[usize], errors: DMatrix<f64>, white: f64) -> Option<DMatrix<f64>> {
        let norms = DVector::from_iterator(kept.len(), kept.iter().map(|&place| self.norms[place]));
        let factor = factored(self.all.gram.select_rows(kept).select_columns(kept))?;
        let per_norm = |mut matrix: DMatrix<f64>| {
            matrix.column_iter_mut().for_each(|mut column| column.component_div_assign(&norms));
            matrix
        };
        let changes = per_norm(factor.solve(&per_norm(errors)));
        let noise = per_norm(per_norm(factor.inverse()).transpose());
        Some(&changes * changes.transpose() + noise * white)
    }

    /// Degrees of freedom of the scatter between blocks; None where there are too few.
    pub(super) fn freedom(&self) -> Option<f64> {
        (self.blocks.len() >= FEWEST).then_some(self.blocks.len() as f64 - 1.0)
    }

    /// The least-squares solution for the factors of the columns at `kept`, by all rows.
    pub(super) fn solved(&self, kept: &[usize]) -> Solved {
        let norms = DVector::from_iterator(kept.len(), kept.iter().map(|&place| self.norms[place]));
        let gram = self.all.gram.select_rows(kept).select_columns(kept).component_mul(&(&norms * norms.transpose()));
        solve_normal(gram, self.all.right.select_rows(kept).component_mul(&norms))
    }
}

fn factored(mut gram: DMatrix<f64>) -> Option<Cholesky<f64, Dyn>> {
    for k in 0..gram.nrows() {
        gram[(k, k)] += RIDGE;
    }
    gram.cholesky()
}

impl Estimates {
    /// Standard deviation of a factor by the scatter of the estimates without each block (jackknife; Efron and Stein, Annals of
    /// Statistics 9, 1981), and its degrees of freedom; None where there are too few blocks.
    pub(super) fn scatter(&self, place: usize) -> Option<(f64, f64)> {
        let count = self.without.len() as f64;
        if self.without.is_empty() {
            return None;
        }
        let mean = self.without.iter().map(|values| values[place]).sum::<f64>() / count;
        let square: f64 = self.without.iter().map(|values| (values[place] - mean).powi(2)).sum();
        Some(((square * (count - 1.0) / count).sqrt(), count - 1.0))
    }
}

/// Block of every row: rows of one log, close together in time.
fn block_of_rows(rows: &Rows) -> Vec<usize> {
    let width = (rows.len() / BLOCKS).clamp(SHORTEST, LONGEST);
    let (mut block_of, mut first) = (Vec::with_capacity(rows.len()), 0);
    for ends in rows.starts.windows(2) {
        let length = ends[1] - ends[0];
        let count = (length / width).max(1);
        block_of.extend((0..length).map(|row| first + (row * count / length).min(count - 1)));
        first += count;
    }
    block_of
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::channels::Channels;
    use crate::diagnosis::logs::FEWEST_ROWS;
    use crate::identification::noise::AutoregressiveNoise;
    use crate::random;
    use crate::recording::Recording;
    use rand_distr::{Distribution, StandardNormal};

    /// A log of 40 s, two columns and a torque of 2 times the first, 3 times the second and noise of unit deviation, whose
    /// sign goes with the first column over two seconds at a time where it is `clustered`.
    fn products(seed: u64, clustered: bool) -> (BlockProducts, f64) {
        let mut source = random::stream(seed, "block_products", 0);
        let time: Vec<f64> = (0..20_000).map(|k| f64::from(k) / 500.0).collect();
        let q = Channels::from_vectors(&[time.iter().map(|t| t.sin()).collect()]);
        let tau = Channels::from_vectors(&[vec![0.0; time.len()]]);
        let log = Recording { joints: vec!["a".into()], time, q, tau, ..Default::default() };
        let rows = Rows::new(&[&log], 10.0, FEWEST_ROWS).unwrap();
        let noise = AutoregressiveNoise { coefficients: Vec::new(), innovation_std: 1.0 };
        let whitener = Whitener::of_known(&rows, vec![noise]);
        let count = rows.len();
        let signal = |f: &dyn Fn(f64) -> f64| Column::on(0, (0..count).map(|k| f(k as f64 / 50.0)).collect());
        let columns = [signal(&|t| (2.3 * t).cos()), signal(&|t| (0.9 * t).sin())];
        let signs: Vec<f64> = (0..count / 100 + 1).map(|_| StandardNormal.sample(&mut source)).collect();
        let mut torque = Column::on(
            0,
            (0..count)
                .map(|k| match clustered {
                    true => signs[k / 100] * (2.3 * k as f64 / 50.0).cos(),
                    false => StandardNormal.sample(&mut source),
                })
                .collect(),
        );
        torque.add(2.0, &columns[0]);
        torque.add(3.0, &columns[1]);
        let white = whitener.apply_all(&columns);
        let plain = 1.0 / white[0].dot(&white[0]).sqrt();
        (BlockProducts::new(&rows, &whitener, &white, &whitener.apply(&torque)), plain)
    }

    #[test]
    fn estimates_are_those_of_least_squares_with_the_scatter_of_white_noise() {
        let mut ratio = 0.0;
        for seed in 0..20 {
            let (products, plain) = products(seed, false);
            let estimates = products.estimates(&[0, 1]);
            assert!((estimates.values[0] - 2.0).abs() < 5.0 * plain && (estimates.values[1] - 3.0).abs() < 5.0 * plain);
            ratio += estimates.scatter(0).unwrap().0 / plain / 20.0;
        }
        assert!((ratio - 1.0).abs() < 0.15, "{ratio}");
    }

    #[test]
    fn errors_along_a_column_are_those_of_its_factor() {
        let (products, plain) = products(3, false);
        // 0.3 times the first column, and 0.1 times both: inner products with them by the normal matrix.
        let along = |factors: [f64; 2]| {
            let scaled = DVector::from_iterator(2, factors.iter().zip(&products.norms).map(|(f, norm)| f * norm));
            let norms = DVector::from_column_slice(&products.norms);
            (&products.all.gram * scaled).component_mul(&norms)
        };
        let errors = DMatrix::from_columns(&[along([0.3, 0.0]), along([0.1, 0.1])]);
        let covariance = products.covariance(&[0, 1], errors.clone(), 0.0).unwrap();
        assert!((covariance[(0, 0)] - 0.1).abs() < 1e-6 && (covariance[(1, 1)] - 0.01).abs() < 1e-6, "{covariance}");
        assert!((covariance[(0, 1)] - 0.01).abs() < 1e-6);
        // White errors of unit variance add those of least squares.
        let both = products.covariance(&[0, 1], errors, 1.0).unwrap() - covariance;
        assert!((both[(0, 0)].sqrt() / plain - 1.0).abs() < 0.05, "{both}");
    }

    #[test]
    fn what_differs_from_block_to_block_scatters_more() {
        let (products, plain) = products(1, true);
        let (std, freedom) = products.estimates(&[0, 1]).scatter(0).unwrap();
        // A mean of 20 factors of unit deviation.
        assert!(std > 0.12 && std < 0.4 && std > 2.0 * plain, "{std} {plain}");
        assert!(freedom >= 29.0);
    }

    #[test]
    fn a_column_twice_is_halved_and_not_infinite() {
        let (products, _) = products(2, false);
        let estimates = products.estimates(&[0, 0, 1]);
        assert!((estimates.values[0] + estimates.values[1] - 2.0).abs() < 0.2);
        assert!(estimates.scatter(0).is_some_and(|(std, _)| std.is_finite()));
    }
}
