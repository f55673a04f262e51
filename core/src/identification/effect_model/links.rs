//! Motions of the links: behind gears, and as the encoders would read them without their errors.

use super::arm::Arm;
use super::state::EffectModel;
use crate::dynamics::Motion;
use crate::effects::{Gear, GearTrain, behind_encoder, behind_gears};
use crate::error::Result;
use crate::identification::preparation::prepare::Prepared;
use crate::recording::Recording;
use std::borrow::Cow;

impl EffectModel<'_> {
    /// The recording with the encoders' errors taken out of its positions, if effects put any in.
    pub(super) fn without_encoder_errors(&self, recording: &Recording) -> Option<Recording> {
        if (0..self.model.dof()).all(|joint| self.sensors(joint).next().is_none()) {
            return None;
        }
        let mut q = recording.q.clone();
        for joint in 0..self.model.dof() {
            if let Some(behind) = behind_encoder(self.sensors(joint), recording.q.channel(joint)) {
                q.channel_mut(joint).copy_from_slice(&behind);
            }
        }
        (q != recording.q).then(|| Recording { q, ..recording.clone() })
    }

    /// Motion of the links: that of the motors less the twist of the gears of `arm`.
    pub(super) fn link_motion<'b>(
        &self,
        arm: &Arm,
        log: &'b Recording,
        prepared: &'b Prepared,
    ) -> Result<Cow<'b, Motion>> {
        let gears: Vec<(usize, Gear)> =
            (0..self.model.dof()).filter_map(|joint| Some((joint, self.gear(joint)?))).collect();
        match gears.is_empty() {
            true => Ok(Cow::Borrowed(&prepared.motion)),
            false => Ok(Cow::Owned(behind_gears(&self.geared(arm, log, prepared), &gears)?)),
        }
    }

    /// The arm with the parameters as last solved for.
    pub(crate) fn found_arm(&self) -> Arm {
        let mut arm = Arm::new(self.model.robot(), self.trust);
        arm.take(self.model, &self.baseline_of_arm());
        arm
    }

    /// Its gears along a log.
    fn geared<'b>(&self, arm: &'b Arm, log: &'b Recording, prepared: &'b Prepared) -> Geared<'b> {
        Geared {
            arm,
            motors: &prepared.motion,
            period: 1.0 / log.rate_hz(),
            sharp: Box::new(move || prepared.sharp(log)),
            smoothed: Box::new(|joint, signal| prepared.filtered_like_positions(joint, signal)),
        }
    }
}

/// What a low-pass makes of a signal of a joint.
type Filter<'a> = dyn Fn(usize, &[f64]) -> Result<Vec<f64>> + 'a;

/// The gears of an arm along one of its logs.
pub(crate) struct Geared<'a> {
    /// The arm as found.
    pub arm: &'a Arm,
    /// Motion of the motors, smooth.
    pub motors: &'a Motion,
    /// Time between two samples, s.
    pub period: f64,
    /// The motion along which play is followed, hardly smoothed or not at all.
    pub sharp: Box<dyn Fn() -> Result<&'a Motion> + 'a>,
    /// A signal of a joint through the low-pass that its positions went through.
    pub smoothed: Box<Filter<'a>>,
}

impl GearTrain for Geared<'_> {
    fn motors(&self) -> &Motion {
        self.motors
    }

    fn sharp(&self) -> Result<&Motion> {
        (self.sharp)()
    }

    fn period(&self) -> f64 {
        self.period
    }

    fn carried(&self, joints: &[usize], motion: &Motion) -> Vec<Vec<f64>> {
        let load = self.arm.load(motion);
        joints.iter().map(|&joint| load.channel(joint).to_vec()).collect()
    }

    fn rotor(&self, joint: usize) -> f64 {
        self.arm.found().joints[joint].drive.armature
    }

    fn smoothed(&self, joint: usize, signal: &[f64]) -> Result<Vec<f64>> {
        (self.smoothed)(joint, signal)
    }
}
