//! Rows that are stamped as they arrive where their receiver stalls: after a pause the rows that waited come at once, and none is lost.

use crate::signal::size_quantile;

/// A step this many times longer than the usual one may be a stall.
const STALL: f64 = 3.0;

/// Share of the usual step below which the first row after a stall comes with the one before: it waited.
const AT_ONCE: f64 = 0.5;

/// Usual steps within which rows are on time again: as many have come as the time that passed has room for.
const ON_TIME: f64 = 0.5;

/// Longest time until the rows that waited have come, s.
const LONGEST_S: f64 = 2.0;

/// Time within which some row is on time, s, and rows at the least, where none is lost.
const WINDOW_S: f64 = 1.0;
const WINDOW: usize = 50;

/// The step of a clock, and when its first row was due.
struct Due {
    step: f64,
    first: f64,
}

/// Puts rows that came late at even steps between those on time before and behind them; returns what was done.
pub(super) fn undo(time: &mut [f64]) -> Option<String> {
    let steps: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).collect();
    if steps.iter().any(|step| !step.is_finite() || *step < 0.0) {
        return None;
    }
    let steady = steady(time);
    let usual = size_quantile(steps.iter().copied().filter(|step| *step > 0.0), 0.5);
    let (mut stalls, mut longest, mut row) = (0, 0.0f64, 0);
    while row + 2 < time.len() {
        // From rows that are lost on, rows are due later.
        let here = || Due { step: usual, first: time[row] - usual * row as f64 };
        let due = steady.as_ref().map_or_else(here, |due| Due { ..*due });
        let stalled = steps[row] > STALL * due.step && steps[row + 1] < AT_ONCE * due.step;
        match stalled.then(|| on_time_again(time, row, &due)).flatten() {
            Some(next) => {
                let (start, step) = (time[row], (time[next] - time[row]) / (next - row) as f64);
                (row + 1..next).for_each(|late| time[late] = start + step * (late - row) as f64);
                (stalls, longest) = (stalls + 1, longest.max(steps[row]));
                row = next;
            }
            None => row += 1,
        }
    }
    (stalls > 0).then(|| {
        format!(
            "rows are stamped as they arrive: {stalls} time{} none came for up to {:.0} ms and then all that had waited, so that none is lost; they \
             are put at even steps; log the time of the measurement if you can",
            if stalls == 1 { "" } else { "s" },
            1e3 * longest
        )
    })
}

/// The clock of rows none of which is lost: then the earliest of any second are due on one line. Many stalls make the usual step another
/// than that.
fn steady(time: &[f64]) -> Option<Due> {
    let half = time.len() / 2;
    if half < WINDOW {
        return None;
    }
    let over_half = (half..time.len()).map(|row| (time[row] - time[row - half]) / half as f64);
    let step = size_quantile(over_half, 0.5);
    let due = |(row, stamp): (usize, &f64)| stamp - step * row as f64;
    let window = WINDOW.max((WINDOW_S / step).min(half as f64) as usize);
    let rows: Vec<f64> = time.iter().enumerate().map(due).collect();
    let earliest: Vec<f64> =
        rows.chunks_exact(window).map(|part| part.iter().copied().fold(f64::INFINITY, f64::min)).collect();
    let least = earliest.iter().copied().fold(f64::INFINITY, f64::min);
    let most = earliest.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    (step > 0.0 && most - least < ON_TIME * step).then_some(Due { step, first: least })
}

/// The first row behind a stall after `row` by which as many have come as are due.
fn on_time_again(time: &[f64], row: usize, due: &Due) -> Option<usize> {
    let within = (row + 2..time.len()).take_while(|&next| time[next] - time[row] < LONGEST_S);
    // Once more have come than are due, the steps were no stall.
    let late = |next: usize| (time[next] - due.first) / due.step - next as f64;
    within.take_while(|&next| late(next) > -ON_TIME).find(|&next| late(next) < ON_TIME)
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEP_S: f64 = 0.01;

    /// A log at 100 Hz of which nothing arrives in the half second after some rows for a time.
    fn stalled(at: &[usize], for_s: f64) -> Vec<f64> {
        let due: Vec<f64> = (0..1000).map(|row| STEP_S * row as f64).collect();
        let arrival = |row: usize| {
            let blocked =
                at.iter().map(|&at| due[at] + 0.4 * STEP_S).find(|&from| (from..from + for_s).contains(&due[row]));
            blocked.map_or(due[row], |from| from + for_s + 1e-4 * (due[row] - from) / STEP_S)
        };
        (0..1000).map(arrival).collect()
    }

    #[test]
    fn rows_that_waited_are_put_where_they_were_due() {
        for for_s in [0.05, 0.2] {
            let mut time = stalled(&[200, 500, 700], for_s);
            let said = undo(&mut time).unwrap();
            assert!(said.contains("3 times"), "{said}");
            for (row, time) in time.iter().enumerate() {
                assert!((time - STEP_S * row as f64).abs() < 0.5 * STEP_S, "{for_s}: row {row} at {time}");
            }
        }
    }

    /// A receiver that stalls so often, for so long, that its usual step is another than that of the clock, and stamps that tremble.
    #[test]
    fn many_stalls_are_undone() {
        let step = 0.002;
        let blocked = |due: f64| {
            let from = 0.38 * (due / 0.38).floor() + 0.1;
            (from..from + 0.06).contains(&due).then_some((from, from + 0.06))
        };
        let arrival = |row: usize| {
            let due = step * row as f64;
            let tremble = 2e-4 * (0.5 + 0.5 * (7.0 * row as f64).sin());
            blocked(due).map_or(due + tremble, |(from, until)| until + 2e-5 * (due - from) / step)
        };
        // Rows come in their order.
        let in_order = |latest: &mut f64, stamp: f64| {
            *latest = latest.max(stamp);
            Some(*latest)
        };
        let mut time: Vec<f64> = (0..15_000).map(arrival).scan(0.0, in_order).collect();
        let said = undo(&mut time).unwrap();
        assert!(said.contains("79 times"), "{said}");
        for (row, time) in time.iter().enumerate() {
            assert!((time - step * row as f64).abs() < 0.6 * step, "row {row} at {time}");
        }
    }

    #[test]
    fn rows_that_are_lost_and_an_uneven_clock_stay() {
        let due = |row: usize| STEP_S * row as f64;
        let lost: Vec<f64> = (0..1000).map(|row| due(row) + if row > 300 { 0.05 } else { 0.0 }).collect();
        let uneven: Vec<f64> = (0..1000).map(|row| due(row) + if row % 2 == 0 { 0.004 } else { 0.0 }).collect();
        // A pause behind which rows come fast, and stay ahead.
        let ahead: Vec<f64> = (0..1000)
            .map(|row| if row > 300 { due(300) + 0.05 + 0.002 * (row - 301) as f64 } else { due(row) })
            .collect();
        for mut time in [lost, uneven, ahead, vec![], vec![1.0]] {
            let before = time.clone();
            assert_eq!(undo(&mut time), None);
            assert_eq!(time, before);
        }
    }
}
