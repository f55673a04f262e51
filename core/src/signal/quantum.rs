//! The step of a signal of few digits, as of a coarse encoder.

use super::{changes, size_quantile};

/// A signal most of whose changes are smaller than this many of its smallest one has few digits.
const COARSE: f64 = 3.5;

/// Sizes of the changes of a signal from one sample to the next, where there are any.
pub(crate) fn change_sizes(values: &[f64]) -> impl Iterator<Item = f64> {
    changes(values).map(f64::abs).filter(|change| *change > 0.0)
}

/// The smallest change of a signal that has so few digits that most of its changes are by the last one.
pub(crate) fn quantum(values: &[f64]) -> Option<f64> {
    let smallest = change_sizes(values).fold(f64::INFINITY, f64::min);
    (smallest.is_finite() && size_quantile(change_sizes(values), 0.5) < COARSE * smallest).then_some(smallest)
}

/// Root mean square of the rounding error of a signal that rests between its steps, which means over samples do not make smaller; zero where
/// noise carries most samples over a step.
pub(crate) fn rounding(values: &[f64]) -> f64 {
    let resting = changes(values).filter(|change| *change == 0.0).count();
    let rests = 2 * resting > changes(values).count();
    quantum(values).filter(|_| rests).map_or(0.0, |step| step / 12f64.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_signal_of_few_digits_has_a_step() {
        let swing =
            |step: f64| -> Vec<f64> { (0..500).map(|k| step * ((0.02 * f64::from(k)).sin() / step).round()).collect() };
        // It moves by 0.013 in the median, which is 3.3 and 4.4 steps, rounded.
        assert!((quantum(&swing(0.006)).unwrap() - 0.006).abs() < 1e-12);
        assert!((quantum(&swing(0.02)).unwrap() - 0.02).abs() < 1e-12);
        assert_eq!(quantum(&swing(0.0015)), None);
        assert_eq!(quantum(&[1.0; 9]), None);
    }

    #[test]
    fn a_signal_that_rests_between_steps_is_rounded() {
        let swing = |step: f64, noise: f64| -> Vec<f64> {
            let own = |k: i32| (0.01 * f64::from(k)).sin() + noise * (1.9 * f64::from(k * k)).sin();
            (0..2000).map(|k| (own(k) / step).round() * step).collect()
        };
        assert!((rounding(&swing(0.1, 0.0)) - 0.1 / 12f64.sqrt()).abs() < 1e-9);
        // Noise of more than a step, and a signal of many digits.
        assert_eq!([rounding(&swing(0.1, 0.3)), rounding(&swing(1e-9, 0.0))], [0.0; 2]);
    }
}
