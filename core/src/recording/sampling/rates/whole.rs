//! Rows that repeat whole while time goes on: a log that is faster than its controller, or a logger that stutters.
//!
//! A repeated row holds no measurement of its own. Left in, it makes staircases of positions, whose derivatives are no motion.

use super::digits::{self, DIGITS};
use super::rows::{FEWEST, keep};
use crate::recording::columns::{ABSENT, Layout};

/// Smaller shares of repeated rows are those of a stutter, and no rate.
const OF_A_RATE: f64 = 0.05;

/// New rows come at a rate where, over so many steps, they stay within so many rows of an even spacing, nearly always. Random
/// repeats wander off.
const WINDOW: usize = 64;
const OFF: f64 = 1.5;
const EVEN: f64 = 0.95;

/// Steps of the rate that are this many times the median, and one row, are rests or gaps.
const REST: usize = 2;

/// Where so large a share of the steps are the same, their stamps are those of the source.
const SAME: f64 = 0.98;

/// New stamps are means over so many rows to either side.
const SMOOTHED: usize = 32;

/// Stamps are smoothed up to a step of this many periods.
const GAP: f64 = 2.5;

/// A joint is in motion on both sides of a stutter where its steps there are larger than this share of its usual step, and than
/// [`DIGITS`] of its smallest: one that comes to rest slows down first, and one of few digits rests between them.
const MOVES: f64 = 0.1;

/// Rows on either side of a stutter that must all be new.
const LIVE: usize = 4;

/// Leaves out rows that repeat the one before whole, as far as they are no rest, and returns what was done. Time is in seconds.
pub(crate) fn without_whole(layout: &Layout, columns: &mut [Vec<f64>], lines: &mut Vec<usize>) -> Option<String> {
    let time = layout.time();
    let stamps = &columns[time];
    let signals: Vec<usize> = {
        let own = layout.positions().iter().chain(layout.torques()).copied().chain(layout.derivatives());
        own.filter(|column| *column != ABSENT && *column != time).collect()
    };
    let differs = |row: usize| {
        let same = |x: f64, y: f64| x == y || (x.is_nan() && y.is_nan());
        signals.iter().any(|&column| !same(columns[column][row], columns[column][row - 1]))
    };
    let is_new: Vec<bool> =
        (0..lines.len()).map(|row| row == 0 || differs(row) || stamps[row] <= stamps[row - 1]).collect();
    let repeated = is_new.iter().filter(|new| !**new).count();
    if repeated == 0 {
        return None;
    }
    let new: Vec<usize> = (0..is_new.len()).filter(|&row| is_new[row]).collect();
    let rate = at_a_rate(&new, is_new.len()).filter(|_| !digits::may_be_why(columns, &signals, &new));
    if let Some((period, kept)) = rate {
        let (before, after) = (is_new.len(), kept.len());
        let own: Vec<f64> = kept.iter().map(|&row| stamps[row]).collect();
        let own = if is_uneven(&new, period) { evened(&own) } else { own };
        let rate = (own.len() - 1) as f64 / (own[own.len() - 1] - own[0]);
        keep(&kept, columns, lines);
        columns[time] = own;
        return Some(format!(
            "{} of {before} rows repeat the row before whole: the log is faster than its source, which gives {rate:.1} rows a second; \
             the log is taken at that rate",
            before - after
        ));
    }
    let stutters = stutters(&is_new, layout.positions(), columns);
    let out: usize = stutters.iter().map(|(_, length)| length - 1).sum();
    let (first, _) = *stutters.first()?;
    let line = lines[first + 1];
    let mut kept = vec![true; lines.len()];
    stutters.iter().for_each(|&(start, length)| kept[start + 1..start + length].fill(false));
    let kept: Vec<usize> = (0..kept.len()).filter(|&row| kept[row]).collect();
    let count = stutters.len();
    keep(&kept, columns, lines);
    Some(format!(
        "{out} rows repeat the row before whole while the arm moves, at {count} place{} (the first in line {line}): the logger \
         stuttered; they are left out",
        if count == 1 { "" } else { "s" }
    ))
}

/// Mean rows per new row and the rows to keep, where new ones come at a rate below that of the log. At rest, where nothing
/// changes, rows are kept at the same rate.
fn at_a_rate(new: &[usize], rows: usize) -> Option<(f64, Vec<usize>)> {
    let mut sorted = steps(new);
    sorted.sort_unstable();
    let longest = REST * sorted.get(sorted.len() / 2)? + 1;
    let moving: Vec<usize> = steps(new).into_iter().filter(|step| *step <= longest).collect();
    let period = moving.iter().sum::<usize>() as f64 / moving.len().max(1) as f64;
    if moving.len() < FEWEST || period * (1.0 - OF_A_RATE) < 1.0 {
        return None;
    }
    let (mut all, mut even) = (0, 0);
    for stretch in steps(new).split(|step| *step > longest) {
        let length = WINDOW.min(stretch.len());
        let sums = stretch.windows(length.max(1)).map(|window| window.iter().sum::<usize>() as f64);
        sums.for_each(|sum| {
            all += 1;
            even += usize::from((sum - length as f64 * period).abs() <= OFF);
        });
    }
    if (even as f64) < EVEN * all as f64 {
        return None;
    }
    let ends = new[1..].iter().copied().chain([rows]);
    let mut kept = Vec::new();
    for (&start, end) in new.iter().zip(ends) {
        let count = if end - start > longest { ((end - start) as f64 / period).round() as usize } else { 1 };
        kept.extend(
            (0..count.max(1)).map(|step| start + (step as f64 * period).round() as usize).filter(|row| *row < end),
        );
    }
    Some((period, kept))
}

fn steps(rows: &[usize]) -> Vec<usize> {
    rows.windows(2).map(|pair| pair[1] - pair[0]).collect()
}

/// Whether new rows come at steps that differ, so that their stamps are those of the log and not those of the source.
fn is_uneven(new: &[usize], period: f64) -> bool {
    let usual = period.round() as usize;
    let steps = steps(new);
    let near = steps.iter().filter(|step| **step <= REST * usual + 1);
    let (same, all) = near.fold((0, 0), |(same, all), step| (same + usize::from(*step == usual), all + 1));
    (same as f64) < SAME * all as f64
}

/// Stamps at an even rate between gaps.
fn evened(stamps: &[f64]) -> Vec<f64> {
    let mut steps: Vec<f64> = stamps.windows(2).map(|pair| pair[1] - pair[0]).collect();
    steps.sort_by(f64::total_cmp);
    let longest = GAP * steps.get(steps.len() / 2).copied().unwrap_or(0.0);
    let mut out = Vec::with_capacity(stamps.len());
    for piece in stamps.chunk_by(|a, b| b - a <= longest) {
        let period = (piece[piece.len() - 1] - piece[0]) / (piece.len().max(2) - 1) as f64;
        let late: Vec<f64> = piece.iter().enumerate().map(|(k, t)| t - k as f64 * period).collect();
        out.extend((0..piece.len()).map(|k| {
            // The same number on both sides, so that a drift of the clock stays.
            let side = SMOOTHED.min(k).min(piece.len() - 1 - k);
            let near = &late[k - side..=k + side];
            k as f64 * period + near.iter().sum::<f64>() / near.len() as f64
        }));
    }
    out
}

/// Runs of equal rows, start and length, that interrupt a motion.
fn stutters(is_new: &[bool], positions: &[usize], columns: &[Vec<f64>]) -> Vec<(usize, usize)> {
    let moving: Vec<(&[f64], f64)> = positions
        .iter()
        .filter(|column| **column != ABSENT)
        .filter_map(|&column| {
            let values = columns[column].as_slice();
            let mut changes: Vec<f64> = values.windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect();
            changes.retain(|change| *change > 0.0);
            changes.sort_by(f64::total_cmp);
            let usual = *changes.get(changes.len() * 19 / 20)?;
            Some((values, (MOVES * usual).max(DIGITS * changes[0])))
        })
        .collect();
    let starts: Vec<usize> = (0..is_new.len()).filter(|&row| is_new[row]).collect();
    let ends = starts[1..].iter().copied().chain([is_new.len()]);
    let interrupts = |&(start, length): &(usize, usize)| {
        let end = start + length;
        let is_live = start >= LIVE
            && end + LIVE <= is_new.len()
            && is_new[start - LIVE..=start].iter().chain(&is_new[end..end + LIVE]).all(|new| *new);
        let step = |values: &[f64], row: usize| (values[row] - values[row - 1]).abs();
        length > 1
            && is_live
            && moving.iter().any(|(values, least)| {
                // The step out of the stutter may make up for it; the one behind shows the speed.
                step(values, start).min(step(values, end + 1)) > *least
            })
    };
    starts.iter().copied().zip(ends).map(|(start, end)| (start, end - start)).filter(interrupts).collect()
}

#[cfg(test)]
mod tests {
    use crate::recording::lenient::{ColumnMap, Sieved, load};

    fn angle(t: f64, joint: usize) -> f64 {
        (1.0 + 0.3 * joint as f64) * (2.0 * t + joint as f64).sin()
    }

    fn torque(t: f64, joint: usize) -> f64 {
        5.0 * (3.0 * t + joint as f64).cos()
    }

    /// A log at 500 Hz for 10 s whose row at time t holds what was measured at `of(row)`.
    fn read(of: impl Fn(usize) -> f64, digits: usize) -> Sieved {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.csv");
        let mut text = "t,q1,q2,tau1,tau2\n".to_owned();
        for row in 0..5000 {
            let then = of(row);
            let [q, tau] = [angle, torque].map(|of| [0, 1].map(|joint| format!("{:.digits$}", of(then, joint))));
            text += &format!("{:.3},{},{},{},{}\n", 0.002 * row as f64, q[0], q[1], tau[0], tau[1]);
        }
        std::fs::write(&path, text).unwrap();
        load(&path, None, &ColumnMap::default()).unwrap()
    }

    /// Largest time by which a sample is off its stamp, but for what all have in common, s.
    fn off(sieved: &Sieved) -> f64 {
        let log = &sieved.recording;
        let late = |row: usize| {
            let (t, q) = (log.time[row], log.q.channel(0)[row]);
            (q - angle(t, 0)) / (2.0 * (2.0 * t).cos())
        };
        let moving = (40..log.samples() - 40).filter(|&row| (2.0 * log.time[row]).cos().abs() > 0.5);
        let late: Vec<f64> = moving.map(late).collect();
        let mean = late.iter().sum::<f64>() / late.len() as f64;
        late.iter().map(|own| (own - mean).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn a_log_that_is_faster_than_its_controller_is_taken_at_the_controllers_rate() {
        for rate in [125.0, 250.0, 400.0, 330.0, 470.0] {
            let sieved = read(|row| (0.002 * row as f64 * rate + 1e-6).floor() / rate, 12);
            let found = sieved.recording.rate_hz();
            assert!((found / rate - 1.0).abs() < 0.02, "{found} for {rate}");
            assert!(off(&sieved) < 3e-4, "{rate}: {}", off(&sieved));
            assert!(sieved.corrections.iter().any(|note| note.contains("rows a second")), "{:?}", sieved.corrections);
        }
        // One row in 25 is repeated: that shows no rate for certain, and the rows stay at their times.
        let near = read(|row| (0.002 * row as f64 * 480.0 + 1e-6).floor() / 480.0, 12);
        assert!(near.recording.samples() < 5000);
    }

    #[test]
    fn a_log_in_faster_rows_is_the_log_itself() {
        let folder = tempfile::tempdir().unwrap();
        let log = |repeats: usize| {
            let mut text = "t,q1,q2,tau1,tau2\n".to_owned();
            for row in 0..1000 * repeats {
                let then = 0.008 * (row / repeats) as f64;
                let [q, tau] = [angle, torque].map(|of| [0, 1].map(|joint| of(then, joint)));
                let t = 0.008 * row as f64 / repeats as f64;
                text += &format!("{t:.3},{},{},{},{}\n", q[0], q[1], tau[0], tau[1]);
            }
            let path = folder.path().join(format!("{repeats}.csv"));
            std::fs::write(&path, text).unwrap();
            load(&path, None, &ColumnMap::default()).unwrap().recording
        };
        let (own, repeated) = (log(1), log(4));
        assert_eq!((&own.time, &own.q, &own.tau), (&repeated.time, &repeated.q, &repeated.tau));
    }

    #[test]
    fn a_rest_keeps_its_rows() {
        // 125 Hz, at rest from 3 s to 6 s.
        let of = |row: usize| {
            let t = (0.25 * row as f64 + 1e-6).floor() / 125.0;
            if t < 3.0 { t } else { 3.0 + (t - 6.0).max(0.0) }
        };
        let sieved = read(of, 12);
        let log = &sieved.recording;
        assert!(
            (log.rate_hz() - 125.0).abs() < 0.1 && (log.samples() as f64 - 1250.0).abs() < 3.0,
            "{}",
            log.samples()
        );
        let longest = log.time.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
        assert!(longest < 0.0101, "{longest}");
        // A log that repeats nothing but its rest stays as it is.
        let of =
            |row: usize| if row < 2000 { 0.002 * row as f64 } else { 0.002 * (2000 + row.max(3000) - 3000) as f64 };
        // It comes to rest there: both joints are made to slow down.
        let slow = |row: usize| {
            let t = of(row);
            4.0 + (t - 4.0) * (t - 4.0).abs() / 4.0
        };
        assert_eq!(read(slow, 12).recording.samples(), 5000);
    }

    #[test]
    fn a_stutter_is_left_out_and_few_digits_are_none() {
        let is_held =
            |row: usize| [700usize, 1900, 3333].iter().find(|start| (**start..**start + 7).contains(&row)).copied();
        let sieved = read(|row| 0.002 * is_held(row).unwrap_or(row) as f64, 12);
        assert_eq!(sieved.recording.samples(), 5000 - 3 * 6);
        assert!(
            sieved.corrections[0].contains("18 rows repeat") && sieved.corrections[0].contains("line 703"),
            "{:?}",
            sieved.corrections
        );
        assert!(off(&sieved) < 1e-9, "{}", off(&sieved));
        // Values of few digits repeat at uneven steps.
        let coarse = read(|row| 0.002 * row as f64, 2);
        assert_eq!((coarse.recording.samples(), coarse.corrections.len()), (5000, 0), "{:?}", coarse.corrections);
    }
}
