//! Motion of the links behind gears that give way.

use super::gear::{DAMPING_TIME_S, Gear};
use crate::channels::Channels;
use crate::dynamics::Motion;
use crate::error::Result;
use crate::signal::{ZeroPhaseLowPass, first_derivative, noise_floor, second_derivative, smooth_derivatives};

/// Most rounds in which the twists of elastic gears settle, and the change of the largest twist, over itself, at which they have.
const ROUNDS: usize = 4;
const SETTLED: f64 = 1e-4;

/// Share of the frequency at which a link swings on its gear up to which the twist is followed: beyond it the rounds amplify
/// every error. The order of that low-pass, and the slowest that still passes motions of arms, Hz.
const BELOW_SWING: f64 = 0.6;
const SWING_ORDER: usize = 4;
const SLOWEST_SWING_HZ: f64 = 1.5;

/// Highest cut-off of that low-pass over the sample rate; a link that swings faster needs none.
const FILTER_SHARE: f64 = 0.45;

/// Play is followed along positions up to the frequency at which the encoder's noise makes this share of the accelerations, as root mean
/// squares: teeth meet within milliseconds, and smoother positions show that too early; the noise of rougher ones throws a link through
/// its play.
const NOISE_OF_ACCELERATION: f64 = 0.05;

/// Lowest such frequency, Hz, and its largest share of the sample rate, above which positions are taken as measured.
const SHARP_HZ: f64 = 60.0;
const SHARP_SHARE: f64 = 0.4;

/// Places of the motion at which a link's inertia about its joint is looked up.
const PLACES: usize = 10;

/// What a model knows of an arm whose motors' motion was measured.
pub(crate) trait GearTrain {
    /// Motion of the motors, smooth.
    fn motors(&self) -> &Motion;

    /// The same hardly smoothed ([`sharp`]).
    ///
    /// # Errors
    /// If the log is too short for the filter.
    fn sharp(&self) -> Result<&Motion>;

    /// Time between two samples, s.
    fn period(&self) -> f64;

    /// Torque of the bodies on some joints along a motion, which their gears carry, N m (N), `[joint][time]`.
    fn carried(&self, joints: &[usize], motion: &Motion) -> Vec<Vec<f64>>;

    /// Inertia of a joint's rotor seen at the joint, kg m2 (kg); zero where it is not known.
    fn rotor(&self, joint: usize) -> f64;

    /// A signal of a joint through the low-pass that its positions went through.
    ///
    /// # Errors
    /// If the log is too short for it.
    fn smoothed(&self, joint: usize, signal: &[f64]) -> Result<Vec<f64>>;
}

/// The motion along which play is followed, from positions as measured.
///
/// # Errors
/// If there are too few samples for the filters.
pub(crate) fn sharp(measured: &Channels, period: f64) -> Result<Motion> {
    let (rate_hz, mut q) = (1.0 / period, measured.clone());
    let highest = SHARP_SHARE * rate_hz;
    let lowest = SHARP_HZ.min(highest);
    let low_pass = ZeroPhaseLowPass::new(SWING_ORDER, lowest, rate_hz)?;
    for joint in 0..q.channels() {
        let mut smooth = measured.channel(joint).to_vec();
        low_pass.apply_in_place(&mut smooth)?;
        let hz = sharpest(noise_floor(measured.channel(joint)), &smooth, rate_hz);
        if hz <= lowest {
            q.channel_mut(joint).copy_from_slice(&smooth);
        } else if hz < highest {
            ZeroPhaseLowPass::new(SWING_ORDER, hz, rate_hz)?.apply_in_place(q.channel_mut(joint))?;
        }
    }
    let mut motion = Motion { q: q.clone(), qd: q.clone(), qdd: q };
    for joint in 0..motion.joints() {
        first_derivative(motion.q.channel(joint), period, motion.qd.channel_mut(joint))?;
        second_derivative(motion.q.channel(joint), period, motion.qdd.channel_mut(joint))?;
    }
    Ok(motion)
}

/// The frequency, Hz, up to which white noise of the standard deviation `noise` makes [`NOISE_OF_ACCELERATION`] of the accelerations of
/// `smooth` positions: below f that noise has accelerations of the variance noise^2 (2 pi)^4 2 f^5 / (5 rate).
fn sharpest(noise: f64, smooth: &[f64], rate_hz: f64) -> f64 {
    let second = |q: &[f64]| ((q[2] - 2.0 * q[1] + q[0]) * rate_hz * rate_hz).powi(2);
    let mean_square = smooth.windows(3).map(second).sum::<f64>() / smooth.len() as f64;
    let allowed = NOISE_OF_ACCELERATION.powi(2) * mean_square / (noise.powi(2) * std::f64::consts::TAU.powi(4));
    (2.5 * rate_hz * allowed).powf(0.2)
}

/// Motion of the links: that of the motors less the twists of `gears` under the torque that they carry by the model. (The measured
/// torque would bring its noise into the columns, and with it a bias larger than what most gears yield.)
///
/// # Errors
/// If the log is too short for its filters.
pub(crate) fn behind_gears(train: &impl GearTrain, gears: &[(usize, Gear)]) -> Result<Motion> {
    let period = train.period();
    let (with_play, springs): (Vec<_>, Vec<_>) = gears.iter().copied().partition(|(_, gear)| gear.half_gap > 0.0);
    let mut played = train.motors().clone();
    for (joint, gear) in with_play {
        put_behind(&mut played, joint, play(train, joint, gear)?, period)?;
    }
    let joints: Vec<usize> = springs.iter().map(|&(joint, _)| joint).collect();
    let below: Vec<Option<ZeroPhaseLowPass>> =
        springs.iter().map(|&(joint, gear)| below_swing(train, joint, gear)).collect::<Result<_>>()?;
    let (mut link, mut before) = (played.clone(), vec![Vec::new(); springs.len()]);
    for _ in 0..if springs.is_empty() { 0 } else { ROUNDS } {
        let mut next = played.clone();
        let mut settled = true;
        for (k, carried) in train.carried(&joints, &link).iter().enumerate() {
            let (joint, gear) = springs[k];
            let steady: Vec<f64> = carried.iter().map(|&torque| gear.twist(torque)).collect();
            let mut twist = train.smoothed(joint, &steady)?;
            if let Some(filter) = &below[k] {
                filter.apply_in_place(&mut twist)?;
            }
            let [mut rate, mut unused] = [(); 2].map(|()| vec![0.0; twist.len()]);
            smooth_derivatives(&twist, period, &mut rate, &mut unused)?;
            twist.iter_mut().zip(&rate).for_each(|(twist, rate)| *twist -= DAMPING_TIME_S * rate);
            settled &= has_settled(&before[k], &twist);
            put_behind(&mut next, joint, twist.clone(), period)?;
            before[k] = twist;
        }
        link = next;
        if settled {
            break;
        }
    }
    Ok(link)
}

/// Whether a twist is that of the round before.
fn has_settled(before: &[f64], twist: &[f64]) -> bool {
    let largest = twist.iter().fold(0.0, |largest: f64, twist| largest.max(twist.abs()));
    before.len() == twist.len() && before.iter().zip(twist).all(|(a, b)| (a - b).abs() <= SETTLED * largest)
}

/// Takes a twist off the motion of a joint.
fn put_behind(motion: &mut Motion, joint: usize, twist: Vec<f64>, period: f64) -> Result<()> {
    let [mut rate, mut second] = [(); 2].map(|()| vec![0.0; twist.len()]);
    smooth_derivatives(&twist, period, &mut rate, &mut second)?;
    for (channels, change) in [&mut motion.q, &mut motion.qd, &mut motion.qdd].into_iter().zip([twist, rate, second]) {
        channels.channel_mut(joint).iter_mut().zip(change).for_each(|(value, change)| *value -= change);
    }
    Ok(())
}

/// Twist of a gear with play: the link falls from flank to flank, which no steady state describes, so its motion is followed in time,
/// along a motion that is hardly smoothed: following integrates twice, which takes care of most noise. The twist is smoothed like the
/// positions. A gear without a compliance of its own is followed with a stiff one, whose share of the twist is taken off.
fn play(train: &impl GearTrain, joint: usize, gear: Gear) -> Result<Vec<f64>> {
    let sharp = train.sharp()?;
    let [load, inertia] = load_and_inertia(train, joint, sharp.clone());
    let rotor = match train.rotor(joint) {
        rotor if rotor > 0.0 => rotor,
        _ => inertia.iter().sum::<f64>() / inertia.len().max(1) as f64,
    };
    let stiff = gear.completed(rotor);
    let [mut twist, ..] = stiff.follow(&load, &inertia, train.period());
    if gear.compliance == 0.0 {
        twist.iter_mut().zip(&load).for_each(|(twist, load)| *twist -= stiff.compliance * load);
    }
    train.smoothed(joint, &twist)
}

/// Torque of the bodies on a joint along a motion, and their inertia about it: what one more unit of its acceleration takes.
fn load_and_inertia(train: &impl GearTrain, joint: usize, mut motion: Motion) -> [Vec<f64>; 2] {
    let load = train.carried(&[joint], &motion).swap_remove(0);
    motion.qdd.channel_mut(joint).iter_mut().for_each(|a| *a += 1.0);
    let pushed = train.carried(&[joint], &motion).swap_remove(0);
    let inertia = pushed.iter().zip(&load).map(|(with, without)| with - without).collect();
    [load, inertia]
}

/// Passes what is slower than the link swings on its gear. None where the swing is faster than any motion.
fn below_swing(train: &impl GearTrain, joint: usize, gear: Gear) -> Result<Option<ZeroPhaseLowPass>> {
    let motors = train.motors();
    let samples = motors.samples();
    let places: Vec<Vec<f64>> = (0..motors.joints())
        .map(|j| (0..PLACES).map(|place| motors.q.channel(j)[place * samples / PLACES]).collect())
        .collect();
    let [_, inertia] = load_and_inertia(train, joint, Motion::at_rest(Channels::from_vectors(&places)));
    let inertia = inertia.into_iter().fold(0.0, f64::max);
    let swing_hz = 1.0 / (std::f64::consts::TAU * (gear.compliance * inertia).sqrt());
    let hz = (BELOW_SWING * swing_hz).max(SLOWEST_SWING_HZ);
    let rate_hz = 1.0 / train.period();
    (hz < FILTER_SHARE * rate_hz).then(|| ZeroPhaseLowPass::new(SWING_ORDER, hz, rate_hz)).transpose()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Steps of 25 urad at 500 Hz are accelerations of 5 rad/s2 as measured, which throw a link through a play within milliseconds.
    #[test]
    fn steps_of_an_encoder_are_no_accelerations() {
        let (step, period) = (2.5e-5, 0.002);
        let motion = |k: u32| 0.3 * (2.0 * f64::from(k) * period).sin();
        let q = Channels::from_vectors(&[(0..5_000).map(|k| (motion(k) / step).round() * step).collect()]);
        let hardly = sharp(&q, period).unwrap();
        let error = |k: usize| hardly.qdd.channel(0)[k] + 4.0 * motion(k as u32);
        let largest = (500..4_500).map(|k| error(k).abs()).fold(0.0, f64::max);
        assert!(largest < 1.0, "{largest}");
        // A jerk of 20 ms is still one.
        let jerk = |k: u32| 1e-3 * (-0.5 * ((f64::from(k) * period - 5.0) / 0.01).powi(2)).exp();
        let q = Channels::from_vectors(&[(0..5_000).map(jerk).collect()]);
        let peak = sharp(&q, period).unwrap().q.channel(0)[2_500];
        assert!(peak > 0.9e-3, "{peak}");
    }

    /// By hand: noise of 1 urad at 1 kHz has accelerations of 0.05 rad/s2 rms up to 83 Hz.
    #[test]
    fn play_is_followed_as_sharply_as_the_noise_of_the_accelerations_lets() {
        let rate_hz = 1_000.0;
        let root_of_two = 2.0_f64.sqrt();
        let smooth: Vec<f64> = (0..10_000).map(|k| root_of_two / 9.0 * (3.0 * f64::from(k) / rate_hz).sin()).collect();
        let hz = |noise| sharpest(noise, &smooth, rate_hz);
        let expected = (2.5 * 1e3 * (0.05_f64 / 39.478 / 1e-6).powi(2)).powf(0.2);
        assert!(
            (hz(1e-6) / expected - 1.0).abs() < 0.02 && (75.0..85.0).contains(&expected),
            "{} {expected}",
            hz(1e-6)
        );
        assert!(hz(0.0).is_infinite());
        // Positions without noise are taken as measured.
        let q = Channels::from_vectors(std::slice::from_ref(&smooth));
        let followed = sharp(&q, 1.0 / rate_hz).unwrap();
        assert!(followed.q.channel(0) == smooth);
    }
}
