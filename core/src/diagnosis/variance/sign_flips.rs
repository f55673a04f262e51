//! Score tests of variance components under flipped signs.
//!
//! The score of a component is `g = Z_k' P y`, a sum over rows, of which each block of time has a part. If blocks are longer than the noise
//! remembers, these parts are independent and as likely of either sign under the null hypothesis. Flipping the signs of whole blocks at
//! random then draws the score, whatever the spectrum, the scale and the changes of scale of the noise. This is the wild cluster bootstrap
//! with residuals under the null hypothesis (Cameron, Gelbach and Miller, 2008). It keeps its level where residuals of the full model are
//! smaller than the noise.
//!
//! A fit with more columns than there are blocks takes much of the noise in each, most of what is slow. So the residual of a block is
//! multiplied by the inverse square root of its block of the residual maker I - H (CR2: Bell and McCaffrey, 2002) before signs are flipped.

use super::design::Design;
use super::mixed::{Fit, Posterior};
use crate::linear::transposed_product;
use crate::random::stream;
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use rand::RngExt;
use std::ops::Range;

/// Rows of 20 ms in a block: a second, several times what joint torque noise remembers once its correlation is made white; in short logs
/// less, for more blocks than there are columns in the model.
const LONGEST_BLOCK: usize = 50;
const SHORTEST_BLOCK: usize = 16;
const BLOCKS: usize = 100;

/// Fewest averaged rows in a block: neighbours are nearly independent.
const LEAST_ROWS: usize = 2;

/// Draws, and the largest of them from which the tail beyond is taken for exponential.
const DRAWS: usize = 4999;
const TAIL: usize = 50;

/// Draws worked out in one product of matrices.
const TOGETHER: usize = 256;

/// Fewest blocks: with fewer there are not enough sign patterns for any p-value that counts. Twelve have 4096, so that the least p-value
/// is 2.4e-4. It belongs to the statistic.
const FEWEST_BLOCKS: usize = 12;

/// Share of a direction of a block's noise below which the fit has taken all of it.
const TAKEN: f64 = 1e-3;

/// The p-value of each kind given all others; None where the logs are too short for a test, or the kind has no functions.
pub(super) fn p_values(design: &Design, fit: &Fit, seed: u64, joint: usize) -> Vec<Option<f64>> {
    let blocks = blocks(design);
    // That of all kinds that play no part is the same.
    let mut of_absent = None;
    (0..design.kinds.len())
        .map(|kind| {
            let columns = design.kinds[kind].1.clone();
            if blocks.len() < FEWEST_BLOCKS || columns.is_empty() {
                return None;
            }
            let own = design.z.columns(columns.start, columns.len()).into_owned();
            let index = (joint * design.kinds.len() + kind) as u64;
            if fit.strengths[kind] != 0.0 {
                let mut strengths = fit.strengths.clone();
                strengths[kind] = 0.0;
                return Some(Null::new(design, &strengths, fit.noise, &blocks).p(&own, seed, index));
            }
            let null = of_absent.get_or_insert_with(|| Null::new(design, &fit.strengths, fit.noise, &blocks));
            Some(null.p(&own, seed, index))
        })
        .collect()
}

/// The model under the null hypothesis.
struct Null<'a> {
    design: &'a Design,
    noise: f64,
    posterior: Option<Posterior>,
    blocks: &'a [Range<usize>],
    /// Residual of the torque.
    residual: DVector<f64>,
    /// The same block by block, as large as the noise is.
    scaled: DVector<f64>,
}

impl<'a> Null<'a> {
    fn new(design: &'a Design, strengths: &[f64], noise: f64, blocks: &'a [Range<usize>]) -> Self {
        let posterior = Posterior::new(design, strengths, noise);
        let residual = left(design, posterior.as_ref(), noise, &DMatrix::from_columns(std::slice::from_ref(&design.y)));
        let residual = residual.column(0).into_owned();
        let taken = posterior.as_ref().map(|posterior| posterior.directions(design, noise));
        let mut scaled = residual.clone();
        for block in blocks {
            let rows = |all: &DMatrix<f64>| all.rows(block.start, block.len()).into_owned();
            let mut share = DMatrix::identity(block.len(), block.len());
            for directions in [Some(&design.basis), taken.as_ref()].into_iter().flatten().map(rows) {
                share -= &directions * directions.transpose();
            }
            let SymmetricEigen { eigenvectors, eigenvalues } = SymmetricEigen::new(share);
            let mut along = eigenvectors.tr_mul(&residual.rows(block.start, block.len()));
            let factors = eigenvalues.map(|share| if share > TAKEN { share.sqrt().recip() } else { 0.0 });
            along.component_mul_assign(&factors);
            scaled.rows_mut(block.start, block.len()).copy_from(&(eigenvectors * along));
        }
        Null { design, noise, posterior, blocks, residual, scaled }
    }

    /// The p-value of a kind with these columns.
    fn p(&self, columns: &DMatrix<f64>, seed: u64, index: u64) -> f64 {
        let own = left(self.design, self.posterior.as_ref(), self.noise, columns);
        let observed = transposed_product(&own, &DMatrix::from_columns(std::slice::from_ref(&self.residual)));
        p_value(observed.norm_squared(), &scores(&own, &self.scaled, self.blocks), seed, index)
    }
}

/// Residuals of columns from which the fixed ones are projected out.
fn left(design: &Design, posterior: Option<&Posterior>, noise: f64, columns: &DMatrix<f64>) -> DMatrix<f64> {
    posterior.map_or_else(|| columns.clone(), |posterior| posterior.residual_of(design, columns, noise))
}

/// Rows of each block: those of one log that lie close together in time.
fn blocks(design: &Design) -> Vec<Range<usize>> {
    let bounds = [SHORTEST_BLOCK, LONGEST_BLOCK].map(|rows| (rows / design.together).max(LEAST_ROWS));
    let length = (design.time.len() / BLOCKS).clamp(bounds[0], bounds[1]);
    let mut blocks: Vec<Range<usize>> = Vec::new();
    for (row, (&time, log)) in design.time.iter().zip(&design.log).enumerate() {
        match blocks.last_mut() {
            Some(block) if design.log[block.start] == *log && time < design.time[block.start] + length => {
                block.end = row + 1;
            }
            _ => blocks.push(row..row + 1),
        }
    }
    blocks
}

/// Sum of each column's products with the residual, block by block: `[block, column]`.
fn scores(columns: &DMatrix<f64>, residual: &DVector<f64>, blocks: &[Range<usize>]) -> DMatrix<f64> {
    let of_block =
        |block: &Range<usize>| columns.rows(block.start, block.len()).tr_mul(&residual.rows(block.start, block.len()));
    DMatrix::from_columns(&blocks.iter().map(of_block).collect::<Vec<DVector<f64>>>()).transpose()
}

/// Probability of a squared sum of `scores`, `[block, column]`, as large as the one `observed` under flipped signs. Where few draws are as
/// large it is that of an exponential tail (peaks over a threshold: Pickands, Annals of Statistics 3, 1975), as quadratic forms have, its
/// mean excess two standard errors above the estimate.
fn p_value(observed: f64, scores: &DMatrix<f64>, seed: u64, index: u64) -> f64 {
    let mut source = stream(seed, "variance_components", index);
    let mut drawn = Vec::with_capacity(DRAWS);
    while drawn.len() < DRAWS {
        let count = TOGETHER.min(DRAWS - drawn.len());
        let signs = DMatrix::from_fn(scores.nrows(), count, |_, _| if source.random::<bool>() { 1.0 } else { -1.0 });
        drawn.extend(transposed_product(scores, &signs).column_iter().map(|sum| sum.norm_squared()));
    }
    drawn.sort_by(|a, b| b.total_cmp(a));
    let threshold = drawn[TAIL];
    if observed <= threshold {
        let exceeding = drawn.partition_point(|score| *score >= observed);
        return (1 + exceeding) as f64 / (DRAWS + 1) as f64;
    }
    let excess = drawn[..TAIL].iter().map(|score| score - threshold).sum::<f64>() / TAIL as f64;
    let excess = excess * (1.0 + 2.0 / (TAIL as f64).sqrt());
    let share = (1 + TAIL) as f64 / (DRAWS + 1) as f64;
    if excess > 0.0 { share * (-(observed - threshold) / excess).exp() } else { share }
}

#[cfg(test)]
mod tests {
    use super::super::mixed::fit;
    use super::super::mixed::tests::one_kind_of_two;
    use super::*;

    #[test]
    fn what_is_there_is_significant_and_what_is_not_is_rarely_so() {
        let p = |size, seed| {
            let design = one_kind_of_two(size, seed);
            p_values(&design, &fit(&design), seed, 0)
        };
        assert!((0..10).all(|seed| p(1.0, seed)[0].is_some_and(|p| p < 0.001)));
        // 40 tests of nothing at 5 %: at most 7 but for one set of draws in 100.
        let false_alarms = (0..20).flat_map(|seed| p(0.0, seed)).flatten().filter(|p| *p < 0.05).count();
        assert!(false_alarms <= 7, "{false_alarms}");
    }

    #[test]
    fn the_level_is_kept_with_kinds_that_play_no_part() {
        let p = |seed| {
            let design = one_kind_of_two(0.0, seed);
            p_values(&design, &fit(&design), seed, 0)
        };
        // 400 tests at 1 %: at most 14 but for a few sets of draws in 1000.
        let false_alarms = (100..300).flat_map(p).flatten().filter(|p| *p < 0.01).count();
        assert!(false_alarms <= 14, "{false_alarms}");
    }

    /// Two slow columns for each of 24 blocks, as an arm's parameters are: the residual of a block is much less than its noise.
    #[test]
    fn the_level_is_kept_with_more_fixed_columns_than_blocks() {
        let p = |seed| {
            let mut design = one_kind_of_two(0.0, seed);
            let rows = design.y.len();
            let slow = |row: usize, k: usize| (0.005 * (k + 1) as f64 * row as f64 + 0.7 * k as f64).sin();
            let basis = DMatrix::from_fn(rows, 48, slow).qr().q();
            let complement = |columns: DMatrix<f64>| &columns - &basis * basis.tr_mul(&columns);
            design.z = complement(design.z);
            design.y = complement(DMatrix::from_columns(&[design.y])).column(0).into_owned();
            (design.gram, design.right) = (design.z.tr_mul(&design.z), design.z.tr_mul(&design.y));
            design.basis = basis;
            p_values(&design, &fit(&design), seed, 0)
        };
        // 400 tests at 5 %: at most 30 but for a few sets of draws in 100.
        let false_alarms = (0..200).flat_map(p).flatten().filter(|p| *p < 0.05).count();
        assert!(false_alarms <= 30, "{false_alarms}");
    }

    #[test]
    fn the_tail_beyond_the_draws_is_that_of_chi_square() {
        // One column whose blocks are alike but for signs: flipped sums are normal, their squares chi-square of one degree.
        for (surplus, expected) in [(26, 0.01), (33, 1e-3), (44, 1e-5)] {
            let signs = (0..400).map(|block| if 2 * block < 400 + 2 * surplus { 0.05 } else { -0.05 });
            let scores = DMatrix::from_column_slice(400, 1, &signs.collect::<Vec<f64>>());
            let p = p_value(scores.row_sum().norm_squared(), &scores, 1, 0);
            assert!(p > 0.7 * expected && p < 30.0 * expected, "{surplus}: {p}");
        }
    }

    #[test]
    fn too_few_blocks_are_no_test() {
        let mut design = one_kind_of_two(1.0, 0);
        design.time.iter_mut().for_each(|time| *time /= 50);
        assert_eq!(blocks(&design).len(), 2);
        assert_eq!(p_values(&design, &fit(&design), 0, 0), [None, None]);
    }
}
