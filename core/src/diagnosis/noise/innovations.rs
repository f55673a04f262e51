//! Innovations of autoregressive noise that is observed in part: rows near reversals are not seen, and logs start anew.
//!
//! A Kalman filter on the last samples predicts each valid row from all such rows before it, over gaps as well; the innovation
//! over its standard deviation is white with unit variance exactly (Jones, 1980, Maximum likelihood fitting of ARMA
//! models to time series with missing observations, Technometrics 22(3)). The filter is linear: torque and columns of the
//! model pass the same one.

use crate::identification::noise::AutoregressiveNoise;
use nalgebra::{DMatrix, DVector};
use std::ops::Range;

/// Share of the innovation's variance below which the state counts as known.
const KNOWN: f64 = 1e-10;

/// Turns noise of a given law into white noise of unit variance on the valid rows.
#[derive(Debug, Clone)]
pub(super) struct InnovationsFilter {
    noise: AutoregressiveNoise,
    /// Valid rows.
    rows: Vec<usize>,
    /// First rows of the logs.
    starts: Vec<usize>,
    /// Of every row: what to do.
    steps: Vec<Step>,
    /// Rows that need no state.
    long_runs: Vec<Range<usize>>,
}

#[derive(Debug, Clone)]
struct Step {
    /// Whether a log starts here.
    starts: bool,
    update: Update,
}

#[derive(Debug, Clone)]
enum Update {
    /// The row is not valid.
    Unseen,
    /// All that the prediction rests on was seen.
    Known,
    /// Standard deviation of the innovation over that of the noise's own, and the Kalman gain.
    Uncertain(f64, Vec<f64>),
}

impl InnovationsFilter {
    /// For rows of which `valid` count; `starts` are the first rows of every log.
    pub(super) fn new(noise: AutoregressiveNoise, valid: &[bool], starts: &[usize]) -> Self {
        let order = noise.coefficients.len();
        let stationary = stationary_covariance(&noise.coefficients);
        let mut covariance = stationary.clone();
        let mut steps = Vec::with_capacity(valid.len());
        for (row, &seen) in valid.iter().enumerate() {
            let begins = starts.contains(&row);
            // One step ahead: the state is (e(t - 1), .., e(t - p)) before, (e(t), .., e(t - p + 1)) after.
            let mut ahead = if begins { stationary.clone() } else { advanced(&covariance, &noise.coefficients) };
            let update = if !seen {
                Update::Unseen
            } else if order == 0 {
                Update::Known
            } else {
                let variance = ahead[(0, 0)];
                let gain = ahead.column(0) / variance;
                ahead -= &gain * gain.transpose() * variance;
                match !begins && (variance - 1.0).abs() < KNOWN {
                    true => Update::Known,
                    false => Update::Uncertain(variance.sqrt(), gain.iter().copied().collect()),
                }
            };
            covariance = ahead;
            steps.push(Step { starts: begins, update });
        }
        let rows = (0..valid.len()).filter(|&row| valid[row]).collect();
        let long_runs = long_runs(&steps, order);
        InnovationsFilter { noise, rows, starts: starts.to_vec(), steps, long_runs }
    }

    /// The noise.
    pub(super) fn noise(&self) -> &AutoregressiveNoise {
        &self.noise
    }

    /// Valid rows.
    pub(super) fn rows(&self) -> &[usize] {
        &self.rows
    }

    /// First rows of the logs.
    pub(super) fn starts(&self) -> &[usize] {
        &self.starts
    }

    /// The same colour with the standard deviation times `factor`.
    pub(super) fn scale_noise(&mut self, factor: f64) {
        self.noise.innovation_std *= factor;
    }

    /// A signal over all rows, whitened; rows that are not valid are gone.
    pub(super) fn apply(&self, signal: &[f64]) -> Vec<f64> {
        let coefficients = &self.noise.coefficients;
        let scale = 1.0 / self.noise.innovation_std;
        let order = coefficients.len();
        let mut state = vec![0.0; order];
        let mut white = Vec::with_capacity(self.rows.len());
        let mut long = self.long_runs.iter();
        let mut next = long.next();
        let mut row = 0;
        while row < self.steps.len() {
            // Where the last rows were all seen they are the state: a filter of finite length, lag by lag.
            if let Some(run) = next.filter(|run| run.start == row) {
                let first = white.len();
                white.resize(first + run.len(), 0.0);
                whiten(coefficients, scale, &signal[run.start - order..run.end], &mut white[first..]);
                state.iter_mut().zip(signal[run.end - order..run.end].iter().rev()).for_each(|(e, &past)| *e = past);
                row = run.end;
                next = long.next();
                continue;
            }
            let (step, value) = (&self.steps[row], signal[row]);
            row += 1;
            if step.starts {
                state.fill(0.0);
            }
            let predicted: f64 = coefficients.iter().zip(&state).map(|(a, e)| a * e).sum();
            if !state.is_empty() {
                state.rotate_right(1);
                state[0] = predicted;
            }
            match &step.update {
                Update::Unseen => {}
                Update::Known => {
                    white.push((value - predicted) * scale);
                    if let Some(first) = state.first_mut() {
                        *first = value;
                    }
                }
                Update::Uncertain(std, gain) => {
                    let new = value - predicted;
                    white.push(new * scale / std);
                    state.iter_mut().zip(gain).for_each(|(e, gain)| *e += gain * new);
                }
            }
        }
        white
    }
}

/// Rows that stay in registers while all lags are taken off them.
const AT_ONCE: usize = 8;

/// Innovations of a signal of which `coefficients` many rows come before, times `scale`.
fn whiten(coefficients: &[f64], scale: f64, signal: &[f64], white: &mut [f64]) {
    let order = coefficients.len();
    let mut blocks = white.chunks_exact_mut(AT_ONCE);
    for (first, block) in (order..).step_by(AT_ONCE).zip(&mut blocks) {
        let mut own = [0.0; AT_ONCE];
        own.copy_from_slice(&signal[first..first + AT_ONCE]);
        for (lag, a) in coefficients.iter().enumerate() {
            let past = &signal[first - lag - 1..][..AT_ONCE];
            own.iter_mut().zip(past).for_each(|(x, e)| *x -= a * e);
        }
        block.iter_mut().zip(own).for_each(|(white, x)| *white = x * scale);
    }
    let rest = blocks.into_remainder();
    let first = signal.len() - rest.len();
    for (k, x) in rest.iter_mut().enumerate() {
        let past = coefficients.iter().enumerate().map(|(lag, a)| (a, signal[first + k - lag - 1]));
        *x = past.fold(signal[first + k], |own, (a, e)| own - a * e) * scale;
    }
}

/// Runs of rows whose prediction rests on rows that were all seen: known, and behind as many seen rows of the same log as the `order`.
fn long_runs(steps: &[Step], order: usize) -> Vec<Range<usize>> {
    let (mut runs, mut in_a_row): (Vec<Range<usize>>, usize) = (Vec::new(), 0);
    for (row, step) in steps.iter().enumerate() {
        if step.starts {
            in_a_row = 0;
        }
        if let Update::Known = step.update
            && in_a_row >= order
        {
            match runs.last_mut().filter(|run| run.end == row) {
                Some(run) => run.end = row + 1,
                None => runs.push(row..row + 1),
            }
        }
        in_a_row = if let Update::Unseen = step.update { 0 } else { in_a_row + 1 };
    }
    runs
}

/// Covariance of the state one step ahead, in units of the innovation's variance.
fn advanced(covariance: &DMatrix<f64>, coefficients: &[f64]) -> DMatrix<f64> {
    let order = coefficients.len();
    if order == 0 {
        return DMatrix::zeros(0, 0);
    }
    let a = DVector::from_column_slice(coefficients);
    let carried = covariance * &a;
    DMatrix::from_fn(order, order, |r, c| match (r, c) {
        (0, 0) => a.dot(&carried) + 1.0,
        (0, _) => carried[c - 1],
        (_, 0) => carried[r - 1],
        _ => covariance[(r - 1, c - 1)],
    })
}

/// Covariance of consecutive samples of the noise in units of the innovation's variance: the autocovariances that the
/// Yule-Walker equations give back.
fn stationary_covariance(coefficients: &[f64]) -> DMatrix<f64> {
    let order = coefficients.len();
    // r(k) - sum_j a_j r(|k - j|) = 1 for k = 0, else 0.
    let mut equations = DMatrix::identity(order + 1, order + 1);
    for k in 0..=order {
        for (j, a) in coefficients.iter().enumerate() {
            equations[(k, k.abs_diff(j + 1))] -= a;
        }
    }
    let mut right = DVector::zeros(order + 1);
    right[0] = 1.0;
    let lags = equations.lu().solve(&right).unwrap_or(right);
    DMatrix::from_fn(order, order, |r, c| lags[r.abs_diff(c)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random;

    fn noise() -> AutoregressiveNoise {
        AutoregressiveNoise { coefficients: vec![1.2, -0.5], innovation_std: 2.0 }
    }

    /// The sum of squares of the innovations is the quadratic form of the inverse covariance, whatever rows are seen.
    #[test]
    fn squares_sum_to_the_likelihood_of_the_rows_seen() {
        let covariance = stationary_covariance(&[1.2, -0.5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let valid = [true, false, true, true, false, false, true, true, true, true];
        let signal: Vec<f64> = (0..10).map(|k| f64::from(k * k % 7) - 2.0).collect();
        let filter = InnovationsFilter::new(noise(), &valid, &[0]);
        let sum: f64 = filter.apply(&signal).iter().map(|x| x * x).sum();
        let seen: Vec<usize> = (0..10).filter(|&k| valid[k]).collect();
        let part = DMatrix::from_fn(seen.len(), seen.len(), |r, c| 4.0 * covariance[(seen[r], seen[c])]);
        let values = DVector::from_iterator(seen.len(), seen.iter().map(|&k| signal[k]));
        let expected = values.dot(&part.lu().solve(&values).unwrap());
        assert!((sum / expected - 1.0).abs() < 1e-10, "{sum} {expected}");
    }

    #[test]
    fn noise_becomes_white_over_gaps_and_from_the_start_of_each_log() {
        let e = noise().simulate(40_000, &mut random::stream(1, "innovations", 0));
        let valid: Vec<bool> = (0..e.len()).map(|t| t % 9 > 2).collect();
        let starts: Vec<usize> = (0..40_000).step_by(50).collect();
        let white = InnovationsFilter::new(noise(), &valid, &starts).apply(&e);
        let mean =
            |lag: usize| white.iter().zip(&white[lag..]).map(|(a, b)| a * b).sum::<f64>() / (white.len() - lag) as f64;
        assert!((mean(0) - 1.0).abs() < 0.03, "{}", mean(0));
        assert!(mean(1).abs() < 0.02 && mean(3).abs() < 0.02, "{} {}", mean(1), mean(3));
    }

    #[test]
    fn behind_enough_rows_innovations_are_what_the_lags_leave() {
        let signal: Vec<f64> = (0..61).map(|k| (0.7 * f64::from(k)).sin()).collect();
        let white = InnovationsFilter::new(noise(), &[true; 61], &[0]).apply(&signal);
        assert_eq!(white.len(), 61);
        for k in 2..61 {
            let expected = (signal[k] - 1.2 * signal[k - 1] + 0.5 * signal[k - 2]) / 2.0;
            assert!((white[k] - expected).abs() < 1e-14, "{k}: {} {expected}", white[k]);
        }
    }

    #[test]
    fn white_noise_is_only_scaled() {
        let filter = InnovationsFilter::new(
            AutoregressiveNoise { coefficients: vec![], innovation_std: 2.0 },
            &[true, false, true],
            &[0],
        );
        assert_eq!(filter.apply(&[2.0, 5.0, -4.0]), [1.0, -2.0]);
    }
}
