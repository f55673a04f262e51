//! Rows in no order of time, as several threads or a table without an order write them.

use super::unit::joined;
use crate::recording::columns::{ABSENT, Layout};

/// Share of the steps of time that go back, from which on rows are in no order: a clock that is set, or several recordings one behind
/// another, go back a few times.
const BACKWARD: f64 = 0.1;

/// Fewer rows show no order.
const FEWEST: usize = 100;

/// In their order positions go no more than this share of the way that they go from row to row as they stand.
const SHORTER: f64 = 0.5;

/// Sorts rows by their times with their `lines` in the file, where these go forth and back and positions go a shorter way in the order of
/// time; returns what was done.
pub(crate) fn sort(layout: &Layout, columns: &mut [Vec<f64>], lines: &mut [usize]) -> Option<String> {
    if layout.time() == ABSENT || lines.len() < FEWEST {
        return None;
    }
    let time = match layout.nanoseconds() {
        Some(parts) => joined(&columns[layout.time()], &columns[parts]),
        None => columns[layout.time()].clone(),
    };
    let back = time.windows(2).filter(|pair| pair[1] < pair[0]).count();
    if (back as f64) < BACKWARD * time.len() as f64 || time.iter().any(|time| !time.is_finite()) {
        return None;
    }
    let mut order: Vec<usize> = (0..time.len()).collect();
    order.sort_by(|&a, &b| time[a].total_cmp(&time[b]));
    let way = |order: &mut dyn Iterator<Item = usize>| {
        let rows: Vec<usize> = order.collect();
        let of = |q: &Vec<f64>| {
            rows.windows(2).map(|pair| (q[pair[1]] - q[pair[0]]).abs()).filter(|step| step.is_finite()).sum::<f64>()
        };
        layout.positions().iter().filter(|column| **column != ABSENT).map(|&column| of(&columns[column])).sum::<f64>()
    };
    let [as_written, in_order] = [way(&mut (0..time.len())), way(&mut order.iter().copied())];
    if in_order > SHORTER * as_written {
        return None;
    }
    for column in columns.iter_mut().filter(|column| !column.is_empty()) {
        *column = order.iter().map(|&row| column[row]).collect();
    }
    let sorted: Vec<usize> = order.iter().map(|&row| lines[row]).collect();
    lines.copy_from_slice(&sorted);
    Some(format!("time goes back in {back} of {} rows: the rows are in no order, and are sorted by time", lines.len()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sorted(place: impl Fn(usize) -> usize, clock: impl Fn(usize) -> f64) -> Option<Vec<usize>> {
        let header: Vec<String> = ["t", "q1", "tau1"].map(str::to_owned).to_vec();
        let layout = Layout::find("log.csv".as_ref(), None, &header, None).unwrap();
        let q = |row: usize| (0.02 * row as f64).sin();
        let of = |value: &dyn Fn(usize) -> f64| (0..500).map(|row| value(place(row))).collect::<Vec<f64>>();
        let mut columns = vec![of(&|row| clock(row)), of(&q), of(&q)];
        let mut lines: Vec<usize> = (2..502).collect();
        sort(&layout, &mut columns, &mut lines).map(|_| lines)
    }

    #[test]
    fn rows_in_no_order_are_sorted() {
        // Each row once, in steps of 183 round the table.
        let scattered = |row: usize| row * 183 % 500;
        let lines = sorted(scattered, |row| 0.01 * row as f64).unwrap();
        assert!(lines.iter().enumerate().all(|(place, line)| scattered(line - 2) == place));
        // In order, and two recordings one behind the other.
        assert_eq!(sorted(|row| row, |row| 0.01 * row as f64), None);
        assert_eq!(sorted(|row| row, |row| 0.01 * (row % 250) as f64), None);
        // A clock that goes forth and back while the motion goes on.
        assert_eq!(sorted(|row| row, |row| 0.01 * (row * 183 % 500) as f64), None);
    }
}
