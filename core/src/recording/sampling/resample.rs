//! Irregular clocks: how regular a clock is, and the log at even steps.

use super::interpolation::{across_gaps, interpolate};
use crate::channels::Channels;
use crate::recording::Recording;
use std::ops::Range;

/// Root mean square of the deviation of the steps from the median step, over the median step, above which a log is
/// taken at even steps before it is used.
pub(crate) const IRREGULAR: f64 = 0.02;

/// A step longer than this many median steps is a gap, whatever the clock.
pub(crate) const GAP: f64 = 2.5;

/// A step longer than this many median steps is a gap already where the others scatter by less than [`STEADY`] of the median: a row was
/// lost.
const LOST_ROW: f64 = 1.5;
const STEADY: f64 = 0.1;

/// How regular the clock of a log is.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::recording;
/// use tauscope::recording::resample::Clock;
///
/// let mut log = recording::load("../tests/reference/payload/before.csv", None)?;
/// let clock = Clock::new(&log);
/// assert!((clock.rate_hz - 50.0).abs() < 1e-6 && clock.gaps.is_empty() && !clock.is_irregular());
///
/// // Half a second is missing after sample 100.
/// log.time[101..].iter_mut().for_each(|time| *time += 0.5);
/// assert_eq!(Clock::new(&log).gaps, [100]);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Clock {
    /// One over the median step, Hz.
    pub rate_hz: f64,
    /// Root mean square of the steps' deviation from the median, gaps left out, s.
    pub jitter_s: f64,
    /// The longest step, s.
    pub longest_step_s: f64,
    /// Samples before a gap.
    #[serde(skip)]
    pub gaps: Vec<usize>,
}

impl Clock {
    /// The clock of times that increase; NaN and empty for fewer than two.
    pub fn new(recording: &Recording) -> Self {
        let rate_hz = recording.rate_hz();
        let median = 1.0 / rate_hz;
        let steps = || recording.time.windows(2).map(|pair| pair[1] - pair[0]);
        let scatter = |longest: f64| {
            let kept = steps().filter(|s| *s <= longest * median);
            let (sum, count) = kept.fold((0.0, 0usize), |(sum, count), s| (sum + (s - median).powi(2), count + 1));
            (sum / count.max(1) as f64).sqrt()
        };
        let longest = if scatter(LOST_ROW) < STEADY * median { LOST_ROW } else { GAP };
        let gaps: Vec<usize> = steps().enumerate().filter(|(_, s)| *s > longest * median).map(|(at, _)| at).collect();
        Clock { rate_hz, jitter_s: scatter(longest), longest_step_s: steps().fold(0.0, f64::max), gaps }
    }

    /// Whether the log should be taken at even steps before it is used.
    pub fn is_irregular(&self) -> bool {
        self.jitter_s * self.rate_hz > IRREGULAR || !self.gaps.is_empty()
    }
}

/// The log at even steps. Where only the stamps scatter, as those do that a host gives on arrival, the samples are even already;
/// else they are brought to the median rate. Truth is left out: it belongs to the old samples.
pub fn evenly(recording: &Recording) -> Recording {
    if recording.samples() < 2 {
        return recording.clone();
    }
    let mut even = at_even_steps(recording);
    if only_stamps_scatter(recording, &even) {
        even = Recording { time: even.time, truth: None, ..recording.clone() };
    }
    even
}

/// Whether the positions are smoother as they are than brought from the stamped times to even ones.
fn only_stamps_scatter(recording: &Recording, even: &Recording) -> bool {
    let rougher = |joint: usize| {
        let [own, moved] = [recording, even].map(|log| roughness(log.q.channel(joint)));
        if own > 0.0 && moved > 0.0 { (own / moved).ln() } else { 0.0 }
    };
    recording.samples() == even.samples() && (0..recording.joints()).map(rougher).sum::<f64>() < 0.0
}

/// Sum of squares of the third differences, in which motion has next to no part.
fn roughness(signal: &[f64]) -> f64 {
    signal.windows(4).map(|x| (x[3] - 3.0 * x[2] + 3.0 * x[1] - x[0]).powi(2)).sum()
}

/// The log at the median rate: piecewise cubic (Catmull-Rom with finite-difference tangents for uneven steps). Across gaps motion, which is
/// smooth, is cubic as far as they are bridged; torque, which jumps where a joint reverses, is linear.
fn at_even_steps(recording: &Recording) -> Recording {
    let clock = Clock::new(recording);
    let (first, step) = (recording.time[0], 1.0 / clock.rate_hz);
    // The median step of a stamped clock is rounded to its digits, or one of stamps that scatter: where no row is missing, a step
    // that meets both ends does not drift.
    let whole = clock.gaps.is_empty();
    let count = if whole { recording.samples() - 1 } else { (recording.duration() / step).round().max(1.0) as usize };
    let step = recording.duration() / count as f64;
    let time: Vec<f64> = (0..=count).map(|sample| first + sample as f64 * step).collect();
    let last = recording.samples() - 2;
    let mut place = 0;
    let places: Vec<usize> = time
        .iter()
        .map(|&t| {
            while place < last && recording.time[place + 1] <= t {
                place += 1;
            }
            place
        })
        .collect();
    let (limit, longest) = (GAP / clock.rate_hz, longest_bridged(clock.rate_hz));
    let at_times = |channels: &Channels, value: &dyn Fn(&[f64], usize, f64) -> f64| {
        let of = |signal: &[f64]| time.iter().zip(&places).map(|(&t, &place)| value(signal, place, t)).collect();
        channels.map(|_, signal| of(signal))
    };
    let table = |channels: &Channels| {
        at_times(channels, &|signal, place, t| across_gaps(&recording.time, signal, place, t, limit, longest))
    };
    let tau = at_times(&recording.tau, &|signal, place, t| interpolate(&recording.time, signal, place, t, limit));
    Recording {
        robot: recording.robot.clone(),
        joints: recording.joints.clone(),
        q: table(&recording.q),
        qd: recording.qd.as_ref().map(table),
        qdd: recording.qdd.as_ref().map(table),
        tau,
        truth: None,
        provenance: recording.provenance.clone(),
        time,
    }
}

/// A step longer than this many median steps cannot be bridged.
pub(crate) const TORN: f64 = 10.0;

/// .. unless a log is full of gaps and would be lost: in this time motion does not turn, s.
const BRIDGED_S: f64 = 0.05;

/// Share of the samples that must stay where a log is cut at its gaps.
const KEPT: f64 = 0.5;

/// A piece with fewer samples is not worth keeping.
const SHORTEST: usize = 50;

/// Longer logs are cut, so that the columns of a model need memory for one piece at a time.
const LONGEST: usize = 60_000;

/// No log starts later on a clock that means anything to it, s.
const LONG_AGO_S: f64 = 1e6;

/// Counts time from the start of a log whose clock started long ago.
pub(crate) fn from_its_start(recording: &mut Recording) {
    if let Some(&first) = recording.time.first().filter(|first| first.abs() > LONG_AGO_S) {
        recording.time.iter_mut().for_each(|t| *t -= first);
    }
}

/// The log ready for filters that need even steps: cut where the clock leaves out more than ten steps, and at the median
/// rate where it is irregular. No piece has more than sixty thousand samples. A clock that started long ago, as one that
/// counts from 1970, starts with the log: what warms up does so from there, and times keep their digits. Otherwise a short log
/// with a regular clock comes back as it is.
pub fn pieces(mut recording: Recording) -> Vec<Recording> {
    from_its_start(&mut recording);
    if recording.samples() <= LONGEST {
        return even_pieces(recording);
    }
    let count = recording.samples().div_ceil(LONGEST);
    let start = |piece: usize| piece * recording.samples() / count;
    (0..count).flat_map(|piece| even_pieces(recording.slice(start(piece)..start(piece + 1)))).collect()
}

fn even_pieces(recording: Recording) -> Vec<Recording> {
    let clock = Clock::new(&recording);
    if !clock.is_irregular() {
        return vec![recording];
    }
    stretches(&recording, &clock).into_iter().map(|rows| evenly(&recording.slice(rows))).collect()
}

/// The longest gap that is ever bridged, s.
fn longest_bridged(rate_hz: f64) -> f64 {
    BRIDGED_S.max(TORN / rate_hz)
}

/// Rows between the gaps that cannot be bridged, those too few to keep left out.
fn stretches(recording: &Recording, clock: &Clock) -> Vec<Range<usize>> {
    let cut = cut_at(recording, clock, TORN / clock.rate_hz);
    let kept = |ranges: &[Range<usize>]| ranges.iter().map(Range::len).sum::<usize>();
    if kept(&cut) as f64 >= KEPT * recording.samples() as f64 {
        return cut;
    }
    let bridged = cut_at(recording, clock, longest_bridged(clock.rate_hz));
    if kept(&bridged) > kept(&cut) { bridged } else { cut }
}

/// The same where a step longer than `longest` cannot be bridged, s.
fn cut_at(recording: &Recording, clock: &Clock, longest: f64) -> Vec<Range<usize>> {
    // Steps of ten rows are written in few digits.
    let torn = |&&at: &&usize| (recording.time[at + 1] - recording.time[at]) > longest * (1.0 + 1e-9);
    let ends: Vec<usize> = clock.gaps.iter().filter(torn).map(|at| at + 1).chain([recording.samples()]).collect();
    let starts = [0].into_iter().chain(ends.iter().copied());
    starts.zip(&ends).map(|(start, &end)| start..end).filter(|rows| rows.len() >= SHORTEST).collect()
}

/// The longest run of rows without a gap that cannot be bridged; None where there is no such gap, or no run worth keeping.
pub(crate) fn longest_stretch(recording: &Recording) -> Option<Range<usize>> {
    let longest = stretches(recording, &Clock::new(recording)).into_iter().max_by_key(|rows| rows.len())?;
    (longest.len() < recording.samples()).then_some(longest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::samples;

    fn irregular(samples: usize, law: impl Fn(f64) -> f64) -> Recording {
        let mut recording = samples::full(1, samples);
        for (index, time) in recording.time.iter_mut().enumerate() {
            *time = 0.01 * index as f64 + if index % 3 == 1 { 0.002 } else { 0.0 };
        }
        let values: Vec<f64> = recording.time.iter().map(|&t| law(t)).collect();
        recording.q.channel_mut(0).copy_from_slice(&values);
        recording
    }

    #[test]
    fn a_sine_survives_an_uneven_clock() {
        let law = |t: f64| (5.0 * t).sin();
        let recording = irregular(300, law);
        let clock = Clock::new(&recording);
        assert!(clock.is_irregular() && clock.gaps.is_empty(), "{clock:?}");
        let even = evenly(&recording);
        assert!(!Clock::new(&even).is_irregular());
        assert!((even.rate_hz() - 100.0).abs() < 0.5, "{}", even.rate_hz());
        for (t, q) in even.time.iter().zip(even.q.channel(0)).skip(2).take(290) {
            assert!((q - law(*t)).abs() < 1e-5, "{t}: {q} {}", law(*t));
        }
    }

    #[test]
    fn stamps_that_scatter_move_no_sample() {
        let mut recording = samples::full(1, 300);
        let law = |t: f64| (5.0 * t).sin();
        let values: Vec<f64> = (0..300).map(|index| law(0.01 * f64::from(index))).collect();
        recording.q.channel_mut(0).copy_from_slice(&values);
        recording.time =
            (0..300).map(|index| 0.01 * f64::from(index) + if index % 3 == 1 { 0.002 } else { 0.0 }).collect();
        let even = evenly(&recording);
        assert!(!Clock::new(&even).is_irregular());
        assert_eq!(even.q.channel(0), values);
        assert_eq!(even.tau, recording.tau);
    }

    #[test]
    fn long_logs_are_cut_without_a_loss() {
        let recording = samples::full(1, 2 * LONGEST + 2);
        let pieces = pieces(recording.clone());
        assert_eq!(pieces.len(), 3);
        assert!(pieces.iter().all(|piece| piece.samples() <= LONGEST));
        let joined: Vec<f64> = pieces.iter().flat_map(|piece| piece.tau.channel(0)).copied().collect();
        assert_eq!(joined, recording.tau.channel(0));
    }

    #[test]
    fn a_clock_from_1970_starts_with_the_log() {
        let mut recording = samples::full(1, 100);
        let own = pieces(recording.clone());
        assert_eq!(own[0].time, recording.time);
        recording.time.iter_mut().for_each(|t| *t += 5000.0);
        assert_eq!(pieces(recording.clone())[0].time[0], 5000.0);
        recording.time.iter_mut().for_each(|t| *t += 1.7e9);
        let pieces = pieces(recording);
        assert_eq!((pieces.len(), pieces[0].time[0]), (1, 0.0));
        assert!(pieces[0].time.iter().zip(&own[0].time).all(|(now, then)| (now - then).abs() < 1e-6));
    }

    #[test]
    fn gaps_are_found_and_crossed_in_a_line() {
        let mut recording = samples::full(1, 100);
        recording.time = (0..100).map(|i| 0.01 * i as f64 + if i >= 50 { 0.5 } else { 0.0 }).collect();
        let values: Vec<f64> = recording.time.iter().map(|t| 3.0 * t - 1.0).collect();
        recording.tau.channel_mut(0).copy_from_slice(&values);
        let clock = Clock::new(&recording);
        assert_eq!(clock.gaps, [49]);
        assert!((clock.longest_step_s - 0.51).abs() < 1e-12 && clock.jitter_s < 1e-12, "{clock:?}");
        let even = evenly(&recording);
        let pieces = pieces(recording.clone());
        assert_eq!(pieces.iter().map(Recording::samples).collect::<Vec<_>>(), [50, 50]);
        assert!((pieces[1].time[0] - 1.0).abs() < 1e-12);
        assert_eq!(even.samples(), 150);
        for (t, tau) in even.time.iter().zip(even.tau.channel(0)) {
            assert!((tau - (3.0 * t - 1.0)).abs() < 1e-12);
        }
    }

    /// A logger at 500 Hz that stops for 30 ms after every ten rows or so.
    #[test]
    fn a_log_full_of_short_gaps_is_bridged_and_one_with_few_is_cut() {
        let law = |t: f64| (5.0 * t).sin();
        let of = |rows: usize, gap_s: f64| {
            let mut recording = samples::full(1, 2000);
            recording.time = (0..2000).map(|i| 0.002 * i as f64 + (gap_s - 0.002) * (i / rows) as f64).collect();
            let values: Vec<f64> = recording.time.iter().map(|&t| law(t)).collect();
            recording.q.channel_mut(0).copy_from_slice(&values);
            pieces(recording)
        };
        let bridged = of(11, 0.03);
        assert_eq!(bridged.len(), 1);
        let error = |(t, q): (&f64, &f64)| (q - law(*t)).abs();
        let worst = bridged[0].time.iter().zip(bridged[0].q.channel(0)).map(error).fold(0.0, f64::max);
        assert!(worst < 2e-4, "{worst}");
        assert_eq!(of(500, 0.03).len(), 4);
        // In a tenth of a second the motion may turn.
        assert!(of(11, 0.1).is_empty() && of(60, 0.1).len() > 30);
    }
}
