//! How smooth measured signals should be, from the signals themselves: the Savitzky-Golay window by the noise of the positions, and
//! the low-pass that is usual in the field by the frequencies of the motion.

use super::prepare::{self, LOW_PASS_ORDER, Smoothing};
use crate::error::{Error, Result};
use crate::recording::Recording;
use crate::signal::{Bandwidth, Edge, SavitzkyGolay, bandwidth, half_gain_hz, window_by_noise};
use serde::Serialize;

/// Cut-off of torque and columns over the highest frequency of the motion: 2 is the rule of Janot, Vandanjon and Gautier. The positions' is
/// four times as high ([`prepare::position_cutoff_hz`]), 8 times the motion's: 5 to 10 is the rule.
const TORQUE_OVER_MOTION: f64 = 2.0;

/// The lowest frequency that counts as the highest of a motion, Hz: at the starts and stops of a slow motion the position loop of an arm
/// has its own bandwidth.
const SLOWEST_HZ: f64 = 1.0;

/// Rows of all logs that decimation leaves at least: from fewer the noise of a joint with some tens of parameters is not estimated.
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

/// Longest Savitzky-Golay window that is chosen by the noise, s: twice the usual one. Over more, torque and columns lose the reversals that
/// tell friction from inertia, and a vibration that the window takes off whole does not show as an error of the window.
const LONGEST_WINDOW_S: f64 = 0.24;

/// Shortest window where nothing is chosen, samples: one of order six smooths from here on.
const SHORTEST_USUAL: usize = 9;

/// Samples below which the window is not chosen by the noise: there are too few windows in the log to tell bias from noise.
const SAMPLES_TO_CHOOSE: usize = 500;

/// The window, in samples, of 0.12 s.
pub fn usual_window(rate_hz: f64) -> usize {
    ((USUAL_WINDOW_S * rate_hz).round() as usize | 1).max(SHORTEST_USUAL)
}

/// The Savitzky-Golay window, in samples, that suits the noise of the positions of `logs`, all of one rate, for polynomials of degree
/// `order`: see [`window_by_noise`].
///
/// # Errors
/// If a log is too short, or nothing moves.
pub fn window(logs: &[&Recording], order: usize) -> Result<usize> {
    let positions: Vec<&[f64]> = logs.iter().flat_map(|log| log.q.iter()).collect();
    let rate_hz = logs.iter().map(|log| log.rate_hz()).fold(f64::INFINITY, f64::min);
    window_by_noise(&positions, order, (LONGEST_WINDOW_S * rate_hz) as usize)
}

/// Polynomial order of a smoother that no scenario describes: even, so that the second derivative gains by it, and high enough that a window
/// of a tenth of a second does not bend accelerations.
pub const USUAL_ORDER: usize = 6;

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
    Ok(Smoothing::SavitzkyGolay { window, order: USUAL_ORDER, decimation: (window / 12).max(1) })
}

/// The smoothing that is usual in the field: a zero-phase Butterworth low-pass of fourth order for the positions (filtfilt), cut off at
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

/// A smoothing in numbers, for reports.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
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
}

/// What `smoothing` is at a rate; None for no smoothing.
///
/// # Errors
/// If the window is impossible.
pub fn described(smoothing: Smoothing, rate_hz: f64) -> Result<Option<Described>> {
    Ok(match smoothing {
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
    })
}
