//! Spectral lines: vibration at a fixed frequency, whatever the motion.

use crate::diagnosis::criteria::StructureCriteria;
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

/// Points between two of the grid at which a line's frequency is refined.
const FINER: i32 = 20;

/// Most lines of a joint.
const MOST: usize = 3;

/// A spectral line.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// # use tauscope::diagnosis::Diagnosis;
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Ignored)?;
/// # let log = |name: &str| recording::load(format!("../tests/reference/pendulum/{name}.csv"), None);
/// # let (train, test) = (log("train")?, log("test")?);
/// # let answer = Diagnosis::of(&robot).train([&train]).test([&test]).candidates(["torque_ripple"]).run()?;
/// # let diagnosis = answer.diagnosis().expect("the logs are good");
///
/// // Every spectral line of a joint's residual that stands clear of the noise is one that is not in noise alone.
/// for joint in &diagnosis.map.joints {
///     assert!(joint.reported_lines().all(|line| line.hz > 0.0 && line.rms >= joint.reported_from && line.p < 0.05));
/// }
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Line {
    /// Frequency, Hz.
    pub hz: f64,
    /// Root mean square of the oscillation, N m or N.
    pub rms: f64,
    /// Probability of one as strong in noise, at any frequency looked at.
    pub p: f64,
}

/// Lines in the `residual` of a joint, the strongest first; `alpha` is the level. A line that its model's `torque` has, too, is one of the
/// motion, unless it is much of that in the residual: what shakes an arm moves it, and near the bandwidth of its controller more so.
pub(super) fn lines(
    rows: &Rows,
    joint: usize,
    [residual, torque]: [&[f64]; 2],
    criteria: &StructureCriteria,
    alpha: f64,
) -> Vec<Line> {
    let valid = &rows.valid[joint];
    let segments = segments(rows);
    let Some(length) = segments.iter().map(|segment| segment.len()).max() else { return Vec::new() };
    let row_s = rows.logs[0].period * rows.logs[0].block as f64;
    let step_hz = 0.5 / (length as f64 * row_s);
    let count = ((HIGHEST_HZ.min(0.48 / row_s) - LOWEST_HZ) / step_hz) as usize;
    let grid: Vec<f64> = (0..count).map(|k| LOWEST_HZ + k as f64 * step_hz).collect();
    let spectrum = |signal: &[f64], grid: &[f64]| -> (Vec<f64>, f64) {
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
            let windowed: Vec<f64> =
                weights.iter().zip(&signal[segment.clone()]).map(|(w, x)| w * (x - mean)).collect();
            for (power, hz) in power.iter_mut().zip(grid) {
                let (re, im) = fourier(&windowed, 2.0 * PI * hz * row_s);
                // An oscillation of root mean square a gives a^2.
                *power += 2.0 * (re * re + im * im) / (sum * sum);
            }
        }
        power.iter_mut().for_each(|power| *power /= f64::max(used, 1.0));
        (power, used)
    };
    let of_torque = spectrum(torque, &grid).0;
    let of_motion = ratios(&of_torque);
    let mut found: Vec<Line> = Vec::new();
    let mut rest = residual.to_vec();
    // One after the other, each taken off before the next is looked for: rows that are left out smear a line over others.
    for _ in 0..MOST {
        let (own, averaged) = spectrum(&rest, &grid);
        let own_ratio = ratios(&own);
        let near = |k: usize, width: usize| k.saturating_sub(width)..(k + width + 1).min(grid.len());
        let moved = |k: usize| {
            // Rows that are left out smear a line over its neighbourhood, so that peaks are compared.
            let strongest = |power: &[f64]| power[near(k, NEAR)].iter().copied().fold(0.0, f64::max);
            of_motion[near(k, LINE)].iter().any(|ratio| *ratio > criteria.of_the_motion)
                && strongest(&own) < criteria.share_of_residual() * strongest(&of_torque)
        };
        let free = (0..grid.len()).filter(|&k| !moved(k));
        let Some(k) = free.max_by(|a, b| own_ratio[*a].total_cmp(&own_ratio[*b])).filter(|_| averaged > 0.0) else {
            break;
        };
        // The median of the mean of `averaged` exponentials is near ln 2 of one, and near one of many.
        let median = if averaged < 2.0 { LN_2 } else { 1.0 - 1.0 / (3.0 * averaged) };
        let p = (grid.len() as f64 * gamma_ur(averaged, averaged * own_ratio[k] * median)).min(1.0);
        if p > alpha {
            break;
        }
        let background = own[k] / own_ratio[k];
        // Between the points of the grid, so that nothing of the line stays when it is taken off.
        let finer: Vec<f64> =
            (-FINER..=FINER).map(|part| grid[k] + f64::from(part) / f64::from(FINER) * step_hz).collect();
        let (powers, _) = spectrum(&rest, &finer);
        let best = (0..finer.len()).max_by(|a, b| powers[*a].total_cmp(&powers[*b])).unwrap_or_default();
        found.push(Line { hz: finer[best], rms: (powers[best] - background).max(0.0).sqrt(), p });
        for segment in rows.starts.windows(2) {
            for from in (segment[0]..segment[1]).step_by(SEGMENT) {
                let part = from..(from + SEGMENT).min(segment[1]);
                take_off(&mut rest[part.clone()], &valid[part], 2.0 * PI * finer[best] * row_s);
            }
        }
    }
    found
}

/// Takes the oscillation at a frequency, rad per sample, that fits the valid samples best off a signal.
fn take_off(signal: &mut [f64], valid: &[bool], step: f64) {
    let wave = |place: usize| [(step * place as f64).cos(), (step * place as f64).sin()];
    let (mut gram, mut right) = ([[0.0; 2]; 2], [0.0; 2]);
    for (place, (x, _)) in signal.iter().zip(valid).enumerate().filter(|(_, (_, ok))| **ok) {
        let wave = wave(place);
        for i in 0..2 {
            right[i] += wave[i] * x;
            (0..2).for_each(|j| gram[i][j] += wave[i] * wave[j]);
        }
    }
    let determinant = gram[0][0] * gram[1][1] - gram[0][1] * gram[1][0];
    if determinant <= 1e-6 * gram[0][0] * gram[1][1] {
        return;
    }
    let cosine = (gram[1][1] * right[0] - gram[0][1] * right[1]) / determinant;
    let sine = (gram[0][0] * right[1] - gram[1][0] * right[0]) / determinant;
    for (place, x) in signal.iter_mut().enumerate() {
        let wave = wave(place);
        *x -= cosine * wave[0] + sine * wave[1];
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::channels::Channels;
    use crate::random::stream;
    use crate::recording::Recording;
    use rand_distr::{Distribution, StandardNormal};

    /// Rows of a log of 30 s.
    fn rows() -> Rows {
        let time: Vec<f64> = (0..3_000).map(|k| f64::from(k) / 100.0).collect();
        let q = Channels::from_vectors(&[time.iter().map(|t| (1.3 * t).sin()).collect()]);
        let tau = Channels::zeros(1, 3_000);
        let log = Recording { joints: vec!["a".into()], time, q, tau, ..Default::default() };
        Rows::new(&[&log], 10.0, 1).unwrap()
    }

    fn noise(rows: &Rows, seed: u64) -> Vec<f64> {
        let mut source = stream(seed, "lines_test", 0);
        (0..rows.len()).map(|_| StandardNormal.sample(&mut source)).collect()
    }

    fn swing(rows: &Rows, hz: f64, amplitude: f64) -> Vec<f64> {
        (0..rows.len()).map(|row| amplitude * (2.0 * PI * hz * 0.02 * row as f64).sin()).collect()
    }

    fn sum(a: &[f64], b: &[f64]) -> Vec<f64> {
        a.iter().zip(b).map(|(a, b)| a + b).collect()
    }

    #[test]
    fn a_line_is_found_with_its_frequency_and_size() {
        let rows = rows();
        let residual = sum(&noise(&rows, 1), &swing(&rows, 7.3, 1.0));
        let criteria = StructureCriteria::default();
        let found = lines(&rows, 0, [&residual, &vec![0.0; rows.len()]], &criteria, 0.01);
        assert_eq!(found.len(), 1, "{found:?}");
        assert!((found[0].hz - 7.3).abs() < 0.05, "{found:?}");
        assert!((found[0].rms - 0.5f64.sqrt()).abs() < 0.1, "{found:?}");
    }

    #[test]
    fn noise_has_no_lines_and_those_of_the_motion_are_the_motions() {
        let rows = rows();
        let still = vec![0.0; rows.len()];
        let criteria = StructureCriteria::default();
        let alarms =
            (0..20).filter(|&seed| !lines(&rows, 0, [&noise(&rows, seed), &still], &criteria, 0.01).is_empty()).count();
        assert!(alarms <= 1, "{alarms}");
        let residual = sum(&noise(&rows, 1), &swing(&rows, 7.3, 1.0));
        let torque = sum(&noise(&rows, 2), &swing(&rows, 7.3, 5.0));
        assert_eq!(lines(&rows, 0, [&residual, &torque], &criteria, 0.01), []);
        // What shakes an arm moves it: up to four times its size in the torque of the model it is no error of that.
        let shaken = sum(&noise(&rows, 2), &swing(&rows, 7.3, 3.0));
        assert_eq!(lines(&rows, 0, [&residual, &shaken], &criteria, 0.01).len(), 1);
    }
}
