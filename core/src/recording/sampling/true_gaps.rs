//! Whether long steps of a clock are those of the motion: rows were lost then, and none of them waited to be stamped.

use crate::signal::size_quantile;

/// A step this many times longer than the usual one is long.
const LONG: f64 = 3.0;

/// Whether positions change in the long steps as much more than in the others as these are longer, rather than as much as in any other, as
/// those of rows do that are stamped as they arrive.
pub(super) fn are_true(time: &[f64], signals: &[&[f64]]) -> bool {
    let steps: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let usual = size_quantile(steps.iter().copied(), 0.5);
    if usual <= 0.0 || steps.iter().any(|step| !step.is_finite() || *step < 0.0) {
        return false;
    }
    let of = |value: &dyn Fn(usize) -> f64| {
        let mean = |long: bool| {
            let own = (0..steps.len()).filter(|&row| (steps[row] > LONG * usual) == long);
            let (sum, count) = own.map(value).filter(|v| v.is_finite()).fold((0.0, 0.0), |(s, n), v| (s + v, n + 1.0));
            sum / count
        };
        mean(true) / mean(false)
    };
    let of_time = of(&|row| steps[row]);
    let each = signals.iter().map(|signal| of(&|row| (signal[row + 1] - signal[row]).abs()));
    let moved: Vec<f64> = each.filter(|ratio| ratio.is_finite() && *ratio > 0.0).collect();
    let mean = moved.iter().map(|ratio| ratio.ln()).sum::<f64>() / moved.len() as f64;
    // Nearer to the ratio of the steps than to one.
    mean > 0.5 * of_time.ln()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn motion_shows_whether_rows_were_lost_or_waited() {
        let stamp = |row: usize| 0.002 * row as f64 + 0.028 * (row / 11) as f64;
        let time: Vec<f64> = (0..2000).map(stamp).collect();
        let sine = |t: f64| (3.0 * t).sin();
        let lost: Vec<f64> = time.iter().map(|&t| sine(t)).collect();
        let mean_step = time[1999] / 1999.0;
        let waited: Vec<f64> = (0..2000).map(|row| sine(mean_step * row as f64)).collect();
        assert!(are_true(&time, &[&lost]) && !are_true(&time, &[&waited]));
        // A joint that stands, a clock without gaps, and one that is coarse show nothing.
        assert!(!are_true(&time, &[&[0.5; 2000]]));
        let even: Vec<f64> = (0..2000).map(|row| 0.002 * row as f64).collect();
        let coarse: Vec<f64> = (0..2000).map(|row| 0.02 * (row / 10) as f64).collect();
        assert!(!are_true(&even, &[&lost]) && !are_true(&coarse, &[&waited]));
    }
}
