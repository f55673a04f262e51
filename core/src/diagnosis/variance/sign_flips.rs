//! Score tests of variance components under flipped signs.
//!
//! The score of a component is `g = Z_k' P y`, a sum over rows. Under the null hypothesis its parts from blocks of time longer than the
//! noise remembers are independent and as likely of either sign: flipping the signs of whole blocks at random draws the score, whatever
//! the spectrum, the scale and the changes of scale of the noise (wild cluster bootstrap with residuals under the null hypothesis, which
//! keeps its level where those of the full model are smaller than the noise: Cameron, Gelbach and Miller, 2008).

use super::design::Design;
use super::mixed::{Fit, Posterior};
use crate::random::stream;
use nalgebra::{DMatrix, DVector};
use rand::RngExt;

/// Rows of 20 ms in a block: 2 s, several times what joint torque noise remembers; in short logs less, for enough blocks.
const LONGEST_BLOCK: usize = 100;
const SHORTEST_BLOCK: usize = 32;
const BLOCKS: usize = 30;

/// Fewest averaged rows in a block: neighbours are nearly independent.
const LEAST_ROWS: usize = 2;

/// Draws, and the largest of them from which the tail beyond is taken for exponential.
const DRAWS: usize = 4999;
const TAIL: usize = 50;

/// Fewest blocks: with fewer there are not enough sign patterns for any p-value that counts.
const FEWEST_BLOCKS: usize = 12;

/// The p-value of each kind given all others; None where the logs are too short for a test, or the kind has no functions.
pub(super) fn p_values(design: &Design, fit: &Fit, seed: u64, joint: usize) -> Vec<Option<f64>> {
    let blocks = blocks(design);
    let count = blocks.last().map_or(0, |last| last + 1);
    (0..design.kinds.len())
        .map(|kind| {
            let columns = design.kinds[kind].1.clone();
            if count < FEWEST_BLOCKS || columns.is_empty() {
                return None;
            }
            let mut strengths = fit.strengths.clone();
            strengths[kind] = 0.0;
            let own = design.z.columns(columns.start, columns.len()).into_owned();
            let y = DMatrix::from_columns(std::slice::from_ref(&design.y));
            let (own, residual) = match Posterior::new(design, &strengths, fit.noise) {
                Some(posterior) => {
                    (posterior.residual_of(design, &own, fit.noise), posterior.residual_of(design, &y, fit.noise))
                }
                None => (own, y),
            };
            let scores = scores(&own, &residual.column(0).into_owned(), &blocks, count);
            Some(flipped(&scores, seed, (joint * design.kinds.len() + kind) as u64))
        })
        .collect()
}

/// Block of each row: rows of one log that lie close together in time.
fn blocks(design: &Design) -> Vec<usize> {
    let bounds = [SHORTEST_BLOCK, LONGEST_BLOCK].map(|rows| (rows / design.together).max(LEAST_ROWS));
    let length = (design.time.len() / BLOCKS).clamp(bounds[0], bounds[1]);
    let mut blocks = Vec::with_capacity(design.time.len());
    let mut open: Option<(usize, usize, usize)> = None;
    for (&time, &log) in design.time.iter().zip(&design.log) {
        let block = match open {
            Some((start, own, block)) if own == log && time < start + length => block,
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

/// Probability of a squared sum of `scores`, one per block, as large as theirs under flipped signs. Where few draws are as large it is that of an
/// exponential tail (peaks over a threshold: Pickands, Annals of Statistics 3, 1975), as quadratic forms have, its mean excess two standard
/// errors above the estimate.
fn flipped(scores: &DMatrix<f64>, seed: u64, index: u64) -> f64 {
    let mut source = stream(seed, "variance_components", index);
    let mut draw = || {
        let mut sum = DVector::zeros(scores.nrows());
        for block in scores.column_iter() {
            let sign = if source.random::<bool>() { 1.0 } else { -1.0 };
            sum.axpy(sign, &block, 1.0);
        }
        sum.norm_squared()
    };
    let mut drawn: Vec<f64> = (0..DRAWS).map(|_| draw()).collect();
    drawn.sort_by(|a, b| b.total_cmp(a));
    let (observed, threshold) = (scores.column_sum().norm_squared(), drawn[TAIL]);
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

    #[test]
    fn the_tail_beyond_the_draws_is_that_of_chi_square() {
        // One column whose blocks are alike but for signs: flipped sums are normal, their squares chi-square of one degree.
        for (surplus, expected) in [(26, 0.01), (33, 1e-3), (44, 1e-5)] {
            let signs = (0..400).map(|block| if 2 * block < 400 + 2 * surplus { 0.05 } else { -0.05 });
            let p = flipped(&DMatrix::from_row_slice(1, 400, &signs.collect::<Vec<f64>>()), 1, 0);
            assert!(p > 0.7 * expected && p < 30.0 * expected, "{surplus}: {p}");
        }
    }

    #[test]
    fn too_few_blocks_are_no_test() {
        let mut design = one_kind_of_two(1.0, 0);
        design.time.iter_mut().for_each(|time| *time /= 10);
        assert_eq!(blocks(&design).last(), Some(&2));
        assert_eq!(p_values(&design, &fit(&design), 0, 0), [None, None]);
    }
}
