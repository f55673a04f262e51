//! What a diagnosis is given: training, held-out and reference logs.

use crate::effects::Placed;
use crate::recording::Recording;
use std::ops::Range;

/// Share of a log that is held out where no other is held out.
const HELD_OUT: f64 = 0.3;

/// Least and largest share of a joint's path in the parts that are held out: beyond these, one of the two sets has no information on it.
const LEAST_PATH: f64 = 0.02;
const LARGEST_PATH: f64 = 0.9;

/// Share of a joint's path that is aimed at where windows are chosen one by one, and the largest that they may have; their length, s, which
/// is longer than the filters remember, and the largest share of all windows.
const WANTED_PATH: f64 = 0.2;
const LARGEST_WANTED: f64 = 0.6;
const WINDOW_S: f64 = 4.0;
const LARGEST_SHARE: f64 = 0.5;

/// Time over which a joint's path is measured, s: shorter steps measure the noise of its encoder.
const STEP_S: f64 = 0.2;

/// What a diagnosis is given.
#[derive(Debug, Clone, Default)]
pub struct Input<'a> {
    /// Logs to find from.
    pub train: Vec<&'a Recording>,
    /// Held-out logs of other motions; a part of every training log where there are none.
    pub test: Vec<&'a Recording>,
    /// Logs from before a change: the question is then what changed since.
    pub reference: Vec<&'a Recording>,
    /// Effects that the simulation has already.
    pub present: Vec<Placed>,
}

/// Every log cut in two: its first and its last part. Where a joint moves in one of these only, as in a log in which joints move one after
/// the other, windows of a few seconds are held out in which joints move of which the least is held out.
pub(crate) fn split(logs: &[&Recording]) -> (Vec<Recording>, Vec<Recording>) {
    let last = |log: &&Recording| {
        let end = ((1.0 - HELD_OUT) * log.samples() as f64) as usize;
        vec![(0..end, false), (end..log.samples(), true)]
    };
    let last: Vec<Parts> = logs.iter().map(last).collect();
    let joints = logs.first().map_or(0, |log| log.joints());
    let paths = |parts: &[Parts]| -> Vec<[f64; 2]> {
        let along = |joint: usize, held: bool| -> f64 {
            of_parts(logs, parts, held).map(|(log, rows)| path(log, rows, joint)).sum()
        };
        (0..joints).map(|joint| [along(joint, false), along(joint, true)]).collect()
    };
    let in_both = |parts: &[Parts]| {
        let is_in_both = |[early, late]: &[f64; 2]| {
            let all = early + late;
            all == 0.0 || (LEAST_PATH * all..=LARGEST_PATH * all).contains(late)
        };
        paths(parts).iter().filter(|paths| is_in_both(paths)).count()
    };
    let parts = match in_both(&last) {
        all if all == joints => last,
        some => Some(windows(logs)).filter(|parts| in_both(parts) > some).unwrap_or(last),
    };
    let cut = |held: bool| of_parts(logs, &parts, held).map(|(log, rows)| log.slice(rows.clone())).collect();
    (cut(false), cut(true))
}

/// Parts of a log, and whether each is held out.
type Parts = Vec<(Range<usize>, bool)>;

/// The parts of all logs that are held out, or the others: the log of each, and its rows.
fn of_parts<'a>(
    logs: &'a [&Recording],
    parts: &'a [Parts],
    held: bool,
) -> impl Iterator<Item = (&'a Recording, &'a Range<usize>)> {
    let all = logs.iter().zip(parts).flat_map(|(log, parts)| parts.iter().map(move |part| (*log, part)));
    all.filter(move |(_, part)| part.1 == held).map(|(log, (rows, _))| (log, rows))
}

/// The way of a joint over some rows.
fn path(log: &Recording, rows: &Range<usize>, joint: usize) -> f64 {
    let step = ((STEP_S * log.rate_hz()) as usize).max(1);
    let places: Vec<f64> = log.q.channel(joint)[rows.clone()].iter().step_by(step).copied().collect();
    places.windows(2).map(|pair| (pair[1] - pair[0]).abs()).sum()
}

/// Windows of all logs, held out one after the other: the one in which the joint goes farthest of whose path the least is held out yet.
fn windows(logs: &[&Recording]) -> Vec<Parts> {
    let of_log = |(index, log): (usize, &&Recording)| -> Vec<(usize, Range<usize>)> {
        let count = ((log.duration() / WINDOW_S) as usize).max(1);
        let bound = |window: usize| window * log.samples() / count;
        (0..count).map(|window| (index, bound(window)..bound(window + 1))).collect()
    };
    let all: Vec<(usize, Range<usize>)> = logs.iter().enumerate().flat_map(of_log).collect();
    let joints = logs.first().map_or(0, |log| log.joints());
    let shares: Vec<Vec<f64>> = (0..joints)
        .map(|joint| {
            let paths: Vec<f64> = all.iter().map(|(log, rows)| path(logs[*log], rows, joint)).collect();
            let whole: f64 = paths.iter().sum();
            paths.into_iter().map(|path| if whole > 0.0 { path / whole } else { 0.0 }).collect()
        })
        .collect();
    let mut held = vec![false; all.len()];
    let of = |joint: usize, held: &[bool]| -> f64 {
        shares[joint].iter().zip(held).filter(|(_, held)| **held).map(|(share, _)| share).sum()
    };
    while (held.iter().filter(|held| **held).count() as f64) < LARGEST_SHARE * all.len() as f64 {
        let moving = (0..joints).filter(|&joint| shares[joint].iter().any(|share| *share > 0.0));
        let least = moving.min_by(|&a, &b| of(a, &held).total_cmp(&of(b, &held)));
        let Some(joint) = least.filter(|&joint| of(joint, &held) < WANTED_PATH) else { break };
        let free = (0..all.len()).filter(|&window| !held[window]);
        // No window that would leave too little to identify a joint from.
        let leaves_enough =
            |window: &usize| (0..joints).all(|joint| of(joint, &held) + shares[joint][*window] <= LARGEST_WANTED);
        let next = free.filter(leaves_enough).max_by(|&a, &b| shares[joint][a].total_cmp(&shares[joint][b]));
        let Some(next) = next.filter(|&window| shares[joint][window] > 0.0) else { break };
        held[next] = true;
    }
    let mut parts: Vec<Parts> = vec![Vec::new(); logs.len()];
    for ((log, rows), held) in all.into_iter().zip(held) {
        match parts[log].last_mut().filter(|part| part.1 == held) {
            Some((own, _)) => own.end = rows.end,
            None => parts[log].push((rows, held)),
        }
    }
    parts
}

/// The logs as a diagnosis uses them: corrected, cut at long gaps, at even steps; torque that must not be used is not a
/// number.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::diagnosis::Diagnosis;
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Ignored)?;
/// # let log = |name: &str| recording::load(format!("../tests/reference/pendulum/{name}.csv"), None);
/// # let (train, test) = (log("train")?, log("test")?);
///
/// // Without held-out logs, parts of the training logs are held out.
/// let answer = Diagnosis::of(&robot).train([&train]).candidates(["torque_ripple"]).run()?;
/// let held_out: f64 = answer.logs.held_out().iter().map(|log| log.duration()).sum();
/// assert!(answer.logs.test.is_empty() && held_out > 1.0 && held_out < train.duration());
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct CleanLogs {
    /// Logs to identify from.
    pub train: Vec<Recording>,
    /// Held-out logs that were given.
    pub test: Vec<Recording>,
    /// Logs from before a change.
    pub reference: Vec<Recording>,
}

impl CleanLogs {
    /// The held-out logs: those given, else parts of every training log.
    pub fn held_out(&self) -> Vec<Recording> {
        if self.test.is_empty() { split(&self.train.iter().collect::<Vec<_>>()).1 } else { self.test.clone() }
    }

    /// All logs: training, test, reference.
    pub fn all(&self) -> impl Iterator<Item = &Recording> {
        self.train.iter().chain(&self.test).chain(&self.reference)
    }

    /// What a diagnosis is given where the simulation has the effects `present` already.
    pub fn input(&self, present: Vec<Placed>) -> Input<'_> {
        let [train, test, reference] = [&self.train, &self.test, &self.reference].map(|logs| logs.iter().collect());
        Input { train, test, reference, present }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::channels::Channels;

    /// A log of 40 s at 100 Hz in which each joint moves within its times only.
    fn moving(times: &[(f64, f64)]) -> Recording {
        let time: Vec<f64> = (0..4000).map(|k| k as f64 / 100.0).collect();
        let place = |from: f64, to: f64| time.iter().map(|&t| (2.0 * (t.clamp(from, to) - from)).sin()).collect();
        let q = Channels::from_vectors(&times.iter().map(|&(from, to)| place(from, to)).collect::<Vec<Vec<f64>>>());
        let names = (0..times.len()).map(|joint| format!("joint_{joint}")).collect();
        Recording { joints: names, tau: q.clone(), q, qd: None, time, ..Recording::default() }
    }

    #[test]
    fn the_last_part_is_held_out() {
        let log = moving(&[(0.0, 40.0), (10.0, 35.0)]);
        let (early, late) = split(&[&log]);
        assert_eq!((early.len(), early[0].samples(), late[0].samples()), (1, 2800, 1200));
    }

    #[test]
    fn joints_that_move_in_turns_are_in_both_parts() {
        let log = moving(&[(0.0, 20.0), (20.0, 33.0), (33.0, 40.0)]);
        let (early, late) = split(&[&log]);
        let along = |logs: &[Recording], joint: usize| -> f64 {
            logs.iter().map(|log| path(log, &(0..log.samples()), joint)).sum()
        };
        for joint in 0..3 {
            let [early, late] = [&early, &late].map(|logs| along(logs, joint));
            assert!(late > 0.15 * (early + late) && late < 0.6 * (early + late), "{joint}: {early} {late}");
        }
        assert_eq!(early.iter().chain(&late).map(Recording::samples).sum::<usize>(), 4000);
    }

    #[test]
    fn a_motion_too_short_to_be_in_both_is_left_as_it_is() {
        let log = moving(&[(0.0, 40.0), (1.0, 1.5)]);
        assert_eq!(split(&[&log]).0.len(), 1);
    }
}
