//! Motions of blind runs, whole or cut out of the middle of longer ones.

use super::case::{Case, MotionKind};
use crate::channels::Channels;
use crate::error::Result;
use crate::excitation::encoding::{FourierEncoding, random_point};
use crate::excitation::random_sequence::FreudensteinEncoding;
use crate::excitation::{Encoding, Motion, Reference};
use crate::random;
use crate::recording::Recording;
use crate::scenario::Setup;
use rand::RngExt;

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
    (0..MOTIONS as u64)
        .map(|index| {
            let encoding: Box<dyn Encoding> = match case.motion {
                MotionKind::Freudenstein => {
                    let moves = (duration / MOVE_S).round() as usize;
                    Box::new(FreudensteinEncoding::new(&setup.limits, moves, duration)?)
                }
                MotionKind::Fourier => {
                    let harmonics = random::stream(case.seed, "blind harmonics", index).random_range(HARMONICS);
                    Box::new(FourierEncoding::new(&setup.limits, harmonics, duration, 1)?)
                }
            };
            Ok(encoding.decode(&random_point(encoding.as_ref(), case.seed, "blind motion", index)))
        })
        .collect()
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
