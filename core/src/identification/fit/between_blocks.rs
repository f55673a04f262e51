//! Standard deviations of a fit by the scatter between blocks of time.
//!
//! What a model lacks is not noise: it stays alike for as long as the arm is about the same place or speed, and a noise model of a few lags
//! does not see that. The covariance here is cluster-robust, the clusters being blocks of a second or more (Cameron and Miller, A
//! practitioner's guide to cluster-robust inference, Journal of Human Resources 50, 2015). A fit with as many parameters as there are
//! blocks takes much of the residual of each: it is scaled up by the inverse root of the share that is left (CR2: Bell and McCaffrey,
//! Survey Methodology 28, 2002), with which the covariance of white noise is unbiased.

use super::blocks::{blocks_of, log_rows};
use crate::identification::numerics::scaled_normal::unit_cholesky;
use crate::identification::regression::joint_regression::JointRegression;
use crate::identification::regression::linear_problem::LinearProblem;
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use std::ops::Range;

/// Blocks aimed at: enough for a standard deviation that is known to a ninth; and their least and largest length, s.
const BLOCKS: f64 = 40.0;
const SHORTEST_S: f64 = 1.0;
const LONGEST_S: f64 = 4.0;

/// Fewest blocks with rows: a standard deviation from fewer is itself uncertain.
const FEWEST: usize = 12;

/// Rows of a block that are looked at for the share that the fit takes of it.
const ROWS: usize = 100;

/// Share of a direction of a block's residual below which the fit has taken all of it.
const TAKEN: f64 = 1e-3;

/// Standard deviation of every parameter of a weighted fit, `beta` with the standard deviations `sigma` of the joints, whose rows have
/// these `times` (not a number between logs). None where there are too few blocks, or the rows looked at do not separate the parameters.
pub(super) fn between_blocks(
    joints: &[JointRegression],
    [beta, sigma]: [&[f64]; 2],
    times: &[f64],
) -> Option<Vec<f64>> {
    let blocks = blocks(times);
    let step = blocks.iter().map(|block| block.len() / ROWS).max()?.max(1);
    let part = |block: &Range<usize>| -> Vec<JointRegression> {
        joints.iter().map(|joint| joint.part(block.clone(), step)).collect()
    };
    let parts = blocks.iter().map(part);
    let (blocks, normals): (Vec<&Range<usize>>, Vec<DMatrix<f64>>) = blocks
        .iter()
        .zip(parts)
        .filter(|(_, parts)| parts.iter().any(|joint| joint.rows() > 0))
        .map(|(block, parts)| (block, LinearProblem::new(&parts, sigma, beta.len()).normal() * step as f64))
        .unzip();
    if blocks.len() < FEWEST {
        return None;
    }
    let root = unit_cholesky(&normals.iter().sum())?;
    let white = |matrix: &DMatrix<f64>| root.solve_lower_triangular(matrix);
    let scores = scores(joints, [beta, sigma], &blocks);
    let mut variance = DVector::zeros(beta.len());
    for (normal, score) in normals.iter().zip(&scores) {
        let taken = white(&white(normal)?.transpose())?;
        let SymmetricEigen { eigenvectors, eigenvalues } = SymmetricEigen::new(taken);
        let mut along = eigenvectors.tr_mul(&root.solve_lower_triangular(score)?);
        along.zip_apply(&eigenvalues, |score, taken| {
            *score *= if 1.0 - taken > TAKEN { (1.0 - taken).sqrt().recip() } else { 0.0 };
        });
        let own = root.tr_solve_lower_triangular(&(eigenvectors * along))?;
        variance += own.component_mul(&own);
    }
    Some(variance.iter().map(|variance: &f64| variance.sqrt()).collect())
}

/// Blocks of the rows of all logs.
fn blocks(times: &[f64]) -> Vec<Range<usize>> {
    let logs = log_rows(times);
    let seconds = |log: &Range<usize>| times[log.end - 1] - times[log.start];
    let length = (logs.iter().map(seconds).sum::<f64>() / BLOCKS).clamp(SHORTEST_S, LONGEST_S);
    logs.iter().flat_map(|log| blocks_of(log, ((seconds(log) / length) as usize).max(1))).collect()
}

/// Scores of the blocks, X'W r of their rows.
fn scores(joints: &[JointRegression], [beta, sigma]: [&[f64]; 2], blocks: &[&Range<usize>]) -> Vec<DVector<f64>> {
    let mut scores = vec![DVector::zeros(beta.len()); blocks.len()];
    for (joint, sigma) in joints.iter().zip(sigma) {
        let mut residual = joint.residual(beta);
        residual.iter_mut().zip(&joint.valid).for_each(|(r, &ok)| *r = if ok { *r / (sigma * sigma) } else { 0.0 });
        for (&parameter, column) in joint.parameters.iter().zip(joint.columns.iter()) {
            for (score, block) in scores.iter_mut().zip(blocks) {
                let both = column[(*block).clone()].iter().zip(&residual[(*block).clone()]);
                score[parameter] += both.map(|(x, r)| if *r == 0.0 { 0.0 } else { x * r }).sum::<f64>();
            }
        }
    }
    scores
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::channels::Channels;
    use crate::random;
    use rand_distr::{Distribution, StandardNormal};

    const ROWS_OF_LOG: usize = 4000;

    /// A log of 40 s of friction 2 in the direction of motion and `more` slow columns that play no part, under white noise of one and a
    /// disturbance of `size` that is another in every second. Friction as found, less 2, and its standard deviation.
    fn found(more: usize, size: f64, seed: u64) -> (f64, f64) {
        let mut source = random::stream(seed, "between blocks", 0);
        let mut normal = || -> f64 { StandardNormal.sample(&mut source) };
        let wave = |rate: f64| (0..ROWS_OF_LOG).map(|k| (rate * k as f64).sin()).collect::<Vec<f64>>();
        let mut columns = vec![(0..ROWS_OF_LOG).map(|k| (0.017 * k as f64).cos().signum()).collect(), wave(0.031)];
        columns.extend((0..more).map(|k| wave(0.0023 * (k + 1) as f64)));
        let disturbance: Vec<f64> = (0..ROWS_OF_LOG / 100).map(|_| size * normal()).collect();
        let torque = (0..ROWS_OF_LOG).map(|k| 2.0 * columns[0][k] + disturbance[k / 100] + normal()).collect();
        let valid = vec![true; ROWS_OF_LOG];
        let columns = Channels::from_vectors(&columns);
        let parameters: Vec<usize> = (0..columns.channels()).collect();
        let names: Vec<String> = parameters.iter().map(usize::to_string).collect();
        let joint = JointRegression { joint: "a".into(), parameters, columns, torque, valid };
        let problem = LinearProblem::new(std::slice::from_ref(&joint), &[1.0], names.len());
        let beta = problem.solve(&problem.right(std::slice::from_ref(&joint.torque)), &names).unwrap();
        let times: Vec<f64> = (0..ROWS_OF_LOG).map(|k| 0.01 * k as f64).collect();
        let std = between_blocks(&[joint], [beta.as_slice(), &[1.0]], &times).unwrap();
        (beta[0] - 2.0, std[0])
    }

    /// Root mean squares of the error and of the standard deviation over some draws.
    fn over_draws(more: usize, size: f64) -> [f64; 2] {
        let draws: Vec<(f64, f64)> = (0..100).map(|seed| found(more, size, seed)).collect();
        let rms = |of: fn(&(f64, f64)) -> f64| (draws.iter().map(|one| of(one).powi(2)).sum::<f64>() / 100.0).sqrt();
        [rms(|one| one.0), rms(|one| one.1)]
    }

    #[test]
    fn the_scatter_is_that_of_the_estimates() {
        for (more, size) in [(0, 0.0), (24, 0.0), (0, 1.0), (24, 1.0)] {
            let [error, std] = over_draws(more, size);
            // The root mean square of 100 errors is known to 7 %.
            assert!((std / error - 1.0).abs() < 0.25, "{more} columns, {size}: {std} for {error}");
        }
    }

    #[test]
    fn a_few_seconds_have_no_scatter_to_speak_of() {
        let times: Vec<f64> = (0..1150).map(|k| 0.01 * k as f64).collect();
        let joint = JointRegression {
            joint: "a".into(),
            parameters: vec![0],
            columns: Channels::from_vectors(&[vec![1.0; times.len()]]),
            torque: vec![0.5; times.len()],
            valid: vec![true; times.len()],
        };
        let one = [0.5];
        assert_eq!(between_blocks(std::slice::from_ref(&joint), [&one, &[1.0]], &times), None);
        let longer: Vec<f64> = times.iter().map(|t| 1.2 * t).collect();
        assert!(between_blocks(&[joint], [&one, &[1.0]], &longer).is_some());
    }
}
