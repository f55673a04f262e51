//! Values that are repeated until the next one comes, while the other signals go on.

use super::digits;
use super::rows::{FEWEST, keep};
use crate::recording::columns::{ABSENT, Layout};

/// Repeated values come at a rate where this share of the steps between two changes is the median step, or one row from it:
/// a channel of few digits changes at uneven steps.
const REGULAR: f64 = 0.95;

/// The other signals go on between two changes: they change as often there as elsewhere, up to this share.
const GOES_ON: f64 = 0.5;

/// Slowest rate, Hz, to which a log is brought because of repeated values: below, the motion of an arm is not followed.
const SLOWEST_HZ: f64 = 8.0;

/// Keeps the rows of new values where values are repeated while the other signals go on. Time is in seconds. Nothing is done
/// where they do not come at a rate, or at a slow one. Returns what was done.
pub(crate) fn without_repeats(layout: &Layout, columns: &mut [Vec<f64>], lines: &mut Vec<usize>) -> Option<String> {
    let changes = |table: &[usize]| -> Vec<bool> {
        let used: Vec<&[f64]> =
            table.iter().filter(|column| **column != ABSENT).map(|column| columns[*column].as_slice()).collect();
        let differs = |values: &&[f64], row: usize| values[row] != values[row - 1];
        (0..lines.len()).map(|row| row > 0 && used.iter().any(|values| differs(values, row))).collect()
    };
    let (position, torque) = (changes(layout.positions()), changes(layout.torques()));
    let (of, own, other) = if repeats(&torque, &position) {
        ("torques", torque, "positions")
    } else if repeats(&position, &torque) {
        ("positions", position, "torques")
    } else {
        return None;
    };
    let new: Vec<usize> = (0..own.len()).filter(|&row| own[row]).collect();
    let signals = if of == "torques" { layout.torques() } else { layout.positions() };
    let signals: Vec<usize> = signals.iter().copied().filter(|column| *column != ABSENT).collect();
    if digits::may_be_why(columns, &signals, &new) {
        return None;
    }
    let usual = median_step(&new)?;
    // While nothing changes, as at rest, rows are kept at the same rate.
    let rest =
        |pair: &[usize]| (pair[0]..pair[1]).step_by(usual).filter(|row| pair[1] - row > usual / 2).collect::<Vec<_>>();
    let mut kept: Vec<usize> = new.windows(2).flat_map(rest).collect();
    kept.extend(new.last());
    let time = &columns[layout.time()];
    let rate = (kept.len() - 1) as f64 / (time[*kept.last()?] - time[kept[0]]);
    if rate.is_nan() || rate < SLOWEST_HZ {
        return None;
    }
    let share = 100.0 * (1.0 - kept.len() as f64 / own.len() as f64);
    keep(&kept, columns, lines);
    Some(format!(
        "the {of} of all joints change at {rate:.1} Hz and are repeated between, while the {other} go on: they come from two sources \
         at rates of their own; the {share:.0} % of the rows that repeat are left out, and the log is taken at that rate"
    ))
}

/// Whether a signal changes at a rate below that of the rows, between which the other one goes on.
fn repeats(own: &[bool], other: &[bool]) -> bool {
    let new: Vec<usize> = (0..own.len()).filter(|&row| own[row]).collect();
    let Some(usual) = median_step(&new).filter(|&usual| usual > 1 && new.len() >= FEWEST) else { return false };
    let near = new.windows(2).filter(|pair| (pair[1] - pair[0]).abs_diff(usual) <= 1).count() as f64;
    let share = |wanted: bool| {
        let rows = || (0..own.len()).filter(|&row| own[row] == wanted);
        rows().filter(|&row| other[row]).count() as f64 / rows().count().max(1) as f64
    };
    near >= REGULAR * (new.len() - 1) as f64 && share(true) > GOES_ON && share(false) > GOES_ON * share(true)
}

fn median_step(rows: &[usize]) -> Option<usize> {
    let mut steps: Vec<usize> = rows.windows(2).map(|pair| pair[1] - pair[0]).collect();
    steps.sort_unstable();
    steps.get(steps.len() / 2).copied()
}

#[cfg(test)]
mod tests {
    use crate::recording::lenient::{ColumnMap, Sieved, load};

    /// A log of 40 s at 200 Hz whose torque is held over so many rows.
    fn held(rows: usize) -> Sieved {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.csv");
        let mut text = "t,q1,tau1\n".to_owned();
        for row in 0..8000 {
            let [t, then] = [row, row / rows * rows].map(|row| 0.005 * row as f64);
            text += &format!("{t:.3},{:.9},{:.9}\n", (1.3 * t).sin(), 5.0 * (1.1 * then).cos());
        }
        std::fs::write(&path, text).unwrap();
        load(&path, None, &ColumnMap::default()).unwrap()
    }

    #[test]
    fn held_torques_are_taken_at_their_own_rate_down_to_eight_a_second() {
        for (rows, rate) in [(8, 25.0), (24, 8.333)] {
            let sieved = held(rows);
            assert!((sieved.recording.rate_hz() / rate - 1.0).abs() < 1e-3, "{}", sieved.recording.rate_hz());
            assert!(
                sieved.corrections.iter().any(|note| note.contains("repeated between")),
                "{:?}",
                sieved.corrections
            );
        }
        assert_eq!(held(26).recording.samples(), 8000);
    }
}
