//! Clocks that were set while a log was written: time jumps, and the motion goes on as if nothing were.
//!
//! A pause or lost rows change the positions, another recording begins elsewhere. So time is put right only where joints surely move on
//! both sides of the jump, and each goes on at its speed.

use crate::signal::{changes, size_quantile};

/// A step this many times longer than the usual one is a jump; one that goes back is always.
const LONG: f64 = 4.0;

/// More jumps are another fault of the clock.
const MOST: usize = 5;

/// Rows that are in order before and behind a jump: single rows out of time are stamped wrongly.
const IN_ORDER: usize = 20;

/// Share of a jump by which the times behind it may come back within as many rows.
const STAYS: f64 = 0.5;

/// A signal surely moves where its steps on both sides are more than this share of its fast ones (that which nineteen of twenty do not
/// exceed), in one direction ..
const MOVES: f64 = 0.2;
const FAST: f64 = 0.95;

/// .. and goes on where the step at the jump differs from their mean by less than this share of it.
const GOES_ON: f64 = 0.5;

/// Joints that must move at a jump ahead: one alone may come back to its place and speed after a pause.
const SEVERAL: usize = 2;

/// Takes jumps out of times in seconds over which all positions go on; returns what was done.
pub(super) fn undo(time: &mut [f64], positions: &[&[f64]]) -> Option<String> {
    let steps: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).collect();
    if steps.iter().any(|step| !step.is_finite()) {
        return None;
    }
    let usual = size_quantile(steps.iter().copied().filter(|step| *step > 0.0), 0.5);
    let jumps: Vec<usize> = (0..steps.len()).filter(|&step| steps[step] < 0.0 || steps[step] > LONG * usual).collect();
    let fast: Vec<f64> = positions.iter().map(|signal| size_quantile(changes(signal), FAST)).collect();
    let alone = |&jump: &usize| {
        let around = jump.saturating_sub(IN_ORDER)..(jump + IN_ORDER + 1).min(steps.len());
        around.len() > IN_ORDER && around.into_iter().all(|step| step == jump || !jumps.contains(&step))
    };
    let goes_on = |&jump: &usize| {
        let moving = positions.iter().zip(&fast).filter_map(|(signal, fast)| continues(signal, jump, *fast));
        let moving: Vec<bool> = moving.collect();
        let enough = if steps[jump] < 0.0 || positions.len() == 1 { 1 } else { SEVERAL };
        moving.len() >= enough && moving.into_iter().all(|goes_on| goes_on)
    };
    // The stamp of a single row is followed by those of the others.
    let stays = |&jump: &usize| {
        let last = (jump + 1 + IN_ORDER).min(time.len() - 1);
        let late = time[last] - time[jump + 1] - usual * (last - jump - 1) as f64;
        late.abs() < STAYS * (steps[jump] - usual).abs()
    };
    let set: Vec<usize> = jumps.iter().copied().filter(|jump| alone(jump) && stays(jump) && goes_on(jump)).collect();
    if set.is_empty() || set.len() > MOST {
        return None;
    }
    let said = |&jump: &usize| {
        let by = steps[jump] - usual;
        let to = if by < 0.0 { "steps back" } else { "jumps ahead" };
        format!("{to} by {:.3} s after {:.3} s (row {})", by.abs(), time[jump], jump + 1)
    };
    let said = set.iter().map(said).collect::<Vec<_>>().join(", and ");
    for jump in set {
        let by = steps[jump] - usual;
        time[jump + 1..].iter_mut().for_each(|t| *t -= by);
    }
    Some(format!(
        "the clock {said}, while the motion goes on as if it had not: undone; a clock that is set while a log is written does that, so log one \
         that only counts"
    ))
}

/// Whether a signal that moves on both sides of a step goes on over it; none where it does not surely move.
fn continues(signal: &[f64], step: usize, fast: f64) -> Option<bool> {
    let change = |at: usize| Some(signal.get(at + 1)? - signal.get(at)?);
    let (before, own, behind) = (change(step.checked_sub(1)?)?, change(step)?, change(step + 1)?);
    let moves = before * behind > 0.0 && before.abs().min(behind.abs()) > MOVES * fast;
    let mean = 0.5 * (before + behind);
    moves.then(|| (own - mean).abs() < GOES_ON * mean.abs())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two joints that move, at 100 Hz, and their times with a jump.
    fn log(by: f64, at: usize) -> (Vec<f64>, [Vec<f64>; 2]) {
        let t = |row: usize| 0.01 * row as f64;
        let time = (0..1000).map(|row| t(row) + if row >= at { by } else { 0.0 }).collect();
        let joint = |rate: f64| (0..1000).map(|row| (rate * t(row) + 0.3).sin()).collect();
        (time, [joint(1.3), joint(1.9)])
    }

    #[test]
    fn a_clock_that_was_set_goes_on() {
        for by in [-0.5, -4.0, 0.7, 3600.0] {
            let (mut time, q) = log(by, 430);
            let said = undo(&mut time, &[&q[0], &q[1]]).unwrap();
            assert!(said.contains(if by < 0.0 { "steps back" } else { "jumps ahead" }), "{said}");
            assert!(time.iter().enumerate().all(|(row, t)| (t - 0.01 * row as f64).abs() < 1e-9), "{by}");
        }
    }

    #[test]
    fn pauses_lost_rows_and_other_recordings_stay() {
        let stays = |mut time: Vec<f64>, q: &[Vec<f64>; 2]| {
            let before = time.clone();
            assert_eq!(undo(&mut time, &[&q[0], &q[1]]), None);
            assert_eq!(time, before);
        };
        let (time, q) = log(0.0, 0);
        stays(time.clone(), &q);
        // Rows that were lost, and another recording: the positions are elsewhere.
        let cut = |signal: &[f64]| [&signal[..400], &signal[450..]].concat();
        stays(cut(&time), &[cut(&q[0]), cut(&q[1])]);
        let again: Vec<f64> = time[..500].iter().chain(&time[..500]).copied().collect();
        stays(again, &q.clone().map(|signal| [&signal[500..], &signal[..500]].concat()));
        // Nobody moves at the jump, and one row out of time.
        let (jumped, _) = log(0.7, 430);
        stays(jumped, &[vec![0.1; 1000], vec![0.2; 1000]]);
        let mut single = time;
        single[300] = single[297] + 1e-3;
        stays(single, &q);
    }
}
