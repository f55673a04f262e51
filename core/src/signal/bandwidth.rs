//! The highest frequency of a motion, from its sampled positions.

use super::{first_derivative, noise_floor};
use crate::error::Result;
use rustdct::DctPlanner;
use std::f64::consts::PI;

/// Share of the velocity's power that lies below the highest frequency of the motion. The spectra of motions have no sharp end; starts
/// and stops are in the last percent.
const POWER: f64 = 0.999;

/// Share of the rate up to which the spectrum counts: a motion that is sampled at all has ten samples in a period, and positions that are
/// held over several samples have images above.
const HIGHEST_SHARE: f64 = 0.1;

/// Standard deviations by which the power of the velocity must exceed that of the encoder's noise: below, there is no motion to be seen.
const CLEAR: f64 = 10.0;

/// Velocity of a joint: its root mean square, and the frequency below which 99.9 % of its power lies.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use std::f64::consts::TAU;
/// use tauscope::signal::bandwidth;
///
/// // 20 s of a joint that swings at 1.7 Hz, in a log of 500 Hz.
/// let positions: Vec<f64> = (0..10_000).map(|k| (TAU * 1.7 * f64::from(k) / 500.0).sin()).collect();
/// let motion = bandwidth(&positions, 500.0)?.expect("it moves");
/// assert!((motion.hz - 1.7).abs() < 0.1);
/// assert!((motion.speed / (TAU * 1.7 / 2f64.sqrt()) - 1.0).abs() < 0.01);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bandwidth {
    /// Root mean square of the velocity without the encoder's noise, unit of the positions per second.
    pub speed: f64,
    /// The highest frequency of the motion, Hz.
    pub hz: f64,
}

/// Bandwidth of the motion with these `positions`; None where nothing moves, to within the white noise of the positions.
///
/// The spectrum is the cosine transform of the central differences (it continues the signal evenly at both ends, so that a motion that
/// ends elsewhere than it began has no jump); what white noise of the measured size adds to it is taken off.
///
/// # Errors
/// If there are fewer than 3 samples, or the rate is not a positive number.
pub fn bandwidth(positions: &[f64], rate_hz: f64) -> Result<Option<Bandwidth>> {
    let count = positions.len();
    let mut spectrum = vec![0.0; count];
    first_derivative(positions, 1.0 / rate_hz, &mut spectrum)?;
    DctPlanner::new().plan_dct2(count).process_dct2(&mut spectrum);
    // The transform's rows have a square norm of half the length, the first one of all of it.
    let power = |k: usize, x: f64| x * x / (count as f64 * if k == 0 { 1.0 } else { 0.5 });
    // A sinusoid of a frequency f comes out of central differences multiplied by sin(2 pi f / rate) rate.
    let noise = noise_floor(positions) * rate_hz;
    let noise = |k: usize| (noise * (PI * k as f64 / count as f64).sin()).powi(2);
    let bins = ((2.0 * HIGHEST_SHARE * count as f64) as usize).clamp(1, count);
    let own: Vec<f64> = spectrum[..bins].iter().enumerate().map(|(k, &x)| power(k, x) - noise(k)).collect();
    let total: f64 = own.iter().sum();
    // The power of a noise bin has twice its square as variance.
    let spread = (0..bins).map(|k| 2.0 * noise(k).powi(2)).sum::<f64>().sqrt();
    if !(total > CLEAR * spread && total > 0.0) {
        return Ok(None);
    }
    let mut sum = 0.0;
    let last = own.iter().position(|power| {
        sum += power;
        sum >= POWER * total
    });
    let hz = last.unwrap_or(bins - 1).max(1) as f64 * 0.5 * rate_hz / count as f64;
    Ok(Some(Bandwidth { speed: (total / count as f64).sqrt(), hz }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random;
    use rand_distr::{Distribution, StandardNormal};
    use std::f64::consts::TAU;

    /// 20 s at 500 Hz.
    fn signal(of: impl Fn(f64) -> f64, noise: f64) -> Vec<f64> {
        let mut source = random::stream(7, "bandwidth", 0);
        let mut draw = || -> f64 { StandardNormal.sample(&mut source) };
        (0..10_000).map(|k| of(f64::from(k) / 500.0) + noise * draw()).collect()
    }

    #[test]
    fn a_sinusoid_has_its_frequency_with_and_without_noise() {
        for noise in [0.0, 1.5e-5, 1e-3] {
            let found = bandwidth(&signal(|t| (TAU * 1.7 * t).sin(), noise), 500.0).unwrap().unwrap();
            assert!((found.hz - 1.7).abs() < 0.1, "{noise}: {found:?}");
            assert!((found.speed / (TAU * 1.7 / 2f64.sqrt()) - 1.0).abs() < 0.01, "{noise}: {found:?}");
        }
    }

    #[test]
    fn what_hardly_adds_power_does_not_count_and_what_does_counts() {
        let two = |share: f64| signal(|t| (TAU * 0.5 * t).sin() / 0.5 + share * (TAU * 6.0 * t).sin() / 6.0, 1e-5);
        let hz = |share: f64| bandwidth(&two(share), 500.0).unwrap().unwrap().hz;
        assert!(hz(0.01) < 0.7, "a hundredth of a percent of the power");
        assert!((hz(0.1) - 6.0).abs() < 0.1, "one percent");
    }

    #[test]
    fn images_of_positions_that_are_held_over_samples_do_not_count() {
        let held = |k: usize| (TAU * 1.7 * (k / 3 * 3) as f64 / 500.0).sin();
        let found = bandwidth(&(0..10_000).map(held).collect::<Vec<f64>>(), 500.0).unwrap().unwrap();
        // The images lie at 166.7 Hz; what the steps leak from there is two tenths of a percent.
        assert!((1.6..10.0).contains(&found.hz), "{found:?}");
    }

    #[test]
    fn a_joint_that_stands_has_none() {
        assert_eq!(bandwidth(&signal(|_| 0.3, 1e-4), 500.0).unwrap(), None);
        assert_eq!(bandwidth(&signal(|_| 0.0, 0.0), 500.0).unwrap(), None);
        assert!(bandwidth(&[0.0, 1.0], 500.0).is_err());
    }
}
