//! Sensors: encoders with resolution and noise, tachometers, torque measurement with white or correlated noise.

use crate::channels::Channels;
use crate::internal::lane::Kernel;
use crate::lane::{Lane, Lanes};
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

/// Position as the encoders of the joints measure it. `seed` and `run` choose the noise; every joint has a stream of its own.
pub(crate) fn encoders(q: &Channels, sensors: &[JointSensors], seed: u64, run: u64) -> Channels {
    assert!(sensors.len() >= q.channels(), "every joint has its sensors");
    Channels::appended(q.channels(), q.samples(), |joint, out| {
        let JointSensors { encoder_noise, encoder_resolution, .. } = sensors[joint];
        let noise = white(normals(seed, "encoder", run, joint));
        measure(q.channel(joint), encoder_noise, noise, encoder_resolution, out);
    })
}

/// Samples of a signal whose noise is drawn at once: few enough to stay in the nearest cache.
const PART: usize = 512;

/// Appends a signal to `out` with noise of a standard deviation, rounded to whole steps where `step` is not zero. Part by part
/// `noise` fills in what is added, of unit standard deviation.
fn measure(signal: &[f64], std: f64, mut noise: impl FnMut(&mut [f64]), step: f64, out: &mut Vec<f64>) {
    let mut part = [0.0; PART];
    for signal in signal.chunks(PART) {
        let part = &mut part[..signal.len()];
        noise(part);
        Lanes::best().run(Measuring { signal, std, step, part });
        out.extend_from_slice(part);
    }
}

/// Turns noise of unit standard deviation into what is measured.
struct Measuring<'a> {
    signal: &'a [f64],
    std: f64,
    step: f64,
    part: &'a mut [f64],
}

impl Kernel for Measuring<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lane>(self) {
        let (std, step) = (L::splat(self.std), L::splat(self.step));
        for (part, signal) in self.part.chunks_mut(L::WIDTH).zip(self.signal.chunks(L::WIDTH)) {
            let measured = L::load_part(signal) + std * L::load_part(part);
            let rounded = if self.step > 0.0 { (measured / step).round() * step } else { measured };
            rounded.store_part(part);
        }
    }
}

/// White noise.
fn white(mut normals: Normals) -> impl FnMut(&mut [f64]) {
    move |part| normals.fill(part)
}

/// Noise of first order, started from its stationary distribution, so that the first samples are like all others. `memory` is
/// what a sample keeps of the one before it.
fn correlated(memory: f64, mut normals: Normals) -> impl FnMut(&mut [f64]) {
    let renewal = (1.0 - memory * memory).sqrt();
    let mut before = None;
    move |part| {
        normals.fill(part);
        for value in part {
            *value = before.map_or(*value, |before| memory * before + renewal * *value);
            before = Some(*value);
        }
    }
}

/// Velocity of one joint as its tachometer measures it.
pub(crate) fn tachometer(qd: &[f64], noise_std: f64, seed: u64, run: u64, joint: usize) -> Vec<f64> {
    let mut out = Vec::with_capacity(qd.len());
    measure(qd, noise_std, white(normals(seed, "tachometer", run, joint)), 0.0, &mut out);
    out
}

/// Torque as measured, sampled every `period_s`.
pub(crate) fn torque(tau: &Channels, sensors: &[JointSensors], period_s: f64, seed: u64, run: u64) -> Channels {
    assert!(sensors.len() >= tau.channels(), "every joint has its sensors");
    Channels::appended(tau.channels(), tau.samples(), |joint, out| {
        let JointSensors { torque_noise, torque_correlation_s, .. } = sensors[joint];
        let (signal, noise) = (tau.channel(joint), normals(seed, "torque", run, joint));
        if torque_correlation_s > 0.0 {
            let memory = (-period_s / torque_correlation_s).exp();
            measure(signal, torque_noise, correlated(memory, noise), 0.0, out);
        } else {
            measure(signal, torque_noise, white(noise), 0.0, out);
        }
    })
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
