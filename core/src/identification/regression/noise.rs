//! Autoregressive model of residual noise: what makes standard deviations right when noise has a colour.

use crate::channels::Channels;
use crate::identification::numerics::sequences::{Law, lagged_products, recur_backward, recur_forward};
use rand::Rng;
use rand_distr::{Distribution, StandardNormal};

/// Samples after which simulated noise has forgotten that it started from rest.
const RUN_IN: usize = 300;

/// Noise e(t) = sum_k a_k e(t - k) + w(t), with w white of a given standard deviation.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct AutoregressiveNoise {
    /// a_1 .. a_p.
    pub coefficients: Vec<f64>,
    /// Standard deviation of w.
    pub innovation_std: f64,
}

impl AutoregressiveNoise {
    /// The model whose autocovariances at lags 0..=order are given, by the Yule-Walker equations (Levinson-Durbin
    /// recursion). Positive definite autocovariances, such as [`autocovariance`] gives, make a stable model.
    pub fn from_autocovariance(covariance: &[f64]) -> Self {
        let order = covariance.len() - 1;
        let mut coefficients: Vec<f64> = Vec::with_capacity(order);
        let mut variance = covariance[0];
        for lag in 1..=order {
            let carried: f64 = coefficients.iter().enumerate().map(|(k, a)| a * covariance[lag - 1 - k]).sum();
            let reflection = (covariance[lag] - carried) / variance;
            // Rounding or a bias correction can leave the last lags outside what any noise has: stop before them.
            if !(variance > 0.0 && reflection.abs() < 1.0) {
                break;
            }
            let mirrored: Vec<f64> = coefficients.iter().rev().copied().collect();
            for (a, m) in coefficients.iter_mut().zip(mirrored) {
                *a -= reflection * m;
            }
            coefficients.push(reflection);
            variance *= 1.0 - reflection * reflection;
        }
        AutoregressiveNoise { coefficients, innovation_std: variance.max(0.0).sqrt() }
    }

    /// Variance at an angle of `omega` a sample over that of white noise of unit variance.
    pub fn power(&self, omega: f64) -> f64 {
        let parts = self.coefficients.iter().zip(1..).map(|(a, lag)| {
            let (sin, cos) = (omega * f64::from(lag)).sin_cos();
            [a * cos, a * sin]
        });
        let [cos, sin] = parts.fold([0.0; 2], |[c, s], [cos, sin]| [c + cos, s + sin]);
        self.innovation_std.powi(2) / ((1.0 - cos).powi(2) + sin.powi(2))
    }

    /// Standard deviation of the noise itself: the impulse response to an innovation, summed in squares.
    pub fn std(&self) -> f64 {
        const MEMORY: usize = 2000;
        let mut response = vec![1.0];
        for t in 1..MEMORY {
            let past = self.coefficients.iter().enumerate();
            response.push(past.filter(|(k, _)| *k < t).map(|(k, a)| a * response[t - 1 - k]).sum());
        }
        self.innovation_std * response.iter().map(|x: &f64| x * x).sum::<f64>().sqrt()
    }

    /// Samples of this noise.
    pub fn simulate(&self, samples: usize, source: &mut impl Rng) -> Vec<f64> {
        simulate_together(std::slice::from_ref(self), samples, source).pop().unwrap_or_default()
    }

    /// Turns every signal of `table` into L' signal, where L is the filter that makes this noise from unit white noise: the
    /// sum of squares of the result is the variance of signal . noise.
    pub(crate) fn color_backward(&self, table: &mut Channels) {
        recur_backward(table, self.innovation_std, &self.coefficients);
    }
}

/// Samples of each of several noises, one after the other from the same source.
pub(crate) fn simulate_together(
    noises: &[AutoregressiveNoise],
    samples: usize,
    source: &mut impl Rng,
) -> Vec<Vec<f64>> {
    let mut table = Channels::zeros(noises.len(), RUN_IN + samples);
    table.as_mut_slice().fill_with(|| StandardNormal.sample(source));
    let laws: Vec<Law> =
        noises.iter().map(|noise| Law { gain: noise.innovation_std, coefficients: &noise.coefficients }).collect();
    recur_forward(&mut table, &laws);
    table.iter().map(|noise| noise[RUN_IN..].to_vec()).collect()
}

/// Autocovariance at lags 0..=`most` of the samples where `valid`, divided by their number at every lag, which keeps it
/// positive definite.
pub(crate) fn autocovariance(signal: &[f64], valid: &[bool], most: usize) -> Vec<f64> {
    let kept: Vec<f64> = signal.iter().zip(valid).map(|(&value, &ok)| if ok { value } else { 0.0 }).collect();
    let count = valid.iter().filter(|&&ok| ok).count().max(1) as f64;
    lagged_products(&kept, most).into_iter().map(|sum| sum / count).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random;

    fn second_order(samples: usize) -> Vec<f64> {
        let noise = AutoregressiveNoise { coefficients: vec![1.2, -0.5], innovation_std: 2.0 };
        noise.simulate(samples, &mut random::stream(3, "test", 0))
    }

    #[test]
    fn simulated_noise_has_the_variance_of_its_law() {
        // Second order by hand: r0 = s^2 (1 - a2) / ((1 + a2) ((1 - a2)^2 - a1^2)).
        let (a1, a2, s): (f64, f64, f64) = (1.2, -0.5, 2.0);
        let expected = s * s * (1.0 - a2) / ((1.0 + a2) * ((1.0 - a2).powi(2) - a1 * a1));
        let e = second_order(400_000);
        let variance = autocovariance(&e, &vec![true; e.len()], 0)[0];
        assert!((variance / expected - 1.0).abs() < 0.02, "{variance} {expected}");
    }

    #[test]
    fn the_power_of_all_frequencies_is_the_variance() {
        let noise = AutoregressiveNoise { coefficients: vec![1.2, -0.5], innovation_std: 2.0 };
        let points = 4000;
        let omega = |k: i32| std::f64::consts::PI * (f64::from(k) + 0.5) / f64::from(points);
        let mean = (0..points).map(|k| noise.power(omega(k))).sum::<f64>() / f64::from(points);
        assert!((mean / noise.std().powi(2) - 1.0).abs() < 1e-9, "{mean}");
        assert!((noise.power(0.0) - 4.0 / 0.09).abs() < 1e-9, "2^2 / (1 - 1.2 + 0.5)^2");
    }

    #[test]
    fn finds_the_coefficients_of_a_second_order_noise_despite_gaps() {
        let e = second_order(100_000);
        let valid: Vec<bool> = (0..e.len()).map(|t| t % 1000 > 50).collect();
        let fit = AutoregressiveNoise::from_autocovariance(&autocovariance(&e, &valid, 2));
        assert!((fit.coefficients[0] - 1.2).abs() < 0.02, "{fit:?}");
        assert!((fit.coefficients[1] + 0.5).abs() < 0.02, "{fit:?}");
        assert!((fit.innovation_std - 2.0).abs() < 0.05, "{fit:?}");
    }

    #[test]
    fn backward_colouring_gives_the_variance_of_a_weighted_sum() {
        // Variance of e1 + e2 of a first-order noise by hand: 2 r0 (1 + a) with r0 = s^2 / (1 - a^2). Started from
        // rest instead of stationarity the filter sees only its own samples, so leave it a run-in.
        let noise = AutoregressiveNoise { coefficients: vec![0.6], innovation_std: 1.5 };
        let mut weights = Channels::zeros(1, 200);
        weights.as_mut_slice()[150..152].fill(1.0);
        noise.color_backward(&mut weights);
        let variance: f64 = weights.as_slice().iter().map(|v| v * v).sum();
        let expected = 2.0 * (1.5 * 1.5 / (1.0 - 0.36)) * 1.6;
        assert!((variance / expected - 1.0).abs() < 1e-12, "{variance} {expected}");
    }
}
