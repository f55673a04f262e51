//! Digits of a channel: its smallest change, its extremes, and runs of equal values.

use crate::signal::{change_sizes, quantum};

/// Whether a channel has so few digits that most of its changes are by the last one: it then rests between them, and at
/// its extremes, without anything being wrong.
pub(super) fn coarse(values: &[f64]) -> bool {
    quantum(values).is_some() || change_sizes(values).next().is_none()
}

/// The smallest change of a channel.
pub(in crate::quality) fn resolution(values: &[f64]) -> f64 {
    change_sizes(values).fold(f64::INFINITY, f64::min)
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
