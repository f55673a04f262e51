//! The clock of a log in seconds: parts in two columns, coarse clocks, stamps that were put together wrongly, and rows of
//! two sources.

use super::late::line;
use super::{late, late_source, restarts, set, true_gaps, unit, wrapped};
use crate::error::{Error, Result};
use crate::recording::columns::{ColumnMap, Layout};
use crate::recording::formats::text::Text;
use std::path::Path;

/// Share of the rows with the stamp of the row before, but other values, from which on the clock is coarse.
const COARSE: f64 = 0.05;

/// A row that comes after less than this share of the usual step (that which nine of ten do not exceed) comes in a burst with the
/// one before: stamps are then those of arrival.
const BURST: f64 = 0.1;
const USUAL: f64 = 0.9;

/// No arm is logged at shorter steps, s: rows that are closer come at once, however many they are.
const AT_ONCE_S: f64 = 1e-4;

/// A step of time in single precision that is longer than this hides the rows, s.
const COARSEST_S: f64 = 0.1;

/// A step this many times longer than the coarse clock's, or than rows are apart, is a gap.
const GAP: f64 = 4.0;

/// Rows that are evenly spread on their own need so many between two gaps.
const FEWEST: usize = 10;

/// Positions that come back to those of the row before last this many times closer than to the last one are of two sources.
const ALTERNATING: f64 = 5.0;

/// Fewer rows may alternate by chance.
const FEWEST_OF_TWO: usize = 50;

/// Smallest mean step between rows of two sources, in any unit of position: noise alternates below.
const APART: f64 = 1e-3;

/// Share of the rows from which on single ones that lie apart from both neighbours are those of a slower source, and no spikes.
const OF_SLOWER: f64 = 0.05;

/// A row lies apart where it differs from both neighbours by more than this share of the signal's range, and the signal by so many
/// of its smallest changes: encoders tremble by one.
const FAR: f64 = 0.01;
const DIGITS: f64 = 50.0;

/// What was done with the clock.
#[derive(Debug, Default)]
pub(crate) struct Clock {
    /// How it was understood and corrected.
    pub corrections: Vec<String>,
    /// Time may be a count of cycles of unknown length, which is taken for ms.
    pub may_count: bool,
    /// Rows with which further recordings of the file begin, which were put apart.
    pub begins: Vec<usize>,
    /// Why the rows cannot be used, and what to do.
    pub spoilt: Option<String>,
}

/// Puts the log's time into a column in seconds. `text` is the table, where the log is one in text.
///
/// # Errors
/// A rate that is none; an index of the rows in place of time.
pub(crate) fn clock(
    path: &Path,
    text: Option<&Text>,
    layout: &mut Layout,
    columns: &mut Vec<Vec<f64>>,
    header: &mut Vec<String>,
    rows: usize,
    map: &ColumnMap,
) -> Result<Clock> {
    let mut clock = Clock::default();
    if let Some(rate) = map.rate_hz {
        if !(rate.is_finite() && rate > 0.0) {
            return Err(Error::input(path, None, "rate_hz", format!("{rate} is no rate; give rows per second")));
        }
        columns.push((0..rows).map(|row| row as f64 / rate).collect());
        header.push("t".to_owned());
        layout.set_time(columns.len() - 1);
        clock.corrections.push(format!("rows are taken at {rate} Hz, the rate of the dataset"));
        return Ok(clock);
    }
    let column = layout.time();
    if let Some(nanoseconds) = layout.nanoseconds() {
        columns.push(unit::joined(&columns[column], &columns[nanoseconds]));
        header.push(header[column].clone());
        layout.set_time(columns.len() - 1);
        clock.corrections.push(format!("time is {} and {} together", header[column], header[nanoseconds]));
    } else {
        if let Some(text) = text.filter(|_| backward(&columns[column]) > 0.0) {
            clock.corrections.extend(zeros_lost(&text.cells(column), &mut columns[column]));
        }
        clock.corrections.extend(wrapped::undo(&mut columns[column]));
        if let Some(assumed) = unit::in_seconds(columns, layout, map.time_factor) {
            clock.may_count = assumed.may_count;
            clock.corrections.push(assumed.said);
        }
        if layout.time_is_index && columns[column].windows(2).all(|pair| pair[1] - pair[0] == 1.0) {
            let problem = "missing column: no column of time (t or time, in s), the first counts the rows; give the sampling rate \
                           in a dataset: rate_hz = 100 in [columns]";
            return Err(Error::input(path, text.map(|text| text.header_line), "t", problem));
        }
    }
    let positions: Vec<usize> = layout.positions().to_vec();
    let signals: Vec<&[f64]> = positions.iter().map(|&column| columns[column].as_slice()).collect();
    if let Some(spoilt) = of_two_sources(&signals).or_else(|| late_source::finding(&signals)) {
        clock.spoilt = Some(spoilt);
        return Ok(clock);
    }
    let used = layout.used();
    let time = layout.time();
    if let Some(spoilt) = standing(&columns[time]) {
        clock.spoilt = Some(spoilt);
        return Ok(clock);
    }
    let mut stamps = std::mem::take(&mut columns[time]);
    let signals: Vec<&[f64]> = positions.iter().map(|&column| columns[column].as_slice()).collect();
    let rows_were_lost = true_gaps::are_true(&stamps, &signals);
    clock.corrections.extend(if rows_were_lost { None } else { late::undo(&mut stamps) });
    clock.corrections.extend(set::undo(&mut stamps, &signals));
    if let Some((said, begins)) = restarts::undo(&mut stamps) {
        clock.corrections.push(said);
        clock.begins = begins;
    }
    columns[time] = stamps;
    clock.corrections.extend(if rows_were_lost { None } else { bursts(&mut columns[time]) });
    let same = |row: usize| used.iter().all(|&column| columns[column][row] == columns[column][row - 1]);
    let stamps = &columns[time];
    let repeated: Vec<usize> = (1..stamps.len()).filter(|&row| stamps[row] == stamps[row - 1]).collect();
    let others = repeated.iter().filter(|row| !same(**row)).count();
    if others as f64 > COARSE * stamps.len() as f64 && 2 * others > repeated.len() && backward(stamps) == 0.0 {
        let (spread, quantum) = spread(stamps);
        let rate = (spread.len() - 1) as f64 / (spread[spread.len() - 1] - spread[0]);
        clock.corrections.push(format!(
            "the clock is coarse (steps of {:.3} ms): {:.0} % of the rows have the stamp of the row before, though other values; \
             they are spread evenly, at {rate:.1} Hz; log a finer clock if you can",
            1e3 * quantum,
            100.0 * repeated.len() as f64 / stamps.len() as f64
        ));
        columns[time] = spread;
    }
    Ok(clock)
}

/// What is wrong with a time that is the same in all rows, and what to do.
fn standing(time: &[f64]) -> Option<String> {
    let first = *time.first()?;
    if time.len() < FEWEST || !time.iter().all(|t| *t == first) {
        return None;
    }
    // Neighbours of this number in single precision are so far apart.
    let step = f64::from(f32::EPSILON) * 2f64.powf(first.abs().max(1.0).log2().floor());
    let cause = match step > COARSEST_S && f64::from(first as f32) == first {
        true => format!(
            ": numbers of single precision are {step} s apart there; write time in double precision (float64), or subtract the first \
             time before it is converted"
        ),
        false => {
            "; log the time of each row, or give the rate of the rows in a dataset: [columns] rate_hz = 100".to_owned()
        }
    };
    Some(format!("the time is {first} s in every row{cause}"))
}

/// Rows that come in bursts, evenly sampled or not, are stamped as they arrived: they are spread evenly.
fn bursts(time: &mut Vec<f64>) -> Option<String> {
    let mut steps: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).collect();
    if steps.iter().any(|step| step.is_nan() || *step < 0.0) {
        return None;
    }
    steps.sort_by(f64::total_cmp);
    let usual = usual(&steps)?;
    let close = |step: f64| step > 0.0 && step < BURST * usual;
    let count = steps.iter().filter(|step| close(**step)).count();
    if (count as f64) < COARSE * time.len() as f64 {
        return None;
    }
    let mut stamps = time.clone();
    for row in 1..stamps.len() {
        let step = time[row] - time[row - 1];
        if step == 0.0 || close(step) {
            stamps[row] = stamps[row - 1];
        }
    }
    let (spread, _) = spread(&stamps);
    let rate = (spread.len() - 1) as f64 / (spread[spread.len() - 1] - spread[0]);
    *time = spread;
    Some(format!(
        "rows come in bursts: {:.0} % of them are stamped within {:.3} ms of the row before, as they arrived; they are spread evenly, at \
         {rate:.1} Hz; log the time of the measurement if you can",
        100.0 * count as f64 / time.len() as f64,
        1e3 * BURST * usual
    ))
}

/// The usual one of ascending steps; that between bursts, where nearly all rows come in these.
fn usual(steps: &[f64]) -> Option<f64> {
    let usual = *steps.get((USUAL * steps.len() as f64) as usize)?;
    let pauses = &steps[steps.partition_point(|step| *step < AT_ONCE_S)..];
    match pauses {
        [] => Some(usual),
        pauses if usual < AT_ONCE_S => Some(pauses[pauses.len() / 2]),
        _ => Some(usual),
    }
}

/// Share of steps that go back.
fn backward(time: &[f64]) -> f64 {
    time.windows(2).filter(|pair| pair[1] < pair[0]).count() as f64 / time.len().max(2) as f64
}

/// Stamps of which the second's fraction lost its leading zeros when it was put behind the point: 12.5000000 for 12 s and
/// 5000000 ns. They are corrected where time then increases.
fn zeros_lost(cells: &[String], time: &mut [f64]) -> Option<String> {
    let parts: Option<Vec<(&str, &str)>> = cells.iter().map(|cell| cell.split_once('.')).collect();
    let parts = parts.filter(|parts| parts.len() == time.len())?;
    let digits = parts.iter().map(|(_, fraction)| fraction.len()).max()?;
    let scale = 10f64.powi(-(i32::try_from(digits).ok()?));
    let value =
        |(whole, fraction): &(&str, &str)| Some(whole.parse::<f64>().ok()? + scale * fraction.parse::<f64>().ok()?);
    let whole: Vec<f64> = parts.iter().map(value).collect::<Option<_>>()?;
    if backward(&whole) > 0.0 {
        return None;
    }
    let example =
        cells.iter().find(|cell| cell.split_once('.').is_some_and(|(_, fraction)| fraction.len() < digits))?;
    time.copy_from_slice(&whole);
    Some(format!(
        "seconds and their fraction were joined without leading zeros ({example}): the digits behind the point are taken as a \
         number of {digits} digits; write them with zeros"
    ))
}

/// Rows that belong to two sources, as of two publishers on one topic.
fn of_two_sources(positions: &[&[f64]]) -> Option<String> {
    let path = |signal: &[f64], step: usize| -> f64 {
        (step..signal.len())
            .map(|row| (signal[row] - signal[row - step]).abs())
            .filter(|change| change.is_finite())
            .sum()
    };
    let alternates = |signal: &&&[f64]| {
        let (one, two) = (path(signal, 1), path(signal, 2));
        signal.len() >= FEWEST_OF_TWO && one > ALTERNATING * two && one > APART * signal.len() as f64
    };
    let visited = |signal: &&&[f64]| {
        let (low, high) =
            signal.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &v| (low.min(v), high.max(v)));
        let changes = signal.windows(2).map(|pair| (pair[1] - pair[0]).abs()).filter(|change| *change > 0.0);
        let mut changes: Vec<f64> = changes.collect();
        let digit = changes.iter().copied().fold(f64::INFINITY, f64::min);
        if signal.len() < FEWEST_OF_TWO || high - low <= DIGITS * digit {
            return false;
        }
        // Noise of a joint that stands, or hardly moves, alternates too: by its own usual change.
        let middle = changes.len() / 2;
        let usual = *changes.select_nth_unstable_by(middle, f64::total_cmp).1;
        let apart = |x: &[f64]| {
            let (to, from) = (x[1] - x[0], x[2] - x[1]);
            let least = to.abs().min(from.abs());
            to * from < 0.0
                && least > ALTERNATING * (x[2] - x[0]).abs()
                && least > FAR * (high - low)
                && least > ALTERNATING * usual
        };
        let count = signal.windows(3).filter(|x| apart(x)).count() as f64;
        count > OF_SLOWER * signal.len() as f64
    };
    positions.iter().any(|signal| alternates(&signal) || visited(&signal)).then(|| {
        "the rows alternate between two sources: two programs write the joints' states, as two publishers on one topic do; stop \
         one of them, or give it a topic of its own, and record again"
            .to_owned()
    })
}

/// Stamps of a coarse clock spread evenly, and the clock's step: on a line where rows come at even steps, else within each
/// group of one stamp.
fn spread(stamps: &[f64]) -> (Vec<f64>, f64) {
    let mut steps: Vec<f64> = stamps.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 0.0).collect();
    steps.sort_by(f64::total_cmp);
    let quantum = steps.get(steps.len() / 20).copied().unwrap_or(0.0);
    let usual = steps.get(steps.len() / 2).copied().unwrap_or(0.0);
    let mut out = Vec::with_capacity(stamps.len());
    for run in stamps.chunk_by(|a, b| b - a < GAP * usual) {
        let line = (run.len() >= FEWEST).then(|| on_a_line(run)).flatten();
        let fits = |line: &Vec<f64>| line.iter().zip(run).all(|(even, stamp)| (even - stamp).abs() < 1.5 * quantum);
        match line.filter(fits) {
            Some(line) => out.extend(line),
            None => {
                let groups: Vec<&[f64]> = run.chunk_by(|a, b| a == b).collect();
                for (index, group) in groups.iter().enumerate() {
                    let end = groups.get(index + 1).map_or(group[0] + quantum, |next| next[0]);
                    let width = end - group[0];
                    out.extend((0..group.len()).map(|row| group[0] + width * row as f64 / group.len() as f64));
                }
            }
        }
    }
    (out, quantum)
}

/// Times at even steps through stamps; None where they do not go on.
fn on_a_line(stamps: &[f64]) -> Option<Vec<f64>> {
    let since: Vec<(f64, f64)> =
        stamps.iter().enumerate().map(|(row, stamp)| (row as f64, stamp - stamps[0])).collect();
    let (start, step) = line(&since);
    (step > 0.0).then(|| since.iter().map(|(row, _)| stamps[0] + start + step * row).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_coarse_clock_is_spread_evenly() {
        let truth: Vec<f64> =
            (0..1000).map(|row| 0.004 * f64::from(row) + if row >= 600 { 0.5 } else { 0.0 }).collect();
        let stamps: Vec<f64> = truth.iter().map(|t| (t / 0.01 + 1e-9).floor() * 0.01).collect();
        let (spread, quantum) = spread(&stamps);
        assert!((quantum - 0.01).abs() < 1e-9, "{quantum}");
        for run in [0..600, 600..1000] {
            let late: Vec<f64> = run.clone().map(|row| spread[row] - truth[row]).collect();
            let (low, high) = late.iter().fold((1.0f64, -1.0f64), |(low, high), &v| (low.min(v), high.max(v)));
            assert!(high - low < 2e-4, "{low} {high}");
        }
        // Bursts at no even rate stay within their stamps.
        let uneven: Vec<f64> = (0..100).map(|row| 0.05 * f64::from((row * row / 120) / 2)).collect();
        let (spread, _) = super::spread(&uneven);
        assert!(spread.windows(2).all(|pair| pair[1] > pair[0]));
    }

    #[test]
    fn a_time_that_stands_is_no_time() {
        let single = vec![f64::from(1_764_321_152.0_f32); 50];
        assert!(standing(&single).is_some_and(|text| text.contains("single precision are 128 s apart")));
        assert!(standing(&[0.1; 50]).is_some_and(|text| text.contains("rate_hz")));
        let moving: Vec<f64> = (0..50).map(|row| f64::from(row / 10)).collect();
        assert!(standing(&moving).is_none() && standing(&[1.0; FEWEST - 1]).is_none());
    }

    /// Pairs of rows at 100 Hz, the second of each just behind the first.
    #[test]
    fn bursts_are_spread_evenly() {
        let pairs = |apart: f64| -> Vec<f64> {
            (0..400).map(|row| 0.02 * f64::from(row / 2) + if row % 2 == 1 { apart } else { 0.0 }).collect()
        };
        for apart in [1e-5, 1e-4, 1e-3] {
            let mut time = pairs(apart);
            assert!(bursts(&mut time).unwrap().contains("100.0 Hz"), "{apart}");
            assert!(time.windows(2).all(|pair| ((pair[1] - pair[0]) - 0.01).abs() < 1e-4));
        }
        // Twenty rows within a few us, and then a pause.
        let late = |row: u32| 0.04 * f64::from(row / 20) + 2e-7 * f64::from(row % 20);
        let mut time: Vec<f64> = (0..4000).map(late).collect();
        assert!(bursts(&mut time).unwrap().contains("500.0 Hz"));
        assert!(time.windows(2).all(|pair| ((pair[1] - pair[0]) - 0.002).abs() < 1e-5));
        // An uneven clock is none of bursts, and neither is one with a pair or two.
        let mut uneven = pairs(0.004);
        assert!(bursts(&mut uneven).is_none() && uneven == pairs(0.004));
        let mut even: Vec<f64> = (0..400).map(|row| 0.01 * f64::from(row)).collect();
        even[7] = even[6] + 1e-5;
        assert!(bursts(&mut even).is_none());
    }

    /// White noise of an encoder on a joint that stands, or drifts by little; and a slower source of other positions among the rows.
    #[test]
    fn noise_of_a_joint_at_rest_is_no_second_source() {
        let mut source = crate::random::stream(3, "noise", 0);
        let noise: Vec<f64> = (0..4000).map(|_| rand::RngExt::random_range(&mut source, -2e-4..2e-4)).collect();
        for drift in [0.0, 1e-6, 1e-5] {
            let still: Vec<f64> = noise.iter().enumerate().map(|(row, v)| v + drift * row as f64).collect();
            assert!(of_two_sources(&[&still]).is_none(), "{drift}");
        }
        let moving: Vec<f64> = (0..4000).map(|row| (0.005 * f64::from(row)).sin()).collect();
        let mixed: Vec<f64> = moving.iter().enumerate().map(|(row, q)| if row % 7 == 3 { 0.4 } else { *q }).collect();
        assert!(of_two_sources(&[&noise, &moving]).is_none() && of_two_sources(&[&noise, &mixed]).is_some());
    }

    #[test]
    fn lost_zeros_are_found() {
        let cells: Vec<String> = (0..40).map(|row| format!("12.{}", 4_000_000 * row)).collect();
        let mut time: Vec<f64> = cells.iter().map(|cell| cell.parse().unwrap()).collect();
        assert!(zeros_lost(&cells, &mut time).unwrap().contains("9 digits"));
        assert!(time.iter().enumerate().all(|(row, t)| (t - 12.0 - 0.004 * row as f64).abs() < 1e-9), "{time:?}");
        let good: Vec<String> = (0..40).map(|row| format!("12.{:09}", 4_000_000 * ((row * 7) % 40))).collect();
        assert_eq!(zeros_lost(&good, &mut time), None);
    }

    #[test]
    fn two_sources_alternate() {
        let moving: Vec<f64> = (0..200).map(|row| (0.05 * f64::from(row)).sin()).collect();
        let resting = vec![0.2; 200];
        let mixed: Vec<f64> = (0..200).map(|row| if row % 2 == 0 { moving[row] } else { resting[row] }).collect();
        assert!(of_two_sources(&[&moving, &mixed]).unwrap().contains("two publishers"));
        let noise: Vec<f64> = (0..200).map(|row| if row % 2 == 0 { 1e-5 } else { -1e-5 }).collect();
        assert_eq!(of_two_sources(&[&moving, &resting, &noise]), None);
        // One of the two at a quarter of the rate of the other.
        let visited: Vec<f64> = (0..200).map(|row| if row % 5 == 4 { 0.2 } else { moving[row] }).collect();
        assert!(of_two_sources(&[&visited, &resting]).is_some());
        let spikes: Vec<f64> = (0..200).map(|row| if row % 50 == 4 { 2.0 } else { moving[row] }).collect();
        let trembling: Vec<f64> = (0..200).map(|row| f64::from(i32::from(row % 3 == 0))).collect();
        assert_eq!(of_two_sources(&[&spikes, &trembling]), None);
    }
}
