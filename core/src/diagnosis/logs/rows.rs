//! From logs to the rows of the tests: smooth positions, means over short blocks, rows near reversals left out.
//!
//! Positions pass a zero-phase low-pass whose cut-off the data choose. Torque is not filtered: torque and every column
//! become means over the same short blocks, which keeps white noise white.

use super::cutoffs::POINTS;
use super::log::{Log, MEMORY, MEMORY_OF_ENDS};
use super::low_pass::LowPass;
use crate::channels::Channels;
use crate::diagnosis::criteria::Levels;
use crate::diagnosis::regression::Column;
use crate::error::{Error, Result};
use crate::identification::equal_states::States;
use crate::identification::low_passed::BLOCK_S;
use crate::recording::Recording;
use crate::signal::{rounding, white_noise};
use std::f64::consts::PI;
use std::ops::Range;
use std::sync::OnceLock;

/// Rows on either side of one in which a joint does not surely move that go with it.
const REVERSAL_NEIGHBOURS: usize = 2;

/// Length of the memory of the low-pass that torque went through before it was logged, in periods of its cut-off.
const MEMORY_OF_LOGGER: f64 = 2.5;

/// Time at an end of a log that shows whether the arm moves there, s.
const END_S: f64 = 0.1;

/// Noise of a position over which a joint goes that does not rest: a difference of two, five standard deviations of it.
const NOISE: f64 = 7.0;

/// Share of the band within which the direction is not certain of a motion that is hardly smoothed.
const HARDLY_SMOOTHED: f64 = 0.5;

/// Share of a joint's motion that reversals may not take.
const KEPT_SHARE: f64 = 0.85;

/// Fewest valid rows of every joint in training logs.
pub(crate) const FEWEST_ROWS: usize = 100;
/// Fewest valid rows of every joint in held-out logs.
pub(crate) const FEWEST_TEST_ROWS: usize = 30;

/// All logs of one kind, their blocks one after the other. Signals over the rows have one value per block of every log.
#[derive(Debug, Clone)]
pub struct Rows {
    /// The logs.
    pub logs: Vec<Log>,
    /// First row of every log, and the number of all rows at the end.
    pub starts: Vec<usize>,
    /// Valid rows, `[joint][row]`.
    pub valid: Vec<Vec<bool>>,
    /// Measured torque, `[joint][row]`.
    pub torque: Vec<Vec<f64>>,
    /// Rows over which the low-pass of each joint's positions smears what happens at once, to either side.
    pub smear: Vec<usize>,
    /// The first so many logs are from before the change in question: what changed plays no part there.
    pub before: usize,
    /// Where torque is the difference from that before the change in question: the share of the rows that have an equal state there.
    pub equal_states: Option<f64>,
    /// What smooth functions of each joint's motion can do, `[joint][column][row]`, once the noise has been computed.
    pub rich: OnceLock<Vec<Vec<Vec<f64>>>>,
}

/// Pieces of a log that are as many, and as short on average, s, are those between the gaps of a bad logger.
const FEWEST_PIECES: usize = 5;
const SHORT_S: f64 = 3.0;

impl Rows {
    /// White noise of the measured torque of a joint in means over so many rows, or what the rounding of few digits leaves in them, of the
    /// noisiest log, N m: what its sensor accounts for.
    pub fn sensor_noise(&self, joint: usize, rows: usize) -> f64 {
        let averaged_s = rows as f64 * BLOCK_S;
        let of_log = |log: &Log| {
            let finite: Vec<f64> = log.torque.channel(joint).iter().copied().filter(|x| x.is_finite()).collect();
            (white_noise(&finite) * (log.period / averaged_s).sqrt()).max(rounding(&finite))
        };
        self.logs.iter().map(of_log).fold(0.0, f64::max)
    }

    /// Makes logs ready with positions smoothed at `cutoff_hz`, by the usual levels; `fewest` rows must count on every joint.
    ///
    /// # Errors
    /// If a log is too short, or a joint hardly moves; named.
    pub fn new(recordings: &[&Recording], cutoff_hz: f64, fewest: usize) -> Result<Self> {
        let joints = recordings.first().map_or(0, |recording| recording.joints());
        let fewest = vec![Some(fewest); joints];
        Self::logged_through(None, recordings, (&vec![cutoff_hz; joints], cutoff_hz), &fewest, &Levels::default())
    }

    /// [`Rows::new`] of logs whose torque went `through` a low-pass before it was logged, with a cut-off for each joint. A row
    /// counts only where the joint also moves with certainty with positions smoothed at `whole_hz`, above which they hold nothing but
    /// noise: where friction holds a joint for a moment, smoother positions move on. At least `fewest` rows must be valid on each
    /// joint; a joint without such a number has no equation.
    ///
    /// # Errors
    /// If a log is too short, or a joint hardly moves; named.
    pub(crate) fn logged_through(
        through: Option<LowPass>,
        recordings: &[&Recording],
        (cutoffs_hz, whole_hz): (&[f64], f64),
        fewest: &[Option<usize>],
        levels: &Levels,
    ) -> Result<Self> {
        let first = recordings.first().ok_or_else(|| Error::request("logs", "there are none; give at least one"))?;
        let dof = first.joints();
        let mut rows = Rows {
            logs: Vec::new(),
            starts: vec![0],
            valid: vec![Vec::new(); dof],
            torque: vec![Vec::new(); dof],
            smear: cutoffs_hz.iter().map(|hz| (0.5 * MEMORY / hz / BLOCK_S).ceil() as usize).collect(),
            before: 0,
            equal_states: None,
            rich: OnceLock::new(),
        };
        let lowest_hz = cutoffs_hz.iter().copied().fold(f64::INFINITY, f64::min);
        for recording in recordings {
            let passed = through.map(|low_pass| low_pass.at_rate(recording.rate_hz())).transpose()?;
            let log = Log::new(recording, (cutoffs_hz, whole_hz), passed, levels)?;
            let blocks = |seconds: f64| (seconds * recording.rate_hz() / log.block as f64).ceil() as usize;
            // What torque there was before and after the log, its low-pass knew.
            let unknown_s = through.map_or(0.0, |low_pass| MEMORY_OF_LOGGER / low_pass.hz);
            let ends = rests(recording, &log)
                .map(|rests| blocks((if rests { MEMORY } else { MEMORY_OF_ENDS } / lowest_hz).max(unknown_s)));
            for (joint, joint_cutoff_hz) in cutoffs_hz.iter().enumerate() {
                // A torque that is not a number is one that must not be used.
                let torque = log.blocks(recording.tau.channel(joint));
                let valid = usable(&log, joint, blocks(MEMORY / joint_cutoff_hz), ends)
                    .into_iter()
                    .zip(&torque)
                    .map(|(ok, value)| ok && value.is_finite());
                rows.valid[joint].extend(valid);
                rows.torque[joint].extend(torque.iter().map(|&value| if value.is_finite() { value } else { 0.0 }));
            }
            rows.starts.push(rows.torque[0].len());
            rows.logs.push(log);
        }
        for (joint, (valid, &fewest)) in rows.valid.iter_mut().zip(fewest).enumerate() {
            let Some(fewest) = fewest else {
                valid.fill(false);
                continue;
            };
            let count = valid.iter().filter(|&&ok| ok).count();
            if count < fewest {
                let cure = too_torn(recordings, fewest)
                    .unwrap_or_else(|| "record a longer motion in which this joint takes part".to_owned());
                let problem = format!(
                    "only {:.1} s of the logs are usable (where the joint surely moves); a \
                     diagnosis needs {:.0} s or more: {cure}",
                    count as f64 * BLOCK_S,
                    fewest as f64 * BLOCK_S
                );
                return Err(Error::request(format!("joint `{}`", first.joints[joint]), problem));
            }
        }
        Ok(rows)
    }

    /// Number of joints.
    pub fn dof(&self) -> usize {
        self.torque.len()
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.torque[0].len()
    }

    /// Whether there are no rows.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// These logs, and `others` after them.
    pub fn and(&self, others: &Rows) -> Rows {
        let (mut all, first) = (self.clone(), self.len());
        all.rich = self.rich.get().zip(others.rich.get()).map_or_else(OnceLock::new, |(own, others)| {
            let joint = |(own, others): (&Vec<Vec<f64>>, &Vec<Vec<f64>>)| -> Vec<Vec<f64>> {
                own.iter().zip(others).map(|(own, others)| [own.as_slice(), others].concat()).collect()
            };
            OnceLock::from(own.iter().zip(others).map(joint).collect::<Vec<_>>())
        });
        all.logs.extend(others.logs.iter().cloned());
        all.starts.extend(others.starts[1..].iter().map(|start| first + start));
        all.valid.iter_mut().zip(&others.valid).for_each(|(valid, other)| valid.extend(other));
        all.torque.iter_mut().zip(&others.torque).for_each(|(torque, other)| torque.extend(other));
        all
    }

    /// Share of white noise, as means over blocks, that the low-pass lets through that torque went through; one without any.
    pub(crate) fn share_as_logged(&self) -> f64 {
        let Some((log, passed)) = self.logs.iter().find_map(|log| Some((log, log.passed.as_ref()?))) else {
            return 1.0;
        };
        let (mut all, mut through) = (0.0, 0.0);
        for k in 0..POINTS {
            let hz = (k as f64 + 0.5) / POINTS as f64 * 0.5 / log.period;
            // A mean over a block is a low-pass of its own (Dirichlet's kernel).
            let phase = PI * hz * log.period;
            let mean = (log.block as f64 * phase).sin() / (log.block as f64 * phase.sin());
            all += mean * mean;
            through += (mean * passed.gain(hz)).powi(2);
        }
        through / all
    }

    /// Whether the question is what changed.
    pub(crate) fn of_change(&self) -> bool {
        self.before > 0 || self.equal_states.is_some()
    }

    /// The logs from the first to the last of a range alone, as if none were from before the change.
    pub(crate) fn of_logs(&self, logs: Range<usize>) -> Rows {
        let rows = self.starts[logs.start]..self.starts[logs.end];
        Rows {
            logs: self.logs[logs.clone()].to_vec(),
            starts: self.starts[logs.start..=logs.end].iter().map(|start| start - rows.start).collect(),
            valid: self.valid.iter().map(|valid| valid[rows.clone()].to_vec()).collect(),
            torque: self.torque.iter().map(|torque| torque[rows.clone()].to_vec()).collect(),
            smear: self.smear.clone(),
            before: 0,
            equal_states: self.equal_states,
            rich: OnceLock::new(),
        }
    }

    /// States of a log, means over its blocks.
    pub fn states(&self, log: usize) -> States {
        let log = &self.logs[log];
        let means = |table: &Channels| table.map(|_, signal| log.blocks(signal));
        States { q: means(&log.motion.q), qd: means(&log.motion.qd) }
    }

    /// First row from after the change in question.
    pub(crate) fn changed_from(&self) -> usize {
        self.starts[self.before]
    }

    /// Signals over the rows, each in two where there are rows from before the change: one for before, one for after.
    pub fn apart(&self, signals: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
        let change = self.changed_from();
        if change == 0 {
            return signals;
        }
        let part = |signal: &[f64], after: bool| -> Vec<f64> {
            signal.iter().enumerate().map(|(row, &x)| if (row >= change) == after { x } else { 0.0 }).collect()
        };
        signals.iter().flat_map(|signal| [part(signal, false), part(signal, true)]).collect()
    }

    /// A signal over the rows with zeros before the change.
    pub(crate) fn since_change(&self, mut signal: Vec<f64>) -> Vec<f64> {
        signal[..self.changed_from()].fill(0.0);
        signal
    }

    /// Leaves out the rows of a joint in which its error exceeds what is bearable on it, but no more than a share of those that
    /// count: then the largest.
    pub(crate) fn leave_out_largest(&mut self, errors: &[Column], bearable: &[f64], most: f64) {
        for (joint, (valid, bearable)) in self.valid.iter_mut().zip(bearable).enumerate() {
            let Some(error) = errors.iter().find_map(|error| error.part(joint)) else { continue };
            let mut sizes: Vec<f64> = error.iter().zip(&*valid).filter(|(_, ok)| **ok).map(|(e, _)| e.abs()).collect();
            sizes.sort_by(|a, b| b.total_cmp(a));
            let limit = sizes.get((most * sizes.len() as f64) as usize).map_or(*bearable, |least| least.max(*bearable));
            tracing::debug!(joint, bearable, limit, "error of the smoothing");
            // An error that is not a number is skipped.
            valid.iter_mut().zip(error).for_each(|(ok, error)| *ok &= error.is_nan() || error.abs() <= limit);
        }
    }

    /// Leaves out the rows of all joints that hold samples `from..to` of a log.
    pub(crate) fn leave_out_samples(&mut self, log: usize, from: usize, to: usize) {
        let (start, end, block) = (self.starts[log], self.starts[log + 1], self.logs[log].block);
        let near = (start + from / block).min(end)..(start + to.div_ceil(block)).min(end);
        self.valid.iter_mut().for_each(|valid| valid[near.clone()].fill(false));
    }

    /// A part of the torque of one joint over the rows as it would have been logged, from what `of` gives for every log at its
    /// own rate.
    pub fn signal(&self, of: impl Fn(&Log) -> Vec<f64>) -> Vec<f64> {
        self.logs.iter().flat_map(|log| log.as_logged(&of(log))).collect()
    }

    /// A signal that is no torque over the rows, from what `of` gives for every log at its own rate.
    pub fn means(&self, of: impl Fn(&Log) -> Vec<f64>) -> Vec<f64> {
        self.logs.iter().flat_map(|log| log.blocks(&of(log))).collect()
    }
}

/// Whether all joints rest at the start and at the end of a log: none goes further than it would at the speed above which it surely
/// moves, or than the noise of two positions.
fn rests(recording: &Recording, log: &Log) -> [bool; 2] {
    let samples = recording.samples();
    let end = ((END_S * recording.rate_hz()) as usize).clamp(1, samples - 1);
    let moved = |from: usize| {
        (0..recording.joints()).any(|joint| {
            let q = recording.q.channel(joint);
            let path = (log.slow[joint].sure * END_S).max(NOISE * log.position_noise[joint]);
            (q[from + end] - q[from]).abs() > path
        })
    };
    [!moved(0), !moved(samples - 1 - end)]
}

/// Blocks of a joint away from the ends of the log and from reversals, of the motion and of the hardly smoothed one where there is
/// one. The full memory of the low-pass is left out around reversals where that leaves most of the motion; a joint that reverses
/// all the time keeps more.
fn usable(log: &Log, joint: usize, margin: usize, ends: [usize; 2]) -> Vec<bool> {
    let speed = log.motion.qd.channel(joint);
    let band = log.slow[joint].sure;
    let is_slow = |block: &[f64], band: f64| {
        let turns = block.iter().any(|v| v.signum() != block[0].signum());
        turns || block.iter().any(|v| v.abs() < band)
    };
    let mut slow: Vec<bool> = speed.chunks_exact(log.block).map(|block| is_slow(block, band)).collect();
    if let Some(whole) = &log.whole {
        let blocks = whole.qd.channel(joint).chunks_exact(log.block);
        slow.iter_mut().zip(blocks).for_each(|(slow, block)| *slow |= is_slow(block, HARDLY_SMOOTHED * band));
    }
    let away = |neighbours: usize| -> Vec<bool> {
        (0..slow.len())
            .map(|row| {
                let near = row.saturating_sub(neighbours)..(row + neighbours + 1).min(slow.len());
                row >= ends[0] && row + ends[1] < slow.len() && !slow[near].contains(&true)
            })
            .collect()
    };
    let count = |rows: &[bool]| rows.iter().filter(|&&ok| ok).count() as f64;
    let most = away(REVERSAL_NEIGHBOURS);
    let enough = KEPT_SHARE * count(&most);
    let fewer = (REVERSAL_NEIGHBOURS + 1..=margin).rev().map(away);
    fewer.into_iter().find(|rows| count(rows) >= enough).unwrap_or(most)
}

/// What helps where gaps cut the logs into pieces so short that the filters leave little of them; `fewest` rows are needed.
fn too_torn(recordings: &[&Recording], fewest: usize) -> Option<String> {
    let seconds: f64 = recordings.iter().map(|recording| recording.duration()).sum();
    let mean_s = seconds / recordings.len().max(1) as f64;
    (recordings.len() >= FEWEST_PIECES && mean_s < SHORT_S && seconds > fewest as f64 * BLOCK_S).then(|| {
        format!(
            "gaps of the clock cut the {seconds:.0} s of the logs into {} pieces of {mean_s:.1} s, of which the filters need the ends: the motion is \
             long enough, but log it without gaps (a queue or a real-time priority for the logger, fewer topics, a local disk)",
            recordings.len()
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::channels::Channels;
    use crate::diagnosis::logs::cutoffs::tests::{RATE, swing};

    #[test]
    fn rows_near_reversals_and_ends_do_not_count() {
        let mut q = Channels::from_vectors(&[swing(0.4, 0.0)]);
        // At rest in the beginning.
        let start = q.channel(0)[125];
        q.channel_mut(0)[..125].fill(start);
        let tau = Channels::zeros(1, 10_000);
        let time = (0..10_000).map(|k| f64::from(k) / RATE).collect();
        let log = Recording { joints: vec!["a".into()], time, q, tau, ..Default::default() };
        let rows = Rows::new(&[&log], 5.0, FEWEST_ROWS).unwrap();
        assert_eq!(rows.len(), 1000);
        // A reversal every half period of 2.5 s: blocks 31, 94, ..
        assert!(!rows.valid[0][0] && !rows.valid[0][94] && !rows.valid[0][999]);
        assert!(rows.valid[0][60] && rows.valid[0][120]);
        // At the end the arm moves: nothing counts within five periods of the low-pass, 1 s.
        assert!(rows.valid[0][950..].iter().all(|&ok| !ok) && rows.valid[0][930..950].contains(&true));
        assert!(Rows::new(&[&log.time_slice(0.0..1.5)], 5.0, FEWEST_ROWS).unwrap_err().to_string().contains("`a`"));
    }

    /// The same log in metres, twenty times slower: no row is lost or won.
    #[test]
    fn rows_are_those_of_a_joint_that_is_slow_in_its_unit() {
        let of = |factor: f64| {
            let q: Vec<f64> = swing(0.4, 0.0).iter().map(|q| factor * q).collect();
            let mut q = Channels::from_vectors(&[q]);
            let start = q.channel(0)[125];
            q.channel_mut(0)[..125].fill(start);
            let time = (0..10_000).map(|k| f64::from(k) / RATE).collect();
            let log =
                Recording { joints: vec!["a".into()], time, q, tau: Channels::zeros(1, 10_000), ..Default::default() };
            let rows = Rows::new(&[&log], 5.0, FEWEST_ROWS).unwrap();
            (rests(&log, &rows.logs[0]), rows.valid)
        };
        let (rests, valid) = of(0.1);
        assert_eq!(rests, [true, false]);
        assert!(valid == of(0.005).1 && of(0.005).0 == rests);
    }

    #[test]
    fn a_joint_that_friction_holds_does_not_count() {
        // Where it is fastest, held for 0.06 s: smooth positions move on.
        let mut q = Channels::from_vectors(&[swing(0.4, 0.0)]);
        let held = q.channel(0)[2500];
        let jump = q.channel(0)[2530] - held;
        q.channel_mut(0)[2500..2530].fill(held);
        q.channel_mut(0)[2530..].iter_mut().for_each(|q| *q -= jump);
        let time = (0..10_000).map(|k| f64::from(k) / RATE).collect();
        let tau = Channels::zeros(1, 10_000);
        let log = Recording { joints: vec!["a".into()], time, q, tau, ..Default::default() };
        let counts = |whole_hz: f64| {
            let rows =
                Rows::logged_through(None, &[&log], (&[3.0], whole_hz), &[Some(FEWEST_ROWS)], &Levels::default())
                    .unwrap();
            rows.valid[0][250..253].iter().filter(|&&ok| ok).count()
        };
        assert_eq!([counts(3.0), counts(20.0)], [3, 0]);
    }

    #[test]
    fn rows_with_a_large_error_are_left_out_but_not_too_many() {
        let q = Channels::from_vectors(&[swing(0.4, 0.0)]);
        let time = (0..10_000).map(|k| f64::from(k) / RATE).collect();
        let log = Recording {
            joints: vec!["a".into()],
            time,
            tau: q.map(|_, q| vec![0.0; q.len()]),
            q,
            ..Default::default()
        };
        let rows = Rows::new(&[&log], 5.0, FEWEST_ROWS).unwrap();
        let counting: Vec<usize> = (0..rows.len()).filter(|&row| rows.valid[0][row]).collect();
        let error = |large: &[usize]| {
            Column::on(
                0,
                (0..rows.len()).map(|row| if large.contains(&row) { -3.0 - row as f64 } else { 0.1 }).collect(),
            )
        };
        let mut few = rows.clone();
        few.leave_out_largest(&[error(&counting[40..43])], &[1.0], 0.1);
        let left: Vec<usize> = (0..rows.len()).filter(|&row| few.valid[0][row]).collect();
        assert_eq!(left, [&counting[..40], &counting[43..]].concat());
        let mut many = rows.clone();
        many.leave_out_largest(&[error(&counting)], &[1.0], 0.1);
        let kept = many.valid[0].iter().filter(|&&ok| ok).count();
        assert!((kept as f64 / counting.len() as f64 - 0.9).abs() < 0.01, "{kept} of {}", counting.len());
        assert!(many.valid[0][counting[0]] && !many.valid[0][*counting.last().unwrap()]);
    }
}
