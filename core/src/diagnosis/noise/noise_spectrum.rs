//! The spectrum of noise, estimated from the residual of a regression.
//!
//! A regression with many smooth columns takes most of what is slow. How far the noise differs from its model at some frequency must be
//! estimated from the residual. If the model of the noise is right, the mean square of whitened residuals at a frequency is the share of
//! the degrees of freedom there that the regression does not use. The ratio of the observed mean square to that share is fitted by a smooth
//! curve over the logarithm of the frequency, with the likelihood of a gamma law (Whittle's). The modelled spectrum is multiplied by that
//! curve. The estimate is that of restricted maximum likelihood (Patterson and Thompson, Biometrika 58, 1971).

use crate::identification::noise::AutoregressiveNoise;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use rustdct::DctPlanner;
use std::f64::consts::PI;

/// Frequencies, over the highest that rows hold, between which the logarithm of the ratio is straight over that of the frequency.
const KNOTS: [f64; 8] = [0.01, 0.02, 0.04, 0.08, 0.16, 0.32, 0.64, 1.0];

/// Weight of the squares of the curve's bends: bins enough of a frequency's surroundings outvote it.
const SMOOTH: f64 = 2.0;

/// Newton's steps towards the curve, and the longest.
const STEPS: usize = 12;
const LONGEST_STEP: f64 = 1.0;

/// Curvature without any observation.
const LEAST_CURVATURE: f64 = 1e-6;

/// Frequencies at which the spectrum is summed to autocovariances.
const GRID: usize = 1024;

/// The noise, of `order`, as whitened residuals show it: `left` is the residual of whitened torque under the regression onto the
/// orthonormal `basis`, whitened by `noise`.
pub(super) fn corrected(
    noise: &AutoregressiveNoise,
    left: &[f64],
    basis: &[Vec<f64>],
    order: usize,
) -> AutoregressiveNoise {
    let transform = DctPlanner::new().plan_dct2(left.len());
    let energies = |signal: &[f64]| -> Vec<f64> {
        let mut buffer = signal.to_vec();
        transform.process_dct2(&mut buffer);
        // As if orthonormal: the transform's own rows have a square norm of half the length, the first one of all of it.
        let length = left.len() as f64;
        buffer.iter().enumerate().map(|(k, x)| x * x / if k == 0 { length } else { 0.5 * length }).collect()
    };
    let observed = energies(left);
    let mut free = vec![1.0; left.len()];
    let taken: Vec<Vec<f64>> = basis.par_iter().map(|direction| energies(direction)).collect();
    for taken in taken {
        free.iter_mut().zip(taken).for_each(|(free, taken)| *free -= taken);
    }
    let frequency = |k: usize, of: usize| (k as f64 + 0.5) / of as f64;
    let weights: Vec<[(usize, f64); 2]> = (0..left.len()).map(|k| between(frequency(k, left.len()))).collect();
    let curve = fitted(&weights, &observed, &free);
    let spectrum: Vec<f64> = (0..GRID)
        .map(|k| frequency(k, GRID))
        .map(|frequency| noise.power(PI * frequency) * at(&curve, &between(frequency)).exp())
        .collect();
    let lag = |lag: usize| {
        let terms = spectrum.iter().enumerate().map(|(k, power)| power * (PI * frequency(k, GRID) * lag as f64).cos());
        terms.sum::<f64>() / GRID as f64
    };
    AutoregressiveNoise::from_autocovariance(&(0..=order).map(lag).collect::<Vec<f64>>())
}

/// The knots to either side of a frequency, with the weights of a line over its logarithm.
fn between(frequency: f64) -> [(usize, f64); 2] {
    let after = KNOTS.partition_point(|knot| *knot < frequency).clamp(1, KNOTS.len() - 1);
    let (low, high) = (KNOTS[after - 1].ln(), KNOTS[after].ln());
    let share = ((frequency.ln() - low) / (high - low)).clamp(0.0, 1.0);
    [(after - 1, 1.0 - share), (after, share)]
}

/// The curve between two knots.
fn at(curve: &DVector<f64>, pair: &[(usize, f64); 2]) -> f64 {
    pair.iter().map(|(knot, weight)| weight * curve[*knot]).sum()
}

/// Logarithms of the ratio at the knots, by Fisher scoring.
fn fitted(weights: &[[(usize, f64); 2]], observed: &[f64], free: &[f64]) -> DVector<f64> {
    let knots = KNOTS.len();
    let bends = DMatrix::from_fn(knots - 2, knots, |row, knot| match knot.wrapping_sub(row) {
        0 | 2 => 1.0,
        1 => -2.0,
        _ => 0.0,
    });
    let smooth = SMOOTH * bends.tr_mul(&bends);
    let mut curve = DVector::zeros(knots);
    for _ in 0..STEPS {
        let mut slope = &smooth * &curve;
        let mut curvature = &smooth + DMatrix::identity(knots, knots) * LEAST_CURVATURE;
        for ((pair, observed), free) in weights.iter().zip(observed).zip(free) {
            let relative = observed * (-at(&curve, pair)).exp();
            for (knot, weight) in pair {
                slope[*knot] += 0.5 * weight * (free - relative);
                for (other, by) in pair {
                    curvature[(*knot, *other)] += 0.25 * weight * by * (free.max(0.0) + relative);
                }
            }
        }
        let Some(factors) = curvature.cholesky() else { break };
        let step = factors.solve(&slope).map(|step| step.clamp(-LONGEST_STEP, LONGEST_STEP));
        curve -= step;
    }
    curve
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random;
    use rand_distr::{Distribution, StandardNormal};

    #[test]
    fn a_frequency_lies_between_its_knots() {
        assert_eq!(between(0.04), [(1, 0.0), (2, 1.0)]);
        let middle = (0.16f64 * 0.32).sqrt();
        let [(low, a), (high, b)] = between(middle);
        assert!(low == 4 && high == 5 && (a - 0.5).abs() < 1e-12 && (b - 0.5).abs() < 1e-12);
        assert_eq!(between(1e-6), [(0, 1.0), (1, 0.0)]);
        assert_eq!(between(1.0), [(6, 0.0), (7, 1.0)]);
    }

    #[test]
    fn the_curve_goes_through_what_many_bins_say() {
        // Twice as much as expected below a tenth of all frequencies, half of each of which is free.
        let bins = 40_000;
        let weights: Vec<_> = (0..bins).map(|k| between((k as f64 + 0.5) / bins as f64)).collect();
        let free = vec![0.5; bins];
        let observed: Vec<f64> = (0..bins).map(|k| if k < bins / 10 { 1.0 } else { 0.5 }).collect();
        let curve = fitted(&weights, &observed, &free);
        assert!((curve[0] - 2.0f64.ln()).abs() < 0.1 && curve[6].abs() < 0.05, "{curve}");
        assert!(fitted(&weights, &vec![0.0; bins], &vec![0.0; bins]).norm() < 1e-12, "nothing seen, nothing changed");
    }

    /// White noise of unit variance taken for a model that is twice too strong: one correction brings it to one.
    #[test]
    fn a_wrong_scale_is_made_good() {
        let mut source = random::stream(4, "scale", 0);
        let left: Vec<f64> = (0..4000)
            .map(|_| {
                let noise: f64 = StandardNormal.sample(&mut source);
                0.5 * noise
            })
            .collect();
        let wrong = AutoregressiveNoise { coefficients: vec![], innovation_std: 2.0 };
        let right = corrected(&wrong, &left, &[], 3);
        assert!((right.innovation_std - 1.0).abs() < 0.05, "{right:?}");
        assert!(right.coefficients.iter().all(|a| a.abs() < 0.1), "{right:?}");
    }
}
