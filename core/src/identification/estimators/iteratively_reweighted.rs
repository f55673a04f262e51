//! Iteratively reweighted least squares: rows far from the model count less (Huber, "Robust statistics", 1981).

use super::covariance::assemble;
use super::{Data, Estimator};
use crate::channels::Channels;
use crate::error::Result;
use crate::identification::regression::joint_regression::JointRegression;
use crate::identification::regression::least_squares::{Estimate, require_rows, weighted_solution};

/// Residual over its scale beyond which a row counts less: 95 % efficient where the noise is normal after all.
const HUBER: f64 = 1.345;

/// Median of the absolute value of a normal variable of unit variance.
const NORMAL_MEDIAN: f64 = 0.674_489_750_196_082;

/// Most rounds of weights. The Huber loss is convex: they converge, and the change after these is far below the noise.
const ROUNDS: usize = 30;

/// Change of every weight at which they have converged.
const SETTLED: f64 = 1e-4;

/// Huber weights within each joint, joints weighted by the median of their absolute residuals.
#[derive(Debug, Clone, Copy)]
pub(crate) struct IterativelyReweighted;

impl Estimator for IterativelyReweighted {
    fn name(&self) -> &'static str {
        "irls"
    }

    fn title(&self) -> &'static str {
        "robust, by iteratively reweighted least squares"
    }

    fn estimate(&self, data: &Data) -> Result<Estimate> {
        require_rows(data.rows)?;
        let mut sigma = vec![1.0; data.rows.len()];
        let mut weights: Vec<Vec<f64>> = data.rows.iter().map(|joint| vec![1.0; joint.torque.len()]).collect();
        let mut beta = Vec::new();
        for _ in 0..ROUNDS {
            let roots = |weights: &[f64]| -> Vec<f64> { weights.iter().map(|w| w.sqrt()).collect() };
            let scaled: Vec<JointRegression> =
                data.rows.iter().zip(&weights).map(|(joint, w)| times(joint, &roots(w))).collect();
            beta = weighted_solution(&scaled, &sigma, data.names)?;
            let mut change: f64 = 0.0;
            for ((joint, s), weights) in data.rows.iter().zip(&mut sigma).zip(&mut weights) {
                let residual = joint.residual(&beta);
                *s = scale(joint, &residual);
                for (weight, r) in weights.iter_mut().zip(&residual) {
                    let next = (HUBER * *s / r.abs()).min(1.0);
                    change = change.max((next - *weight).abs());
                    *weight = next;
                }
            }
            if change < SETTLED {
                break;
            }
        }
        let instruments: Vec<JointRegression> =
            data.rows.iter().zip(&weights).map(|(joint, weights)| times(joint, weights)).collect();
        assemble(&instruments, data.rows, beta, &sigma, data.names)
    }
}

/// The rows of a joint, torque and columns, times a factor each.
fn times(joint: &JointRegression, factors: &[f64]) -> JointRegression {
    let product = |signal: &[f64]| -> Vec<f64> { signal.iter().zip(factors).map(|(x, f)| x * f).collect() };
    let columns: Channels = joint.columns.map(|_, column| product(column));
    JointRegression { columns, torque: product(&joint.torque), ..joint.clone() }
}

/// Standard deviation of the residual by its median absolute value, above rounding.
fn scale(joint: &JointRegression, residual: &[f64]) -> f64 {
    let mut sizes: Vec<f64> = residual.iter().zip(&joint.valid).filter(|(_, ok)| **ok).map(|(r, _)| r.abs()).collect();
    let middle = sizes.len() / 2;
    let (_, median, _) = sizes.select_nth_unstable_by(middle, f64::total_cmp);
    let largest = joint.torque.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    (*median / NORMAL_MEDIAN).max(1e-12 * largest).max(f64::MIN_POSITIVE)
}
