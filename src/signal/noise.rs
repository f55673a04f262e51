//! The noise on a signal whose own content is smooth.

/// Standard deviation of the white noise on a smooth signal, from its third differences (whose coefficients are 1, 3, 3, 1).
pub fn white_noise(signal: &[f64]) -> f64 {
    let third = signal.windows(4).map(|x| x[3] - 3.0 * x[2] + 3.0 * x[1] - x[0]).filter(|d| d.is_finite());
    let (sum, count) = third.fold((0.0, 0usize), |(sum, count), d| (sum + d * d, count + 1));
    (sum / (20.0 * count.max(1) as f64)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random;
    use rand_distr::{Distribution, StandardNormal};

    #[test]
    fn white_noise_is_told_from_a_smooth_signal() {
        let mut source = random::stream(4, "white noise", 0);
        let mut draw = || -> f64 { StandardNormal.sample(&mut source) };
        let signal: Vec<f64> = (0..20_000).map(|k| (0.004 * f64::from(k)).sin() + 1e-3 * draw()).collect();
        assert!((white_noise(&signal) / 1e-3 - 1.0).abs() < 0.05);
    }
}
