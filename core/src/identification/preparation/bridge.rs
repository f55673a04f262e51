//! Torque across samples at which it was not measured.

use crate::channels::Channels;
use std::borrow::Cow;
use std::ops::Range;

/// The torque with its missing samples (not a number) on straight lines, so that filters pass over them, and where these are, by channel. A
/// channel without any value stays as it is.
pub(super) fn bridged(torque: &Channels) -> (Cow<'_, Channels>, Vec<Vec<Range<usize>>>) {
    let missing: Vec<Vec<Range<usize>>> = torque.iter().map(missing).collect();
    if missing.iter().all(Vec::is_empty) {
        return (Cow::Borrowed(torque), missing);
    }
    let mut whole = torque.clone();
    for (joint, gaps) in missing.iter().enumerate() {
        let channel = whole.channel_mut(joint);
        gaps.iter().for_each(|gap| bridge(channel, gap));
    }
    (Cow::Owned(whole), missing)
}

/// Runs of samples that are no number, if there are others.
fn missing(channel: &[f64]) -> Vec<Range<usize>> {
    if channel.iter().all(|value| value.is_nan()) {
        return Vec::new();
    }
    let runs = channel.chunk_by(|a, b| a.is_nan() == b.is_nan()).scan(0, |start, run| {
        let own = *start;
        *start += run.len();
        Some((own..*start, run[0].is_nan()))
    });
    runs.filter(|(_, is_missing)| *is_missing).map(|(samples, _)| samples).collect()
}

/// A line between the values on both sides; at an end of the log the value on the one side.
fn bridge(channel: &mut [f64], gap: &Range<usize>) {
    let before = gap.start.checked_sub(1).map(|at| channel[at]);
    let behind = channel.get(gap.end).copied();
    let (Some(from), Some(to)) = (before.or(behind), behind.or(before)) else { return };
    let steps = (gap.len() + 1) as f64;
    for (step, value) in channel[gap.clone()].iter_mut().enumerate() {
        *value = from + (to - from) * (step + 1) as f64 / steps;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaps_are_bridged_by_lines_and_a_channel_without_values_is_not() {
        let none = f64::NAN;
        let torque = Channels::from_vectors(&[
            vec![none, 1.0, none, none, 4.0, none],
            vec![none; 6],
            vec![0.0, 1.0, 2.0, 3.0, 4.0, 5.0],
        ]);
        let (whole, missing) = bridged(&torque);
        assert_eq!(whole.channel(0), [1.0, 1.0, 2.0, 3.0, 4.0, 4.0]);
        assert!(whole.channel(1).iter().all(|value| value.is_nan()));
        assert_eq!(missing, [vec![0..1, 2..4, 5..6], vec![], vec![]]);
        let all = Channels::from_vectors(&[vec![0.0, 1.0]]);
        assert!(matches!(bridged(&all).0, Cow::Borrowed(_)));
    }
}
