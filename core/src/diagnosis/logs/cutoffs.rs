//! Cut-offs of the low-pass of positions: from the slowest motion to the frequency above which a log's positions hold nothing but noise.

use crate::error::Result;
use crate::identification::low_passed::ORDER;
use crate::recording::Recording;
use crate::signal::{ZeroPhaseLowPass, quantum};
use rayon::prelude::*;

/// Cut-offs that are tried, Hz.
pub(crate) const CUTOFFS_HZ: [f64; 12] = [3.0, 4.0, 5.0, 6.3, 8.0, 10.0, 12.5, 16.0, 20.0, 25.0, 32.0, 40.0];

/// The widest of them, Hz.
const WIDEST_HZ: f64 = CUTOFFS_HZ[CUTOFFS_HZ.len() - 1];

/// Lowest cut-off worth trying, relative to the one above which there is only white noise.
const LOWEST_SHARE: f64 = 0.25;

/// Highest cut-off, and the edge above which positions hold nothing but noise anyway, as shares of the rate.
const HIGHEST_SHARE: f64 = 0.2;
const NOISE_SHARE: f64 = 0.25;

/// Blocks over half of which a band must stand clear of the encoder's noise, s.
const CLEAR_OVER_S: f64 = 0.5;

/// Points of integrals over frequency.
pub(super) const POINTS: usize = 4000;

/// Cut-offs worth trying up to the one above which there is only white noise, Hz: a lower one distorts the motion a little, and lets
/// less of the encoder's noise into the accelerations.
pub(crate) fn cutoffs_up_to(highest_hz: f64) -> Vec<f64> {
    let lowest = highest_hz * LOWEST_SHARE;
    CUTOFFS_HZ.into_iter().filter(|hz| (lowest..=highest_hz).contains(hz)).collect()
}

/// The widest cut-off of a log's positions at a rate, Hz.
pub(crate) fn widest(rate_hz: f64) -> f64 {
    WIDEST_HZ.min(HIGHEST_SHARE * rate_hz)
}

/// The lowest cut-off, Hz, above which the positions of all joints of all logs hold nothing but white noise: no more than `misfit` times
/// the power of the encoder's.
///
/// # Errors
/// If a log is too short for the filters.
pub(crate) fn cutoff(recordings: &[&Recording], misfit: f64) -> Result<f64> {
    let jobs: Vec<(&Recording, usize)> =
        recordings.iter().flat_map(|&recording| (0..recording.joints()).map(move |joint| (recording, joint))).collect();
    let each: Vec<f64> = jobs
        .par_iter()
        .map(|(recording, joint)| cutoff_of(recording.q.channel(*joint), recording.rate_hz(), misfit))
        .collect::<Result<_>>()?;
    Ok(each.into_iter().fold(CUTOFFS_HZ[0], f64::max))
}

/// The lowest cut-off, Hz, above which no band of the positions `q` has `clear` times the power of the encoder's noise most of the time.
///
/// # Errors
/// If there are too few samples for the filters.
pub(super) fn clear_of_noise(q: &[f64], rate_hz: f64, clear: f64) -> Result<f64> {
    let block = (CLEAR_OVER_S * rate_hz) as usize;
    highest_band(q, rate_hz, |band, noise| typical_power(band, block) > clear * noise)
}

/// The lowest cut-off, Hz, above which the positions `q`, jerks included, have no band of `clear` times the power of the encoder's noise.
///
/// # Errors
/// If there are too few samples for the filters.
pub(super) fn mostly_noise(q: &[f64], rate_hz: f64, clear: f64) -> Result<f64> {
    highest_band(q, rate_hz, |band, noise| inner_power(band, rate_hz) > clear * noise)
}

fn cutoff_of(q: &[f64], rate_hz: f64, misfit: f64) -> Result<f64> {
    highest_band(q, rate_hz, |band, noise| inner_power(band, rate_hz) > misfit * noise)
}

/// Upper edge of the highest band, Hz, that `holds` more than noise, which is asked with what is in it and the power that the encoder's
/// noise has there: white noise, and of few digits what rounding does to the same motion. A joint that takes several samples for a step of
/// its encoder has rounding errors that are slow, and no white noise.
fn highest_band(q: &[f64], rate_hz: f64, holds: impl Fn(&[f64], f64) -> bool) -> Result<f64> {
    let candidates: Vec<f64> = CUTOFFS_HZ.into_iter().filter(|hz| *hz <= HIGHEST_SHARE * rate_hz).collect();
    let edges: Vec<f64> = candidates.iter().copied().chain([NOISE_SHARE * rate_hz]).collect();
    let filters: Vec<ZeroPhaseLowPass> =
        edges.iter().map(|&hz| ZeroPhaseLowPass::new(ORDER, hz, rate_hz)).collect::<Result<_>>()?;
    let passed = passed(q, &filters)?;
    let rounding = match quantum(q) {
        Some(step) => {
            let error: Vec<f64> = passed[0].iter().map(|x| step * (x / step).round() - x).collect();
            Some(self::passed(&error, &filters)?)
        }
        None => None,
    };
    let top = filters.len() - 1;
    let above: Vec<f64> = q.iter().zip(&passed[top]).map(|(x, low)| x - low).collect();
    let all = |hz: f64| 1.0 - filters[top].gain(hz);
    let noise = inner_power(&above, rate_hz) / share(all, rate_hz);
    // From the top down: the first band that holds more than noise must still pass.
    let mut lowest = 0;
    let inside = |passed: &[Vec<f64>], band: usize| -> Vec<f64> {
        passed[band + 1].iter().zip(&passed[band]).map(|(wide, narrow)| wide - narrow).collect()
    };
    for band in (0..top).rev() {
        let white = noise * share(|hz| filters[band + 1].gain(hz) - filters[band].gain(hz), rate_hz);
        let rounded = rounding.as_ref().map_or(0.0, |passed| inner_power(&inside(passed, band), rate_hz));
        if holds(&inside(&passed, band), white.max(rounded)) {
            lowest = (band + 1).min(candidates.len() - 1);
            break;
        }
    }
    Ok(candidates.get(lowest).copied().unwrap_or(CUTOFFS_HZ[0]))
}

/// What each of the filters passes of a signal.
fn passed(signal: &[f64], filters: &[ZeroPhaseLowPass]) -> Result<Vec<Vec<f64>>> {
    let through = |filter: &ZeroPhaseLowPass| {
        let mut out = vec![0.0; signal.len()];
        filter.apply(signal, &mut out)?;
        Ok(out)
    };
    filters.iter().map(through).collect()
}

/// Mean square away from both ends, where the filters settle.
pub(crate) fn inner_power(signal: &[f64], rate_hz: f64) -> f64 {
    let cut = (2.0 * rate_hz) as usize;
    let inner = if signal.len() > 4 * cut { &signal[cut..signal.len() - cut] } else { signal };
    inner.iter().map(|x| x * x).sum::<f64>() / inner.len() as f64
}

/// Median over blocks of so many samples of their mean square.
pub(crate) fn typical_power(signal: &[f64], block: usize) -> f64 {
    let mut powers: Vec<f64> =
        signal.chunks_exact(block.max(1)).map(|part| part.iter().map(|x| x * x).sum::<f64>() / block as f64).collect();
    powers.sort_by(f64::total_cmp);
    powers.get(powers.len() / 2).copied().unwrap_or(0.0)
}

/// Share of white noise that a zero-phase filter of this gain passes.
fn share(gain: impl Fn(f64) -> f64, rate_hz: f64) -> f64 {
    (0..POINTS).map(|k| gain((k as f64 + 0.5) / POINTS as f64 * 0.5 * rate_hz).powi(2)).sum::<f64>() / POINTS as f64
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::random;
    use rand_distr::{Distribution, StandardNormal};

    /// Rate of the positions of [`swing`], Hz.
    pub(crate) const RATE: f64 = 500.0;

    /// Positions over 20 s: a slow swing, one of `size` at `hz`, and an encoder's noise.
    pub(crate) fn swing(hz: f64, size: f64) -> Vec<f64> {
        let mut source = random::stream(5, "cut-off", 0);
        (0..10_000)
            .map(|k| {
                let t = f64::from(k) / RATE;
                let noise: f64 = StandardNormal.sample(&mut source);
                (std::f64::consts::TAU * 0.4 * t).sin() + size * (std::f64::consts::TAU * hz * t).sin() + 1.5e-5 * noise
            })
            .collect()
    }

    #[test]
    fn cut_off_lies_just_above_the_motion() {
        let slow = cutoff_of(&swing(0.4, 0.1), RATE, 1.5).unwrap();
        assert!(slow <= 4.0, "{slow}");
        let fast = cutoff_of(&swing(9.0, 1e-3), RATE, 1.5).unwrap();
        assert!((10.0..=16.0).contains(&fast), "{fast}");
    }

    /// An encoder of 12 bits takes five samples for a step where the joint moves at 0.15 rad/s.
    #[test]
    fn rounding_of_a_coarse_encoder_is_no_motion() {
        let step = std::f64::consts::TAU / 4096.0;
        let rounded = |q: Vec<f64>| -> Vec<f64> { q.into_iter().map(|x| step * (x / step).round()).collect() };
        let slow: Vec<f64> = swing(0.4, 0.0).into_iter().map(|x| 0.3 * x).collect();
        let cutoff = |q: Vec<f64>| cutoff_of(&rounded(q), RATE, 1.5).unwrap();
        assert!(cutoff(slow.clone()) <= 5.0, "{}", cutoff(slow));
        assert!(cutoff(swing(0.4, 0.0)) <= 5.0);
        assert!((10.0..=16.0).contains(&cutoff(swing(9.0, 0.01))), "{}", cutoff(swing(9.0, 0.01)));
    }

    #[test]
    fn what_is_there_for_moments_is_not_clear_of_the_noise() {
        let mut q = swing(0.4, 0.1);
        let all_the_time = swing(9.0, 1e-3);
        assert!((10.0..=16.0).contains(&clear_of_noise(&all_the_time, RATE, 10.0).unwrap()));
        q[4000..4500].copy_from_slice(&all_the_time[4000..4500]);
        assert!(cutoff_of(&q, RATE, 1.5).unwrap() >= 10.0);
        assert_eq!(clear_of_noise(&q, RATE, 10.0).unwrap(), CUTOFFS_HZ[0]);
    }
}
