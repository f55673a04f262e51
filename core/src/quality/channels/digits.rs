//! Digits of a channel: its smallest change, its extremes, and runs of equal values.

use crate::signal::{changes, size_quantile};

/// A channel most of whose changes are smaller than this many of its last digit is coarse.
const COARSE: f64 = 3.5;

/// Whether a channel has so few digits that most of its changes are by the last one: it then rests between them, and at
/// its extremes, without anything being wrong.
pub(super) fn coarse(values: &[f64]) -> bool {
    size_quantile(sizes(values), 0.5) < COARSE * resolution(values)
}

/// The smallest change of a channel.
pub(in crate::quality) fn resolution(values: &[f64]) -> f64 {
    sizes(values).fold(f64::INFINITY, f64::min)
}

/// Sizes of the changes of a channel from one sample to the next, where there are any.
fn sizes(values: &[f64]) -> impl Iterator<Item = f64> {
    changes(values).map(f64::abs).filter(|change| *change > 0.0)
}

/// Runs of equal values: start and length.
pub(in crate::quality) fn runs(values: &[f64]) -> impl Iterator<Item = (usize, usize)> {
    values.chunk_by(|a, b| a == b).scan(0, |start, run| {
        let own = *start;
        *start += run.len();
        Some((own, run.len()))
    })
}

/// The smallest and the largest value.
pub(in crate::quality) fn extremes(values: &[f64]) -> (f64, f64) {
    values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &v| (low.min(v), high.max(v)))
}
