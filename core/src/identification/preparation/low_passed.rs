//! Motion from positions that pass a steep zero-phase low-pass, and the blocks over which torque and columns become means: what `diagnose`
//! makes of a log, and `identify` where it is asked to.

use crate::channels::Channels;
use crate::dynamics::Motion;
use crate::error::{Error, Result};
use crate::recording::Recording;
use crate::signal::{ZeroPhaseLowPass, smooth_derivatives};

/// Order of the low-pass of the positions, in each direction: steep, so that a slow motion does not leak past the cut-off.
pub(crate) const ORDER: usize = 6;

/// Length of a block, s.
pub(crate) const BLOCK_S: f64 = 0.02;

/// Samples of a block at a rate.
pub(crate) fn block(rate_hz: f64) -> usize {
    ((BLOCK_S * rate_hz).round() as usize).max(1)
}

/// The motion with the positions of each joint through its low-pass.
///
/// # Errors
/// If the log is too short; the joint is named.
pub(crate) fn low_passed(recording: &Recording, low_pass: &[ZeroPhaseLowPass]) -> Result<Motion> {
    let mut q = recording.q.clone();
    for (joint, low_pass) in low_pass.iter().enumerate() {
        low_pass
            .apply_in_place(q.channel_mut(joint))
            .map_err(|e| Error::request(format!("joint `{}`", recording.joints[joint]), e.to_string()))?;
    }
    differentiated(q, 1.0 / recording.rate_hz())
}

/// The motion whose positions are `q`, smooth already.
///
/// # Errors
/// If there are too few samples to differentiate.
pub(crate) fn differentiated(q: Channels, period: f64) -> Result<Motion> {
    let mut motion = Motion { qd: q.clone(), qdd: q.clone(), q };
    for joint in 0..motion.joints() {
        let Motion { q, qd, qdd } = &mut motion;
        smooth_derivatives(q.channel(joint), period, qd.channel_mut(joint), qdd.channel_mut(joint))?;
    }
    Ok(motion)
}
