//! From a recording to regression rows: smoothing, differentiation, the filter that torque and columns share, the samples
//! to leave out.

use super::bridge::bridged;
use super::low_passed;
use super::reversals::{self, Band};
use crate::channels::Channels;
use crate::dynamics::Motion;
use crate::effects;
use crate::error::{Error, Result};
use crate::identification::model::Model;
use crate::identification::model::linear_model::LinearModel;
use crate::identification::regression::joint_regression::JointRegression;
use crate::recording::{Recording, Signals};
use crate::signal::{
    Edge, Filter, NoiseGains, SavitzkyGolay, Slow, ZeroPhaseLowPass, downsample, first_derivative, second_derivative,
    white_noise,
};
use std::borrow::{Borrow, Cow};
use std::f64::consts::SQRT_2;
use std::ops::Range;
use std::sync::OnceLock;

/// How measured signals are smoothed before they enter the regression.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::identification::prepare::Smoothing;
/// use tauscope::identification::smoothing_choice;
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/payload/arm.urdf", InertiaCheck::Ignored)?;
/// # let log = recording::load("../tests/reference/payload/before.csv", None)?;
///
/// // The window that suits the noise of a log, or a low-pass by its motion.
/// assert!(matches!(smoothing_choice::savitzky_golay(&[&log])?, Smoothing::SavitzkyGolay { order: 6, .. }));
/// let Smoothing::LowPass { cutoff_hz, .. } = smoothing_choice::usual_low_pass(&[&log])? else { unreachable!() };
/// assert!((1.0..5.0).contains(&cutoff_hz));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub enum Smoothing {
    /// Not at all: measured positions, velocities and accelerations (or central differences) as they are.
    None,
    /// Savitzky-Golay: position, velocity and acceleration from one polynomial per window; torque and columns through
    /// the same smoother, then every n-th sample.
    SavitzkyGolay {
        /// Window in samples, odd.
        window: usize,
        /// Polynomial order.
        order: usize,
        /// Every n-th row is used.
        decimation: usize,
    },
    /// Zero-phase Butterworth low-pass of fourth order for torque and columns alike; positions through a wider one,
    /// differences for velocity and acceleration. The choice where a gear or a controller rings above the motion.
    LowPass {
        /// Cut-off frequency, Hz.
        cutoff_hz: f64,
        /// Every n-th row is used.
        decimation: usize,
    },
    /// As `diagnose` prepares logs: positions through a steep zero-phase low-pass, differences of high order for velocity and
    /// acceleration, torque and columns as means over blocks, which leaves white noise white.
    BlockMeans {
        /// Cut-off of the positions, Hz: one of all joints, or one of each.
        cutoffs_hz: Vec<f64>,
        /// Samples in a block.
        block: usize,
    },
}

impl Smoothing {
    /// Samples from one row to the next.
    pub fn decimation(&self) -> usize {
        match *self {
            Smoothing::None => 1,
            Smoothing::SavitzkyGolay { decimation, .. } | Smoothing::LowPass { decimation, .. } => decimation,
            Smoothing::BlockMeans { block, .. } => block,
        }
    }
}

/// Positions pass up to this multiple of the cut-off: what torque and columns go through must be the narrower filter,
/// else accelerations would be filtered twice where the torque is filtered once.
const POSITION_MARGIN: f64 = 4.0;

/// Order of the low-pass of [`Smoothing::LowPass`], in each direction.
pub(crate) const LOW_PASS_ORDER: usize = 4;

/// Cut-off of the positions, Hz, where torque and columns go through [`Smoothing::LowPass`] with a cut-off.
pub fn position_cutoff_hz(cutoff_hz: f64, rate_hz: f64) -> f64 {
    /// Closer to half the rate the filter has no room to fall.
    const HIGHEST_SHARE: f64 = 0.45;
    (POSITION_MARGIN * cutoff_hz).min(HIGHEST_SHARE * rate_hz)
}

/// A recording made ready for a model: the motion, the filter for torque and columns, and which samples count. What it takes
/// over as it is stays in the recording.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::identification::model::Model;
/// use tauscope::identification::prepare::{self, Smoothing};
/// use tauscope::identification::reversals::Band;
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/payload/arm.urdf", InertiaCheck::Ignored)?;
/// # let log = recording::load("../tests/reference/payload/before.csv", None)?;
///
/// // Every fourth sample is a row; columns go through the same filter as the torque.
/// let smoothing = Smoothing::SavitzkyGolay { window: 11, order: 4, decimation: 4 };
/// let prepared = prepare::measured(&log, &smoothing, Band::OfNoise)?;
/// let rows = prepared.regression(&Model::new(&robot))?;
/// assert_eq!((prepared.motion.samples(), rows.len()), (800, 5));
///
/// // Near reversals the direction of a joint is not certain.
/// assert!(prepared.moving(1).iter().any(|moves| !moves));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Prepared<'a> {
    /// Names of the joints.
    joints: Vec<String>,
    /// Time, s.
    pub time: Cow<'a, [f64]>,
    /// The motion as the model sees it, at the rate of the log.
    pub motion: Motion,
    /// [`Prepared::sharp`], once it has been computed.
    sharp: OnceLock<Motion>,
    /// Torque, unfiltered; bridged where it was not measured.
    pub torque: Cow<'a, Channels>,
    /// Samples without torque, of each joint.
    unmeasured: Vec<Vec<Range<usize>>>,
    filter: Filter,
    /// The filter that the positions of each joint went through.
    position_filters: Vec<Filter>,
    decimation: usize,
    /// Samples on either side whose values enter a filtered sample.
    reach: usize,
    /// Whether the rows of each joint that see a quick reversal or slow motion are used.
    quick: Vec<bool>,
    /// Speed below which the direction of each joint is not certain, rad/s or m/s.
    slow: Vec<Slow>,
    /// Sizes of the weights of the samples that enter a filtered one.
    weights: Vec<f64>,
}

/// Makes the measured signals of `recording` ready. `band` is the speed below which a joint's direction is not certain.
///
/// # Errors
/// If the log is too short for the filter, the window is impossible, or there is another number of cut-offs than of joints.
pub fn measured(
    recording: &Recording,
    smoothing: impl Borrow<Smoothing>,
    band: impl Into<Band>,
) -> Result<Prepared<'_>> {
    let (smoothing, band) = (smoothing.borrow(), band.into());
    let period = 1.0 / recording.rate_hz();
    let (q, joints) = (&recording.q, &recording.joints);
    let alike = |filter: Filter| vec![filter; joints.len()];
    let (motion, filter, position_filters, decimation, reach) = match *smoothing {
        Smoothing::None => {
            let motion = Motion {
                q: q.clone(),
                qd: or_derivative(recording.qd.as_ref(), q, joints, |x, out| first_derivative(x, period, out))?,
                qdd: or_derivative(recording.qdd.as_ref(), q, joints, |x, out| second_derivative(x, period, out))?,
            };
            (motion, Filter::None, alike(Filter::None), 1, 1)
        }
        Smoothing::SavitzkyGolay { window, order, decimation } => {
            SavitzkyGolay::check_window(window, q.samples())?;
            let smoother = |degree| SavitzkyGolay::new(window, order, degree, period, Edge::Polynomial);
            let filters = [smoother(0)?, smoother(1)?, smoother(2)?];
            let mut motion = Motion::zeros(q.channels(), q.samples());
            for (joint, name) in joints.iter().enumerate() {
                let Motion { q: smooth, qd, qdd } = &mut motion;
                let output = [smooth, qd, qdd].map(|channels| channels.channel_mut(joint));
                SavitzkyGolay::apply_three(filters.each_ref(), q.channel(joint), output)
                    .map_err(|e| Error::request(name.as_str(), e.to_string()))?;
            }
            let [filter, ..] = filters;
            let filter = Filter::SavitzkyGolay(filter);
            (motion, filter.clone(), alike(filter), decimation, window / 2)
        }
        Smoothing::LowPass { cutoff_hz, decimation } => {
            let low_pass = ZeroPhaseLowPass::new(LOW_PASS_ORDER, cutoff_hz, recording.rate_hz())?;
            let wide = position_cutoff_hz(cutoff_hz, recording.rate_hz());
            let wide = ZeroPhaseLowPass::new(LOW_PASS_ORDER, wide, recording.rate_hz())?;
            let smooth = filtered(q, joints, |x, out| wide.apply(x, out))?;
            let motion = Motion {
                qd: filtered(&smooth, joints, |x, out| first_derivative(x, period, out))?,
                qdd: filtered(&smooth, joints, |x, out| second_derivative(x, period, out))?,
                q: smooth,
            };
            // The response has died away after about one period of the cut-off.
            let reach = (recording.rate_hz() / cutoff_hz).ceil() as usize;
            (motion, Filter::LowPass(low_pass), alike(Filter::LowPass(wide)), decimation, reach)
        }
        Smoothing::BlockMeans { ref cutoffs_hz, block } => {
            let low_passes = low_passed::low_passes(cutoffs_hz, recording)?;
            let motion = low_passed::low_passed(recording, &low_passes)?;
            let filter = Filter::Means(block);
            let reach = filter.reach().unwrap_or_default();
            (motion, filter, low_passes.into_iter().map(Filter::LowPass).collect(), block, reach)
        }
    };
    let (slow, weights) = match band {
        Band::Given(speed) => (vec![Slow::given(speed); recording.joints()], Vec::new()),
        Band::OfNoise => (
            own_bands(recording, &motion, smoothing, &position_filters)?,
            reversals::weights(&filter, reach, recording.samples())?,
        ),
    };
    let (torque, unmeasured) = bridged(&recording.tau);
    Ok(Prepared {
        joints: recording.joints.clone(),
        time: Cow::Borrowed(&recording.time),
        motion,
        sharp: OnceLock::new(),
        torque,
        unmeasured,
        filter,
        position_filters,
        decimation,
        reach,
        quick: vec![band == Band::OfNoise; recording.joints()],
        slow,
        weights,
    })
}

/// Speed below which the direction of each joint is not certain, from the noise of its velocity.
fn own_bands(recording: &Recording, motion: &Motion, smoothing: &Smoothing, filters: &[Filter]) -> Result<Vec<Slow>> {
    let period = 1.0 / recording.rate_hz();
    let gains_of = |filter: &Filter| {
        NoiseGains::new(recording.samples(), |impulse| {
            let [mut smooth, mut rate] = [impulse.to_vec(), impulse.to_vec()];
            filter.apply(impulse, &mut smooth)?;
            match *smoothing {
                Smoothing::SavitzkyGolay { window, order, .. } => {
                    SavitzkyGolay::new(window, order, 1, period, Edge::Polynomial)?.apply(impulse, &mut rate)?;
                }
                Smoothing::None | Smoothing::LowPass { .. } | Smoothing::BlockMeans { .. } => {
                    first_derivative(&smooth, period, &mut rate)?;
                }
            }
            Ok([smooth, rate])
        })
    };
    // Joints with one filter have one answer.
    let mut gains: Vec<NoiseGains> = Vec::with_capacity(filters.len());
    for (joint, filter) in filters.iter().enumerate() {
        let same = filters[..joint].iter().position(|other| other == filter);
        gains.push(same.map_or_else(|| gains_of(filter), |other| Ok(gains[other]))?);
    }
    let velocity = |joint| recording.qd.as_ref().filter(|_| recording.has_velocity(joint));
    let noise = |joint: usize| match (smoothing, velocity(joint)) {
        (Smoothing::None, Some(measured)) => white_noise(measured.channel(joint)),
        // Central differences of white noise.
        (Smoothing::None, None) => white_noise(recording.q.channel(joint)) / (SQRT_2 * period),
        _ => gains[joint].velocity_noise(recording.q.channel(joint), motion.q.channel(joint)),
    };
    Ok((0..recording.joints()).map(|joint| Slow::new(motion.qd.channel(joint), noise(joint))).collect())
}

/// Makes exact signals ready: what identification could do with perfect sensors.
pub fn exact<'a>(time: &'a [f64], signals: &'a Signals, band: f64) -> Prepared<'a> {
    let Signals { q, qd, qdd, tau } = signals;
    Prepared {
        joints: (1..=q.channels()).map(|joint| format!("joint {joint}")).collect(),
        time: Cow::Borrowed(time),
        motion: Motion { q: q.clone(), qd: qd.clone(), qdd: qdd.clone() },
        sharp: OnceLock::new(),
        torque: Cow::Borrowed(tau),
        unmeasured: vec![Vec::new(); q.channels()],
        filter: Filter::None,
        position_filters: vec![Filter::None; q.channels()],
        decimation: 1,
        reach: 0,
        quick: vec![false; q.channels()],
        slow: vec![Slow::given(band); q.channels()],
        weights: Vec::new(),
    }
}

impl<'a> Prepared<'a> {
    /// The same torque and filter along another motion over the same times, as a simulation gives it: its columns, and the
    /// valid rows, are those of that motion.
    ///
    /// # Panics
    /// If the motion has another number of samples.
    pub fn along(&self, motion: Motion) -> Prepared<'a> {
        assert_eq!(motion.samples(), self.time.len(), "the motion must be over the same times");
        Prepared { motion, ..self.clone() }
    }

    /// The same with only every n-th row used; 0 counts as 1.
    pub fn every(self, decimation: usize) -> Self {
        Prepared { decimation: decimation.max(1), ..self }
    }

    /// Regression rows of `model`: torque and columns through the same filter, rows near reversals marked as not valid.
    ///
    /// # Errors
    /// If the log is too short for the filter.
    pub fn regression(&self, model: &impl LinearModel) -> Result<Vec<JointRegression>> {
        let tables = model.filtered_columns(&self.motion, &self.time, &self.filter, self.decimation)?;
        tables
            .into_iter()
            .enumerate()
            .map(|(joint, columns)| {
                Ok(JointRegression {
                    joint: self.joints[joint].clone(),
                    parameters: model.active(joint),
                    columns,
                    torque: self.thinned(self.torque.channel(joint))?,
                    valid: self.rows_to_use(joint),
                })
            })
            .collect()
    }

    /// The motion along which play is followed, from the positions of the log that this was made from. A fit asks for it at every step.
    ///
    /// # Errors
    /// If the log is too short for the filters.
    pub(in crate::identification) fn sharp(&self, log: &Recording) -> Result<&Motion> {
        if let Some(sharp) = self.sharp.get() {
            return Ok(sharp);
        }
        let motion = effects::sharp(&log.q, 1.0 / log.rate_hz())?;
        Ok(self.sharp.get_or_init(|| motion))
    }

    /// A signal of a joint through the filter that its positions went through, at the rate of the log.
    ///
    /// # Errors
    /// If the log is too short for the filter.
    pub(in crate::identification) fn filtered_like_positions(&self, joint: usize, signal: &[f64]) -> Result<Vec<f64>> {
        let mut out = vec![0.0; signal.len()];
        self.position_filters[joint].apply(signal, &mut out)?;
        Ok(out)
    }

    /// The columns of `model` as regression rows, `[column][row]` for every joint, where links move as `link`.
    ///
    /// # Errors
    /// If the log is too short for the filter.
    pub(in crate::identification) fn columns(&self, model: &Model, link: &Motion) -> Result<Vec<Channels>> {
        model.filtered_columns_apart([&self.motion, link], &self.filter, self.decimation)
    }

    /// A signal of the log as regression rows: filtered, every n-th sample.
    ///
    /// # Errors
    /// If the log is too short for the filter.
    pub(in crate::identification) fn thinned(&self, signal: &[f64]) -> Result<Vec<f64>> {
        self.filter.apply_every(signal, self.decimation)
    }

    /// Time of every regression row, s.
    ///
    /// # Errors
    /// Never for a decimation that is positive.
    pub(in crate::identification) fn row_times(&self) -> Result<Vec<f64>> {
        self.place(&self.time)
    }

    /// Position and velocity of a joint at every regression row.
    ///
    /// # Errors
    /// Never for a decimation that is positive.
    pub(in crate::identification) fn row_motion(&self, joint: usize) -> Result<[Vec<f64>; 2]> {
        Ok([self.place(self.motion.q.channel(joint))?, self.place(self.motion.qd.channel(joint))?])
    }

    /// What a signal is where each regression row stands: at one sample, or the mean over its block.
    fn place(&self, signal: &[f64]) -> Result<Vec<f64>> {
        match self.filter {
            Filter::Means(_) => self.thinned(signal),
            _ => downsample(signal, self.decimation),
        }
    }

    /// Standard deviation of the white noise in the filtered torque of every joint.
    ///
    /// # Errors
    /// If the log is too short for the filter.
    pub(in crate::identification) fn torque_noise(&self) -> Result<Vec<f64>> {
        let gain = self.filter.noise_gain(self.torque.samples())?;
        Ok((0..self.torque.channels()).map(|joint| gain * white_noise(self.torque.channel(joint))).collect())
    }

    /// Torque of every joint that the parameters `beta` predict along the motion, unfiltered, `[joint][time]`.
    pub fn predict(&self, model: &impl LinearModel, beta: &[f64]) -> Channels {
        model.torque(&self.motion, &self.time, beta)
    }

    /// The torque through the filter that regression rows go through, at the rate of the log.
    ///
    /// # Errors
    /// If the log is too short for the filter.
    pub fn filtered_torque(&self) -> Result<Channels> {
        filtered(&self.torque, &self.joints, |signal, out| self.filter.apply(signal, out))
    }

    /// Samples at which the direction of `joint` is certain.
    pub fn moving(&self, joint: usize) -> Vec<bool> {
        self.slow[joint].moving(self.motion.qd.channel(joint), 2 * self.reach + 1)
    }

    /// Rows after decimation all of whose inputs are inside the log, and whose torque was measured and direction is certain.
    pub(in crate::identification) fn rows_to_use(&self, joint: usize) -> Vec<bool> {
        self.rows_of(joint, self.quick[joint])
    }

    /// Those of them that see a reversal or slow motion.
    pub(in crate::identification) fn rows_at_reversals(&self, joint: usize) -> Vec<bool> {
        let mut rows = self.rows_to_use(joint);
        rows.iter_mut().zip(self.rows_of(joint, false)).for_each(|(row, clear)| *row &= !clear);
        rows
    }

    fn rows_of(&self, joint: usize, quick: bool) -> Vec<bool> {
        let moving = match quick {
            true => self.moving(joint),
            false => self.motion.qd.channel(joint).iter().map(|v| v.abs() > self.slow[joint].sure).collect(),
        };
        let mut rows = reversals::rows_to_use(&moving, (self.reach, &self.weights), self.decimation, quick);
        for samples in &self.unmeasured[joint] {
            let first = samples.start.saturating_sub(self.reach).div_ceil(self.decimation);
            let behind = (samples.end + self.reach).div_ceil(self.decimation).min(rows.len());
            rows[first.min(behind)..behind].fill(false);
        }
        rows
    }

    /// With the choice of rows near reversals that `other` has.
    pub(in crate::identification) fn like(mut self, other: &Prepared) -> Self {
        self.quick.clone_from(&other.quick);
        self
    }

    /// Leaves out the rows that see a reversal or slow motion, except on joints where they are to be `kept`.
    pub(in crate::identification) fn keep_reversals(&mut self, kept: &[bool]) {
        self.quick.iter_mut().zip(kept).for_each(|(quick, kept)| *quick &= kept);
    }
}

fn filtered(input: &Channels, joints: &[String], apply: impl Fn(&[f64], &mut [f64]) -> Result<()>) -> Result<Channels> {
    let mut output = Channels::zeros(input.channels(), input.samples());
    for (joint, name) in joints.iter().enumerate() {
        apply(input.channel(joint), output.channel_mut(joint))
            .map_err(|e| Error::request(name.as_str(), e.to_string()))?;
    }
    Ok(output)
}

fn or_derivative(
    measured: Option<&Channels>,
    q: &Channels,
    joints: &[String],
    differentiate: impl Fn(&[f64], &mut [f64]) -> Result<()>,
) -> Result<Channels> {
    let Some(measured) = measured else { return filtered(q, joints, differentiate) };
    let mut out = measured.clone();
    for joint in (0..joints.len()).filter(|&joint| measured.channel(joint).iter().all(|value| value.is_nan())) {
        differentiate(q.channel(joint), out.channel_mut(joint))
            .map_err(|e| Error::request(joints[joint].as_str(), e.to_string()))?;
    }
    Ok(out)
}
