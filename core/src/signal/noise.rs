//! The noise on a signal whose own content is smooth.

use rustdct::DctPlanner;
use std::f64::consts::PI;

/// Share of the rate above which the spectrum of a smooth signal holds nothing but noise.
const NOISE_SHARE: f64 = 0.1;

/// Mean square of Hann's window.
const HANN_POWER: f64 = 0.375;

/// Median of the square of a standard normal number.
const MEDIAN_SQUARE: f64 = 0.454_936;

/// Standard deviation of the white noise on a smooth signal, from its third differences (whose coefficients are 1, 3, 3, 1).
pub fn white_noise(signal: &[f64]) -> f64 {
    let third = signal.windows(4).map(|x| x[3] - 3.0 * x[2] + 3.0 * x[1] - x[0]).filter(|d| d.is_finite());
    let (sum, count) = third.fold((0.0, 0usize), |(sum, count), d| (sum + d * d, count + 1));
    (sum / (20.0 * count.max(1) as f64)).sqrt()
}

/// Standard deviation of the white noise on a smooth signal, from the median of its spectrum above a tenth of the rate: unlike
/// [`white_noise`] it does not take lines for noise, such as the images of positions that are held over some samples.
pub fn noise_floor(signal: &[f64]) -> f64 {
    let mut third: Vec<f64> = signal.windows(4).map(|x| x[3] - 3.0 * x[2] + 3.0 * x[1] - x[0]).collect();
    let count = third.len();
    if count == 0 {
        return 0.0;
    }
    // Hann's window keeps lines, and what the ends cut off, from leaking into all of the spectrum.
    for (k, x) in third.iter_mut().enumerate() {
        *x *= (PI * (k as f64 + 0.5) / count as f64).sin().powi(2);
    }
    DctPlanner::new().plan_dct2(count).process_dct2(&mut third);
    let first = ((2.0 * NOISE_SHARE * count as f64).ceil() as usize).max(1);
    // Third differences multiply what they see by (2 sin)^3; the transform's rows have a square norm of half the length.
    let own = third.iter().enumerate().skip(first).map(|(k, x)| {
        let gain = (2.0 * (0.5 * PI * k as f64 / count as f64).sin()).powi(6);
        x * x / (HANN_POWER * 0.5 * count as f64 * gain)
    });
    let mut powers: Vec<f64> = own.collect();
    if powers.is_empty() {
        return 0.0;
    }
    let middle = powers.len() / 2;
    (*powers.select_nth_unstable_by(middle, f64::total_cmp).1 / MEDIAN_SQUARE).sqrt()
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
        assert!((noise_floor(&signal) / 1e-3 - 1.0).abs() < 0.05);
    }

    #[test]
    fn images_of_a_held_signal_are_no_noise() {
        let mut source = random::stream(4, "held", 0);
        let mut draw = || -> f64 { StandardNormal.sample(&mut source) };
        let held = |k: u32| (0.004 * f64::from(k / 3 * 3)).sin();
        let signal: Vec<f64> = (0..20_000).map(|k| held(k) + 1e-5 * draw()).collect();
        assert!(white_noise(&signal) > 1e-3);
        assert!((noise_floor(&signal) / 1e-5 - 1.0).abs() < 0.1, "{}", noise_floor(&signal));
        assert_eq!((noise_floor(&[1.0; 3]), noise_floor(&[1.0; 50])), (0.0, 0.0));
    }
}
