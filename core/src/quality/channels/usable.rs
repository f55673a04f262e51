//! The part of a log that can be used: what is no measurement is left out, and the clock is even.

use super::clipped::{clipping, is_saturated};
use super::jumps::{self, Jumps};
use super::leave_out_unmeasured;
use crate::error::Result;
use crate::quality::view::View;
use crate::recording::{Recording, resample};

/// Time on either side of a clipped sample that is left out with it, s: noise hides there how much was cut off.
const AROUND_CLIPPED_S: f64 = 0.04;

/// Said of a log of which nothing is left.
pub(crate) const NO_PIECE: &str = "the clock is so full of gaps that no piece of the log is left, since 50 rows without a long gap make one: log it \
                                   without gaps (a queue or a real-time priority for the logger, fewer topics, a local disk)";

/// The part of a log that can be used.
pub(crate) struct Usable {
    /// The pieces between long gaps and places at which all positions jump, at even steps; torque that must not be used is not a number there.
    pub pieces: Vec<Recording>,
    /// Samples of every joint's torque that are left out since it is cut off at a limit there.
    pub clipped: Vec<usize>,
}

/// Leaves out of a log what is no measurement, torque that is cut off at a limit too, and cuts it into pieces at even steps.
///
/// # Errors
/// Those of the filters: the log is too short.
pub(crate) fn usable(mut recording: Recording) -> Result<Usable> {
    leave_out_unmeasured(&mut recording)?;
    let levels: Vec<Vec<f64>> = recording.tau.iter().map(clipping_levels).collect();
    let mut clipped = vec![0; levels.len()];
    let mut pieces = Vec::new();
    for part in parts(recording)? {
        pieces.extend(resample::pieces(part));
    }
    for piece in &mut pieces {
        let around = (AROUND_CLIPPED_S * piece.rate_hz()).round() as usize;
        for (joint, levels) in levels.iter().enumerate() {
            clipped[joint] += leave_out(piece.tau.channel_mut(joint), levels, around);
        }
    }
    let all: usize = pieces.iter().map(Recording::samples).sum();
    for joint in (0..levels.len()).filter(|&joint| is_saturated(clipped[joint], all)) {
        pieces.iter_mut().for_each(|piece| piece.tau.channel_mut(joint).fill(f64::NAN));
    }
    Ok(Usable { pieces, clipped })
}

/// The parts of a log between the places at which all positions jump: a filter would make accelerations of a jump that no joint has.
fn parts(mut recording: Recording) -> Result<Vec<Recording>> {
    resample::from_its_start(&mut recording);
    let mut ends = match jumps::any(&recording) {
        true => Jumps::of(&View::new(&recording, None)?).cuts(),
        false => Vec::new(),
    };
    if ends.is_empty() {
        return Ok(vec![recording]);
    }
    ends.push(recording.samples());
    let starts = [0].into_iter().chain(ends.iter().copied());
    Ok(starts.zip(&ends).map(|(start, &end)| recording.slice(start..end)).collect())
}

/// Levels at which a torque is cut off, on both sides where both extremes are the same size.
fn clipping_levels(tau: &[f64]) -> Vec<f64> {
    let mut levels: Vec<f64> = clipping(tau).into_iter().map(|(level, ..)| level).collect();
    if let [level] = levels[..]
        && tau.contains(&-level)
    {
        levels.push(-level);
    }
    levels
}

/// Torques at a level, and samples around them, become not a number; returns how many are at a level.
fn leave_out(tau: &mut [f64], levels: &[f64], around: usize) -> usize {
    let at: Vec<usize> = (0..tau.len())
        .filter(|&k| levels.iter().any(|level| (tau[k] - level) * level.signum() >= -1e-9 * level.abs()))
        .collect();
    for &k in &at {
        let end = (k + around + 1).min(tau.len());
        tau[k.saturating_sub(around)..end].fill(f64::NAN);
    }
    at.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_torque_that_is_nearly_always_at_its_limits_is_left_out() {
        let left = |limit: f64| {
            let wave = |k: i32| 5.0 * (0.05 * f64::from(k)).sin();
            let vector = |of: &dyn Fn(i32) -> f64| (0..4000).map(of).collect::<Vec<f64>>();
            let recording = Recording {
                joints: vec!["a".to_owned()],
                time: vector(&|k| 0.01 * f64::from(k)),
                q: crate::channels::Channels::from_vectors(&[vector(&wave)]),
                tau: crate::channels::Channels::from_vectors(&[vector(&|k| wave(k + 20).clamp(-limit, limit))]),
                ..Recording::default()
            };
            let usable = usable(recording).unwrap();
            usable.pieces.iter().any(|piece| piece.tau.channel(0).iter().any(|torque| torque.is_finite()))
        };
        // At the limits in 50 % and in 97 % of the samples.
        assert_eq!([left(3.5), left(0.25)], [true, false]);
    }

    #[test]
    fn recordings_that_were_joined_are_parted() {
        let wave = |k: usize, joint: usize| {
            let start = if k < 700 { 0.0 } else { 3.0 };
            (0.05 * k as f64 + start + joint as f64).sin()
        };
        let table = || {
            let channel = |joint: usize| (0..1500).map(|k| wave(k, joint)).collect();
            crate::channels::Channels::from_vectors(&[0, 1].map(channel))
        };
        let log = Recording {
            joints: vec!["a".to_owned(), "b".to_owned()],
            // A clock that counts from 1970 begins with the log, and goes on in the second part.
            time: (0..1500).map(|k| 1.7e9 + 0.01 * f64::from(k)).collect(),
            q: table(),
            tau: table(),
            ..Recording::default()
        };
        let pieces = usable(log).unwrap().pieces;
        assert_eq!(pieces.iter().map(Recording::samples).collect::<Vec<_>>(), [700, 800]);
        assert!((pieces[1].time[0] - 7.0).abs() < 1e-6);
    }

    #[test]
    fn clipped_samples_and_their_neighbours_are_left_out() {
        let mut tau: Vec<f64> = (0..400).map(|k| (5.0 * (0.05 * f64::from(k)).sin()).clamp(-3.0, 9.0)).collect();
        let levels = clipping_levels(&tau);
        assert_eq!(levels, [-3.0]);
        let cut_off = tau.iter().filter(|v| **v == -3.0).count();
        assert_eq!(leave_out(&mut tau, &levels, 2), cut_off);
        let first = tau.iter().position(|v| v.is_nan()).unwrap();
        let at = |k: usize| 5.0 * (0.05 * k as f64).sin();
        assert!(at(first + 1) > -3.0 && at(first + 2) <= -3.0);
        assert!(tau.iter().filter(|v| !v.is_nan()).all(|v| *v > -3.0));
    }
}
