//! Whether torque that is said to be cut off at a level is flat there: where the model is beyond the level, the measured torque of
//! a joint that is cut off does not move with the model's, however wrong that is and however slow the noise.

use super::arm::Arm;
use super::rows::Rows;

/// Fewest samples of an excursion that count.
const FEWEST: usize = 3;

/// Slope of measured torque against the model's, half way between torque that is cut off (0) and torque that is not (1).
const FLAT: f64 = 0.5;

/// Whether the measured torque of `joint` is flat wherever the arm as found has more than `level`, N m.
pub fn is_flat(arm: &Arm, rows: &Rows, joint: usize, level: f64) -> bool {
    let [mut together, mut model_alone] = [0.0; 2];
    for log in &rows.logs[rows.before..] {
        let model = arm.torque(&log.motion, &log.motion);
        let [shared, own] = beyond(model.channel(joint), log.torque.channel(joint), level);
        together += shared;
        model_alone += own;
    }
    model_alone > 0.0 && together < FLAT * model_alone
}

/// Sums of products of model and measured torque, and of squares of the model's, about their means in each excursion of the
/// model beyond `level`.
fn beyond(model: &[f64], measured: &[f64], level: f64) -> [f64; 2] {
    let side = |k: usize| match measured[k].is_finite() && model[k].abs() > level {
        true => model[k].signum(),
        false => 0.0,
    };
    let (mut sums, mut start) = ([0.0; 2], 0);
    while start < model.len() {
        let end = (start..model.len()).find(|&k| side(k) != side(start)).unwrap_or(model.len());
        if side(start) != 0.0 && end - start >= FEWEST {
            let (model, measured) = (&model[start..end], &measured[start..end]);
            let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
            let (of_model, of_measured) = (mean(model), mean(measured));
            for (m, r) in model.iter().zip(measured) {
                sums[0] += (m - of_model) * (r - of_measured);
                sums[1] += (m - of_model).powi(2);
            }
        }
        start = end;
    }
    sums
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
}
