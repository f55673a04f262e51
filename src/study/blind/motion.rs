//! Motions of blind runs, whole or cut out of the middle of longer ones.

use super::case::{Case, MotionKind};
use crate::channels::Channels;
use crate::error::Result;
use crate::excitation::random_sequence::FreudensteinEncoding;
use crate::excitation::{Encoding, JointLimits, Motion, Reference};
use crate::internal::excitation::{FourierEncoding, random_point};
use crate::random;
use crate::recording::Recording;
use crate::scenario::Setup;
use rand::RngExt;
use std::f64::consts::PI;

/// Motions of a run that are identified from; the other is held out.
pub(crate) const TRAIN: usize = 2;
const MOTIONS: usize = 3;

/// Length of each log, s, and what is cut off at either end of a longer motion.
const DURATION_S: f64 = 20.0;
const CUT_S: f64 = 3.0;

/// Time of a move and least period of a harmonic, s.
const MOVE_S: f64 = 20.0 / 12.0;
const HARMONICS: std::ops::RangeInclusive<usize> = 5..=10;

/// The motions of a run.
///
/// # Errors
/// If the limits allow none.
pub(crate) fn motions(case: &Case, setup: &Setup) -> Result<Vec<Motion>> {
    let duration = if case.cut { DURATION_S + 2.0 * CUT_S } else { DURATION_S };
    let limits: Vec<JointLimits> = setup.limits.iter().map(finite).collect();
    (0..MOTIONS as u64)
        .map(|index| {
            let encoding: Box<dyn Encoding> = match case.motion {
                MotionKind::Freudenstein => {
                    let moves = (duration / MOVE_S).round() as usize;
                    Box::new(FreudensteinEncoding::new(&limits, moves, duration)?)
                }
                MotionKind::Fourier => {
                    let harmonics = random::stream(case.seed, "blind harmonics", index).random_range(HARMONICS);
                    Box::new(FourierEncoding::new(&limits, harmonics, duration, 1)?)
                }
            };
            Ok(encoding.decode(&random_point(encoding.as_ref(), case.seed, "blind motion", index)))
        })
        .collect()
}

/// Limits to scale a motion to: where a joint has none, half a turn to either side, and the speed that it reaches halfway.
fn finite(limits: &JointLimits) -> JointLimits {
    let or = |value: f64, other: f64| if value.is_finite() { value } else { other };
    let (lower, upper) = (or(limits.lower, -PI), or(limits.upper, PI));
    let velocity = or(limits.velocity, (limits.acceleration * (upper - lower)).sqrt());
    JointLimits { lower, upper, velocity, ..*limits }
}

/// The part of a log of a motion that is kept; times stay as they are.
pub(crate) fn kept(case: &Case, log: &Recording) -> Recording {
    if case.cut { log.time_slice(CUT_S..=CUT_S + DURATION_S) } else { log.clone() }
}

/// A log of the motion itself, without torque.
pub(crate) fn reference_log(case: &Case, setup: &Setup, motion: &Motion) -> Recording {
    let dof = setup.known.dof();
    let rate = setup.scenario.sensors.rate_hz;
    let samples = setup.scenario.samples(motion.duration_s());
    let mut q = Channels::zeros(dof, samples);
    let mut state = [vec![0.0; dof], vec![0.0; dof], vec![0.0; dof]];
    let time: Vec<f64> = (0..samples).map(|sample| sample as f64 / rate).collect();
    for (sample, &t) in time.iter().enumerate() {
        let [position, velocity, acceleration] = &mut state;
        motion.at(t, position, velocity, acceleration);
        q.set(sample, position);
    }
    let tau = Channels::zeros(dof, samples);
    kept(case, &Recording { joints: setup.known.joint_names(), time, q, tau, ..Default::default() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_joint_that_turns_without_end_moves_within_a_turn() {
        let endless = JointLimits {
            lower: f64::NEG_INFINITY,
            upper: f64::INFINITY,
            velocity: f64::INFINITY,
            acceleration: 8.0 / PI,
        };
        let bounded = finite(&endless);
        assert_eq!([bounded.lower, bounded.upper, bounded.acceleration], [-PI, PI, 8.0 / PI]);
        assert!((bounded.velocity - 4.0).abs() < 1e-12);
        assert!(FourierEncoding::new(&[bounded], 5, 20.0, 1).is_ok());
        let own = JointLimits { lower: -1.0, upper: 0.5, velocity: 2.0, acceleration: 3.0 };
        assert_eq!(finite(&own), own);
    }
}
