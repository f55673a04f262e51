//! Sensors: encoders with resolution and noise, tachometers, torque measurement with white or correlated noise.

use crate::channels::Channels;
use crate::lane::{Kernel, Lane, Lanes};
use crate::random::{self, Normals};

/// What measures one joint.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize)]
pub struct JointSensors {
    /// Step of the encoder, rad at the joint; zero for none.
    pub encoder_resolution: f64,
    /// Standard deviation of white noise on the position before it is quantised, rad.
    pub encoder_noise: f64,
    /// Standard deviation of white noise on the velocity of a tachometer, rad/s; None where there is no tachometer.
    pub tachometer_noise: Option<f64>,
    /// Standard deviation of the torque noise, N m.
    pub torque_noise: f64,
    /// Correlation time of the torque noise, s (first order, autocovariance exp(-|dt| / T)); zero for white noise.
    pub torque_correlation_s: f64,
}

/// Position as the encoders of the joints tell it. `seed` and `run` choose the noise; every joint has a stream of its own.
pub fn encoders(q: &Channels, sensors: &[JointSensors], seed: u64, run: u64) -> Channels {
    let mut out = Channels::zeros(q.channels(), q.samples());
    assert!(sensors.len() >= q.channels(), "every joint has its sensors");
    for (joint, sensor) in sensors.iter().enumerate().take(q.channels()) {
        let signal = out.channel_mut(joint);
        noisy(q.channel(joint), sensor.encoder_noise, normals(seed, "encoder", run, joint), signal);
        if sensor.encoder_resolution > 0.0 {
            Lanes::best().run(Rounding { signal, step: sensor.encoder_resolution });
        }
    }
    out
}

/// A signal with white noise of a standard deviation.
fn noisy(signal: &[f64], noise_std: f64, mut noise: Normals, out: &mut [f64]) {
    noise.fill(out);
    out.iter_mut().zip(signal).for_each(|(out, value)| *out = value + noise_std * *out);
}

/// Rounds a signal to whole steps.
struct Rounding<'a> {
    signal: &'a mut [f64],
    step: f64,
}

impl Kernel for Rounding<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lane>(self) {
        let step = L::splat(self.step);
        for part in self.signal.chunks_mut(L::WIDTH) {
            ((L::load_part(part) / step).round() * step).store_part(part);
        }
    }
}

/// Velocity of one joint as its tachometer tells it.
pub fn tachometer(qd: &[f64], noise_std: f64, seed: u64, run: u64, joint: usize) -> Vec<f64> {
    let mut out = vec![0.0; qd.len()];
    noisy(qd, noise_std, normals(seed, "tachometer", run, joint), &mut out);
    out
}

/// Torque as measured, sampled every `period_s`.
pub fn torque(tau: &Channels, sensors: &[JointSensors], period_s: f64, seed: u64, run: u64) -> Channels {
    let mut out = Channels::zeros(tau.channels(), tau.samples());
    assert!(sensors.len() >= tau.channels(), "every joint has its sensors");
    for (joint, sensor) in sensors.iter().enumerate().take(tau.channels()) {
        let JointSensors { torque_noise, torque_correlation_s, .. } = *sensor;
        let (signal, own) = (tau.channel(joint), out.channel_mut(joint));
        let mut noise = normals(seed, "torque", run, joint);
        if torque_correlation_s > 0.0 {
            let memory = (-period_s / torque_correlation_s).exp();
            let renewal = (1.0 - memory * memory).sqrt();
            noise.fill(own);
            // Started from its stationary distribution, so that the first samples are like all others.
            let mut state = own.first().copied().unwrap_or(0.0);
            for (sample, (own, value)) in own.iter_mut().zip(signal).enumerate() {
                if sample > 0 {
                    state = memory * state + renewal * *own;
                }
                *own = value + torque_noise * state;
            }
        } else {
            noisy(signal, torque_noise, noise, own);
        }
    }
    out
}

/// The noise of one sensor: runs and joints never share numbers.
fn normals(seed: u64, sensor: &str, run: u64, joint: usize) -> Normals {
    random::normals(seed, &format!("{sensor} of joint {joint}"), run)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spread(values: &[f64]) -> f64 {
        (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt()
    }

    #[test]
    fn encoders_round_to_their_resolution() {
        let q = Channels::from_vectors(&[vec![0.1234, -0.1234, 0.0]]);
        let sensors = [JointSensors { encoder_resolution: 0.01, ..Default::default() }];
        let measured = encoders(&q, &sensors, 1, 0);
        for (value, expected) in measured.channel(0).iter().zip([0.12, -0.12, 0.0]) {
            assert!((value - expected).abs() < 1e-12);
        }
    }

    #[test]
    fn correlated_noise_has_its_size_and_its_memory() {
        let (size, time, period) = (3.0, 0.05, 0.002);
        let quiet = Channels::zeros(1, 200_000);
        let sensors = [JointSensors { torque_noise: size, torque_correlation_s: time, ..Default::default() }];
        let noise = torque(&quiet, &sensors, period, 7, 0);
        let noise = noise.channel(0);
        assert!((spread(noise) / size - 1.0).abs() < 0.03, "{}", spread(noise));
        let lag = 25;
        let covariance: f64 =
            noise.iter().zip(&noise[lag..]).map(|(a, b)| a * b).sum::<f64>() / (noise.len() - lag) as f64;
        let expected = size * size * (-(lag as f64) * period / time).exp();
        assert!((covariance / expected - 1.0).abs() < 0.1, "{covariance} {expected}");
    }

    #[test]
    fn joints_runs_and_sensors_have_independent_noise() {
        let quiet = Channels::zeros(2, 8);
        let sensors = [JointSensors { torque_noise: 1.0, encoder_noise: 1.0, ..Default::default() }; 2];
        let first = torque(&quiet, &sensors, 0.001, 1, 0);
        assert_eq!(first, torque(&quiet, &sensors, 0.001, 1, 0));
        assert_ne!(first.channel(0), first.channel(1));
        assert_ne!(first, torque(&quiet, &sensors, 0.001, 1, 1));
        assert_ne!(first, torque(&quiet, &sensors, 0.001, 2, 0));
        assert_ne!(first, encoders(&quiet, &sensors, 1, 0));
    }
}
