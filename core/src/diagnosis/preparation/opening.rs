//! How a session is opened: the low-passes that serve the logs, how sharply friction turns, and rows that are not to be used.

use super::coulomb_width::{self, Likeliest};
use super::feedback::{FEEDBACK, feedback};
use super::filters::{Preparation, Prepared};
use super::smoothing;
use crate::diagnosis::criteria::Criteria;
use crate::diagnosis::evidence::Gains;
use crate::diagnosis::model::{ArmModel, DataSet, Fit, Known, PreparedLogs, Session};
use crate::diagnosis::noise::Whitener;
use crate::diagnosis::regression::{Column, combined, solve};
use crate::error::Result;
use crate::identification::effect_model::Trust;
use crate::identification::model::Model;
use crate::recording::Recording;

impl<'a> Session<'a> {
    /// Makes the logs ready.
    ///
    /// # Errors
    /// If a log is too short or a joint hardly moves.
    pub fn new(model: &'a Model, trust: Trust, train: &[&Recording], test: &[&Recording]) -> Result<Self> {
        prepare(model, trust, Known::nothing(model.robot(), trust), train, test, Criteria::default())
    }
}

/// Prepares the logs with what is known in addition to the robot description, for findings by `criteria`.
///
/// # Errors
/// If a log is too short or a joint hardly moves.
pub(crate) fn prepare<'a>(
    model: &'a Model,
    trust: Trust,
    known: Known<'a>,
    train: &[&Recording],
    test: &[&Recording],
    criteria: Criteria,
) -> Result<Session<'a>> {
    let preparation = Preparation::new(model, &known, train, test, criteria)?;
    let Prepared { data_sets: [train, test], cutoff_hz, passband } = preparation.prepared()?;
    let (apart, cutoffs_hz) = (preparation.is_apart(), preparation.alike(cutoff_hz));
    let logs = PreparedLogs { train, test, bands: 0..0, apart, cutoffs_hz, passband };
    let (arm, knows) = (known.arm.clone(), known.clone());
    let model = ArmModel { base: model, trust, known: knows, arm, open_play: Vec::new(), rounding_gains: Vec::new() };
    let mut session = Session::unfitted(logs, model, criteria);
    // The Coulomb smoothing velocity is that from before a change, if one is in question; low-pass filtered torque does not determine
    // it.
    let Likeliest { rounding, gains } = match known.reference.is_empty() && passband.is_none() {
        true if apart => coulomb_width::likeliest(&session.over_all_logs(), &[])?,
        true => coulomb_width::likeliest(&session, &[])?,
        false => Likeliest { rounding: known.arm.coulomb_rounding.clone(), gains: vec![0.0; session.model.base.dof()] },
    };
    session.take_rounding_gains(gains);
    let known = known.with_coulomb_rounding(rounding);
    let preparation = preparation.knowing(&known);
    if known.arm.coulomb_rounding != session.model.arm.coulomb_rounding {
        let cutoffs_hz = session.logs.cutoffs_hz.clone();
        session.take_data_sets(preparation.data_sets(passband, &cutoffs_hz)?, cutoffs_hz);
        session.know(known.clone());
    }
    let mut noise = session.settle_baseline()?;
    let of_fit = (&noise.whitener, &noise.projection.residual);
    let likeliest = preparation.own_cutoffs((&session.model.arm, &session.logs.train.rows), of_fit, cutoff_hz)?;
    let own: Vec<f64> = likeliest.iter().map(|hz| preparation.raised(*hz)).collect();
    // What is above the low-pass of the torque is not seen in it, and its factor would fit anything.
    let seen_hz = passband.map_or(f64::INFINITY, |low_pass| low_pass.hz);
    if own.iter().any(|hz| *hz != cutoff_hz)
        && let Ok(data_sets) = preparation.data_sets(passband, &own)
    {
        tracing::debug!(?likeliest, ?own, "cut-offs of the joints");
        session.take_data_sets(data_sets, own);
        session.take_arm_as_known();
        noise = session.settle_baseline()?;
    }
    let noise_from = smoothing::noise_from_hz(&session.logs.train.rows)?;
    let from: Vec<f64> = likeliest.iter().zip(&noise_from).map(|(likeliest, noise)| likeliest.min(*noise)).collect();
    let up_to: Vec<f64> = session.logs.cutoffs_hz.iter().map(|hz| hz.min(seen_hz)).collect();
    tracing::debug!(?from, ?up_to, "bands of the encoders' noise");
    let bands = |set: &DataSet| smoothing::bands(&session.model.arm, &set.rows, &from, &up_to);
    let bands = [bands(&session.logs.train)?, bands(&session.logs.test)?];
    session.take_bands(bands);
    session.free_noise_of_encoders(seen_hz, &noise)?;
    session.take_arm_as_known();
    noise = session.settle_baseline()?;
    let noisy = smoothing::noisy_once_moved(
        &session.model.arm,
        &session.logs.train.rows,
        &noise.whitener,
        criteria.levels.minor,
    )?;
    session.mark_noisy(&noisy);
    session.leave_out_distorted(&noise.whitener);
    session.take_differences(&noise.whitener)?;
    Ok(session)
}

impl Session<'_> {
    /// Frees what the motion of each joint in its band does to the torque, by one factor: as far as that is noise of the encoder, columns
    /// of accelerations that hold it attenuate every estimate (errors in variables; Fuller, Measurement Error Models, 1987). What its
    /// controller makes of that noise is free, too, unless the held-out logs contradict what the training logs estimate: a controller
    /// answers in the same way in all of them (`fit` is that without these columns).
    fn free_noise_of_encoders(&mut self, seen_hz: f64, fit: &Fit) -> Result<()> {
        let dof = self.model.base.dof();
        let mut answers = [feedback(&self.logs.train.rows, seen_hz)?, feedback(&self.logs.test.rows, seen_hz)?];
        let of_joint = |joint: usize| FEEDBACK * joint..FEEDBACK * (joint + 1);
        let does_answer = |joint: &usize| answers[0][of_joint(*joint)].iter().any(|column| !column.parts.is_empty());
        let contradicted = self.contradicted(fit, (0..dof).filter(does_answer).collect(), |joint| {
            answers.each_ref().map(|all| all[of_joint(joint)].iter().map(|column| column.only(&[joint])).collect())
        })?;
        for joint in contradicted {
            answers.iter_mut().for_each(|all| all[of_joint(joint)].fill(Column::default()));
        }
        let sum = |on_each: &[Column]| Column::of(on_each.iter().flat_map(|column| column.parts.clone()).collect());
        let [train, test] = answers;
        let columns = [(&self.logs.train, train), (&self.logs.test, test)]
            .map(|(data, answers)| data.bands.chunks(dof).map(sum).chain(answers).collect::<Vec<Column>>());
        let place = self.blocks(&[]).known.start;
        let logs = self.logs.clone().with(place, &columns);
        self.go_on_with(PreparedLogs { bands: place..place + columns[0].len(), ..logs });
        Ok(())
    }

    /// Those of `joints` on which the held-out logs contradict what the training logs estimate of columns `of` them along both, added to
    /// `fit`.
    fn contradicted(
        &self,
        fit: &Fit,
        joints: Vec<usize>,
        of: impl Fn(usize) -> [Vec<Column>; 2],
    ) -> Result<Vec<usize>> {
        if joints.is_empty() {
            return Ok(joints);
        }
        let held_out = self.baseline_residual_on(&self.logs.test, &fit.whitener)?;
        let on_held_out = fit.whitener.on(&self.logs.test.rows);
        let is_contradicted = |joint: &usize| {
            let [train, test] = of(*joint);
            let free = fit.projection.left_of(fit.whitener.apply_all(&train));
            let mut after = held_out.only(&[*joint]);
            after.add(-1.0, &combined(&test, &solve(&free, &fit.projection.residual.only(&[*joint])).values));
            let gains = Gains::new(&on_held_out, &held_out, &after, &[*joint], self.logs.test.rows.len());
            tracing::debug!(joint, growth_p = gains.growth_p(), "held-out growth by what controllers make of noise");
            gains.growth_p() < self.criteria.levels.strict_p
        };
        Ok(joints.into_iter().filter(is_contradicted).collect())
    }

    /// Fits the arm without any effect; the noise is that under it.
    fn settle_baseline(&mut self) -> Result<Fit> {
        let noise = self.fit_under(&self.logs.train.baseline);
        self.settle(&mut [], &noise.whitener)?;
        Ok(noise)
    }

    /// Leaves out rows in which the low-pass distorted the motion, by the arm as estimated without any effect and the noise under it: the
    /// residual of a jerk there is no noise, and a few such rows can support any effect. The arm is then as known before.
    fn leave_out_distorted(&mut self, whitener: &Whitener) {
        let bearable = |std: &f64| self.criteria.structure.above_noise * std;
        let bearable: Vec<f64> = whitener.innovation_std().iter().map(bearable).collect();
        // The largest share of the rows that may be left out for this.
        let minor = self.criteria.levels.minor;
        let smoothing = [&self.logs.train, &self.logs.test].map(|set| self.errors(set).smoothing.clone());
        self.leave_out_largest(&smoothing, &bearable, minor);
        self.take_arm_as_known();
    }
}
