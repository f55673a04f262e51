//! Which samples of a joint surely move, and which rows see enough of them: friction's sign is the only column that a
//! velocity near zero can get wrong.
//!
//! The sign column goes through the filter of the torque, so a row near a reversal is as good as any other as long as the
//! moment of the reversal is known. It is known to where the velocity exceeds its own noise.

use crate::error::Result;
use crate::signal::Filter;

/// Speed below which the direction of a joint is not certain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Band {
    /// The same for every joint, rad/s or m/s. No row whose filter reaches a slower sample is used.
    Given(f64),
    /// Each joint's own, from the noise of its velocity and its own speed. A row whose filter reaches a quick reversal is
    /// used.
    OfNoise,
}

impl From<f64> for Band {
    fn from(speed: f64) -> Self {
        Band::Given(speed)
    }
}

/// Standard deviations of the velocity's noise within which its sign is not certain: one sign in a thousand is wrong there.
const DEVIATIONS: f64 = 3.0;

/// Share of a joint's own fast speed within which it stands if it stays there for as long as the filter is: a held joint creeps,
/// and stiction gives its friction, not Coulomb's law. A quick reversal passes through.
const STANDING: f64 = 0.05;

/// Share of the largest position that is rounding in positions without noise.
const ROUNDING: f64 = 1e-12;

/// The fast speed is the one that so large a share of the samples stay below; single spikes do not count.
const FAST: f64 = 0.95;

/// Part of the filter's weight in a row that may lie on uncertain samples. The crossing of zero is known to a sixth of the time
/// within the band or so, which gives an error of a hundredth or two in the filtered sign.
const MOST_UNCERTAIN: f64 = 0.05;

/// Samples after which the response to an impulse has died away.
const MOST_RESPONSE: usize = 4096;

/// What the noise of positions becomes in a velocity.
#[derive(Debug, Clone, Copy)]
pub struct NoiseGains {
    /// Standard deviation of what smoothing takes off, for unit white noise in the positions.
    taken: f64,
    /// Standard deviation of the velocity's noise, for the same.
    rate: f64,
}

impl NoiseGains {
    /// Of what makes a smooth position and its velocity from a signal of `samples`.
    ///
    /// # Errors
    /// Those of the filter: there are too few samples for it.
    pub fn new(samples: usize, smooth: impl Fn(&[f64]) -> Result<[Vec<f64>; 2]>) -> Result<Self> {
        let mut impulse = vec![0.0; samples.min(MOST_RESPONSE)];
        if let Some(last) = impulse.len().checked_sub(1) {
            impulse[last / 2] = 1.0;
        }
        let [passed, rate] = smooth(&impulse)?;
        let taken: Vec<f64> = impulse.iter().zip(&passed).map(|(whole, part)| whole - part).collect();
        Ok(NoiseGains { taken: length(&taken), rate: length(&rate) })
    }

    /// Standard deviation of the noise of the velocity that belongs to `smoothed` positions, as far as what was taken off
    /// the measured ones shows it.
    pub fn velocity_noise(&self, measured: &[f64], smoothed: &[f64]) -> f64 {
        if self.taken == 0.0 {
            return 0.0;
        }
        let rest: Vec<f64> = measured.iter().zip(smoothed).map(|(q, smooth)| q - smooth).collect();
        let noise = length(&rest) / (rest.len().max(1) as f64).sqrt() / self.taken;
        let largest = measured.iter().fold(0.0f64, |most, q| most.max(q.abs()));
        noise.max(ROUNDING * largest) * self.rate
    }
}

fn length(signal: &[f64]) -> f64 {
    signal.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Speeds below which a joint is not known to move.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slow {
    /// The direction is not certain at a moment.
    pub uncertain: f64,
    /// The joint stands if it stays below.
    pub standing: f64,
}

impl Slow {
    /// Of a joint with these velocities, whose noise has the standard deviation `noise`.
    pub fn new(velocity: &[f64], noise: f64) -> Self {
        let mut speeds: Vec<f64> = velocity.iter().map(|v| v.abs()).filter(|v| v.is_finite()).collect();
        if speeds.is_empty() {
            return Slow { uncertain: 0.0, standing: 0.0 };
        }
        let place = ((speeds.len() - 1) as f64 * FAST) as usize;
        let fast = *speeds.select_nth_unstable_by(place, f64::total_cmp).1;
        let uncertain = DEVIATIONS * noise;
        Slow { uncertain, standing: uncertain.max(STANDING * fast) }
    }

    /// Samples at which the joint surely moves; it stands where it is slow for `length` samples or more.
    pub fn moving(&self, velocity: &[f64], length: usize) -> Vec<bool> {
        let mut moving: Vec<bool> = velocity.iter().map(|v| v.abs() > self.uncertain).collect();
        let mut start = 0;
        for run in velocity.chunk_by(|a, b| (a.abs() > self.standing) == (b.abs() > self.standing)) {
            if run[0].abs() <= self.standing && run.len() >= length {
                moving[start..start + run.len()].fill(false);
            }
            start += run.len();
        }
        moving
    }
}

/// Sizes of the weights with which a filter takes the `reach` samples on either side of a row, and its own in the middle.
///
/// # Errors
/// Those of the filter: there are too few samples for it.
pub fn weights(filter: &Filter, reach: usize, samples: usize) -> Result<Vec<f64>> {
    let mut impulse = vec![0.0; samples.min(MOST_RESPONSE + 2 * reach)];
    let middle = impulse.len() / 2;
    if middle < reach || middle + reach >= impulse.len() {
        return Ok(Vec::new());
    }
    impulse[middle] = 1.0;
    let mut response = impulse.clone();
    filter.apply(&impulse, &mut response)?;
    Ok(response[middle - reach..=middle + reach].iter().map(|weight| weight.abs()).collect())
}

/// Every `step`-th sample whose row may be used: the filter, which sees `reach` samples to either side with these `weights`, fits
/// into the log, and the direction is certain as far as `band` asks.
pub fn rows_to_use(moving: &[bool], (reach, weights): (usize, &[f64]), step: usize, band: Band) -> Vec<bool> {
    let mut uncertain_before = vec![0usize; moving.len() + 1];
    for (sample, &ok) in moving.iter().enumerate() {
        uncertain_before[sample + 1] = uncertain_before[sample] + usize::from(!ok);
    }
    let is_certain = |sample: usize| {
        let seen = sample - reach..sample + reach + 1;
        if uncertain_before[seen.end] == uncertain_before[seen.start] {
            return true;
        }
        let uncertain = |(weight, ok): (&f64, &bool)| if *ok { 0.0 } else { *weight };
        band == Band::OfNoise
            && moving[sample]
            && weights.iter().zip(&moving[seen]).map(uncertain).sum::<f64>() <= MOST_UNCERTAIN
    };
    (0..moving.len())
        .step_by(step)
        .map(|sample| sample >= reach && sample + reach < moving.len() && is_certain(sample))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random;
    use crate::signal::{Edge, SavitzkyGolay};
    use rand_distr::{Distribution, StandardNormal};

    #[test]
    fn noise_of_a_velocity_is_that_of_white_noise_through_the_filter() {
        let period = 0.002;
        let mut source = random::stream(6, "velocity noise", 0);
        let motion = |k: usize| (1.3 * k as f64 * period).sin();
        let q: Vec<f64> = (0..20_000)
            .map(|k| {
                let draw: f64 = StandardNormal.sample(&mut source);
                motion(k) + 1e-4 * draw
            })
            .collect();
        let smoother = |degree| SavitzkyGolay::new(61, 4, degree, period, Edge::Polynomial).unwrap();
        let (mut smooth, mut rate) = (q.clone(), q.clone());
        smoother(0).apply(&q, &mut smooth).unwrap();
        smoother(1).apply(&q, &mut rate).unwrap();
        let both = |x: &[f64]| {
            let mut out = [x.to_vec(), x.to_vec()];
            for (degree, out) in out.iter_mut().enumerate() {
                smoother(degree).apply(x, out)?;
            }
            Ok(out)
        };
        let found = NoiseGains::new(q.len(), both).unwrap().velocity_noise(&q, &smooth);
        let errors = (100..19_900).map(|k| (rate[k] - 1.3 * (1.3 * k as f64 * period).cos()).powi(2));
        let real = (errors.sum::<f64>() / 19_800.0).sqrt();
        assert!((found / real - 1.0).abs() < 0.15, "{found} {real}");
    }

    #[test]
    fn a_band_knows_no_unit() {
        let velocity: Vec<f64> = (0..1000).map(|k| (0.01 * f64::from(k)).sin()).collect();
        let slow: Vec<f64> = velocity.iter().map(|v| 1e-3 * v).collect();
        let (band, of_slow) = (Slow::new(&velocity, 1e-4), Slow::new(&slow, 1e-7));
        assert_eq!(band.moving(&velocity, 30), of_slow.moving(&slow, 30));
        assert!((band.standing / of_slow.standing - 1e3).abs() < 1e-6 && band.standing < 0.051, "{band:?} {of_slow:?}");
        let noisy = Slow::new(&velocity, 0.1);
        assert_eq!([noisy.uncertain, noisy.standing], [0.1 * DEVIATIONS; 2]);
        assert_eq!(Slow::new(&[], 0.1).uncertain, 0.0);
    }

    #[test]
    fn a_joint_that_stays_slow_stands_and_one_that_turns_does_not() {
        // A reversal within ten samples, and a stop that creeps on at two per cent.
        let mut velocity: Vec<f64> = (0..400).map(|k| (f64::from(k) - 100.0).clamp(-100.0, 100.0) / 100.0).collect();
        velocity[300..350].fill(0.02);
        let moving = Slow::new(&velocity, 1e-3).moving(&velocity, 30);
        assert!(!moving[100] && moving[99] && moving[101] && moving[299] && !moving[320] && moving[350]);
    }

    #[test]
    fn quick_reversals_stay_and_standing_does_not() {
        let mut moving = vec![true; 400];
        moving[50] = false;
        moving[100..160].fill(false);
        // A mean over 41 samples, of which two may be uncertain.
        let mean = vec![1.0 / 41.0; 41];
        let rows = rows_to_use(&moving, (20, &mean), 1, Band::OfNoise);
        assert!(!rows[19] && rows[20] && rows[49] && !rows[50] && rows[51]);
        assert!(rows[81] && !rows[82] && !rows[130] && !rows[177] && rows[178] && !rows[380]);
        let given = rows_to_use(&moving, (20, &mean), 1, Band::Given(0.1));
        assert!(!given[45] && !given[70] && given[71] && !given[81]);
        // A short window gives so much weight to each that none may be.
        let short = rows_to_use(&moving, (1, &[0.2, 0.6, 0.2]), 1, Band::OfNoise);
        assert!(short[48] && !short[49] && !short[51] && short[52]);
    }

    #[test]
    fn weights_are_those_of_the_filter() {
        let smoother = SavitzkyGolay::new(9, 4, 0, 0.01, Edge::Polynomial).unwrap();
        let sizes: Vec<f64> = smoother.coefficients().iter().map(|weight| weight.abs()).collect();
        let found = weights(&Filter::SavitzkyGolay(smoother), 4, 1000).unwrap();
        assert!(found.iter().zip(&sizes).all(|(a, b)| (a - b).abs() < 1e-12) && found.len() == 9);
        assert_eq!(weights(&Filter::None, 1, 100).unwrap(), [0.0, 1.0, 0.0]);
        assert!(weights(&Filter::None, 10, 5).unwrap().is_empty());
    }
}
