//! Recordings: the signals of all joints of an arm over time.

use super::arrays::{JointArrays, Joints};
use crate::channels::Channels;
use crate::error::Result;
use std::collections::BTreeMap;
use std::ops::{Range, RangeBounds};
use std::sync::Arc;

/// Positions (rad), velocities (rad/s), accelerations (rad/s²) and torques (N m) of all joints over time.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::channels::Channels;
/// use tauscope::recording::Signals;
///
/// // What simulated logs hold in addition to their measurements, under `Recording::truth`.
/// let ramp = Channels::from_vectors(&[vec![0.0, 0.1, 0.2, 0.3]]);
/// let none = Channels::zeros(1, 4);
/// let truth = Signals { q: ramp, qd: none.clone(), qdd: none.clone(), tau: none };
/// assert_eq!(truth.slice(1..3).q.channel(0), [0.1, 0.2]);
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Signals {
    /// Joint positions, rad.
    pub q: Channels,
    /// Joint velocities, rad/s.
    pub qd: Channels,
    /// Joint accelerations, rad/s².
    pub qdd: Channels,
    /// Torques the motors deliver at the joints, N m.
    pub tau: Channels,
}

/// A log: sensor signals and, where it is known, the truth behind them. All tables have one channel per joint, in
/// the order of `joints`, and one sample per entry of `time`.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::recording;
///
/// let log = recording::load("../tests/reference/payload/before.csv", None)?;
/// assert_eq!((log.joints(), log.samples()), (5, 800));
/// assert!((log.rate_hz() - 50.0).abs() < 1e-6);
/// assert!(log.has_torque(4) && !log.has_velocity(4));
///
/// // The first four seconds.
/// assert_eq!(log.time_slice(..4.0).samples(), 200);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Recording {
    /// Name of the robot; empty where the file does not have it.
    pub robot: String,
    /// Names of the joints from base to flange.
    pub joints: Vec<String>,
    /// Time of every sample, s, increasing.
    pub time: Vec<f64>,
    /// Measured positions, rad.
    pub q: Channels,
    /// Measured velocities, rad/s, where there is a sensor for them; a joint without is not a number at every sample, as
    /// of accelerations and torques.
    pub qd: Option<Channels>,
    /// Measured accelerations, rad/s², where there is a sensor for them.
    pub qdd: Option<Channels>,
    /// Measured torques, N m.
    pub tau: Channels,
    /// The signals without noise; simulated logs only. Logs of one simulation under different noise share them.
    pub truth: Option<Arc<Signals>>,
    /// Where the log comes from: seed, versions, what measured the velocity.
    pub provenance: BTreeMap<String, String>,
}

/// [`Recording`] by the name that users of arrays look for: [`Log::new`](Recording::new).
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::Log;
///
/// let (t, q, tau) = ([0.0, 0.01, 0.02], [[0.0, 0.1, 0.2]], [[1.0, 1.1, 1.2]]);
/// let log = Log::new(["elbow"], t, q, tau)?;
/// assert_eq!((log.joints(), log.rate_hz().round()), (1, 100.0));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
pub type Log = Recording;

impl Signals {
    /// The samples of `range` of every signal.
    ///
    /// # Panics
    /// If `range` reaches beyond the last sample.
    pub fn slice(&self, range: Range<usize>) -> Self {
        Signals {
            q: cut(&self.q, &range),
            qd: cut(&self.qd, &range),
            qdd: cut(&self.qdd, &range),
            tau: cut(&self.tau, &range),
        }
    }
}

impl Recording {
    /// A log of positions and torques. `joints` is the robot, or the names of its joints from base to flange. `time` has the time of
    /// every sample, s, increasing. `q` and `tau` have one array per joint and one value per sample: positions, rad or m, and the torques
    /// that the motors deliver at the joints, N m or N. A torque that was not measured is not a number. Measured velocities and
    /// accelerations may follow: [`Recording::velocities`], [`Recording::accelerations`].
    ///
    /// ```
    /// # extern crate tauscope_core as tauscope;
    /// use tauscope::Log;
    /// use tauscope::robot::{self, InertiaCheck};
    ///
    /// let robot = robot::load("../tests/reference/payload/arm.urdf", InertiaCheck::Ignored)?;
    /// let t: Vec<f64> = (0..100).map(|k| 0.01 * f64::from(k)).collect();
    /// let wave = |rate: f64| -> Vec<f64> { t.iter().map(|t| (rate * t).sin()).collect() };
    /// let (q, qd, tau) = (vec![wave(1.0); 5], vec![wave(2.0); 5], vec![wave(3.0); 5]);
    ///
    /// let log = Log::new(&robot, &t, &q, &tau)?.velocities(&qd)?;
    /// assert_eq!((log.joints(), log.samples()), (5, 100));
    ///
    /// let refused = Log::new(&robot, &t, &q, &tau[..4]).unwrap_err();
    /// assert_eq!(refused.to_string(), "tau: has 4 joints of 100 samples; 5 joints of 100 samples are wanted");
    /// # Ok::<(), tauscope::error::Error>(())
    /// ```
    ///
    /// # Errors
    /// An array that has not one signal per joint and one value per time: the array, the joint where one alone differs, its length and
    /// the one that is wanted.
    pub fn new(
        joints: impl Into<Joints>,
        time: impl AsRef<[f64]>,
        q: impl Into<JointArrays>,
        tau: impl Into<JointArrays>,
    ) -> Result<Self> {
        let Joints { robot, names } = joints.into();
        let time = time.as_ref().to_vec();
        let [q, tau] = [(q.into(), "q"), (tau.into(), "tau")].map(|(own, name)| own.checked(name, &names, time.len()));
        Ok(Recording { q: q?, tau: tau?, robot, joints: names, time, ..Recording::default() })
    }

    /// The log with measured velocities, rad/s or m/s: one array per joint and one value per sample.
    ///
    /// # Errors
    /// Those of [`Recording::new`].
    pub fn velocities(self, qd: impl Into<JointArrays>) -> Result<Self> {
        let qd = Some(qd.into().checked("qd", &self.joints, self.samples())?);
        Ok(Recording { qd, ..self })
    }

    /// The log with measured accelerations, rad/s² or m/s²: one array per joint and one value per sample.
    ///
    /// # Errors
    /// Those of [`Recording::new`].
    pub fn accelerations(self, qdd: impl Into<JointArrays>) -> Result<Self> {
        let qdd = Some(qdd.into().checked("qdd", &self.joints, self.samples())?);
        Ok(Recording { qdd, ..self })
    }

    /// Whether the joints are called by number alone: `joint_1` and so on.
    pub(crate) fn is_numbered(&self) -> bool {
        self.joints.iter().enumerate().all(|(joint, name)| *name == format!("joint_{}", joint + 1))
    }

    /// Number of joints.
    pub fn joints(&self) -> usize {
        self.joints.len()
    }

    /// Whether the log holds the torque of a joint. A joint without has a torque that is not a number at every sample: its
    /// motion counts, its equation does not.
    pub fn has_torque(&self, joint: usize) -> bool {
        has_values(Some(&self.tau), joint)
    }

    /// Whether the log holds the velocity of a joint. A joint without has a velocity that is not a number at every sample.
    pub fn has_velocity(&self, joint: usize) -> bool {
        has_values(self.qd.as_ref(), joint)
    }

    /// Number of samples.
    pub fn samples(&self) -> usize {
        self.time.len()
    }

    /// Time from the first to the last sample, s.
    pub fn duration(&self) -> f64 {
        self.time.last().zip(self.time.first()).map_or(0.0, |(last, first)| last - first)
    }

    /// Sampling rate, Hz: one over the median step of time, so that single gaps do not matter. NaN for fewer than two
    /// samples.
    pub fn rate_hz(&self) -> f64 {
        let mut steps: Vec<f64> = self.time.windows(2).map(|pair| pair[1] - pair[0]).collect();
        if steps.is_empty() {
            return f64::NAN;
        }
        let middle = steps.len() / 2;
        let even = steps.len().is_multiple_of(2);
        let (below, &mut high, _) = steps.select_nth_unstable_by(middle, f64::total_cmp);
        let low = if even { below.iter().copied().max_by(f64::total_cmp).unwrap_or(high) } else { high };
        1.0 / (low + 0.5 * (high - low))
    }

    /// The samples of `range`, with everything known about the whole.
    ///
    /// # Panics
    /// If `range` reaches beyond the last sample.
    pub fn slice(&self, range: Range<usize>) -> Self {
        Recording {
            robot: self.robot.clone(),
            joints: self.joints.clone(),
            time: self.time[range.clone()].to_vec(),
            q: cut(&self.q, &range),
            qd: self.qd.as_ref().map(|table| cut(table, &range)),
            qdd: self.qdd.as_ref().map(|table| cut(table, &range)),
            tau: cut(&self.tau, &range),
            truth: self.truth.as_ref().map(|signals| Arc::new(signals.slice(range))),
            provenance: self.provenance.clone(),
        }
    }

    /// The samples that are not `left_out`. Simulated truth, which belongs to all of them, is dropped.
    pub(crate) fn without_rows(&self, left_out: &[bool]) -> Self {
        let kept = |signal: &[f64]| -> Vec<f64> {
            signal.iter().zip(left_out).filter(|(_, left_out)| !**left_out).map(|(value, _)| *value).collect()
        };
        let table = |channels: &Channels| channels.map(|_, signal| kept(signal));
        Recording {
            robot: self.robot.clone(),
            joints: self.joints.clone(),
            time: kept(&self.time),
            q: table(&self.q),
            qd: self.qd.as_ref().map(table),
            qdd: self.qdd.as_ref().map(table),
            tau: table(&self.tau),
            truth: None,
            provenance: self.provenance.clone(),
        }
    }

    /// The samples whose time, s, lies in `range`: `time_slice(0.0..10.0)` is the first ten seconds without the sample
    /// at 10 s. Times stay as they are. No sample may be left.
    pub fn time_slice(&self, range: impl RangeBounds<f64>) -> Self {
        let first = self.time.iter().position(|time| range.contains(time)).unwrap_or(0);
        let end = self.time.iter().rposition(|time| range.contains(time)).map_or(0, |last| last + 1);
        self.slice(first..end)
    }
}

/// Whether a channel holds numbers: one without is not a number at every sample.
fn has_values(table: Option<&Channels>, joint: usize) -> bool {
    table.is_some_and(|table| table.channel(joint).first().is_some_and(|value| value.is_finite()))
}

fn cut(table: &Channels, range: &Range<usize>) -> Channels {
    table.map(|_, signal| signal[range.clone()].to_vec())
}

#[cfg(test)]
mod tests {
    use crate::recording::samples;

    #[test]
    fn rate_is_the_median_and_ignores_a_gap() {
        let mut recording = samples::full(2, 6);
        recording.time = vec![1.0, 1.01, 1.02, 1.03, 5.0, 5.01];
        assert!((recording.rate_hz() - 100.0).abs() < 1e-9, "{}", recording.rate_hz());
        assert!((recording.duration() - 4.01).abs() < 1e-12);
        recording.time = vec![0.0, 0.1, 0.4];
        assert!((recording.rate_hz() - 5.0).abs() < 1e-12);
    }

    #[test]
    fn too_few_samples_have_no_rate_and_no_duration() {
        for samples in 0..2 {
            let recording = samples::full(1, samples);
            assert!(recording.rate_hz().is_nan());
            assert_eq!(recording.duration(), 0.0);
        }
    }

    #[test]
    fn time_slice_cuts_every_signal_at_the_same_samples() {
        let recording = samples::full(3, 10);
        let part = recording.time_slice(recording.time[2]..recording.time[6]);
        assert_eq!(part.time, recording.time[2..6]);
        assert_eq!((part.joints(), part.samples()), (3, 4));
        let truth = part.truth.as_ref().unwrap();
        let whole = recording.truth.as_ref().unwrap();
        for joint in 0..3 {
            assert_eq!(part.q.channel(joint), &recording.q.channel(joint)[2..6]);
            assert_eq!(part.tau.channel(joint), &recording.tau.channel(joint)[2..6]);
            assert_eq!(truth.qdd.channel(joint), &whole.qdd.channel(joint)[2..6]);
        }
        assert_eq!(part.provenance, recording.provenance);
        assert_eq!(recording.time_slice(..), recording);
        assert_eq!(recording.time_slice(recording.time[8]..=recording.time[9]).samples(), 2);
        assert_eq!(recording.time_slice(1e6..2e6).samples(), 0);
    }
}
