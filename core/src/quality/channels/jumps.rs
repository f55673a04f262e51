//! Positions that jump and go on from there: the zero of an encoder that slipped, or rows that are missing though the clock goes on.
//!
//! Before and behind a jump a joint has the same speed, and between two samples it goes much further than it ever does. One joint by itself
//! slipped; where most of those that move jump at once, time is missing.

use super::digits::resolution;
use crate::quality::finding::{Finding, Kind, Severity};
use crate::quality::view::View;
use crate::recording::Recording;
use crate::signal::size_quantile;
use std::f64::consts::PI;

/// A step stands out from the mean of its neighbours by so many times what steps usually do (all but one in a hundred) ..
const STANDS_OUT: f64 = 20.0;
const USUAL: f64 = 0.99;

/// .. by this many times the longest usual step, ..
const LONGER: f64 = 1.2;

/// .. by so many of the position's last digit, and by more than this, rad or m: less is play and calibration.
const DIGITS: f64 = 20.0;
const LEAST: f64 = 3e-3;

/// The steps before and behind differ by less than this share of the jump: a spike comes back, and what is hit goes on faster.
const ALIKE: f64 = 0.3;

/// Half turns are another fault, within this share.
const OF_HALF_TURN: f64 = 0.05;

/// So many equal samples before a jump are a position that was frozen, and makes up for it.
const FROZEN: usize = 5;

/// More jumps are no accidents.
const MOST: usize = 20;

/// Places at which positions jump.
#[derive(Debug, Default)]
pub(crate) struct Jumps {
    /// Joint, sample before the jump, and its size.
    slips: Vec<(usize, usize, f64)>,
    /// Samples behind which rows are missing.
    lost: Vec<usize>,
}

impl Jumps {
    pub(crate) fn of(view: &View) -> Jumps {
        let moves = |joint: &usize| view.band[*joint].is_finite();
        let moving: Vec<usize> = (0..view.dof()).filter(moves).collect();
        let of_joint =
            |&joint: &usize| jumps(view.log.q.channel(joint)).into_iter().map(move |(at, by)| (joint, at, by));
        let all: Vec<(usize, usize, f64)> = moving.iter().flat_map(of_joint).collect();
        let together = |at: usize| all.iter().filter(|jump| jump.1 == at).count();
        let is_lost = |at: usize| together(at) > 1 && 2 * together(at) >= moving.len();
        let mut lost: Vec<usize> = all.iter().map(|jump| jump.1).filter(|&at| is_lost(at)).collect();
        lost.sort_unstable();
        lost.dedup();
        let slips = all.into_iter().filter(|jump| !lost.contains(&jump.1)).collect();
        Jumps { slips, lost }
    }

    pub(crate) fn findings(&self, view: &View) -> Vec<Finding> {
        let mut out = Vec::new();
        for joint in 0..view.dof() {
            let own: Vec<_> = self.slips.iter().filter(|slip| slip.0 == joint).collect();
            let Some(&&(_, at, by)) = own.first() else { continue };
            let more = if own.len() > 1 { format!(" (and {} times more)", own.len() - 1) } else { String::new() };
            let text = format!(
                "the position jumps by {by:.4} between two samples and goes on from there{more}: the encoder slipped or was set anew; its zero is \
                 another from then on, so use the parts before and behind as logs of their own"
            );
            let place = format!("{} at {:.4} s", view.place("q", joint), view.log.time[at]);
            out.push(Finding::new(Kind::PositionJump, Severity::Warning, place, text));
        }
        if let Some(&first) = self.lost.first() {
            let count = self.lost.len();
            let text = format!(
                "{}all positions jump at once, at {count} place{}, though the clock goes on: rows are missing there, recordings were joined, or \
                 the clock was set back and what it repeated is left out; the log is cut there. Log the time of the measurement",
                if count == 1 { "" } else { "again and again " },
                if count == 1 { "" } else { "s" }
            );
            let place = format!("rows at {:.4} s", view.log.time[first]);
            out.push(Finding::new(Kind::LostRows, Severity::Warning, place, text));
        }
        out
    }

    /// The first samples behind the places at which all positions jump: no motion crosses them.
    pub(crate) fn cuts(&self) -> Vec<usize> {
        self.lost.iter().map(|at| at + 1).collect()
    }

    /// The longest part of a log without a jump; none where there is no jump.
    pub(crate) fn longest_without(&self, log: &Recording) -> Option<Recording> {
        let mut ends: Vec<usize> =
            self.slips.iter().map(|slip| slip.1 + 1).chain(self.lost.iter().map(|at| at + 1)).collect();
        if ends.is_empty() {
            return None;
        }
        ends.extend([0, log.samples()]);
        ends.sort_unstable();
        let longest = ends.windows(2).max_by_key(|ends| ends[1] - ends[0])?;
        Some(log.slice(longest[0]..longest[1]))
    }
}

/// Whether some position of a log jumps.
pub(crate) fn any(log: &Recording) -> bool {
    log.q.iter().any(|q| !jumps(q).is_empty())
}

/// Samples behind which a position jumps, each with the size of the jump; none where it does again and again.
fn jumps(q: &[f64]) -> Vec<(usize, f64)> {
    let steps: Vec<f64> = q.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let excess = |x: &[f64]| x[1] - 0.5 * (x[0] + x[2]);
    let digit = resolution(q);
    let usual = size_quantile(steps.windows(3).map(excess), USUAL);
    let longest = size_quantile(steps.iter().copied(), USUAL);
    let least = (STANDS_OUT * usual).max(LONGER * longest).max(DIGITS * digit).max(LEAST);
    let is_frozen = |at: usize| at + 1 >= FROZEN && q[at + 1 - FROZEN..=at].iter().all(|value| *value == q[at]);
    let is_jump = |(at, x): &(usize, &[f64])| {
        let by = excess(x).abs();
        let turns = by / PI;
        let of_turns = turns.round() > 0.0 && (turns - turns.round()).abs() < OF_HALF_TURN;
        by > least && (x[2] - x[0]).abs() < ALIKE * by && !of_turns && !(is_frozen(at + 1) && x[2] != 0.0)
    };
    let found = steps.windows(3).enumerate().filter(is_jump).map(|(at, x)| (at + 1, excess(x)));
    let found: Vec<(usize, f64)> = found.collect();
    if found.len() > MOST { Vec::new() } else { found }
}

#[cfg(test)]
mod tests {
    use super::jumps;

    fn moving() -> Vec<f64> {
        (0..1000).map(|row| (0.01 * f64::from(row)).sin()).collect()
    }

    #[test]
    fn a_position_that_goes_on_elsewhere_jumps() {
        let by = |size: f64| {
            let mut q = moving();
            q[400..].iter_mut().for_each(|q| *q += size);
            jumps(&q)
        };
        for size in [0.02, -0.3, 1.0] {
            let [(at, found)] = by(size)[..] else { panic!("{size}: {:?}", by(size)) };
            assert!(at == 399 && (found - size).abs() < 1e-4, "{at} {found}");
        }
        // No further than the joint moves, and turns that were wrapped.
        assert_eq!([by(0.01), by(std::f64::consts::PI), by(-std::f64::consts::TAU)], [const { Vec::new() }; 3]);
    }

    #[test]
    fn spikes_stops_held_and_frozen_positions_do_not_jump() {
        let mut spike = moving();
        spike[400] += 0.5;
        let mut frozen = moving();
        let from = frozen[400];
        frozen[400..450].fill(from);
        let held: Vec<f64> = (0..1000).map(|row| (0.01 * f64::from(row / 8 * 8)).sin()).collect();
        let stops: Vec<f64> = (0..1000).map(|row| 0.02 * f64::from(row.clamp(300, 500))).collect();
        let coarse: Vec<f64> = moving().iter().map(|q| (q / 0.05).round() * 0.05).collect();
        for q in [spike, frozen, held, stops, coarse] {
            assert_eq!(jumps(&q), []);
        }
    }
}
