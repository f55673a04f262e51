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

/// The low-pass of the positions of each joint with these cut-offs, Hz: one of all joints, or one of each.
///
/// # Errors
/// If there is another number of them, or a cut-off is not between zero and half the rate.
pub(crate) fn low_passes(cutoffs_hz: &[f64], recording: &Recording) -> Result<Vec<ZeroPhaseLowPass>> {
    let joints = recording.joints();
    let of_joint = |joint: usize| cutoffs_hz.get(if cutoffs_hz.len() == 1 { 0 } else { joint }).copied();
    if cutoffs_hz.len() != 1 && cutoffs_hz.len() != joints {
        let problem = format!("are {} for {joints} joints; give one for all joints, or one for each", cutoffs_hz.len());
        return Err(Error::request("cut-offs of the positions", problem));
    }
    let each = (0..joints).filter_map(of_joint);
    each.map(|cutoff_hz| ZeroPhaseLowPass::new(ORDER, cutoff_hz, recording.rate_hz())).collect()
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_cut_off_is_that_of_all_joints_and_several_are_one_of_each() {
        let log = Recording {
            joints: vec!["a".into(), "b".into()],
            time: (0..100).map(|k| 0.002 * f64::from(k)).collect(),
            q: Channels::zeros(2, 100),
            tau: Channels::zeros(2, 100),
            ..Default::default()
        };
        let of = |cutoffs_hz: &[f64]| low_passes(cutoffs_hz, &log);
        assert_eq!(of(&[20.0]).unwrap(), of(&[20.0, 20.0]).unwrap());
        let [slow, fast] = [10.0, 20.0].map(|hz| ZeroPhaseLowPass::new(ORDER, hz, log.rate_hz()).unwrap());
        assert_eq!(of(&[10.0, 20.0]).unwrap(), [slow, fast]);
        let problem = of(&[10.0, 20.0, 30.0]).unwrap_err().to_string();
        assert!(problem.contains("are 3 for 2 joints"), "{problem}");
    }
}
