//! Rows in the reverse order of time, as tables sorted by it downwards have them.

use super::unit::joined;
use crate::recording::columns::{ABSENT, Layout};

/// Share of the steps of time that go back, from which on all rows are in reverse order: some may be out of order besides.
const BACKWARD: f64 = 0.9;

/// Fewer steps say nothing of the order.
const FEWEST: usize = 20;

/// Puts rows in reverse order of time right, with their `lines` in the file; returns what was done.
pub(crate) fn undo(layout: &Layout, columns: &mut [Vec<f64>], lines: &mut [usize]) -> Option<String> {
    if layout.time() == ABSENT {
        return None;
    }
    let whole = &columns[layout.time()];
    let backwards = match layout.nanoseconds() {
        Some(parts) => runs_backwards(&joined(whole, &columns[parts])),
        None => runs_backwards(whole),
    };
    if !backwards {
        return None;
    }
    columns.iter_mut().for_each(|values| values.reverse());
    lines.reverse();
    Some("time runs backwards from row to row: the rows are taken in reverse order".to_owned())
}

/// Whether nearly all steps of time go back, and the whole with them.
fn runs_backwards(time: &[f64]) -> bool {
    let finite: Vec<f64> = time.iter().copied().filter(|time| time.is_finite()).collect();
    let steps = || finite.windows(2).map(|pair| pair[1] - pair[0]);
    let (back, forth) = (steps().filter(|step| *step < 0.0).count(), steps().filter(|step| *step > 0.0).count());
    back + forth >= FEWEST && back as f64 >= BACKWARD * (back + forth) as f64 && finite.last() < finite.first()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_time_that_runs_backwards_throughout_is_reversed() {
        let down: Vec<f64> = (0..100).rev().map(|row| 0.01 * f64::from(row)).collect();
        assert!(runs_backwards(&down));
        // A coarse clock, and single rows out of order or without a time.
        assert!(runs_backwards(&down.iter().map(|time| (40.0 * time).floor()).collect::<Vec<_>>()));
        let mut swapped = down.clone();
        swapped.swap(40, 42);
        swapped[70] = f64::NAN;
        assert!(runs_backwards(&swapped));
        let up: Vec<f64> = down.iter().rev().copied().collect();
        // In order, one recording behind another, and too few rows to tell.
        for time in [up.clone(), [up.clone(), up].concat(), down[..20].to_vec(), vec![f64::NAN; 100], vec![]] {
            assert!(!runs_backwards(&time), "{time:?}");
        }
    }
}
