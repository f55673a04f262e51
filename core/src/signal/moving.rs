//! Whether a joint moves: the speed below which its direction is not certain, from its own speed and noise, so that no number of
//! rad/s counts as one of m/s.

use crate::error::Result;

/// Standard deviations of the velocity's noise within which its sign is not certain: one sign in a thousand is wrong there.
const DEVIATIONS: f64 = 3.0;

/// Share of a joint's own fast speed within which it stands if it stays there for as long as the filter is: a held joint creeps,
/// and stiction gives its friction, not Coulomb's law. A quick reversal passes through.
const STANDING: f64 = 0.05;

/// Share of the largest position that is rounding in positions without noise.
const ROUNDING: f64 = 1e-12;

/// The fast speed is the one that so large a share of the samples stay below; single spikes do not count.
const FAST: f64 = 0.95;

/// Share of a joint's own fast speed above which it surely moves at a moment: closer to a reversal, smoothing mixes both directions ..
const SURE: f64 = 0.1;

/// .. and the speed above which a fast joint does in any case, rad/s or m/s. It only ever makes the band narrower.
const SURE_AT: f64 = 0.03;

/// No joint surely moves below, rad/s or m/s, however little its noise: it creeps, and friction is not that of sliding. A slow rail goes
/// some millimetres a second.
const CREEPS: f64 = 1e-3;

/// Least range (rad) and fast speed (rad/s) of a joint whose friction and inertia show: the sag of a held joint under the motion of the
/// others is smaller.
const LEAST_MOTION: [f64; 2] = [0.02, 0.06];

/// The same of a sliding joint, in m and m/s: links are some tenths of a metre long, so that the others move a held one by so much less.
const LEAST_SLIDE: [f64; 2] = [0.002, 0.006];

/// Times the least range from which a joint moves at any speed: no held joint sags by three degrees.
const WIDE: f64 = 2.5;

/// Samples after which the response to an impulse has died away.
const MOST_RESPONSE: usize = 4096;

/// What the noise of positions becomes in a velocity.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::signal::{Edge, NoiseGains, SavitzkyGolay};
///
/// let [position, velocity] = [0, 1].map(|derivative| SavitzkyGolay::new(11, 2, derivative, 0.01, Edge::Polynomial));
/// let (position, velocity) = (position?, velocity?);
/// let smooth = |measured: &[f64]| {
///     let mut both = [measured.to_vec(), measured.to_vec()];
///     position.apply(measured, &mut both[0])?;
///     velocity.apply(measured, &mut both[1])?;
///     Ok(both)
/// };
/// // An encoder noise of 0.1 mrad at rest: the velocity has what the filter's weights make of it.
/// let gains = NoiseGains::new(2000, smooth)?;
/// # let mut measured = vec![0.0; 2000];
/// # tauscope::random::normals(1, "encoder", 0).fill(&mut measured);
/// # measured.iter_mut().for_each(|value| *value *= 1e-4);
/// let noise = gains.velocity_noise(&measured, &smooth(&measured)?[0]);
/// let weights = velocity.coefficients().iter().map(|weight| weight * weight).sum::<f64>().sqrt();
/// assert!((noise / (1e-4 * weights) - 1.0).abs() < 0.1);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct NoiseGains {
    /// Standard deviation of what smoothing takes off, for unit white noise in the positions.
    taken: f64,
    /// Standard deviation of the velocity's noise, for the same.
    rate: f64,
}

impl NoiseGains {
    /// The gains of what makes a smooth position and its velocity from a signal of `samples`.
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
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::signal::Slow;
///
/// // A joint that moves, rests for six samples, and turns back at once.
/// let velocity = [0.5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.5, 0.0, -0.5];
/// let moving = Slow::given(0.1).moving(&velocity, 5);
/// assert_eq!(moving, [true, false, false, false, false, false, false, true, false, true]);
///
/// // Within three standard deviations of its noise the sign of a velocity is not certain.
/// assert!((Slow::new(&velocity, 0.01).uncertain - 0.03).abs() < 1e-12);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slow {
    /// The direction is not certain at a moment.
    pub uncertain: f64,
    /// The joint stands if it stays below.
    pub standing: f64,
    /// It surely moves above, whatever smoothing mixes in from a reversal near by.
    pub sure: f64,
    /// The joint's own fast speed over that of a fast joint, at most one: speeds that hold for a fast joint count for this one by that
    /// share.
    pub share: f64,
}

impl Slow {
    /// The speeds of a joint with these velocities, whose noise has the standard deviation `noise`.
    pub fn new(velocity: &[f64], noise: f64) -> Self {
        let mut speeds: Vec<f64> = velocity.iter().map(|v| v.abs()).filter(|v| v.is_finite()).collect();
        if speeds.is_empty() {
            return Slow::given(0.0);
        }
        let place = ((speeds.len() - 1) as f64 * FAST) as usize;
        let fast = *speeds.select_nth_unstable_by(place, f64::total_cmp).1;
        let uncertain = DEVIATIONS * noise;
        let standing = uncertain.max(STANDING * fast);
        let share = (SURE * fast / SURE_AT).min(1.0);
        Slow { uncertain, standing, sure: uncertain.max(SURE_AT.min(SURE * fast)).max(CREEPS), share }
    }

    /// One speed for all.
    pub fn given(speed: f64) -> Self {
        Slow { uncertain: speed, standing: speed, sure: speed, share: 1.0 }
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

/// Whether a joint with this range (rad or m) and highest speed moves enough for its friction and inertia to show: over a wide range at
/// any speed, over a small one at a speed that no held joint has.
pub(crate) fn moves_enough(range: f64, speed: f64, slides: bool) -> bool {
    let least = if slides { LEAST_SLIDE } else { LEAST_MOTION };
    range >= least[0] && (speed >= least[1] || range >= WIDE * least[0])
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
        assert_eq!([noisy.uncertain, noisy.standing, noisy.sure], [0.1 * DEVIATIONS; 3]);
        assert_eq!(Slow::new(&[], 0.1), Slow::given(0.0));
        // A joint 1000 times slower counts speeds by as much less, and one that is fast counts them as they are.
        assert!(
            (band.share - 1.0).abs() < 1e-12 && (of_slow.share / (1e-3 * 0.997 * SURE / SURE_AT) - 1.0).abs() < 0.01
        );
    }

    #[test]
    fn a_slow_joint_surely_moves_at_a_tenth_of_its_speed_and_a_fast_one_at_no_more_than_before() {
        let swing = |size: f64| -> Vec<f64> { (0..1000).map(|k| size * (0.01 * f64::from(k)).sin()).collect() };
        let sure = |size: f64, noise: f64| Slow::new(&swing(size), noise).sure;
        // A rail at 12 mm/s: a hundredth of a metre per second is most of its speed.
        assert!((sure(0.012, 0.0) / 0.0012 - 1.0).abs() < 0.01, "{}", sure(0.012, 0.0));
        assert!(sure(0.29, 0.0) < SURE_AT);
        assert_eq!([sure(0.31, 0.0), sure(2.0, 0.0), sure(2.0, 0.009), sure(2.0, 0.02)], [0.03, 0.03, 0.03, 0.06]);
        assert_eq!(sure(0.012, 0.001), 0.003);
        // What is so slow creeps.
        assert_eq!([sure(9e-3, 0.0), sure(1e-4, 0.0)], [CREEPS; 2]);
    }

    #[test]
    fn a_joint_moves_enough_by_range_and_speed_in_its_own_unit() {
        assert!(moves_enough(0.021, 0.061, false) && moves_enough(0.0021, 0.0061, true));
        assert!(!moves_enough(0.019, 0.061, false) && !moves_enough(0.021, 0.059, false));
        assert!(!moves_enough(0.0019, 0.0061, true) && !moves_enough(0.0021, 0.0059, true));
        assert!(!moves_enough(0.01, 0.012, false) && moves_enough(0.01, 0.012, true));
    }

    #[test]
    fn a_joint_that_goes_far_moves_however_slowly() {
        assert!(moves_enough(0.05, 0.01, false) && !moves_enough(0.049, 0.01, false));
        assert!(moves_enough(0.005, 1e-3, true) && !moves_enough(0.0049, 1e-3, true));
    }

    #[test]
    fn a_joint_that_stays_slow_stands_and_one_that_turns_does_not() {
        // A reversal within ten samples, and a stop that creeps on at two per cent.
        let mut velocity: Vec<f64> = (0..400).map(|k| (f64::from(k) - 100.0).clamp(-100.0, 100.0) / 100.0).collect();
        velocity[300..350].fill(0.02);
        let moving = Slow::new(&velocity, 1e-3).moving(&velocity, 30);
        assert!(!moving[100] && moving[99] && moving[101] && moving[299] && !moving[320] && moving[350]);
    }
}
