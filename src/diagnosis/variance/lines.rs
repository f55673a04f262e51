//! Spectral lines: vibration at a fixed frequency, whatever the motion.

use crate::diagnosis::logs::Rows;
use serde::Serialize;
use statrs::function::gamma::gamma_ur;
use std::f64::consts::{LN_2, PI};

/// Segments of a log over which spectra are averaged, rows of 20 ms, and their overlap.
const SEGMENT: usize = 1000;

/// Frequencies between which lines are looked for, Hz: below, a motion's own harmonics lie close; above, 20 ms means hold little.
const LOWEST_HZ: f64 = 1.0;
const HIGHEST_HZ: f64 = 24.0;

/// Half width of the neighbourhood whose median is the background, bins, and of the line itself under a Hann window.
const NEAR: usize = 30;
const LINE: usize = 3;

/// Background ratio from which the model's own torque has a line at the same frequency: then it is the motion's.
const OF_THE_MOTION: f64 = 6.0;

/// Most lines of a joint.
const MOST: usize = 3;

/// A spectral line.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Line {
    /// Frequency, Hz.
    pub hz: f64,
    /// Root mean square of the oscillation, N m or N.
    pub rms: f64,
    /// Probability of one as strong in noise, at any frequency looked at.
    pub p: f64,
}

/// Lines in the `residual` of a joint that its model's `torque` does not have, the strongest first; `alpha` is the level.
pub(super) fn lines(rows: &Rows, joint: usize, residual: &[f64], torque: &[f64], alpha: f64) -> Vec<Line> {
    let valid = &rows.valid[joint];
    let segments = segments(rows);
    let Some(length) = segments.iter().map(|segment| segment.len()).max() else { return Vec::new() };
    let row_s = rows.logs[0].period * rows.logs[0].block as f64;
    let step_hz = 0.5 / (length as f64 * row_s);
    let count = ((HIGHEST_HZ.min(0.48 / row_s) - LOWEST_HZ) / step_hz) as usize;
    let grid: Vec<f64> = (0..count).map(|k| LOWEST_HZ + k as f64 * step_hz).collect();
    let spectrum = |signal: &[f64]| -> (Vec<f64>, f64) {
        let mut power = vec![0.0; grid.len()];
        let mut used = 0.0;
        for segment in &segments {
            let weights: Vec<f64> = segment
                .clone()
                .map(|row| {
                    let place = (row - segment.start) as f64 + 0.5;
                    if valid[row] { (PI * place / segment.len() as f64).sin().powi(2) } else { 0.0 }
                })
                .collect();
            let scale: f64 = weights.iter().map(|w| w * w).sum();
            if scale < 0.1 * segment.len() as f64 {
                continue;
            }
            used += 1.0;
            let sum: f64 = weights.iter().sum();
            let mean: f64 = weights.iter().zip(&signal[segment.clone()]).map(|(w, x)| w * x).sum::<f64>() / sum;
            let windowed: Vec<f64> = weights.iter().zip(&signal[segment.clone()]).map(|(w, x)| w * (x - mean)).collect();
            for (power, hz) in power.iter_mut().zip(&grid) {
                let (re, im) = fourier(&windowed, 2.0 * PI * hz * row_s);
                // An oscillation of root mean square a gives a^2.
                *power += 2.0 * (re * re + im * im) / (sum * sum);
            }
        }
        power.iter_mut().for_each(|power| *power /= f64::max(used, 1.0));
        (power, used)
    };
    let (own, averaged) = spectrum(residual);
    if averaged == 0.0 {
        return Vec::new();
    }
    let (own_ratio, motion_ratio) = (ratios(&own), ratios(&spectrum(torque).0));
    let mut found: Vec<Line> = Vec::new();
    let mut order: Vec<usize> = (0..grid.len()).collect();
    order.sort_by(|a, b| own_ratio[*b].total_cmp(&own_ratio[*a]));
    for k in order {
        // The median of the mean of `averaged` exponentials is near ln 2 of one, and near one of many.
        let median = if averaged < 2.0 { LN_2 } else { 1.0 - 1.0 / (3.0 * averaged) };
        let p = (grid.len() as f64 * gamma_ur(averaged, averaged * own_ratio[k] * median)).min(1.0);
        if p > alpha || found.len() == MOST {
            break;
        }
        let near = |from: &Line| (from.hz - grid[k]).abs() < 2.0 * LINE as f64 * step_hz;
        let peak = k.saturating_sub(LINE)..(k + LINE + 1).min(grid.len());
        let moved = motion_ratio[peak].iter().any(|ratio| *ratio > OF_THE_MOTION);
        if !found.iter().any(near) && !moved {
            let background = own[k] / own_ratio[k];
            found.push(Line { hz: grid[k], rms: (own[k] - background).max(0.0).sqrt(), p });
        }
    }
    found
}

/// Rows of every log in segments that overlap by half.
fn segments(rows: &Rows) -> Vec<std::ops::Range<usize>> {
    let mut segments = Vec::new();
    for log in rows.starts.windows(2) {
        let length = SEGMENT.min(log[1] - log[0]);
        let mut start = log[0];
        while length > 0 && start + length <= log[1] {
            segments.push(start..start + length);
            start += (length / 2).max(1);
        }
    }
    // Shorter logs would blur the lines of the longer.
    let longest = segments.iter().map(|segment| segment.len()).max().unwrap_or_default();
    segments.retain(|segment| 2 * segment.len() > longest);
    segments
}

/// Each value over the median of those near it but not of the same line.
fn ratios(power: &[f64]) -> Vec<f64> {
    (0..power.len())
        .map(|k| {
            let near = k.saturating_sub(NEAR)..(k + NEAR + 1).min(power.len());
            let mut near: Vec<f64> = near.filter(|other| other.abs_diff(k) > LINE).map(|other| power[other]).collect();
            near.sort_by(f64::total_cmp);
            let median = near.get(near.len() / 2).copied().unwrap_or_default();
            if median > 0.0 { power[k] / median } else { 0.0 }
        })
        .collect()
}

/// Real and imaginary part of the Fourier sum at a frequency, rad per sample.
fn fourier(signal: &[f64], step: f64) -> (f64, f64) {
    let (cos, sin) = (step.cos(), step.sin());
    let (mut c, mut s) = (1.0, 0.0);
    let (mut re, mut im) = (0.0, 0.0);
    for x in signal {
        re += x * c;
        im += x * s;
        (c, s) = (c * cos - s * sin, s * cos + c * sin);
    }
    (re, im)
}
