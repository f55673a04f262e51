//! Torques that are cut off at a level.

use super::digits::{coarse, extremes, resolution, runs};
use crate::quality::finding::{Finding, Kind, Severity};
use crate::quality::view::View;

/// Consecutive samples at one extreme value, and samples there in all, that make a channel clipped.
const RUN: usize = 4;
const FEWEST: usize = 12;

/// A torque whose range has fewer digits than this shows no noise while its joint rests.
const FEW_DIGITS: f64 = 1000.0;

/// Samples at the extreme over those that are one digit from it, above which it is a limit: a torque of few digits that has its peak
/// there is at its last digit two to three times as often as at the one before.
const TURNS_ROUND: usize = 5;

/// Share of a torque that stands at its limits from which on the rest shows nothing of the arm: it is the way from one limit to the other
/// where the motion reverses, and too short for a fit.
const SATURATED: f64 = 0.9;

/// Whether a torque that stands at its limits in so many samples of all is no measurement.
pub fn is_saturated(at_limits: usize, all: usize) -> bool {
    at_limits as f64 > SATURATED * all as f64
}

/// Levels at which a torque is cut off, each with the number of samples there and the first of them; none for a torque of
/// few digits.
pub fn clipping(tau: &[f64]) -> Vec<(f64, usize, usize)> {
    if coarse(tau) {
        return Vec::new();
    }
    let (low, high) = extremes(tau);
    let at = |level: f64| {
        let (count, first) = runs_at(tau, level)
            .fold((0, 0), |(count, first), (start, length)| (count + length, if count == 0 { start } else { first }));
        (level, count, first)
    };
    let digit = 1.5 * resolution(tau);
    let is_limit = |&(level, count, _): &(f64, usize, usize)| {
        let near = tau.iter().filter(|value| **value != level && (**value - level).abs() < digit).count();
        count >= FEWEST && count > TURNS_ROUND * near
    };
    // A sensor that never reads zero does not rest at its extreme unless it is cut off there.
    let levels = if low == high { vec![] } else { vec![low, high] };
    levels.into_iter().filter(|level| *level != 0.0).map(at).filter(is_limit).collect()
}

/// Runs of a torque at a level at which it is cut off: start and length.
pub(super) fn runs_at(tau: &[f64], level: f64) -> impl Iterator<Item = (usize, usize)> {
    runs(tau).filter(move |&(start, length)| tau[start] == level && length >= RUN)
}

pub(super) fn clipped(view: &View, joint: usize, tau: &[f64]) -> Option<Finding> {
    // A torque without noise rests where the arm does, at its extreme too; one of few digits does where its own joint rests.
    let (low, high) = extremes(tau);
    let few_digits = high - low < FEW_DIGITS * resolution(tau);
    let moves = |sample: usize| {
        let of = |own: usize| view.qd.channel(own)[sample].abs() > view.band[own];
        if few_digits { of(joint) } else { (0..view.dof()).any(of) }
    };
    // A torque of few digits also stands at others, to which something without digits may have been added.
    let stands: usize = runs(tau)
        .filter(|&(start, length)| length >= RUN && tau[start] != low && tau[start] != high && moves(start))
        .map(|(_, length)| length)
        .sum();
    let is_cut_off = |&(level, count, _): &(f64, usize, usize)| {
        count > stands && 2 * (0..tau.len()).filter(|&sample| tau[sample] == level && moves(sample)).count() >= count
    };
    let levels: Vec<(f64, usize, usize)> = clipping(tau).into_iter().filter(is_cut_off).collect();
    let first = levels.iter().map(|(.., first)| *first).min()?;
    let count: usize = levels.iter().map(|(_, count, _)| count).sum();
    let share = 100.0 * count as f64 / tau.len() as f64;
    let at = levels.iter().map(|(level, ..)| level.to_string()).collect::<Vec<_>>().join(" or ");
    let text = match is_saturated(count, tau.len()) {
        true => format!(
            "{share:.1} % of the samples stand at {at}: the drive or its log is at a limit in nearly all of the log, or the torque was not \
             measured; its motion is used, its equation is not"
        ),
        false => format!(
            "{count} samples ({share:.1} %) stand at {at}: the drive or its log is at a limit there; `identify` and `diagnose` \
             leave these samples out, and a slower motion has none"
        ),
    };
    let place = format!("{} from {:.4} s", view.place("tau", joint), view.log.time[first]);
    Some(Finding::new(Kind::Clipped, Severity::Warning, place, text))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wave(size: f64) -> Vec<f64> {
        (0..4000).map(|row| size * (0.01 * f64::from(row)).sin() + 0.3 * (0.37 * f64::from(row)).sin()).collect()
    }

    #[test]
    fn a_torque_of_few_digits_to_which_a_drift_was_added_is_not_cut_off() {
        let row = |row: usize| 0.005 * row as f64;
        // The joint moves in every second part of the log, its neighbour in the others.
        let part = |row: usize| row / 500;
        let moves = |joint: usize| move |row: usize| part(row) % 2 == joint;
        let q = |joint: usize| (0..6000).map(|k| if moves(joint)(k) { (3.0 * row(k)).sin() } else { 0.2 }).collect();
        let few = |k: usize| {
            (5.0 * (0.9 * part(k) as f64).sin()).round() + if moves(0)(k) { 0.3 * (3.0 * row(k)).cos() } else { 0.0 }
        };
        let cut = |k: usize| (5.0 * (3.0 * row(k)).cos() + 0.1 * (37.0 * row(k)).sin()).min(4.0);
        let finding = |torque: &dyn Fn(usize) -> f64| {
            let tau: Vec<f64> = (0..6000).map(torque).collect();
            let log = crate::recording::Recording {
                joints: vec!["a".into(), "b".into()],
                time: (0..6000).map(row).collect(),
                q: crate::channels::Channels::from_vectors(&[q(0), q(1)]),
                tau: crate::channels::Channels::from_vectors(&[tau.clone(), tau.clone()]),
                ..Default::default()
            };
            clipped(&View::new(&log, None).unwrap(), 0, &tau).map(|finding| finding.kind)
        };
        assert_eq!([finding(&few), finding(&cut)], [None, Some(Kind::Clipped)]);
    }

    #[test]
    fn a_torque_of_few_digits_that_turns_round_is_not_cut_off() {
        let cut: Vec<f64> = wave(5.0).iter().map(|torque| torque.min(4.0)).collect();
        assert_eq!(clipping(&cut).iter().map(|level| level.0).collect::<Vec<_>>(), [4.0]);
        let slow: Vec<f64> = (0..4000).map(|row| 5.0 * (0.01 * f64::from(row)).sin()).collect();
        for digit in [0.01, 0.1, 0.4] {
            let few: Vec<f64> = slow.iter().map(|torque| (torque / digit).round() * digit).collect();
            assert_eq!(clipping(&few), [], "{digit}");
        }
        // Cut off in few digits.
        let few: Vec<f64> = wave(5.0).iter().map(|torque| (torque.min(4.0) / 0.02).round() * 0.02).collect();
        assert_eq!(clipping(&few).len(), 1);
    }
}
