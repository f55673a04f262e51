//! Autoregressive model of residual noise: what makes standard deviations right when noise has a colour.

/// Noise e(t) = sum_k a_k e(t - k) + w(t), with w white of a given standard deviation.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct AutoregressiveNoise {
    /// a_1 .. a_p.
    pub coefficients: Vec<f64>,
    /// Standard deviation of w.
    pub innovation_std: f64,
}

impl AutoregressiveNoise {
    /// Fits a model of the given order to a residual by the Yule-Walker equations (Levinson-Durbin recursion), which
    /// always give a stable model. Samples where `valid` is false are left out; the autocovariance is taken over the
    /// pairs that remain. `lost` is the number of parameters that were fitted to make the residual.
    pub fn fit(residual: &[f64], valid: &[bool], order: usize, lost: f64) -> Self {
        let covariance = autocovariance(residual, valid, order, lost);
        let mut coefficients: Vec<f64> = Vec::with_capacity(order);
        let mut variance = covariance[0];
        for lag in 1..=order {
            if variance <= 0.0 {
                break;
            }
            let carried: f64 = coefficients.iter().enumerate().map(|(k, a)| a * covariance[lag - 1 - k]).sum();
            let reflection = (covariance[lag] - carried) / variance;
            let mirrored: Vec<f64> = coefficients.iter().rev().copied().collect();
            for (a, m) in coefficients.iter_mut().zip(mirrored) {
                *a -= reflection * m;
            }
            coefficients.push(reflection);
            variance *= 1.0 - reflection * reflection;
        }
        AutoregressiveNoise { coefficients, innovation_std: variance.max(0.0).sqrt() }
    }

    /// Turns `signal` into L' signal, where L is the filter that makes this noise from unit white noise: the sum of
    /// squares of the result is the variance of signal . noise.
    pub fn color_backward(&self, signal: &mut [f64]) {
        for t in (0..signal.len()).rev() {
            let mut value = self.innovation_std * signal[t];
            for (k, a) in self.coefficients.iter().enumerate() {
                if let Some(later) = signal.get(t + k + 1) {
                    value += a * later;
                }
            }
            signal[t] = value;
        }
    }
}

/// Autocovariance at lags 0..=`most`, tapered as 1/N (biased), which keeps it positive definite, and scaled for the
/// `lost` degrees of freedom.
fn autocovariance(residual: &[f64], valid: &[bool], most: usize, lost: f64) -> Vec<f64> {
    let kept: Vec<f64> = residual.iter().zip(valid).map(|(&r, &ok)| if ok { r } else { 0.0 }).collect();
    let count = valid.iter().filter(|&&ok| ok).count() as f64;
    let scale = 1.0 / (count - lost).max(1.0);
    (0..=most).map(|lag| scale * kept.iter().zip(&kept[lag.min(kept.len())..]).map(|(a, b)| a * b).sum::<f64>()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random;
    use rand_distr::{Distribution, StandardNormal};

    fn second_order(samples: usize) -> Vec<f64> {
        let mut source = random::stream(3, "test", 0);
        let mut e = vec![0.0; samples];
        for t in 0..samples {
            let white: f64 = StandardNormal.sample(&mut source);
            let one = if t > 0 { e[t - 1] } else { 0.0 };
            let two = if t > 1 { e[t - 2] } else { 0.0 };
            e[t] = 1.2 * one - 0.5 * two + 2.0 * white;
        }
        e
    }

    #[test]
    fn finds_the_coefficients_of_a_second_order_noise_despite_gaps() {
        let e = second_order(100_000);
        let valid: Vec<bool> = (0..e.len()).map(|t| t % 1000 > 50).collect();
        let fit = AutoregressiveNoise::fit(&e, &valid, 2, 0.0);
        assert!((fit.coefficients[0] - 1.2).abs() < 0.02, "{fit:?}");
        assert!((fit.coefficients[1] + 0.5).abs() < 0.02, "{fit:?}");
        assert!((fit.innovation_std - 2.0).abs() < 0.05, "{fit:?}");
    }

    #[test]
    fn backward_colouring_gives_the_variance_of_a_weighted_sum() {
        // Variance of e1 + e2 of a first-order noise by hand: 2 r0 (1 + a) with r0 = s^2 / (1 - a^2). Started from
        // rest instead of stationarity the filter sees only its own samples, so leave it a run-in.
        let noise = AutoregressiveNoise { coefficients: vec![0.6], innovation_std: 1.5 };
        let mut weights = vec![0.0; 200];
        weights[150] = 1.0;
        weights[151] = 1.0;
        noise.color_backward(&mut weights);
        let variance: f64 = weights.iter().map(|v| v * v).sum();
        let expected = 2.0 * (1.5 * 1.5 / (1.0 - 0.36)) * 1.6;
        assert!((variance / expected - 1.0).abs() < 1e-12, "{variance} {expected}");
    }
}
