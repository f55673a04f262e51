//! Motions of the links: behind gears, and as the encoders would read them without their errors.

use super::arm_parameters::{ArmParameter, Trust, drive_of};
use super::state::EffectModel;
use crate::dynamics::{Motion, inverse_dynamics};
use crate::effects::{Gear, GearTrain, behind_encoder, behind_gears};
use crate::error::Result;
use crate::identification::preparation::prepare::{self, Prepared, Smoothing};
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

    /// Motion of the links: that of the motors less the twist of their gears.
    pub(super) fn link_motion<'b>(&self, log: &'b Recording, prepared: &'b Prepared) -> Result<Cow<'b, Motion>> {
        let gears: Vec<(usize, Gear)> =
            (0..self.model.dof()).filter_map(|joint| Some((joint, self.gear(joint)?))).collect();
        match gears.is_empty() {
            true => Ok(Cow::Borrowed(&prepared.motion)),
            false => Ok(Cow::Owned(behind_gears(&AlongLog { model: self, log, prepared }, &gears)?)),
        }
    }

    /// Torque that the gear of a joint carries along a motion: that of the bodies, without rotor and friction.
    fn carried(&self, joint: usize, motion: &Motion) -> Vec<f64> {
        let rotor = self.lumped_rotor(joint);
        let mut torque: Vec<f64> = motion.qdd.channel(joint).iter().map(|a| -rotor * a).collect();
        let columns = self.model.columns_on(joint, motion, motion, 0.0);
        let active = self.model.active(joint);
        for (&parameter, &value) in self.arm.iter().zip(&self.baseline) {
            if let ArmParameter::Base(base) = parameter
                && drive_of(self.model, parameter).is_none()
                && let Some(place) = active.iter().position(|&own| own == base)
            {
                torque.iter_mut().zip(columns.channel(place)).for_each(|(sum, x)| *sum += value * x);
            }
        }
        torque
    }
}

/// The arm of a model along one of its logs.
struct AlongLog<'a> {
    model: &'a EffectModel<'a>,
    log: &'a Recording,
    prepared: &'a Prepared<'a>,
}

impl GearTrain for AlongLog<'_> {
    fn motors(&self) -> &Motion {
        &self.prepared.motion
    }

    fn measured(&self) -> Result<Cow<'_, Motion>> {
        Ok(Cow::Owned(prepare::measured(self.log, Smoothing::None, self.model.preparation.band)?.motion))
    }

    fn period(&self) -> f64 {
        1.0 / self.log.rate_hz()
    }

    fn carried(&self, joints: &[usize], motion: &Motion) -> Vec<Vec<f64>> {
        let EffectModel { model, trust, .. } = self.model;
        match trust {
            Trust::Nominal => {
                let torque = inverse_dynamics(model.chain(), &model.robot().inertial_parameters(), motion);
                joints.iter().map(|&joint| torque.channel(joint).to_vec()).collect()
            }
            Trust::Structure => joints.iter().map(|&joint| self.model.carried(joint, motion)).collect(),
        }
    }

    fn rotor(&self, joint: usize) -> f64 {
        self.model.model.robot().joints[joint].drive.armature
    }

    fn smoothed(&self, _: usize, signal: &[f64]) -> Result<Vec<f64>> {
        self.prepared.filtered_like_positions(signal)
    }
}
