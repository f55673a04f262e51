//! Saturation: whether torque is flat at a limit, and at which: where the model is beyond the limit, the measured
//! torque of a joint that is cut off does not move with the model's, however wrong that is and however slow the noise.

use crate::diagnosis::logs::{Log, Rows};
use crate::identification::effect_model::Arm;

/// Fewest samples of an excursion that count.
const FEWEST: usize = 3;

/// Slope of the measured torque of `joint` over the model's wherever the arm as found has more than `level`, N m: zero for torque that is
/// cut off, one for torque that is not. NaN where the model nowhere has.
pub(crate) fn slope_beyond(arm: &Arm, rows: &Rows, joint: usize, level: f64) -> f64 {
    let [mut together, mut model_alone] = [0.0; 2];
    for log in &rows.logs[rows.before..] {
        let model = arm.torque(&log.motion, &log.motion);
        let [shared, own] = beyond(model.channel(joint), log.torque.channel(joint), level);
        together += shared;
        model_alone += own;
    }
    together / model_alone
}

/// A level at which torque is cut off, with its standard deviation, N m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct FlatLevel {
    /// Mean of the measured torque where it is cut off.
    pub level: f64,
    /// Scatter of that between excursions, whatever the noise is within one (Liang and Zeger, Biometrika 73, 1986); zero of one alone.
    pub std: f64,
}

/// The level of the measured torque of `joint` where the arm as found has more than about `level`, N m. A fit of what is cut off takes
/// rounded corners and errors of the peaks for a lower one. None where no excursion is long enough.
pub(crate) fn flat_level(arm: &Arm, rows: &Rows, joint: usize, level: f64) -> Option<FlatLevel> {
    let logs = rows.logs.iter().enumerate().skip(rows.before);
    let models: Vec<(Vec<f64>, &Log)> = logs
        .map(|(index, log)| {
            let mut model = arm.torque(&log.motion, &log.motion).channel(joint).to_vec();
            // At the ends of a log, and after a gap, the model is not to be trusted.
            for (sample, torque) in model.iter_mut().enumerate() {
                let row = rows.starts[index] + sample / log.block;
                if row >= rows.starts[index + 1] || !rows.valid[joint][row] {
                    *torque = 0.0;
                }
            }
            (model, log)
        })
        .collect();
    let peak = models.iter().flat_map(|(model, _)| model).fold(level, |most, torque| most.max(torque.abs()));
    let of_log = |(model, log): &(Vec<f64>, &Log)| tops(model, log.torque.channel(joint), 0.5 * (level + peak));
    mean_of_tops(&models.iter().flat_map(of_log).collect::<Vec<_>>())
}

/// Sums of products of model and measured torque, and of squares of the model's, about their means in each excursion of the
/// model beyond `level`.
fn beyond(model: &[f64], measured: &[f64], level: f64) -> [f64; 2] {
    let mut sums = [0.0; 2];
    for (model, measured) in excursions(model, measured, level) {
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        let (of_model, of_measured) = (mean(model), mean(measured));
        for (m, r) in model.iter().zip(measured) {
            sums[0] += (m - of_model) * (r - of_measured);
            sums[1] += (m - of_model).powi(2);
        }
    }
    sums
}

/// Intervals of model and measured torque in which the model's is beyond `level` on one side.
fn excursions<'a>(model: &'a [f64], measured: &'a [f64], level: f64) -> Vec<(&'a [f64], &'a [f64])> {
    let side = |k: usize| match measured[k].is_finite() && model[k].abs() > level {
        true => model[k].signum(),
        false => 0.0,
    };
    let (mut intervals, mut start) = (Vec::new(), 0);
    while start < model.len() {
        let end = (start..model.len()).find(|&k| side(k) != side(start)).unwrap_or(model.len());
        if side(start) != 0.0 && end - start >= FEWEST {
            intervals.push((&model[start..end], &measured[start..end]));
        }
        start = end;
    }
    intervals
}

/// Sum and number of the measured torque, its sign aside, in each excursion beyond what is surely cut off: half way from the level to the
/// largest torque of the model, which may err by that much then.
fn tops(model: &[f64], measured: &[f64], surely: f64) -> Vec<(f64, f64)> {
    let top = |(model, measured): (&[f64], &[f64])| {
        let sum = model.iter().zip(measured).map(|(m, r)| m.signum() * r).sum();
        (sum, model.len() as f64)
    };
    excursions(model, measured, surely).into_iter().map(top).collect()
}

fn mean_of_tops(tops: &[(f64, f64)]) -> Option<FlatLevel> {
    let (sum, count) = tops.iter().fold((0.0, 0.0), |(s, n), (sum, count)| (s + sum, n + count));
    if count == 0.0 {
        return None;
    }
    let (level, clusters) = (sum / count, tops.len() as f64);
    let scatter: f64 = tops.iter().map(|(sum, count)| (sum - count * level).powi(2)).sum();
    let few = if clusters > 1.0 { clusters / (clusters - 1.0) } else { 0.0 };
    Some(FlatLevel { level, std: (few * scatter).sqrt() / count })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Slope of a torque against a model that is 10 % too small, with a slow error of its own.
    fn slope(of: impl Fn(f64) -> f64) -> f64 {
        let torque = |k: usize| 100.0 * (0.02 * k as f64).sin();
        let model: Vec<f64> = (0..2000).map(|k| 0.9 * torque(k)).collect();
        let measured: Vec<f64> = (0..2000).map(|k| of(torque(k)) + 5.0 * (0.003 * k as f64).cos()).collect();
        let [together, alone] = beyond(&model, &measured, 70.0);
        together / alone
    }

    #[test]
    fn what_is_cut_off_is_flat() {
        assert!(slope(|torque| torque.clamp(-75.0, 75.0)).abs() < 0.1, "{}", slope(|torque| torque.clamp(-75.0, 75.0)));
        assert!((slope(|torque| torque) - 1.0 / 0.9).abs() < 0.1);
    }

    #[test]
    fn both_sides_and_gaps_are_excursions_of_their_own() {
        let model = [5.0, 6.0, 7.0, -5.0, -6.0, -7.0, 0.0, 9.0];
        let measured = [1.0, 2.0, 3.0, -1.0, -2.0, f64::NAN, 0.0, 9.0];
        // The second excursion has two samples, the last one.
        assert_eq!(beyond(&model, &measured, 4.0), [2.0, 2.0]);
        assert_eq!(beyond(&model, &measured, 10.0), [0.0, 0.0]);
    }

    #[test]
    fn the_level_is_that_of_the_tops() {
        // A model 10 % too small, with a peak of 90, and a level taken too low: at 65 the torque is not cut off yet, half way to the peak
        // it is.
        let torque: Vec<f64> = (0..2000).map(|k| 100.0 * (0.02 * f64::from(k)).sin()).collect();
        let model: Vec<f64> = torque.iter().map(|torque| 0.9 * torque).collect();
        let measured: Vec<f64> = torque.iter().map(|torque| torque.clamp(-75.0, 75.0)).collect();
        let flat = mean_of_tops(&tops(&model, &measured, 0.5 * (65.0 + 90.0))).unwrap();
        assert!((flat.level - 75.0).abs() < 1e-9 && flat.std < 1e-9, "{flat:?}");
        assert_eq!(mean_of_tops(&tops(&model, &measured, 95.0)), None);
        // Means of 8 and 10 of 3 and 1 samples: 8.5, and 2 (0.5 * 3 squared + 1.5 squared) under the root, over 4.
        let two = mean_of_tops(&[(24.0, 3.0), (10.0, 1.0)]).unwrap();
        assert!((two.level - 8.5).abs() < 1e-12 && (two.std - (2.0 * 4.5f64).sqrt() / 4.0).abs() < 1e-12, "{two:?}");
    }
}
