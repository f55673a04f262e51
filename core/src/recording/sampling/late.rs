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

/// Share of a coarse clock's step by which its steps may miss a multiple of it: digits are cut off.
const GRID: f64 = 0.01;

/// Share of the rows that come late from which on a stamp says when a message came, in all rows: they are due by their number alone.
const OFTEN: f64 = 0.05;

/// Fewest windows through whose earliest rows a line is laid: through two, it always fits.
const FEWEST: usize = 5;

/// Rounds in which the line of the earliest rows is found.
const ROUNDS: usize = 3;

/// The step of a clock, and when its first row was due.
#[derive(Clone, Copy)]
struct Due {
    step: f64,
    first: f64,
}

impl Due {
    /// When a row was due.
    fn at(&self, row: usize) -> f64 {
        self.first + self.step * row as f64
    }
}

/// Puts rows that came late at even steps between those on time before and behind them, all rows where many did; returns what was done.
pub(super) fn undo(time: &mut [f64]) -> Option<String> {
    let steps: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).collect();
    if steps.iter().any(|step| !step.is_finite() || *step < 0.0) || is_coarse(&steps) {
        return None;
    }
    let steady = steady(time);
    let usual = size_quantile(steps.iter().copied().filter(|step| *step > 0.0), 0.5);
    let (mut stalls, mut longest, mut row) = (0, 0.0f64, 0);
    let mut even = time.to_vec();
    while row + 2 < time.len() {
        // From rows that are lost on, rows are due later.
        let due = steady.unwrap_or_else(|| Due { step: usual, first: time[row] - usual * row as f64 });
        let stalled = steps[row] > STALL * due.step && steps[row + 1] < AT_ONCE * due.step;
        match stalled.then(|| on_time_again(time, row, &due)).flatten() {
            Some(next) => {
                let (start, step) = (time[row], (time[next] - time[row]) / (next - row) as f64);
                (row + 1..next).for_each(|late| even[late] = start + step * (late - row) as f64);
                (stalls, longest) = (stalls + 1, longest.max(steps[row]));
                row = next;
            }
            None => row += 1,
        }
    }
    if stalls == 0 {
        return None;
    }
    let late = |due: &Due| {
        let stamps = time.iter().enumerate();
        stamps.filter(|(row, stamp)| **stamp - due.at(*row) > ON_TIME * due.step).count()
    };
    let often = steady.filter(|due| late(due) as f64 > OFTEN * time.len() as f64);
    let at_rate = often.map_or_else(String::new, |due| format!(" by their number, at {:.1} Hz", 1.0 / due.step));
    match often {
        Some(due) => time.iter_mut().enumerate().for_each(|(row, stamp)| *stamp = due.at(row)),
        None => time.copy_from_slice(&even),
    }
    Some(format!(
        "rows are stamped as they arrive: {stalls} time{} none came for up to {:.0} ms and then all that had waited, so that none is lost; they \
         are put at even steps{at_rate}; log the time of the measurement if you can",
        if stalls == 1 { "" } else { "s" },
        1e3 * longest
    ))
}

/// Whether all steps of a clock are multiples of one that is longer than rows are apart: it is coarse, and no row is late.
fn is_coarse(steps: &[f64]) -> bool {
    let moved: Vec<f64> = steps.iter().copied().filter(|step| *step > 0.0).collect();
    let least = moved.iter().copied().fold(f64::INFINITY, f64::min);
    let multiple = |step: &f64| (step / least - (step / least).round()).abs() < GRID;
    2 * moved.len() <= steps.len() && moved.iter().all(multiple)
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
    if step <= 0.0 {
        return None;
    }
    let window = WINDOW.max((WINDOW_S / step).min(half as f64) as usize);
    let mut due = Due { step, first: time[0] };
    let mut late = Vec::new();
    // The step from whole rows is off by as much as these are late.
    for round in 0..ROUNDS {
        let lateness = |row: usize| (row as f64, time[row] - due.at(row));
        let earliest = (0..time.len() / window)
            .filter_map(|part| (part * window..(part + 1) * window).map(lateness).min_by(|a, b| a.1.total_cmp(&b.1)));
        let earliest: Vec<(f64, f64)> = earliest.collect();
        late = earliest.iter().map(|(_, late)| *late).collect();
        if round + 1 < ROUNDS && earliest.len() >= FEWEST {
            let (offset, slope) = line(&earliest);
            due = Due { step: due.step + slope, first: due.first + offset };
        }
    }
    let least = late.iter().copied().fold(f64::INFINITY, f64::min);
    let most = late.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    (most - least < ON_TIME * due.step).then_some(Due { first: due.first + least, ..due })
}

/// The line of least squares through points: its value at zero, and its slope, which is zero for a single point.
pub(super) fn line(points: &[(f64, f64)]) -> (f64, f64) {
    let count = points.len().max(1) as f64;
    let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / count;
    let (x, y) = (mean(|point| point.0), mean(|point| point.1));
    let width: f64 = points.iter().map(|point| (point.0 - x).powi(2)).sum();
    let slope = points.iter().map(|point| (point.0 - x) * (point.1 - y)).sum::<f64>() / width.max(f64::MIN_POSITIVE);
    (y - slope * x, slope)
}

/// The first row behind a stall after `row` by which as many have come as are due.
fn on_time_again(time: &[f64], row: usize, due: &Due) -> Option<usize> {
    let within = (row + 2..time.len()).take_while(|&next| time[next] - time[row] < LONGEST_S);
    // Once more have come than are due, the steps were no stall.
    let late = |next: usize| (time[next] - due.at(next)) / due.step;
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

    /// Rows that come in bursts of two to eight, the last of each on time: the stamp says nothing of the others.
    #[test]
    fn rows_that_always_come_in_bursts_are_due_by_their_number() {
        let (step, mut time, mut burst) = (0.005, Vec::new(), 0);
        while time.len() < 5000 {
            let count = 2 + (burst * 5 + burst / 7) % 7;
            let last = time.len() + count - 1;
            time.extend((0..count).map(|k| step * last as f64 + 0.0006 + 2e-5 * k as f64));
            burst += 1;
        }
        let said = undo(&mut time).unwrap();
        assert!(said.contains("by their number, at 200.0 Hz"), "{said}");
        let off: Vec<f64> = time.iter().enumerate().map(|(row, stamp)| stamp - step * row as f64).collect();
        let (least, most) = off.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(*x), b.max(*x)));
        assert!(most - least < 0.1 * step, "{least} {most}");
    }

    #[test]
    fn a_coarse_clock_is_not_late() {
        let stamps = |quantum: f64| -> Vec<f64> {
            (0..1000).map(|row| (0.004 * row as f64 / quantum + 1e-9).floor() * quantum).collect()
        };
        assert_eq!((undo(&mut stamps(0.02)), undo(&mut stamps(0.016))), (None, None));
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
