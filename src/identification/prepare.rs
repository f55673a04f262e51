//! From a recording to regression rows: smoothing, differentiation, the filter that torque and columns share, the samples
//! to leave out.

use super::least_squares::JointRegression;
use super::model::Model;
use crate::channels::Channels;
use crate::dynamics::Motion;
use crate::error::{Error, Result};
use crate::recording::{Recording, Signals};
use crate::signal::{Edge, Filter, SavitzkyGolay, downsample, first_derivative, second_derivative};

/// How measured signals are smoothed before they enter the regression.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
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
}

/// A recording made ready for a model: the motion, the filter for torque and columns, and which samples count.
#[derive(Debug, Clone)]
pub struct Prepared {
    /// Time, s.
    pub time: Vec<f64>,
    /// The motion as the model sees it, at the rate of the log.
    pub motion: Motion,
    /// Torque, unfiltered.
    pub torque: Channels,
    filter: Filter,
    decimation: usize,
    /// Samples on either side whose values enter a filtered sample.
    reach: usize,
    /// Velocity below which the direction of motion is not certain, rad/s.
    band: f64,
}

/// Makes the measured signals of `recording` ready. `band` is the velocity (rad/s) below which a joint's direction is not certain.
///
/// # Errors
/// If the log is too short for the filter or the window is impossible.
pub fn measured(recording: &Recording, smoothing: Smoothing, band: f64) -> Result<Prepared> {
    let period = 1.0 / recording.rate_hz();
    let q = &recording.q;
    let (motion, filter, decimation, reach) = match smoothing {
        Smoothing::None => {
            let motion = Motion {
                q: q.clone(),
                qd: or_derivative(recording.qd.as_ref(), q, |x, out| first_derivative(x, period, out))?,
                qdd: or_derivative(recording.qdd.as_ref(), q, |x, out| second_derivative(x, period, out))?,
            };
            (motion, Filter::None, 1, 1)
        }
        Smoothing::SavitzkyGolay { window, order, decimation } => {
            let derivative = |degree| -> Result<Channels> {
                let smoother = SavitzkyGolay::new(window, order, degree, period, Edge::Polynomial)?;
                filtered(q, |x, out| smoother.apply(x, out))
            };
            let motion = Motion { q: derivative(0)?, qd: derivative(1)?, qdd: derivative(2)? };
            let filter = Filter::SavitzkyGolay(SavitzkyGolay::new(window, order, 0, period, Edge::Polynomial)?);
            (motion, filter, decimation, window / 2)
        }
    };
    let (time, torque) = (recording.time.clone(), recording.tau.clone());
    Ok(Prepared { time, motion, torque, filter, decimation, reach, band })
}

/// Makes exact signals ready: what identification could do with perfect sensors.
pub fn exact(time: &[f64], signals: &Signals, band: f64) -> Prepared {
    let Signals { q, qd, qdd, tau } = signals.clone();
    Prepared {
        time: time.to_vec(),
        motion: Motion { q, qd, qdd },
        torque: tau,
        filter: Filter::None,
        decimation: 1,
        reach: 0,
        band,
    }
}

impl Prepared {
    /// Regression rows of `model`: torque and columns through the same filter, rows near reversals marked as not valid.
    ///
    /// # Errors
    /// If the log is too short for the filter.
    pub fn regression(&self, model: &Model) -> Result<Vec<JointRegression>> {
        let columns = model.columns(&self.motion, &self.time, 0.0);
        let thinned = |signal: &[f64]| -> Result<Vec<f64>> {
            let mut out = vec![0.0; signal.len()];
            self.filter.apply(signal, &mut out)?;
            downsample(&out, self.decimation)
        };
        columns
            .iter()
            .enumerate()
            .map(|(joint, table)| {
                let table: Vec<Vec<f64>> = table.iter().map(&thinned).collect::<Result<_>>()?;
                Ok(JointRegression {
                    parameters: model.active(joint),
                    columns: Channels::from_vectors(&table),
                    torque: thinned(self.torque.channel(joint))?,
                    valid: self.rows_to_use(joint),
                })
            })
            .collect()
    }

    /// Torque of every joint that base parameters `beta` predict along the motion, unfiltered, `[joint][time]`.
    pub fn predict(&self, model: &Model, beta: &[f64]) -> Channels {
        let torque: Vec<Vec<f64>> = model
            .columns(&self.motion, &self.time, 0.0)
            .iter()
            .enumerate()
            .map(|(joint, table)| {
                let mut tau = vec![0.0; table.samples()];
                for (parameter, column) in model.active(joint).into_iter().zip(table.iter()) {
                    for (value, x) in tau.iter_mut().zip(column) {
                        *value += x * beta[parameter];
                    }
                }
                tau
            })
            .collect();
        Channels::from_vectors(&torque)
    }

    /// Samples at which the direction of `joint` is certain.
    pub fn moving(&self, joint: usize) -> Vec<bool> {
        self.motion.qd.channel(joint).iter().map(|v| v.abs() > self.band).collect()
    }

    /// Rows after decimation all of whose inputs are inside the log and away from reversals.
    fn rows_to_use(&self, joint: usize) -> Vec<bool> {
        let moving = self.moving(joint);
        let mut uncertain_before = vec![0usize; moving.len() + 1];
        for (sample, &ok) in moving.iter().enumerate() {
            uncertain_before[sample + 1] = uncertain_before[sample] + usize::from(!ok);
        }
        (0..moving.len())
            .step_by(self.decimation)
            .map(|sample| {
                sample >= self.reach
                    && sample + self.reach < moving.len()
                    && uncertain_before[sample + self.reach + 1] == uncertain_before[sample - self.reach]
            })
            .collect()
    }
}

fn filtered(input: &Channels, apply: impl Fn(&[f64], &mut [f64]) -> Result<()>) -> Result<Channels> {
    let mut output = Channels::zeros(input.channels(), input.samples());
    for joint in 0..input.channels() {
        apply(input.channel(joint), output.channel_mut(joint))
            .map_err(|e| Error::request(format!("joint {}", joint + 1), e.to_string()))?;
    }
    Ok(output)
}

fn or_derivative(
    measured: Option<&Channels>,
    q: &Channels,
    differentiate: impl Fn(&[f64], &mut [f64]) -> Result<()>,
) -> Result<Channels> {
    measured.map_or_else(|| filtered(q, differentiate), |signal| Ok(signal.clone()))
}
