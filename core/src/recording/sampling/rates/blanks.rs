//! Rows of two sources, with blanks where one of them has no value.

use super::super::unit::joined;
use super::rows::{FEWEST, keep};
use crate::recording::columns::{ABSENT, Layout};
use crate::recording::sampling::interpolation::interpolate;

/// A column that lacks a smaller share of the rows has gaps, and no rate of its own.
const BLANK: f64 = 0.05;

/// Columns whose blanks differ in a smaller share of their rows are of one source.
const ALIKE: f64 = 0.05;

/// Blanks of a source of a slower rate come in runs of no more than this many of its mean steps, most of them.
const LONGEST_RUN: f64 = 4.0;
const IN_SHORT_RUNS: f64 = 0.8;

/// Values are not brought across longer gaps than this many median steps of their own.
const BRIDGED: f64 = 4.0;

/// Keeps the rows of the slower of positions and torques where rows have blanks, and brings the other signals to their times.
/// Nothing is done where the blanks are gaps. Returns what was done.
pub(crate) fn without_blanks(layout: &Layout, columns: &mut [Vec<f64>], lines: &mut Vec<usize>) -> Option<String> {
    let count = lines.len();
    let held: Vec<usize> = columns.iter().map(|values| values.iter().filter(|v| v.is_finite()).count()).collect();
    let of = |table: &[usize]| -> Vec<usize> {
        table.iter().copied().filter(|&column| column != ABSENT && held[column] >= FEWEST).collect()
    };
    let (positions, torques) = (of(layout.positions()), of(layout.torques()));
    // Before the first value of the one and behind the last of the other nothing was recorded: these rows are no blanks.
    let signals = || positions.iter().chain(&torques).copied();
    let first = signals().filter_map(|column| columns[column].iter().position(|v| v.is_finite())).max()?;
    let last = signals().filter_map(|column| columns[column].iter().rposition(|v| v.is_finite())).min()?;
    let shared = first..last.max(first);
    let blank = |column: usize| {
        let missing = columns[column][shared.clone()].iter().filter(|value| !value.is_finite()).count();
        missing as f64 > BLANK * shared.len() as f64
    };
    if !signals().any(blank) {
        return None;
    }
    let of_positions = majority(columns, &positions)?;
    let of_torques = majority(columns, &torques).filter(|&torque| !alike(columns, torque, of_positions));
    if of_torques.is_none() && !torques.is_empty() && majority(columns, &torques).is_none() {
        return None;
    }
    let slower = of_torques.filter(|&torque| held[torque] <= held[of_positions]);
    let base = slower.unwrap_or(of_positions);
    let kept: Vec<usize> = (0..count).filter(|&row| columns[base][row].is_finite()).collect();
    if !at_a_rate(&kept) {
        return None;
    }
    let time = clock(layout, columns, count);
    for column in positions.iter().chain(&torques).copied().chain(layout.derivatives()).collect::<Vec<_>>() {
        let missing = kept.iter().filter(|&&row| !columns[column][row].is_finite()).count() as f64;
        if missing > BLANK * kept.len() as f64 {
            columns[column] = brought(&time, &columns[column], &kept);
        }
    }
    let note = match of_torques {
        Some(torque) => format!(
            "of {count} rows {} hold positions and {} torques: they come from two sources at rates of their own; the log is taken \
             at the rows of the {}, and the other signals are brought to their times; log both in one loop if you can",
            held[of_positions],
            held[torque],
            if slower.is_some() { "torques" } else { "positions" }
        ),
        None if kept.len() < count => format!(
            "{} of {count} rows hold nothing of these joints: they are those of another source, and are left out",
            count - kept.len()
        ),
        None => return None,
    };
    keep(&kept, columns, lines);
    Some(note)
}

/// A column of the source to which more than half of the columns belong: those whose blanks are in the same rows.
fn majority(columns: &[Vec<f64>], of: &[usize]) -> Option<usize> {
    let members = |&&column: &&usize| of.iter().filter(|&&other| alike(columns, column, other)).count();
    of.iter().find(|column| 2 * members(column) > of.len()).copied()
}

/// Whether two columns have their blanks in the same rows, but for a few.
fn alike(columns: &[Vec<f64>], a: usize, b: usize) -> bool {
    let (mut either, mut one) = (0, 0);
    for (x, y) in columns[a].iter().zip(&columns[b]) {
        either += usize::from(x.is_finite() || y.is_finite());
        one += usize::from(x.is_finite() != y.is_finite());
    }
    one as f64 <= ALIKE * either as f64
}

/// Whether rows are those of a source with a rate, and not what gaps leave.
fn at_a_rate(rows: &[usize]) -> bool {
    let (Some(first), Some(last)) = (rows.first(), rows.last()) else { return false };
    let mean = (last - first) as f64 / (rows.len().max(2) - 1) as f64;
    let (mut all, mut short) = (0, 0);
    for pair in rows.windows(2) {
        let blanks = pair[1] - pair[0] - 1;
        all += blanks;
        short += if (blanks as f64) <= LONGEST_RUN * mean { blanks } else { 0 };
    }
    rows.len() >= FEWEST && short as f64 >= IN_SHORT_RUNS * all as f64
}

/// Time of every row in any unit, for bringing signals to the times of others.
fn clock(layout: &Layout, columns: &[Vec<f64>], count: usize) -> Vec<f64> {
    match (layout.time(), layout.nanoseconds()) {
        (ABSENT, _) => (0..count).map(|row| row as f64).collect(),
        (seconds, None) => columns[seconds].clone(),
        (seconds, Some(nanoseconds)) => joined(&columns[seconds], &columns[nanoseconds]),
    }
}

/// A signal with the values that it lacks at the rows `kept`, from those before and behind.
fn brought(time: &[f64], values: &[f64], kept: &[usize]) -> Vec<f64> {
    let mut points: Vec<(f64, f64)> =
        time.iter().copied().zip(values.iter().copied()).filter(|(t, v)| t.is_finite() && v.is_finite()).collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    points.dedup_by(|a, b| a.0 == b.0);
    let (times, values_there): (Vec<f64>, Vec<f64>) = points.into_iter().unzip();
    let mut steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    steps.sort_by(f64::total_cmp);
    let longest = BRIDGED * steps.get(steps.len() / 2).copied().unwrap_or(0.0);
    let mut out = values.to_vec();
    for &row in kept.iter().filter(|&&row| !values[row].is_finite()) {
        let next = times.partition_point(|&t| t <= time[row]);
        if next > 0 && next < times.len() && times[next] - times[next - 1] <= longest {
            out[row] = interpolate(&times, &values_there, next - 1, time[row], longest);
        }
    }
    out
}
