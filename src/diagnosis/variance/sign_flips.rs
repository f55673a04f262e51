//! Score tests of variance components under flipped signs.
//!
//! The score of a component is `g = Z_k' P y`, a sum over rows. Split into blocks of time longer than the noise remembers, its
//! parts are independent and, without the component, as likely of either sign: flipping them at random draws from the null
//! hypothesis whatever the spectrum, the scale and the changes of scale of the noise (wild cluster bootstrap).

use super::design::Design;
use super::mixed::{Fit, Posterior};
use crate::random::stream;
use nalgebra::{DMatrix, DVector};
use rand::RngExt;

/// Averaged rows in a block: 2 s, several times what joint torque noise remembers.
const BLOCK: usize = 25;

/// Draws: with a hundred tests the smallest adjusted p-value is 0.02.
const DRAWS: usize = 4999;

/// Fewest blocks: with fewer there are not enough sign patterns for any p-value that counts.
const FEWEST_BLOCKS: usize = 12;

/// The p-value of each kind given all others; one where the logs are too short for a test.
pub(super) fn p_values(design: &Design, fit: &Fit, seed: u64, joint: usize) -> Vec<f64> {
    let blocks = blocks(design);
    let count = blocks.last().map_or(0, |last| last + 1);
    (0..design.kinds.len())
        .map(|kind| {
            let columns = design.kinds[kind].1.clone();
            if count < FEWEST_BLOCKS || columns.is_empty() {
                return 1.0;
            }
            let mut strengths = fit.strengths.clone();
            strengths[kind] = 0.0;
            let own = design.z.columns(columns.start, columns.len()).into_owned();
            let y = DMatrix::from_columns(std::slice::from_ref(&design.y));
            let (own, residual) = match Posterior::new(design, &strengths, fit.noise) {
                Some(posterior) => (posterior.residual_of(&own, fit.noise), posterior.residual_of(&y, fit.noise)),
                None => (own, y),
            };
            let scores = scores(&own, &residual.column(0).into_owned(), &blocks, count);
            flipped(&scores, design.y.len(), design.rank as f64 + fit.freedom, seed, (joint * design.kinds.len() + kind) as u64)
        })
        .collect()
}

/// Block of each row: rows within [`BLOCK`] of each other in one log.
fn blocks(design: &Design) -> Vec<usize> {
    let mut blocks = Vec::with_capacity(design.time.len());
    let mut open: Option<(usize, usize, usize)> = None;
    for (&time, &log) in design.time.iter().zip(&design.log) {
        let block = match open {
            Some((start, own, block)) if own == log && time < start + BLOCK => block,
            Some((_, _, block)) => {
                open = Some((time, log, block + 1));
                block + 1
            }
            None => 0,
        };
        if open.is_none() {
            open = Some((time, log, 0));
        }
        blocks.push(block);
    }
    blocks
}

/// Sum of each column's products with the residual, block by block.
fn scores(columns: &DMatrix<f64>, residual: &DVector<f64>, blocks: &[usize], count: usize) -> DMatrix<f64> {
    let mut scores = DMatrix::zeros(columns.ncols(), count);
    for (row, &block) in blocks.iter().enumerate() {
        for column in 0..columns.ncols() {
            scores[(column, block)] += columns[(row, column)] * residual[row];
        }
    }
    scores
}

/// Probability of a score as large under flipped signs. Residuals are smaller than the noise by the degrees of freedom that the
/// fit took, which the draws make up for.
fn flipped(scores: &DMatrix<f64>, rows: usize, freedom: f64, seed: u64, index: u64) -> f64 {
    let shrunk = (1.0 - freedom / rows as f64).max(0.1);
    let observed = scores.column_sum().norm_squared() * shrunk;
    let mut source = stream(seed, "variance_components", index);
    let mut exceeding = 0;
    for _ in 0..DRAWS {
        let mut sum = DVector::zeros(scores.nrows());
        for block in scores.column_iter() {
            let sign = if source.random::<bool>() { 1.0 } else { -1.0 };
            sum.axpy(sign, &block, 1.0);
        }
        exceeding += usize::from(sum.norm_squared() >= observed);
    }
    (1 + exceeding) as f64 / (DRAWS + 1) as f64
}
