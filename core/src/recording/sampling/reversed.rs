//! Rows in the reverse order of time, as tables sorted by it downwards have them, and clocks that count down.

use super::unit::joined;
use crate::recording::columns::{ABSENT, Layout};

/// Share of the steps of time that go back, from which on all rows are in reverse order: some may be out of order besides.
const BACKWARD: f64 = 0.9;

/// Fewer steps say nothing of the order.
const FEWEST: usize = 20;

/// Rows over which a change of position is compared with velocities: from one row to the next it may be rounding.
const STRIDE: usize = 10;

/// Correlation of changes of position with velocities from which on a joint shows which way time goes.
const SHOWN: f64 = 0.5;

/// Puts rows in reverse order of time right, with their `lines` in the file; returns what was done. Where velocities show that the rows are
/// in order, the clock counts down, and is turned instead.
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
    if layout.nanoseconds().is_none() && in_order(layout, columns) {
        let time = &mut columns[layout.time()];
        let finite = || time.iter().copied().filter(|time| time.is_finite());
        let both = finite().next()? + finite().next_back()?;
        time.iter_mut().for_each(|time| *time = both - *time);
        return Some(
            "the clock counts down: velocities show that the rows are in order, and time is taken to increase"
                .to_owned(),
        );
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

/// Whether the velocities of all joints that move are those of the rows as they stand.
fn in_order(layout: &Layout, columns: &[Vec<f64>]) -> bool {
    let both = layout.positions().iter().zip(layout.velocities().unwrap_or_default());
    let logged = both.filter(|(q, qd)| **q != ABSENT && **qd != ABSENT);
    let each = logged.filter_map(|(&q, &qd)| correlation(&columns[q], &columns[qd])).filter(|own| own.abs() > SHOWN);
    let each: Vec<f64> = each.collect();
    !each.is_empty() && each.iter().all(|own| *own > 0.0)
}

/// Correlation of changes of position with velocities between them; None where nothing changes.
fn correlation(q: &[f64], qd: &[f64]) -> Option<f64> {
    let pairs = q.windows(STRIDE + 1).zip(qd.windows(STRIDE + 1));
    let pairs = pairs.map(|(q, qd)| (q[STRIDE] - q[0], qd.iter().sum::<f64>()));
    let [mut both, mut changes, mut velocities] = [0.0; 3];
    for (change, velocity) in pairs.filter(|(change, velocity)| change.is_finite() && velocity.is_finite()) {
        both += change * velocity;
        changes += change * change;
        velocities += velocity * velocity;
    }
    let size = (changes * velocities).sqrt();
    (size > 0.0).then(|| both / size)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn velocities_show_which_way_rows_go() {
        let angle = |row: u32| 0.02 * f64::from(row);
        let q: Vec<f64> = (0..600).map(|row| angle(row).sin()).collect();
        let qd: Vec<f64> = (0..600).map(|row| angle(row).cos()).collect();
        let reversed: Vec<f64> = qd.iter().map(|qd| -qd).collect();
        let shown = |qd: &[f64]| correlation(&q, qd).unwrap();
        assert!(shown(&qd) > 0.99 && shown(&reversed) < -0.99);
        // A velocity that lags by nearly 60 degrees shows it still, one by more does not.
        let late = |by: f64| (0..600).map(|row| (angle(row) - by).cos()).collect::<Vec<f64>>();
        assert!(shown(&late(1.0)) > SHOWN && shown(&late(1.1)).abs() < SHOWN);
        assert_eq!(correlation(&q, &vec![0.0; 600]), None);
    }

    #[test]
    fn a_clock_that_counts_down_leaves_rows_in_order() {
        let header: Vec<String> = ["t", "q1", "q2", "qd1", "qd2", "tau1", "tau2"].map(str::to_owned).to_vec();
        let layout = Layout::find("log.csv".as_ref(), None, &header, None).unwrap();
        let angle = |row: u32| 0.02 * f64::from(row);
        let of = |signal: &dyn Fn(u32) -> f64| (0..600).map(signal).collect::<Vec<f64>>();
        let undone = |signs: [f64; 2]| {
            let [one, two] = signs;
            let mut columns = vec![
                of(&|row| 5.0 + 0.01 * f64::from(599 - row)),
                of(&|row| angle(row).sin()),
                of(&|row| angle(row).cos()),
                of(&|row| one * angle(row).cos()),
                of(&|row| -two * angle(row).sin()),
                of(&|row| f64::from(row)),
                of(&|row| f64::from(row)),
            ];
            let mut lines: Vec<usize> = (2..602).collect();
            let said = undo(&layout, &mut columns, &mut lines).unwrap();
            assert!(columns[0].is_sorted() && columns[0][0] == 5.0);
            (said.contains("counts down"), columns[5][0] == 0.0, lines[0] == 2)
        };
        assert_eq!(undone([1.0, 1.0]), (true, true, true));
        // Reversed rows, and velocities of which one joint denies what another shows.
        assert_eq!([undone([-1.0, -1.0]), undone([1.0, -1.0])], [(false, false, false); 2]);
        // A joint without velocity shows nothing.
        assert_eq!([undone([1.0, 0.0]), undone([0.0, 0.0])], [(true, true, true), (false, false, false)]);
    }

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
