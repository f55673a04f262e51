//! Logs in a fit, and blocks of their rows.

use std::ops::Range;

/// The rows of each log, which rows without a time separate.
pub(super) fn log_rows(times: &[f64]) -> Vec<Range<usize>> {
    let mut logs: Vec<Range<usize>> = Vec::new();
    for row in (0..times.len()).filter(|&row| times[row].is_finite()) {
        match logs.last_mut().filter(|log| log.end == row) {
            Some(log) => log.end = row + 1,
            None => logs.push(row..row + 1),
        }
    }
    logs
}

/// The rows of a log in so many blocks.
pub(super) fn blocks_of(rows: &Range<usize>, count: usize) -> impl Iterator<Item = Range<usize>> {
    let bound = |block: usize| rows.start + rows.len() * block / count;
    let bounds: Vec<usize> = (0..=count).map(bound).collect();
    (0..count).map(move |block| bounds[block]..bounds[block + 1]).filter(|block| !block.is_empty())
}
