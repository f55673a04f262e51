//! Columns that are nearly combinations of others: which of them are parameters of their own, and what of the others' they take.

use crate::linear::{inner_product, length};
use nalgebra::DMatrix;

/// Part by which a column's residual must be longer than that of one before it to be kept first: columns that a symmetric arm
/// makes alike are ordered by their places, not by rounding.
const LONGER: f64 = 1e-6;

/// Coefficients below this are rounding of the factorisation.
const NEGLIGIBLE: f64 = 1e-9;

/// A column that separate columns do not wholly explain.
pub(super) struct Near {
    /// Which one.
    pub column: usize,
    /// Its length.
    pub size: f64,
    /// What they leave of it at unit length.
    pub rest: Vec<f64>,
}

/// One that is a parameter of its own.
pub(super) struct Kept {
    /// Which one.
    pub column: usize,
    /// Its sum: standard parameters with their shares, its own first.
    pub shares: Vec<(usize, f64)>,
}

/// Chooses among `near` columns those that are kept, the one with the longest residual first so that no share of another is large; a
/// residual of up to `independent` of its column is none.
///
/// `regrouping` has the coefficients of all columns in the separate ones, whose lengths are `norms`. Those of a kept column lose
/// what is smaller than its residual; what that takes from the columns that follow it goes to their own coefficients.
pub(super) fn reduce(near: Vec<Near>, independent: f64, regrouping: &mut DMatrix<f64>, norms: &[f64]) -> Vec<Kept> {
    let shares: Vec<f64> = near.iter().map(|near| length(&near.rest)).collect();
    let (order, along, left) = pivoted(&near, independent);
    let mut taken = DMatrix::zeros(norms.len(), order.len());
    for (k, &own) in order.iter().enumerate() {
        for (row, norm) in norms.iter().enumerate() {
            let value = &mut regrouping[(row, near[own].column)];
            if (*value * norm / near[own].size).abs() < shares[own] {
                taken[(row, k)] = std::mem::take(value);
            }
        }
    }
    let mut kept: Vec<Kept> =
        order.iter().map(|&own| Kept { column: near[own].column, shares: vec![(near[own].column, 1.0)] }).collect();
    for other in (0..near.len()).filter(|other| !order.contains(other)) {
        let Near { column, size, .. } = near[other];
        let mut factors = vec![0.0; order.len()];
        for k in (0..order.len()).rev() {
            let later: f64 = (k + 1..order.len()).map(|l| along[order[l]][k] * factors[l]).sum();
            factors[k] = (along[other][k] - later) / along[order[k]][k];
        }
        for (k, &own) in order.iter().enumerate() {
            let factor = factors[k] * size / near[own].size;
            if (factors[k] * shares[own]).abs() > independent {
                kept[k].shares.push((column, factor));
                for row in 0..norms.len() {
                    regrouping[(row, column)] -= factor * taken[(row, k)];
                }
            }
        }
        for (row, norm) in norms.iter().enumerate() {
            let value = &mut regrouping[(row, column)];
            if (*value * norm / size).abs() < left[other].max(NEGLIGIBLE) {
                *value = 0.0;
            }
        }
    }
    kept
}

/// The kept columns in their order, the parts of every residual along their directions, and the length of what these leave of it.
fn pivoted(near: &[Near], independent: f64) -> (Vec<usize>, Vec<Vec<f64>>, Vec<f64>) {
    let mut rests: Vec<Vec<f64>> = near.iter().map(|near| near.rest.clone()).collect();
    let mut along = vec![Vec::new(); near.len()];
    let mut order: Vec<usize> = Vec::new();
    loop {
        let mut longest: Option<(usize, f64)> = None;
        for (own, rest) in rests.iter().enumerate().filter(|(own, _)| !order.contains(own)) {
            let left = length(rest);
            let size = left * near[own].size;
            if left > independent && longest.is_none_or(|(_, most)| size > (1.0 + LONGER) * most) {
                longest = Some((own, size));
            }
        }
        let Some((own, _)) = longest else { break };
        let left = length(&rests[own]);
        let direction: Vec<f64> = rests[own].iter().map(|x| x / left).collect();
        for other in (0..near.len()).filter(|other| !order.contains(other)) {
            let part = inner_product(&direction, &rests[other]);
            along[other].push(part);
            rests[other].iter_mut().zip(&direction).for_each(|(x, d)| *x -= part * d);
        }
        order.push(own);
    }
    let left = rests.iter().map(|rest| length(rest)).collect();
    (order, along, left)
}
