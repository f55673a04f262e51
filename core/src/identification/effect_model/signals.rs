//! Signals of one joint: differences, derivatives, a twist taken off a motion.

use crate::dynamics::Motion;
use crate::error::Result;
use crate::signal::{first_derivative, second_derivative};

/// Takes a twist, its rate and its acceleration off the motion of a joint.
pub(super) fn put_behind(motion: &mut Motion, joint: usize, twist: [Vec<f64>; 3]) {
    for (channels, change) in [&mut motion.q, &mut motion.qd, &mut motion.qdd].into_iter().zip(twist) {
        channels.channel_mut(joint).iter_mut().zip(change).for_each(|(value, c)| *value -= c);
    }
}

/// One signal less another.
pub(super) fn difference(signal: &[f64], other: &[f64]) -> Vec<f64> {
    signal.iter().zip(other).map(|(a, b)| a - b).collect()
}

/// A signal with its first and second derivative.
pub(super) fn derivatives(signal: Vec<f64>, period: f64) -> Result<[Vec<f64>; 3]> {
    let (mut rate, mut second) = (vec![0.0; signal.len()], vec![0.0; signal.len()]);
    first_derivative(&signal, period, &mut rate)?;
    second_derivative(&signal, period, &mut second)?;
    Ok([signal, rate, second])
}
