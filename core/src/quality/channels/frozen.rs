//! Positions and torques that stand still for a while although the joint moves on.

use super::digits::{extremes, runs};
use super::motor_off::{FROZEN_S, PATH, path};
use crate::quality::finding::{Finding, Kind, Severity};
use crate::quality::view::View;
use crate::signal::{changes, noise_floor, size_quantile};
use std::ops::Range;

/// Number of runs of equal samples in a log that chance brings, up to which a torque that has one is frozen there.
const BY_CHANCE: f64 = 1e-3;

/// Speed up to the last sample before that which no joint loses within a sample, rad/s or m/s.
const STOPS_DEAD: f64 = 0.2;

/// Samples within which the torque of a motor that is switched off has gone.
const FALLS_IN: usize = 3;

/// A joint whose logged speed is below this share of its usual speed may stick: velocities have a last digit and an offset of
/// their own, which add up to a path where nothing moves.
const STICKS: f64 = 0.1;

/// Standard deviations of a velocity's noise above which it is one.
const SURELY: f64 = 3.0;

/// A position that stands so long, s, between two motions without slowing down before or speeding up behind is frozen. Joints that stick
/// stand for less.
const STANDS_S: f64 = 0.5;

/// Time over which the speeds before and behind are taken, s; two samples at least.
const SPEED_S: f64 = 0.01;

/// No joint brakes or accelerates by more, rad/s2 or m/s2: a speed that is lost or gained within a sample is larger on one side, ..
const HARDEST: f64 = 100.0;

/// .. and larger than this on the other, rad/s or m/s.
const SLOWEST: f64 = 0.05;

/// A joint that brakes or accelerates evenly has a third of the speed next to standstill: a speed is unchanged to within this factor.
const UNCHANGED: f64 = 1.4;

/// Parts in which the position of a joint stands although the joint moves on: start and length.
pub(super) fn positions<'a>(view: &'a View, joint: usize) -> impl Iterator<Item = (usize, usize)> + 'a {
    let q = view.log.q.channel(joint);
    let shortest = ((0.02 / view.period) as usize).max(5);
    let typical = size_quantile(changes(q), 0.99);
    let velocity = view.log.qd.as_ref().filter(|_| view.log.has_velocity(joint)).map(|qd| qd.channel(joint));
    let fastest = velocity.map_or(0.0, |qd| size_quantile(qd.iter().copied(), 0.95));
    let tau = view.log.tau.channel(joint);
    // One that stands all along hardly moves, as far as the log shows.
    runs(q).filter(move |(_, length)| (shortest..q.len()).contains(length)).filter(move |&(start, length)| {
        let end = start + length;
        let makes_up = end < q.len() && (q[end] - q[end - 1]).abs() > (4.0 * typical).max(1e-3);
        let runs_on = velocity.is_some_and(|qd| {
            // The first samples of a joint that stops may still have the speed of before.
            let speed = size_quantile(qd[start..end].iter().copied(), 0.5);
            let moves = speed > STICKS * fastest && speed * length as f64 * view.period > PATH;
            // A joint that waits for its turn has the noise of its velocity alone.
            moves && speed > SURELY * noise_floor(qd)
        });
        // A joint that is moving does not stand from one sample to the next; one that comes to rest slows down first.
        let speed = |step: usize| (q[start] - q[start.saturating_sub(step)]).abs() / (step as f64 * view.period);
        // A motor that is switched off lets its brake fall in.
        let is_off =
            || tau.iter().any(|v| *v != 0.0) && tau[(start + FALLS_IN).min(end)..end].iter().all(|v| *v == 0.0);
        let seconds = length as f64 * view.period;
        let stops_dead = end == q.len() && seconds > FROZEN_S && speed(2).min(speed(4)) > STOPS_DEAD && !is_off();
        makes_up
            || runs_on
            || stops_dead
            || (seconds > STANDS_S && stands_dead(q, start..end, view.period) && !is_off())
    })
}

/// Whether a position stands between two motions that neither slow down before nor speed up behind.
fn stands_dead(q: &[f64], part: Range<usize>, period: f64) -> bool {
    let step = ((SPEED_S / period).round() as usize).max(2);
    // Of three samples, next to standstill first: the speed where it is the same over both steps.
    let unchanged = |near: usize, middle: usize, far: usize| {
        let [own, other] = [(near, middle), (middle, far)].map(|(a, b)| (q[b] - q[a]).abs() / (step as f64 * period));
        (own < UNCHANGED * other && other < UNCHANGED * own).then_some(own)
    };
    let before = part.start.checked_sub(2 * step).and_then(|far| unchanged(part.start, part.start - step, far));
    let behind = Some(part.end + 2 * step).filter(|far| *far < q.len());
    let behind = behind.and_then(|far| unchanged(part.end, part.end + step, far));
    before.zip(behind).is_some_and(|(a, b)| a.min(b) > SLOWEST && a.max(b) > HARDEST * period)
}

/// Share of a log from which a position that stands although the joint moves on leaves too little.
const MOST: f64 = 0.5;

/// Samples at which the position of a joint stands although it moves on: the motion of the whole arm is not known there.
pub(in crate::quality) fn rows(view: &View) -> Vec<bool> {
    let mut out = vec![false; view.log.samples()];
    for joint in 0..view.dof() {
        // The first sample is a measurement.
        positions(view, joint).for_each(|(start, length)| out[start + 1..start + length].fill(true));
    }
    out
}

/// The finding on a position that stands although the joint moves on.
pub(super) fn position(view: &View, joint: usize) -> Option<Finding> {
    let parts: Vec<(usize, usize)> = positions(view, joint).collect();
    let how_long = how_long(view, &parts)?;
    let (severity, what) = match lasts(&parts) as f64 > MOST * view.log.samples() as f64 {
        true => {
            (Severity::Fatal, "too little of the log is left; log this position, or leave the joint out (--joints)")
        }
        false => (Severity::Warning, "these rows are left out"),
    };
    let text = format!("the position is frozen for {how_long} while the joint moves on; {what}");
    Some(Finding::new(Kind::Frozen, severity, place(view, "q", joint, &parts), text))
}

/// The finding on a torque that stands although the joint moves.
pub(super) fn torque(view: &View, joint: usize) -> Option<Finding> {
    let parts: Vec<(usize, usize)> = torques(view, joint).collect();
    let how_long = how_long(view, &parts)?;
    let text = format!("the torque is frozen for {how_long} while the joint moves; these samples are left out");
    Some(Finding::new(Kind::Frozen, Severity::Warning, place(view, "tau", joint, &parts), text))
}

fn lasts(parts: &[(usize, usize)]) -> usize {
    parts.iter().map(|(_, length)| length).sum()
}

fn how_long(view: &View, parts: &[(usize, usize)]) -> Option<String> {
    let seconds = |length: usize| format!("{:.3} s", length as f64 * view.period);
    match parts {
        [] => None,
        [(_, length)] => Some(seconds(*length)),
        [(_, length), more @ ..] => {
            Some(format!("{} and {} times more, {} together,", seconds(*length), more.len(), seconds(lasts(parts))))
        }
    }
}

fn place(view: &View, quantity: &str, joint: usize, parts: &[(usize, usize)]) -> String {
    let first = parts.first().map_or(0, |(start, _)| *start);
    format!("{} from {:.4} s", view.place(quantity, joint), view.log.time[first])
}

/// Joints whose position is frozen for a while, as found.
pub(in crate::quality) fn with_frozen_position(view: &View, found: &[Finding]) -> Vec<usize> {
    let of = |joint: &usize| {
        let place = view.place("q", *joint);
        found.iter().any(|finding| finding.kind == Kind::Frozen && finding.place.starts_with(&place))
    };
    (0..view.dof()).filter(of).collect()
}

/// Parts in which a torque stands while its joint moves: start and length.
pub(super) fn torques<'a>(view: &'a View, joint: usize) -> impl Iterator<Item = (usize, usize)> + 'a {
    let tau = view.log.tau.channel(joint);
    let shortest = ((FROZEN_S / view.period) as usize).max(10);
    let (low, high) = extremes(tau);
    let repeated: usize = runs(tau).filter(|(_, length)| *length < shortest).map(|(_, length)| length - 1).sum();
    let repeats = repeated as f64 / tau.len().max(1) as f64;
    runs(tau).filter(move |&(start, length)| {
        let moved = || path(&view.q.channel(joint)[start..start + length]) > PATH;
        let long = length >= shortest && !is_by_chance(length, repeats, tau.len());
        long && ![low, high, 0.0].contains(&tau[start]) && moved()
    })
}

/// Whether a torque of few digits, a share of whose samples `repeats` the one before, has a run of so many samples by chance.
fn is_by_chance(length: usize, repeats: f64, samples: usize) -> bool {
    samples as f64 * repeats.powf((length - 1) as f64) > BY_CHANCE
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn torques_of_few_digits_repeat_themselves() {
        // Of 4000 samples half of which repeat the one before, 3.9 runs of 11 are by chance, and 9e-4 of 23; of noise with all its digits,
        // none.
        assert!(is_by_chance(11, 0.5, 4000) && is_by_chance(22, 0.5, 4000) && !is_by_chance(23, 0.5, 4000));
        assert!(!is_by_chance(11, 0.0, 4000));
    }

    /// A position that moves at one speed up to sample 200, stands, and goes on at another from sample 400 on, at 200 samples a second;
    /// `ramp` samples take it to rest and away from it.
    fn stands([before, behind]: [f64; 2], ramp: f64) -> bool {
        let period = 0.005;
        let speed = |sample: f64| match sample {
            at if at < 200.0 => before * ((200.0 - at) / ramp).min(1.0),
            at if at < 400.0 => 0.0,
            at => behind * ((at - 399.0) / ramp).min(1.0),
        };
        let step = |q: &mut f64, sample: u16| {
            let own = *q;
            *q += period * speed(f64::from(sample));
            Some(own)
        };
        let q: Vec<f64> = (0..600).scan(0.3, step).collect();
        stands_dead(&q, 200..401, period)
    }

    #[test]
    fn a_position_is_frozen_between_motions_that_do_not_slow_down() {
        assert!(stands([1.0, -1.0], 1.0) && stands([1.0, 0.06], 1.0) && stands([0.06, 1.0], 1.0));
        // Below 0.05 rad/s on one side, and with 0.5 rad/s = 100 rad/s2 x 5 ms on none.
        assert!(!stands([1.0, 0.04], 1.0) && !stands([0.04, 1.0], 1.0));
        assert!(stands([0.51, 0.4], 1.0) && !stands([0.49, 0.4], 1.0));
        // One that slows down over four samples, or over many.
        assert!(!stands([1.0, 1.0], 4.0) && !stands([3.0, 3.0], 40.0));
    }
}
