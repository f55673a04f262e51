//! How smooth measured signals should be, from the signals themselves: the Savitzky-Golay window by the noise of the positions, and
//! common practice's low-pass by the frequencies of the motion.

use super::low_passed;
use super::prepare::{self, LOW_PASS_ORDER, Smoothing};
use crate::error::{Error, Result};
use crate::recording::Recording;
use crate::signal::{Bandwidth, Edge, SavitzkyGolay, bandwidth, half_gain_hz, noise_share, window_by_noise};
use serde::Serialize;

/// Cut-off of torque and columns over the highest frequency of the motion: 2 is the rule of Janot, Vandanjon and Gautier. The positions' is
/// four times as high ([`prepare::position_cutoff_hz`]), 8 times the motion's: 5 to 10 is the rule.
const TORQUE_OVER_MOTION: f64 = 2.0;

/// The lowest frequency that counts as the highest of a motion, Hz: at the starts and stops of a slow motion the position loop of an arm
/// has its own bandwidth.
const SLOWEST_HZ: f64 = 1.0;

/// Rows of all logs that decimation keeps at least: from fewer the noise of a joint with some tens of parameters is not estimated.
const LEAST_ROWS: usize = 200;

/// Share of half the rate of the rows that the low-pass of torque and columns lets through, so that decimation folds nothing back.
const OF_HALF_THE_RATE_OF_ROWS: f64 = 0.8;

/// Highest cut-off of torque and columns, as a share of the rate: positions need room for a wider one.
const HIGHEST_SHARE: f64 = 0.1;

/// Speed of a joint over that of the fastest below which it does not count: what shakes a joint that is held is not the motion.
const HELD: f64 = 0.02;

/// Length of the Savitzky-Golay window where nothing is chosen, s: below a tenth of the time that a joint of an industrial arm takes to
/// start and stop.
const USUAL_WINDOW_S: f64 = 0.12;

/// Longest Savitzky-Golay window that is chosen by the noise, over the usual one. Over more, torque and columns lose the reversals that
/// separate friction from inertia, and a vibration that the window takes off whole does not show as an error of the window.
const LONGEST_OVER_USUAL: usize = 2;

/// Share of the noise in the variance of an acceleration from which the usual window is too short: inertias, of which a regression sees
/// small differences between accelerations and gravity, are then attenuated by several times their standard deviations.
const NOISY: f64 = 0.02;

/// Longest window of positions that are noisier than that, over the usual one: half a second, over which a motion of 1 Hz is not bent.
const LONGEST_OF_NOISY: usize = 4;

/// Shortest window where nothing is chosen, samples: one of order six smooths from here on.
const SHORTEST_USUAL: usize = 9;

/// Samples below which the window is not chosen by the noise: there are too few windows in the log to separate bias from noise.
const SAMPLES_TO_CHOOSE: usize = 500;

/// The window, in samples, of 0.12 s.
pub fn usual_window(rate_hz: f64) -> usize {
    ((USUAL_WINDOW_S * rate_hz).round() as usize | 1).max(SHORTEST_USUAL)
}

/// Rows in a smoothing window: the next row adds little that the filter has not mixed into this one.
const ROWS_IN_A_WINDOW: usize = 12;

/// Every how many samples a row is taken from signals that are smoothed over `window` samples, where nothing is chosen.
pub fn usual_decimation(window: usize) -> usize {
    (window / ROWS_IN_A_WINDOW).max(1)
}

/// The usual window where the noise of the positions of `log` leaves accelerations for a regression, else the one that suits that noise:
/// at 50 to 125 Hz the usual one has few samples, and smooths hardly at all.
pub fn window_of_log(log: &Recording) -> usize {
    let usual = usual_window(log.rate_hz());
    let positions: Vec<&[f64]> = log.q.iter().collect();
    if noise_share(&positions, usual, USUAL_ORDER).is_ok_and(|share| share < NOISY) {
        return usual;
    }
    let longest = LONGEST_OF_NOISY * usual;
    // A log that is too short to choose by, or in which nothing moves, is refused where it is fitted, or has the usual one.
    window_by_noise(&positions, USUAL_ORDER, longest).map_or(usual, |window| window.max(usual))
}

/// The Savitzky-Golay window, in samples, that suits the noise of the positions of `logs`, all of one rate, for polynomials of degree
/// `order`: see [`window_by_noise`].
///
/// # Errors
/// If a log is too short, or nothing moves.
pub fn window(logs: &[&Recording], order: usize) -> Result<usize> {
    let positions: Vec<&[f64]> = logs.iter().flat_map(|log| log.q.iter()).collect();
    let rate_hz = logs.iter().map(|log| log.rate_hz()).fold(f64::INFINITY, f64::min);
    window_by_noise(&positions, order, LONGEST_OVER_USUAL * usual_window(rate_hz))
}

/// Polynomial order of a smoother that no scenario describes: even, so that the second derivative gains by it, and high enough that a
/// window of a tenth of a second does not bend accelerations.
pub(crate) const USUAL_ORDER: usize = 6;

/// Savitzky-Golay of order six for `logs` that no scenario describes, over the window that suits their noise; over the usual one
/// where a log is too short to choose by. A twelfth of the window lies between two rows.
///
/// # Errors
/// If nothing moves.
pub fn savitzky_golay(logs: &[&Recording]) -> Result<Smoothing> {
    let shortest = logs.iter().map(|log| log.samples()).min().unwrap_or(0);
    let window = match logs.first() {
        Some(log) if shortest < SAMPLES_TO_CHOOSE => usual_window(log.rate_hz()),
        _ => window(logs, USUAL_ORDER)?,
    };
    Ok(Smoothing::SavitzkyGolay { window, order: USUAL_ORDER, decimation: usual_decimation(window) })
}

/// Common practice: a zero-phase Butterworth low-pass of fourth order for the positions (filtfilt), cut off at
/// eight times the highest frequency of the motion, central differences for velocity and acceleration, and for torque and columns a
/// low-pass of the same kind at twice that frequency, after which every n-th row is kept (parallel filter and decimation).
///
/// The highest frequency of the motion is the one below which 99.9 % of the power of the velocity lies, of the joint for which it is
/// highest ([`bandwidth`]), and 1 Hz at least.
///
/// References: M. Gautier, "Dynamic identification of robots with power model", ICRA 1997; W. Khalil and E. Dombre, "Modeling,
/// identification and control of robots", 2002, section 12.5; A. Janot, P.-O. Vandanjon and M. Gautier, "A generic instrumental
/// variable approach for industrial robot identification", IEEE Transactions on Control Systems Technology 22 (2014) 132-145.
///
/// # Errors
/// If nothing moves, or a log is too short to differentiate.
pub fn usual_low_pass(logs: &[&Recording]) -> Result<Smoothing> {
    let mut joints: Vec<Bandwidth> = Vec::new();
    for log in logs {
        for q in log.q.iter() {
            joints.extend(bandwidth(q, log.rate_hz())?);
        }
    }
    let fastest = joints.iter().map(|joint| joint.speed).fold(0.0, f64::max);
    let moving = joints.iter().filter(|joint| joint.speed > HELD * fastest);
    let motion_hz = moving.map(|joint| joint.hz).fold(0.0, f64::max);
    let rate_hz = logs.iter().map(|log| log.rate_hz()).fold(f64::INFINITY, f64::min);
    if motion_hz <= 0.0 {
        return Err(Error::request("low-pass of the positions", "no joint moves; take a log of a motion"));
    }
    let cutoff_hz = (TORQUE_OVER_MOTION * motion_hz.max(SLOWEST_HZ)).min(HIGHEST_SHARE * rate_hz);
    let samples: usize = logs.iter().map(|log| log.samples()).sum();
    let decimation = ((OF_HALF_THE_RATE_OF_ROWS * 0.5 * rate_hz / cutoff_hz) as usize).min(samples / LEAST_ROWS).max(1);
    Ok(Smoothing::LowPass { cutoff_hz, decimation })
}

/// Samples of the blocks over which `diagnose` takes means, at a rate: 20 ms.
pub fn usual_block(rate_hz: f64) -> usize {
    low_passed::block(rate_hz)
}

/// A smoothing in numbers, for reports.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::identification::prepare::Smoothing;
/// use tauscope::identification::smoothing_choice::{Described, described};
///
/// let smoothing = Smoothing::SavitzkyGolay { window: 61, order: 6, decimation: 5 };
/// let in_numbers = described(&smoothing, 500.0)?;
/// let Some(Described::SavitzkyGolay { window_s, cutoff_hz, .. }) = in_numbers else { unreachable!() };
/// assert!((window_s - 0.12).abs() < 0.01 && (10.0..40.0).contains(&cutoff_hz));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Described {
    /// Savitzky-Golay.
    SavitzkyGolay {
        /// Window, samples.
        window: usize,
        /// Window, s.
        window_s: f64,
        /// Polynomial order.
        order: usize,
        /// Frequency that passes with half its amplitude, Hz.
        cutoff_hz: f64,
        /// Every n-th row is used.
        decimation: usize,
    },
    /// Butterworth low-pass, forward and backward.
    Butterworth {
        /// Order in each direction.
        order: usize,
        /// Cut-off of the positions, Hz: half the amplitude passes.
        position_cutoff_hz: f64,
        /// Cut-off of torque and columns, Hz.
        torque_cutoff_hz: f64,
        /// Every n-th row is used.
        decimation: usize,
    },
    /// Positions through a low-pass, torque and columns as means over blocks.
    BlockMeans {
        /// Order of the low-pass in each direction.
        order: usize,
        /// Cut-offs of the positions, Hz, one of all joints or one of each: half the amplitude passes.
        position_cutoffs_hz: Vec<f64>,
        /// Samples in a block.
        block: usize,
    },
}

/// What `smoothing` is at a rate; None for no smoothing.
///
/// # Errors
/// If the window is impossible.
pub fn described(smoothing: &Smoothing, rate_hz: f64) -> Result<Option<Described>> {
    Ok(match *smoothing {
        Smoothing::None => None,
        Smoothing::SavitzkyGolay { window, order, decimation } => {
            let smoother = SavitzkyGolay::new(window, order, 0, 1.0 / rate_hz, Edge::Nearest)?;
            let cutoff_hz = half_gain_hz(&smoother, rate_hz);
            Some(Described::SavitzkyGolay { window, window_s: window as f64 / rate_hz, order, cutoff_hz, decimation })
        }
        Smoothing::LowPass { cutoff_hz, decimation } => Some(Described::Butterworth {
            order: LOW_PASS_ORDER,
            position_cutoff_hz: prepare::position_cutoff_hz(cutoff_hz, rate_hz),
            torque_cutoff_hz: cutoff_hz,
            decimation,
        }),
        Smoothing::BlockMeans { ref cutoffs_hz, block } => {
            Some(Described::BlockMeans { order: low_passed::ORDER, position_cutoffs_hz: cutoffs_hz.clone(), block })
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::channels::Channels;
    use crate::random;
    use rand_distr::{Distribution, StandardNormal};
    use std::collections::BTreeMap;
    use std::f64::consts::TAU;

    /// 20 s of two joints at a rate: one swings at 0.4 and `hz`, one is held and shakes a little at 9 Hz.
    fn log(rate_hz: f64, hz: f64) -> Recording {
        let mut source = random::stream(9, "smoothing choice", 0);
        let samples = (20.0 * rate_hz) as usize;
        let mut positions = |of: &dyn Fn(f64) -> f64| -> Vec<f64> {
            let mut draw = || -> f64 { StandardNormal.sample(&mut source) };
            (0..samples).map(|k| of(k as f64 / rate_hz) + 1e-5 * draw()).collect()
        };
        let moving = positions(&|t| (TAU * 0.4 * t).sin() + 0.2 * (TAU * hz * t).sin());
        let held = positions(&|t| 1e-4 * (TAU * 9.0 * t).sin());
        Recording {
            robot: String::new(),
            joints: vec!["a".into(), "b".into()],
            time: (0..samples).map(|k| k as f64 / rate_hz).collect(),
            q: Channels::from_vectors(&[moving, held]),
            qd: None,
            qdd: None,
            tau: Channels::zeros(2, samples),
            truth: None,
            provenance: BTreeMap::new(),
        }
    }

    #[test]
    fn the_low_pass_follows_the_fastest_joint_that_is_not_held() {
        let cutoff = |hz: f64| match usual_low_pass(&[&log(500.0, hz)]).unwrap() {
            Smoothing::LowPass { cutoff_hz, decimation } => (cutoff_hz, decimation),
            other => panic!("{other:?}"),
        };
        let (fast, every) = cutoff(3.0);
        assert!((fast - 6.0).abs() < 0.2, "{fast}");
        assert!(every as f64 * fast <= 0.8 * 250.0 && (every + 1) as f64 * fast > 0.8 * 250.0, "{every}");
        // A slow motion is at least one of 1 Hz.
        assert_eq!(cutoff(0.5).0, 2.0);
    }

    #[test]
    fn a_window_is_found_at_every_rate_and_is_at_most_twice_the_usual_one() {
        for rate_hz in [10.0, 25.0, 50.0, 125.0, 1000.0] {
            let Smoothing::SavitzkyGolay { window, .. } = savitzky_golay(&[&log(rate_hz, 0.8)]).unwrap() else {
                panic!()
            };
            assert!(window <= 2 * usual_window(rate_hz) + 1, "{rate_hz} Hz: {window}");
            assert!(window % 2 == 1 && window > USUAL_ORDER + 1, "{rate_hz} Hz: {window}");
        }
        assert_eq!((usual_window(500.0), usual_window(20.0)), (61, 9));
    }

    #[test]
    fn what_is_described_is_what_is_used() {
        assert_eq!(described(&Smoothing::None, 500.0).unwrap(), None);
        let low_pass = described(&Smoothing::LowPass { cutoff_hz: 100.0, decimation: 3 }, 500.0).unwrap();
        let position_cutoff_hz = 0.45 * 500.0;
        let expected = Described::Butterworth { order: 4, position_cutoff_hz, torque_cutoff_hz: 100.0, decimation: 3 };
        assert_eq!(low_pass, Some(expected));
        let means = described(&Smoothing::BlockMeans { cutoffs_hz: vec![8.0], block: 10 }, 500.0).unwrap();
        assert_eq!(means, Some(Described::BlockMeans { order: 6, position_cutoffs_hz: vec![8.0], block: 10 }));
        let window = Smoothing::SavitzkyGolay { window: 61, order: 6, decimation: 5 };
        let Some(Described::SavitzkyGolay { window_s, cutoff_hz, .. }) = described(&window, 500.0).unwrap() else {
            panic!()
        };
        assert!((window_s - 0.122).abs() < 1e-12 && (20.0..25.0).contains(&cutoff_hz), "{cutoff_hz}");
    }
}
