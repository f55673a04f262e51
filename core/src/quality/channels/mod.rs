//! Faults of single channels: frozen, held, clipped, spikes, jumps of a whole turn.

use super::finding::{Finding, Kind, Severity};
use super::view::View;
use crate::channels::Channels;
use crate::error::Result;
use crate::recording::Recording;
use crate::signal::{changes, size_quantile};
use std::f64::consts::{PI, TAU};
use std::ops::Range;

mod clipped;
mod digits;
mod frozen;
mod jumps;
mod motor_off;
mod usable;

use clipped::clipped;
pub use clipped::{clipping, is_saturated};
use digits::coarse;
pub(super) use digits::{extremes, resolution, runs};
pub(super) use frozen::{rows as frozen_rows, with_frozen_position};
pub(super) use jumps::Jumps;
use motor_off::{motor_off, off};
pub(crate) use usable::{NO_PIECE, Usable, usable};

/// No joint is faster, rad/s: a sample that is left and reached faster is a spike.
const FASTEST: f64 = 50.0;

/// A torque that differs from both neighbours by so many times its usual change (that which nine of ten do not exceed) stands out; of a
/// share of all samples that do, more is another fault.
const STANDS_OUT: f64 = 20.0;
const USUAL_CHANGE: f64 = 0.9;
const FEW: f64 = 0.02;

/// Samples to either side within which an impact shows in other torques, and how far these go and come back over their usual change.
const RINGS: usize = 3;
const STRUCK: f64 = 5.0;

/// Fewer rows of a log are not worth keeping.
const LEAST_ROWS: usize = 50;

/// Leaves out what is no measurement: rows in which a position is frozen, and torques that are frozen, of motors that are switched off,
/// and spikes, which become not a number.
///
/// # Errors
/// Those of the filters: the log is too short.
pub(super) fn leave_out_unmeasured(recording: &mut Recording) -> Result<()> {
    let mut known = recording.clone();
    let without: Vec<usize> = (0..known.joints()).filter(|&joint| !known.has_torque(joint)).collect();
    without.into_iter().for_each(|joint| known.tau.channel_mut(joint).fill(0.0));
    let (view, rate) = (View::new(&known, None)?, recording.rate_hz());
    let parts = |joint: usize| {
        let (q, tau) = (known.q.channel(joint), known.tau.channel(joint));
        let frozen = frozen::torques(&view, joint).filter(|_| !coarse(tau) && held(&view, joint, tau).is_none());
        let spikes = torque_spikes(&recording.tau, joint).into_iter().map(|at| at..at + 1);
        let frozen = frozen.map(|(start, length)| start..start + length);
        motor_off(q, tau, rate).into_iter().chain(frozen).chain(spikes).collect::<Vec<Range<usize>>>()
    };
    let parts: Vec<Vec<Range<usize>>> = (0..recording.joints()).map(parts).collect();
    let frozen = frozen_rows(&view);
    for (joint, parts) in parts.into_iter().enumerate() {
        parts.into_iter().for_each(|samples| recording.tau.channel_mut(joint)[samples].fill(f64::NAN));
    }
    let left = frozen.iter().filter(|frozen| !**frozen).count();
    if (LEAST_ROWS..recording.samples()).contains(&left) {
        *recording = recording.without_rows(&frozen);
    }
    Ok(())
}

/// Findings about the channels of every joint; `logged` is the log as it was, with joints that have no torque, and with the
/// digits that even steps do not keep.
pub(super) fn findings(view: &View, logged: &Recording) -> Vec<Finding> {
    let mut out = Vec::new();
    for joint in 0..view.dof() {
        let (q, tau, own) = (view.log.q.channel(joint), view.log.tau.channel(joint), logged.tau.channel(joint));
        out.extend(wrapped(view, joint, q));
        out.extend(spike(view, joint, q));
        out.extend(frozen::position(view, joint));
        if !logged.has_torque(joint) {
            let text = "there is no torque of this joint in the log: its motion is used, its equation is not";
            out.push(Finding::new(Kind::NoTorque, Severity::Warning, view.place("tau", joint), text));
            continue;
        }
        if tau.iter().all(|v| v == &tau[0]) {
            let text = format!("the torque is {} all along: it was not logged; leave the joint out or log it", tau[0]);
            out.push(Finding::new(Kind::NoTorque, Severity::Warning, view.place("tau", joint), text));
            continue;
        }
        out.extend(torque_spike(view, joint, logged));
        if !coarse(own) {
            out.extend(clipped(view, joint, tau));
            out.extend(held(view, joint, tau).or_else(|| frozen::torque(view, joint)));
        }
        out.extend(off(view, joint, tau));
    }
    if out.iter().filter(|finding| finding.kind == Kind::NoTorque).count() == view.dof() {
        // One fault of all: the joints are not listed one by one.
        out.retain(|finding| finding.kind != Kind::NoTorque);
        let zero = logged.tau.as_slice().iter().all(|value| *value == 0.0 || value.is_nan());
        let text = match zero {
            true => {
                "the torque is zero on all joints in every row: the driver does not report it; log motor currents or torques"
            }
            false => "no joint has a torque that changes",
        };
        out.push(Finding::new(Kind::NoTorque, Severity::Fatal, "tau", text));
    }
    out
}

/// The samples behind which a position that hardly moves before and behind jumps by a part of a turn. A joint that is so fast all
/// along is in another unit.
fn jumps_by(q: &[f64], turn: f64) -> impl Iterator<Item = usize> {
    let jumps = move |x: &[f64]| {
        let calm = (x[1] - x[0]).abs().max((x[3] - x[2]).abs());
        calm < 0.1 * turn && ((x[2] - x[1]).abs() - turn).abs() < 0.05 * turn
    };
    q.windows(4).enumerate().filter(move |(_, x)| jumps(x)).map(|(at, _)| at + 1)
}

/// The first of the samples before which a position jumps by half a turn, again and again: it was wrapped at half a turn, or
/// comes from a function that knows no more of an angle.
pub(super) fn half_turn(q: &[f64]) -> Option<usize> {
    let mut places = jumps_by(q, PI);
    // One jump may be anything.
    let first = places.next()?;
    places.next().map(|_| first)
}

fn wrapped(view: &View, joint: usize, q: &[f64]) -> Option<Finding> {
    let whole = jumps_by(q, TAU).next();
    let at = whole.or_else(|| half_turn(q))?;
    let text = match whole {
        Some(_) => "the position jumps by a whole turn between two samples; unwrap it before use",
        None => {
            "the position jumps by half a turn between two samples, again and again: it was wrapped at half a turn; undo that, or log \
             the angle itself"
        }
    };
    let place = format!("{} at {:.4} s", view.place("q", joint), view.log.time[at]);
    Some(Finding::new(Kind::Wrapped, Severity::Warning, place, text))
}

/// The first sample that is a spike by itself and its two neighbours, and how many there are.
/// Samples that stand out from both neighbours.
fn places(signal: &[f64], is_spike: impl Fn(&[f64]) -> bool) -> impl Iterator<Item = usize> {
    signal.windows(3).enumerate().filter(move |(_, x)| is_spike(x)).map(|(at, _)| at + 1)
}

fn spike(view: &View, joint: usize, q: &[f64]) -> Option<Finding> {
    let fastest = FASTEST * view.period;
    let typical = size_quantile(changes(q), 0.99);
    let limit = fastest.max(20.0 * typical);
    let is_spike = |x: &[f64]| {
        let (to, from) = (x[1] - x[0], x[2] - x[1]);
        to.abs() > limit && from.abs() > limit && to * from < 0.0 && to.abs().min(from.abs()) < 0.9 * TAU
    };
    let spikes: Vec<usize> = places(q, is_spike).collect();
    let (at, count) = (*spikes.first()?, spikes.len());
    let text = format!("{count} samples stand out from both neighbours by more than any joint can move; remove them");
    let place = format!("{} at {:.4} s", view.place("q", joint), view.log.time[at]);
    Some(Finding::new(Kind::Spike, Severity::Warning, place, text))
}

/// Torques of a joint that stand out from both neighbours: of a message that was read wrongly, or a count that ran over. What other
/// torques show as well is an impact, as of the teeth of a gear with play.
fn torque_spike(view: &View, joint: usize, logged: &Recording) -> Option<Finding> {
    let spikes = torque_spikes(&logged.tau, joint);
    let at = *spikes.first()?;
    let text = format!(
        "{} samples stand out from both neighbours by more than {STANDS_OUT:.0} times as much as torque usually changes; they are left out: \
         least squares would follow them",
        spikes.len()
    );
    let place = format!("{} at {:.4} s", view.place("tau", joint), logged.time[at]);
    Some(Finding::new(Kind::TorqueSpike, Severity::Warning, place, text))
}

/// Samples at which one of several torques, `[joint][time]`, stands out from both neighbours and no other changes as it rarely does.
fn torque_spikes(tau: &Channels, joint: usize) -> Vec<usize> {
    let usual = |signal: &[f64]| {
        let change = size_quantile(changes(signal), USUAL_CHANGE);
        change.max(resolution(signal))
    };
    let own = tau.channel(joint);
    // Friction of a joint that hardly moves goes from one side to the other and back: by no more than where it turns for good.
    let limit = (STANDS_OUT * usual(own)).max(lasting_step(own));
    let there_and_back = |x: &[f64], least: f64| {
        let (to, from) = (x[1] - x[0], x[2] - x[1]);
        to * from < 0.0 && to.abs().min(from.abs()) > least
    };
    let spikes: Vec<usize> = places(own, |x| there_and_back(x, limit)).collect();
    // Many are no accidents: a drive that chatters, another fault.
    if spikes.is_empty() || spikes.len() as f64 > FEW * own.len() as f64 {
        return Vec::new();
    }
    let others: Vec<(&[f64], f64)> = (0..tau.channels())
        .filter(|&other| other != joint)
        .map(|other| tau.channel(other))
        .map(|t| (t, usual(t)))
        .collect();
    let is_impact = |at: usize| {
        let around = at.saturating_sub(RINGS)..(at + RINGS + 1).min(own.len());
        // A step is friction that turns.
        others
            .iter()
            .any(|(signal, usual)| signal[around.clone()].windows(3).any(|x| there_and_back(x, STRUCK * usual)))
    };
    spikes.into_iter().filter(|&at| !is_impact(at)).collect()
}

/// The largest step of a signal that lasts: that between the medians of some samples before and behind.
fn lasting_step(signal: &[f64]) -> f64 {
    let median = |part: &[f64]| {
        let mut sorted = [part[0], part[1], part[2]];
        sorted.sort_by(f64::total_cmp);
        sorted[1]
    };
    signal.windows(6).map(|part| (median(&part[3..]) - median(&part[..3])).abs()).fold(0.0, f64::max)
}

/// Samples of a joint at which its torque or its position is no measurement. They are reported; what they do to comparisons of torque with
/// motion is no fault of its own.
pub(super) fn spoilt(view: &View, joint: usize) -> Vec<Range<usize>> {
    let frozen = frozen::positions(view, joint).map(|(start, length)| start..start + length);
    frozen.chain(spoilt_torques(view, joint)).collect()
}

/// Samples of a joint at which its torque is no measurement.
pub(super) fn spoilt_torques(view: &View, joint: usize) -> Vec<Range<usize>> {
    let (q, tau) = (view.log.q.channel(joint), view.log.tau.channel(joint));
    let mut parts: Vec<(usize, usize)> = Vec::new();
    if !coarse(tau) {
        let clipped = clipping(tau).into_iter().flat_map(|(level, ..)| clipped::runs_at(tau, level));
        parts.extend(clipped.chain(frozen::torques(view, joint)));
    }
    let frozen = parts.into_iter().map(|(start, length)| start..start + length);
    motor_off(q, tau, 1.0 / view.period).into_iter().chain(frozen).collect()
}

/// A torque that changes less often than the log has rows.
fn held(view: &View, joint: usize, tau: &[f64]) -> Option<Finding> {
    // A torque that is cut off repeats itself there.
    let levels: Vec<f64> = clipping(tau).into_iter().map(|(level, ..)| level).collect();
    let moves = |i: &usize| view.qd.channel(joint)[*i].abs() > view.band[joint] && !levels.contains(&tau[*i]);
    let moving: Vec<usize> = (1..tau.len()).filter(moves).collect();
    let repeated = |signal: &[f64]| {
        moving.iter().filter(|&&i| signal[i] == signal[i - 1]).count() as f64 / moving.len().max(1) as f64
    };
    let (share, of_position) = (repeated(tau), repeated(view.log.q.channel(joint)));
    if moving.len() < 50 || share < 0.45 || of_position > 0.5 * share {
        return None;
    }
    let rate = (1.0 - share) / view.period;
    let text = format!(
        "{:.0} % of the samples repeat the one before: the torque comes at about {rate:.0} Hz and is held; log at that \
         rate, or smooth over several of its steps",
        100.0 * share
    );
    Some(Finding::new(Kind::HeldSamples, Severity::Note, view.place("tau", joint), text))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random;
    use rand::RngExt;

    /// Torques with friction's jumps and white noise of 1 N m; the first with spikes of a size, the second with a share of them.
    #[test]
    fn torques_that_stand_out_alone_are_spikes() {
        let mut source = random::stream(4, "noise", 0);
        let mut torque = || -> Vec<f64> {
            (0..4000)
                .map(|row| 20.0 * (0.003 * f64::from(row)).sin().signum() + source.random_range(-1.7..1.7))
                .collect()
        };
        let clean = [torque(), torque()];
        let found = |count: usize, size: f64, of_other: f64| {
            let mut spoilt = clean.clone();
            for k in 0..count {
                spoilt[0][100 + 37 * k] += size;
                spoilt[1][101 + 37 * k] += of_other * size;
            }
            torque_spikes(&Channels::from_vectors(&spoilt), 0).len()
        };
        assert_eq!(found(0, 0.0, 0.0), 0);
        assert_eq!([found(1, 100.0, 0.0), found(30, 100.0, 0.0)], [1, 30]);
        // Twenty times the change that nine of ten do not exceed, 2.3 N m: 46 N m.
        assert_eq!([found(3, 35.0, 0.0), found(3, 60.0, 0.0)], [0, 3]);
        // Every fiftieth sample is no accident.
        assert_eq!([found(79, 100.0, 0.0), found(90, 100.0, 0.0)], [79, 0]);
        // Another torque changes by five times 2.3 N m.
        assert_eq!([found(3, 100.0, 0.05), found(3, 100.0, 0.2)], [3, 0]);
    }
}
