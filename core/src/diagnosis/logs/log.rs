//! One log made ready for the rows: its motion from smooth positions, its torque, and what passes either.

use super::cutoffs::{clear_of_noise, mostly_noise};
use crate::channels::Channels;
use crate::diagnosis::criteria::Levels;
use crate::dynamics::Motion;
use crate::effects::{BySample, Placed, behind_encoder, sharp};
use crate::error::Result;
use crate::identification::low_passed::{ORDER, block, differentiated, low_passed};
use crate::recording::Recording;
use crate::signal::{Slow, ZeroPhaseLowPass, block_means, first_derivative, noise_floor, smooth_derivatives};
use rayon::prelude::*;
use std::f64::consts::PI;
use std::sync::OnceLock;

/// Length of the low-pass' memory, in periods of its cut-off: the kink of a reversal is smeared over it.
pub(super) const MEMORY: f64 = 1.0;

/// The same at an end of the log at which the arm moves: the filter starts from a motion that it cannot know, and a tiny
/// share of an arm's torque is much against its noise.
pub(super) const MEMORY_OF_ENDS: f64 = 5.0;

/// One log made ready, at its own rate.
#[derive(Debug, Clone)]
pub struct Log {
    /// Time, s.
    pub time: Vec<f64>,
    /// The motion from smooth positions.
    pub motion: Motion,
    /// The motion from positions smoothed no more than their noise requires, where `motion` is smoother.
    pub whole: Option<Motion>,
    /// Measured torque, `[joint][time]`; not a number where it must not be used.
    pub torque: Channels,
    /// Time between samples, s.
    pub period: f64,
    /// The low-pass that the positions of each joint went through.
    pub low_pass: Vec<ZeroPhaseLowPass>,
    /// The low-pass that torque went through before it was logged, if any.
    pub passed: Option<ZeroPhaseLowPass>,
    /// Samples in a block.
    pub block: usize,
    /// Joints whose torque, moved in time, holds so much of the encoders' noise that it attenuates the estimate of a shift.
    pub noisy: Vec<bool>,
    /// Speeds below which each joint is not known to move.
    pub slow: Vec<Slow>,
    /// Standard deviation of the noise of each joint's measured positions, rad or m.
    pub position_noise: Vec<f64>,
    /// Measured positions, rad or m.
    measured: Channels,
    /// The levels that say what is motion and what an encoder's noise.
    levels: Levels,
    /// [`Log::clear`], once it has been computed.
    clear: OnceLock<Motion>,
    /// [`Log::sharp`], once it has been computed.
    sharp: OnceLock<Motion>,
    /// [`Log::noise_from_hz`], once it has been computed.
    noise_from_hz: OnceLock<Vec<f64>>,
    /// [`Log::by_sample`], once it has been worked out.
    by_sample: OnceLock<BySample>,
}

impl Log {
    /// A log with the positions of each joint smoothed at its own cut-off, Hz, and at `whole_hz` where that is higher; `passed` is the
    /// low-pass that the torque went through.
    ///
    /// # Errors
    /// If the log is too short; the joint is named.
    pub fn new(
        recording: &Recording,
        (cutoffs_hz, whole_hz): (&[f64], f64),
        passed: Option<ZeroPhaseLowPass>,
        levels: &Levels,
    ) -> Result<Self> {
        let rate = recording.rate_hz();
        let (motion, low_pass) = smooth(recording, cutoffs_hz)?;
        let is_smoother = cutoffs_hz.iter().any(|hz| *hz < whole_hz);
        let whole = if is_smoother { Some(smooth(recording, &vec![whole_hz; cutoffs_hz.len()])?.0) } else { None };
        let position_noise: Vec<f64> = recording.q.iter().map(noise_floor).collect();
        let slow = (0..recording.joints()).map(|joint| {
            let noise = position_noise[joint] * velocity_gain(cutoffs_hz[joint], rate);
            Slow::new(motion.qd.channel(joint), noise)
        });
        Ok(Log {
            slow: slow.collect(),
            position_noise,
            time: recording.time.clone(),
            motion,
            whole,
            torque: recording.tau.clone(),
            period: 1.0 / rate,
            low_pass,
            passed,
            block: block(rate),
            noisy: vec![false; recording.joints()],
            measured: recording.q.clone(),
            levels: *levels,
            clear: OnceLock::new(),
            sharp: OnceLock::new(),
            noise_from_hz: OnceLock::new(),
            by_sample: OnceLock::new(),
        })
    }

    /// [`Log::motion`] sample by sample.
    pub(crate) fn by_sample(&self) -> &BySample {
        self.by_sample.get_or_init(|| BySample::of(&self.motion))
    }

    /// The motion where effects of the encoders are behind what these read, if they put errors into any position: errors are taken out
    /// of what was measured, before it is smoothed.
    ///
    /// # Errors
    /// If there are too few samples to differentiate.
    pub(crate) fn behind_encoders(&self, placed: &[Placed]) -> Result<Option<Motion>> {
        let mut motion = None;
        for joint in 0..self.measured.channels() {
            let sensors = placed.iter().filter(|one| one.sensed(self.measured.channels()).contains(&joint));
            let Some(mut behind) = behind_encoder(sensors, self.measured.channel(joint)) else { continue };
            self.low_pass[joint].apply_in_place(&mut behind)?;
            let Motion { q, qd, qdd } = motion.get_or_insert_with(|| self.motion.clone());
            smooth_derivatives(&behind, self.period, qd.channel_mut(joint), qdd.channel_mut(joint))?;
            q.channel_mut(joint).copy_from_slice(&behind);
        }
        Ok(motion)
    }

    /// The motion with its positions smoothed once more.
    ///
    /// # Errors
    /// If there are too few samples to differentiate.
    pub(crate) fn smoothed_again(&self) -> Result<Motion> {
        let mut q = self.motion.q.clone();
        for (joint, low_pass) in self.low_pass.iter().enumerate() {
            low_pass.apply_in_place(q.channel_mut(joint))?;
        }
        differentiated(q, self.period)
    }

    /// The motion with accelerations that stand clear of the encoder's noise. Near the ends, where so slow a low-pass knows too little,
    /// they are those of [`Log::motion`].
    ///
    /// # Errors
    /// If there are too few samples for the filters.
    pub fn clear(&self) -> Result<&Motion> {
        if let Some(clear) = self.clear.get() {
            return Ok(clear);
        }
        let mut clear = self.motion.clone();
        let (rate_hz, last) = (1.0 / self.period, self.time.len() - 1);
        for joint in 0..clear.joints() {
            let hz = clear_of_noise(self.measured.channel(joint), rate_hz, self.levels.clear())?;
            let slow = clear.qdd.channel_mut(joint);
            ZeroPhaseLowPass::new(ORDER, hz, rate_hz)?.apply_in_place(slow)?;
            for (sample, (slow, all)) in slow.iter_mut().zip(self.motion.qdd.channel(joint)).enumerate() {
                let periods = sample.min(last - sample) as f64 * self.period * hz;
                let known = ((periods - MEMORY) / (MEMORY_OF_ENDS - MEMORY)).clamp(0.0, 1.0);
                *slow += 0.5 * (1.0 + (PI * known).cos()) * (all - *slow);
            }
        }
        Ok(self.clear.get_or_init(|| clear))
    }

    /// The motion hardly smoothed, along which play is followed.
    ///
    /// # Errors
    /// If there are too few samples for the filter.
    pub fn sharp(&self) -> Result<&Motion> {
        if let Some(sharp) = self.sharp.get() {
            return Ok(sharp);
        }
        let motion = sharp(&self.measured, self.period)?;
        Ok(self.sharp.get_or_init(|| motion))
    }

    /// The frequency above which the measured position of each joint is mostly noise, Hz.
    ///
    /// # Errors
    /// If there are too few samples for the filters.
    pub(crate) fn noise_from_hz(&self) -> Result<&[f64]> {
        if let Some(noise_from_hz) = self.noise_from_hz.get() {
            return Ok(noise_from_hz);
        }
        let of_joint = |joint| mostly_noise(self.measured.channel(joint), 1.0 / self.period, self.levels.stands_out);
        let all = (0..self.measured.channels()).into_par_iter().map(of_joint).collect::<Result<Vec<f64>>>()?;
        Ok(self.noise_from_hz.get_or_init(|| all))
    }

    /// What the measured position of a joint holds above the frequency from which it is mostly noise, and its rate; zero where that
    /// is far more than usual, which is motion, near the ends, where a low-pass knows too little, and where that frequency is not below
    /// `seen_hz`.
    ///
    /// # Errors
    /// If there are too few samples for the filters.
    pub(crate) fn above_motion(&self, joint: usize, seen_hz: f64) -> Result<[Vec<f64>; 2]> {
        let (measured, rate_hz) = (self.measured.channel(joint), 1.0 / self.period);
        let hz = self.noise_from_hz()?[joint];
        if hz >= seen_hz {
            return Ok([0, 1].map(|_| vec![0.0; measured.len()]));
        }
        let mut motion = vec![0.0; measured.len()];
        ZeroPhaseLowPass::new(ORDER, hz, rate_hz)?.apply(measured, &mut motion)?;
        let mut above: Vec<f64> = measured.iter().zip(&motion).map(|(q, slow)| q - slow).collect();
        let mut rate = vec![0.0; above.len()];
        first_derivative(&above, self.period, &mut rate)?;
        let mut sizes: Vec<f64> = above.iter().map(|x| x.abs()).collect();
        let middle = sizes.len() / 2;
        let usual = sizes.select_nth_unstable_by(middle, f64::total_cmp).1.to_owned();
        let (settled, last) = ((MEMORY_OF_ENDS / hz * rate_hz) as usize, above.len().saturating_sub(1));
        for (k, (above, rate)) in above.iter_mut().zip(&mut rate).enumerate() {
            if above.abs() > self.levels.stands_out * usual || k.min(last - k) < settled {
                (*above, *rate) = (0.0, 0.0);
            }
        }
        Ok([above, rate])
    }

    /// Moves one measured position.
    #[cfg(test)]
    pub(crate) fn knock(&mut self, joint: usize, sample: usize, by: f64) {
        self.measured.channel_mut(joint)[sample] += by;
        self.noise_from_hz.take();
    }

    /// Means over the blocks of a signal of this log.
    pub fn blocks(&self, signal: &[f64]) -> Vec<f64> {
        block_means(signal, self.block).unwrap_or_default()
    }

    /// Means over the blocks of a part of the torque, as it would have been logged: through the low-pass that the torque went
    /// through.
    pub(crate) fn as_logged(&self, torque: &[f64]) -> Vec<f64> {
        let Some(passed) = &self.passed else { return self.blocks(torque) };
        let mut logged = vec![0.0; torque.len()];
        match passed.apply(torque, &mut logged) {
            Ok(()) => self.blocks(&logged),
            // No log is so short that made it here.
            Err(_) => self.blocks(torque),
        }
    }
}

/// Standard deviation of a velocity for unit white noise in the positions, which pass a steep low-pass: its power in a band grows with
/// the square of the frequency.
fn velocity_gain(cutoff_hz: f64, rate_hz: f64) -> f64 {
    2.0 * PI * (2.0 * cutoff_hz.powi(3) / (3.0 * rate_hz)).sqrt()
}

/// The motion of a log with the positions of each joint smoothed by a low-pass, which is returned too.
fn smooth(recording: &Recording, cutoffs_hz: &[f64]) -> Result<(Motion, Vec<ZeroPhaseLowPass>)> {
    let low_pass = |&hz: &f64| ZeroPhaseLowPass::new(ORDER, hz, recording.rate_hz());
    let low_pass: Vec<ZeroPhaseLowPass> = cutoffs_hz.iter().map(low_pass).collect::<Result<_>>()?;
    Ok((low_passed(recording, &low_pass)?, low_pass))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::logs::cutoffs::tests::{RATE, swing};
    use crate::diagnosis::logs::rows::{FEWEST_ROWS, Rows};

    #[test]
    fn noise_of_a_velocity_is_that_of_its_positions_through_the_low_pass() {
        let q = Channels::from_vectors(&[swing(0.4, 0.0)]);
        let (time, tau) = ((0..10_000).map(|k| f64::from(k) / RATE).collect(), Channels::zeros(1, 10_000));
        let recording = Recording { joints: vec!["a".into()], time, q, tau, ..Default::default() };
        let log = Log::new(&recording, (&[10.0], 10.0), None, &Levels::default()).unwrap();
        let rate = 2.0 * PI * 0.4;
        let error = |k: usize| log.motion.qd.channel(0)[k] - rate * (rate * k as f64 / RATE).cos();
        let real = ((1000..9000).map(|k| error(k).powi(2)).sum::<f64>() / 8000.0).sqrt();
        let noise = log.position_noise[0];
        assert!((noise / 1.5e-5 - 1.0).abs() < 0.1, "{noise}");
        let found = noise * velocity_gain(10.0, RATE);
        assert!((found / real - 1.0).abs() < 0.2, "{found} {real}");
    }

    #[test]
    fn clear_accelerations_are_those_of_the_motion() {
        let q = Channels::from_vectors(&[swing(0.4, 0.0)]);
        let (time, tau) = ((0..10_000).map(|k| f64::from(k) / RATE).collect(), Channels::zeros(1, 10_000));
        let log = Recording { joints: vec!["a".into()], time, q, tau, ..Default::default() };
        let rows = Rows::new(&[&log], 20.0, FEWEST_ROWS).unwrap();
        let (own, clear) = (&rows.logs[0].motion, rows.logs[0].clear().unwrap());
        let rate = std::f64::consts::TAU * 0.4;
        let error = |motion: &Motion| {
            let true_at = |k: usize| -rate * rate * (rate * k as f64 / RATE).sin();
            let errors = (1000..9000).map(|k| (motion.qdd.channel(0)[k] - true_at(k)).powi(2));
            (errors.sum::<f64>() / 8000.0).sqrt()
        };
        assert!(error(clear) < 0.03 * error(own), "{} of {}", error(clear), error(own));
        assert_eq!((&clear.q, &clear.qd), (&own.q, &own.qd));
        assert_eq!(clear.qdd.channel(0)[9999], own.qdd.channel(0)[9999]);
    }
}
