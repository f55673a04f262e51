//! Motions of the links: behind gears, and as the encoders would read them without their errors.

use super::parts::Parts;
use super::signals::{derivatives, put_behind};
use super::state::EffectModel;
use crate::dynamics::Motion;
use crate::effects::{DAMPING_TIME_S, Gear, behind_encoder};
use crate::error::Result;
use crate::identification::preparation::prepare::{self, Prepared, Smoothing};
use crate::recording::Recording;
use std::borrow::Cow;

/// Rounds in which links are put behind their gears.
const GEAR_ROUNDS: usize = 4;

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

    /// Motion of the links: that of the motors less the twist of the gears under the torque that by the model they
    /// carry. (The measured torque would bring its noise into the columns, and with it a bias larger than what most gears
    /// yield.) Twists pass the filter of torque and columns: above the frequency at which the link swings on its gear the
    /// rounds would amplify every error.
    pub(super) fn link_motion<'b>(&self, log: &Recording, prepared: &'b Prepared) -> Result<Cow<'b, Motion>> {
        let period = 1.0 / log.rate_hz();
        if (0..self.model.dof()).all(|joint| self.gear(joint).is_none()) {
            return Ok(Cow::Borrowed(&prepared.motion));
        }
        let gears: Vec<(usize, Gear)> = (0..self.model.dof())
            .filter_map(|joint| {
                let rotor = self.model.robot().joints[joint].drive.armature;
                Some((joint, self.gear(joint)?.completed(rotor)))
            })
            .collect();
        let (with_play, springs): (Vec<_>, Vec<_>) = gears.into_iter().partition(|(_, gear)| gear.half_gap > 0.0);
        let mut played = prepared.motion.clone();
        for (joint, gear) in with_play {
            put_behind(&mut played, joint, self.play(gear, joint, log, prepared)?);
        }
        let mut link = played.clone();
        for _ in 0..if springs.is_empty() { 0 } else { GEAR_ROUNDS } {
            let parts = Parts::new(self, prepared, &link);
            let mut next = played.clone();
            for &(joint, gear) in &springs {
                let carried = parts.carried(joint, link.qdd.channel(joint));
                let steady: Vec<f64> = carried.into_iter().map(|torque| gear.twist(torque)).collect();
                let [steady, rate, _] = derivatives(prepared.filtered(&steady)?, period)?;
                let twist = steady.iter().zip(rate).map(|(twist, rate)| twist - DAMPING_TIME_S * rate);
                put_behind(&mut next, joint, derivatives(twist.collect(), period)?);
            }
            link = next;
        }
        Ok(Cow::Owned(link))
    }

    /// Twist of a gear with play: the link falls from flank to flank, which no steady state describes, so its motion is
    /// followed in time. It is followed on the unsmoothed motion, since smoothing would make impacts come too early;
    /// following integrates twice, which takes care of the noise. Then the twist is smoothed like the positions.
    fn play(&self, gear: Gear, joint: usize, log: &Recording, prepared: &Prepared) -> Result<[Vec<f64>; 3]> {
        let period = 1.0 / log.rate_hz();
        let sharp = prepare::measured(log, Smoothing::None, self.preparation.band)?;
        let carried = |motion: &Motion| Parts::new(self, &sharp, motion).carried(joint, motion.qdd.channel(joint));
        let load = carried(&sharp.motion);
        let mut pushed = sharp.motion.clone();
        pushed.qdd.channel_mut(joint).iter_mut().for_each(|a| *a += 1.0);
        let inertia: Vec<f64> = carried(&pushed).iter().zip(&load).map(|(with, without)| with - without).collect();
        let [twist, ..] = gear.follow(&load, &inertia, period);
        derivatives(prepared.filtered_like_positions(&twist)?, period)
    }
}
