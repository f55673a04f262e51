//! The arm as identified so far along rows: columns of its baseline, and what effects add to its torque.

use super::roles::is_shift;
use crate::channels::Channels;
use crate::diagnosis::logs::{Log, Rows};
use crate::diagnosis::regression::Column;
use crate::dynamics::{Motion, inverse_dynamics};
use crate::effects::{Along, Contribution, Gear, Placed, Rounding, Scope, Site, behind_gears};
use crate::error::Result;
use crate::identification::effect_model::{Arm, Geared, Laws, Trust, law_sites};
use crate::identification::model::Model;
use crate::identification::standard::{COULOMB, STANDARD};
use crate::signal::second_derivative;
use rayon::prelude::*;
use std::ops::Range;

/// Placed effects whose torque is worked out in one pass over a log; bounds the memory that takes.
const BATCH: usize = 24;

/// Which torque is moved in time by a law that shifts or spreads it. The noise of the accelerations is in the moved torque and in the
/// residual alike: their correlation looks like a shift.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Moved {
    /// To test for a shift: along accelerations that stand clear of the noise, which omits some of the motion.
    Tested,
    /// In a model: the same on joints that [`Log::noisy`] has, along all of the motion on the others.
    Modelled,
}

impl Arm {
    /// Columns of the baseline: rotor inertia, viscous and Coulomb friction of every joint, and where the inertias are
    /// estimated all base parameters.
    pub fn baseline(&self, model: &Model, rows: &Rows) -> Vec<Column> {
        let tables: Vec<Vec<Channels>> = rows.logs.par_iter().map(|log| model.columns(&log.motion, 0.0)).collect();
        let mut columns: Vec<Column> = self
            .base(model)
            .map(|b| {
                if is_dry(model, b) {
                    return dry_column(model, b, rows, &self.coulomb_rounding);
                }
                let on = |joint: usize| {
                    let place = model.active(joint).into_iter().position(|other| other == b)?;
                    let logs = rows.logs.iter().zip(&tables);
                    Some(logs.flat_map(|(log, table)| log.as_logged(table[joint].channel(place))).collect())
                };
                Column::new((0..rows.dof()).map(|joint| on(joint).unwrap_or_default()))
            })
            .collect();
        if self.trust() == Trust::Nominal {
            columns.extend(
                (0..rows.dof())
                    .filter(|&joint| model.has_equation(joint))
                    .map(|joint| Column::on(joint, rows.signal(|log| log.motion.qdd.channel(joint).to_vec()))),
            );
        }
        columns
    }

    /// Base parameters with a column in the baseline.
    fn base<'m>(&self, model: &'m Model) -> impl Iterator<Item = usize> + use<'m> {
        let trust = self.trust();
        (0..model.base().len()).filter(move |&b| trust == Trust::Structure || model.is_friction(b))
    }

    /// Columns of Coulomb friction whose sign is rounded otherwise, each with its place in the baseline.
    pub(crate) fn dry_columns(&self, model: &Model, rows: &Rows, rounding: &[Rounding]) -> Vec<(usize, Column)> {
        let dry = self.base(model).enumerate().filter(|&(_, b)| is_dry(model, b));
        dry.map(|(place, b)| (place, dry_column(model, b, rows, rounding))).collect()
    }

    /// The same of those that act on a joint.
    pub(crate) fn dry_columns_on(
        &self,
        joint: usize,
        model: &Model,
        rows: &Rows,
        rounding: &[Rounding],
    ) -> Vec<Column> {
        let own = self.base(model).filter(|&b| is_dry(model, b) && model.active(joint).contains(&b));
        own.map(|b| dry_column(model, b, rows, rounding)).collect()
    }

    /// Torque that is known before anything is fitted: that of the bodies where their inertias are taken from the URDF.
    pub(crate) fn described_torque(&self, rows: &Rows) -> Column {
        match self.trust() {
            Trust::Structure => Column::default(),
            Trust::Nominal => {
                let inertial = self.described().inertial_parameters();
                let logs: Vec<Channels> =
                    rows.logs.par_iter().map(|log| inverse_dynamics(self.chain(), &inertial, &log.motion)).collect();
                all_over_rows(rows, &logs)
            }
        }
    }

    /// Torque of the arm as found along every log, `[joint][time]`.
    pub fn along(&self, rows: &Rows) -> Vec<Channels> {
        rows.logs.par_iter().map(|log| self.torque(&log.motion, &log.motion)).collect()
    }

    /// Torque of the arm as found over the rows.
    pub(crate) fn all_torque(&self, rows: &Rows) -> Column {
        all_over_rows(rows, &self.along(rows))
    }

    /// Torque of the arm as found along `other` motions of the logs less `along` the smooth ones, over the rows.
    ///
    /// # Errors
    /// Those of `other`, which is given the number of a log and the log.
    pub fn departure(
        &self,
        rows: &Rows,
        along: &[Channels],
        other: impl Fn(usize, &Log) -> Result<Motion> + Sync,
    ) -> Result<Column> {
        let each = rows.logs.par_iter().zip(along).enumerate().map(|(index, (log, along))| {
            let motion = other(index, log)?;
            let mut torque = self.torque(&motion, &motion);
            torque.subtract(along);
            Ok(torque)
        });
        Ok(all_over_rows(rows, &each.collect::<Result<Vec<Channels>>>()?))
    }

    /// Second derivative of the torque that the gears of the arm as found carry, over the rows, N m/s2.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub fn bend(&self, rows: &Rows) -> Result<Column> {
        let each = rows.logs.par_iter().map(|log| {
            let load = self.load(&log.motion);
            let mut bend = load.clone();
            for joint in 0..load.channels() {
                second_derivative(load.channel(joint), log.period, bend.channel_mut(joint))?;
            }
            Ok(bend)
        });
        Ok(all_over_rows(rows, &each.collect::<Result<Vec<Channels>>>()?))
    }

    /// What each placed effect adds to the logged torque over the rows from after the change in question (all rows where no
    /// log is from before), against the arm as found.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub fn added(&self, placed: &[Placed], rows: &Rows) -> Result<Vec<Column>> {
        self.added_in(rows.before..rows.logs.len(), placed, rows, Moved::Modelled)
    }

    /// [`Arm::added`] over all rows, those from before the change too.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub(crate) fn added_throughout(&self, placed: &[Placed], rows: &Rows) -> Result<Vec<Column>> {
        self.added_in(0..rows.logs.len(), placed, rows, Moved::Modelled)
    }

    /// The same over all rows where they act in some of the logs only.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub(crate) fn added_in(
        &self,
        acting: Range<usize>,
        placed: &[Placed],
        rows: &Rows,
        moved: Moved,
    ) -> Result<Vec<Column>> {
        // What laws may ask about a motion is worked out once for all batches, where there are such laws.
        let asked: Vec<Site> = law_sites(placed).collect();
        let sites = rows.logs.par_iter().enumerate().map(|(k, log)| {
            let asked = asked.iter().filter(|_| acting.contains(&k));
            asked
                .map(|site| (*site, self.laws_along(*site, &log.time, &log.motion).with_samples(log.by_sample())))
                .collect()
        });
        let sites: Vec<Vec<(Site, Along)>> = sites.collect();
        let batches = placed.par_chunks(BATCH).map(|batch| -> Result<Vec<Column>> {
            let logs = rows.logs.par_iter().zip(&sites).enumerate();
            let logs = logs.map(|(k, (log, sites))| match acting.contains(&k) {
                true => self.added_to(batch, log, sites, moved),
                false => Ok(vec![Vec::new(); batch.len()]),
            });
            let logs: Vec<Vec<AsLogged>> = logs.collect::<Result<_>>()?;
            let of = |index: usize| over_rows(rows, |log, joint| logs[log][index].get(joint)?.as_deref());
            Ok((0..batch.len()).map(of).collect())
        });
        let batches: Vec<Vec<Column>> = batches.collect::<Result<_>>()?;
        Ok(batches.into_iter().flatten().collect())
    }

    fn added_to(&self, batch: &[Placed], log: &Log, sites: &[(Site, Along)], moved: Moved) -> Result<Vec<AsLogged>> {
        let (mut plain, mut carried, mut to_move) = (None, None, None);
        let mut laws = Laws::new(sites);
        let mut all = Vec::with_capacity(batch.len());
        for placed in batch {
            let torque: Contribution = match (laws.torque(placed), placed.effect.gear(&placed.parameters)) {
                (Some(torque), _) => torque,
                (None, Some(gear)) => {
                    let carried = carried.get_or_insert_with(|| self.load(&log.motion));
                    self.behind_gear(placed.joint, gear, log, carried)?.into()
                }
                (None, None) => {
                    let plain = plain.get_or_insert_with(|| self.torque(&log.motion, &log.motion));
                    if is_shift(placed.effect) && to_move.is_none() {
                        to_move = Some(self.torque_to_move(log, plain, moved)?);
                    }
                    let before = to_move.as_ref().filter(|_| is_shift(placed.effect)).unwrap_or(plain);
                    self.changed(placed, log, before)?.into()
                }
            };
            // At the rate of the rows at once: hundreds of signals at the log's own rate would each take memory anew.
            all.push(
                (0..log.motion.joints()).map(|joint| torque.on(joint).map(|torque| log.as_logged(torque))).collect(),
            );
        }
        Ok(all)
    }

    /// Torque that is to be moved in time, where `plain` is that along the motion: along accelerations that stand clear of the encoders'
    /// noise, on all joints or where that noise is most of it once it is moved.
    fn torque_to_move(&self, log: &Log, plain: &Channels, moved: Moved) -> Result<Channels> {
        let is_clear = |joint: usize| moved == Moved::Tested || log.noisy[joint];
        let mut torque = plain.clone();
        if (0..torque.channels()).any(is_clear) {
            let motion = log.clear()?;
            let clear = self.torque(motion, motion);
            for joint in (0..torque.channels()).filter(|joint| is_clear(*joint)) {
                torque.channel_mut(joint).copy_from_slice(clear.channel(joint));
            }
        }
        Ok(torque)
    }

    /// Its gears along a log.
    fn geared<'a>(&'a self, log: &'a Log) -> Geared<'a> {
        Geared {
            arm: self,
            motors: &log.motion,
            period: log.period,
            sharp: Box::new(|| log.sharp()),
            smoothed: Box::new(|joint, signal| {
                let mut smooth = signal.to_vec();
                log.low_pass[joint].apply_in_place(&mut smooth)?;
                Ok(smooth)
            }),
        }
    }

    /// Change of the torque that the gears carry, which is `carried` behind stiff ones, by one that gives way. Rotors and friction are on
    /// the motors' side.
    pub(crate) fn behind_gear(&self, joint: usize, gear: Gear, log: &Log, carried: &Channels) -> Result<Channels> {
        let mut torque = self.load(&behind_gears(&self.geared(log), &[(joint, gear)])?);
        torque.subtract(carried);
        Ok(torque)
    }

    /// Change of the logged torque, which is `plain` without it, by an effect in a sensor.
    fn changed(&self, placed: &Placed, log: &Log, plain: &Channels) -> Result<Channels> {
        let mut torque = match log.behind_encoders(std::slice::from_ref(placed))? {
            Some(motion) => self.torque(&motion, &motion),
            None => plain.clone(),
        };
        let joints = match placed.effect.about().scope {
            Scope::Arm => 0..torque.channels(),
            _ => placed.joint..placed.joint + 1,
        };
        for joint in joints {
            placed.effect.distort_torque(&placed.parameters, torque.channel_mut(joint), log.period);
        }
        torque.subtract(plain);
        Ok(torque)
    }
}

/// Torque on each joint over the rows of a log; None where there is none.
type AsLogged = Vec<Option<Vec<f64>>>;

/// The torque that `of` gives over the rows of a log on a joint as a column; None where there is none.
fn over_rows<'a>(rows: &Rows, of: impl Fn(usize, usize) -> Option<&'a [f64]>) -> Column {
    let logs = || 0..rows.logs.len();
    Column::new((0..rows.dof()).map(|joint| {
        if logs().all(|log| of(log, joint).is_none()) {
            return Vec::new();
        }
        let mut all = Vec::with_capacity(rows.len());
        for log in logs() {
            match of(log, joint) {
                Some(torque) => all.extend_from_slice(torque),
                None => all.resize(rows.starts[log + 1], 0.0),
            }
        }
        all
    }))
}

/// Torques of all logs, `[joint][time]`, at their own rates as a column over the rows.
pub(super) fn all_over_rows(rows: &Rows, logs: &[Channels]) -> Column {
    let on = |joint: usize| {
        let each = rows.logs.iter().zip(logs);
        each.flat_map(|(log, torque)| log.as_logged(torque.channel(joint))).collect()
    };
    Column::new((0..rows.dof()).map(on))
}

/// Whether a base parameter is Coulomb friction.
fn is_dry(model: &Model, b: usize) -> bool {
    model.base().kept()[b] % STANDARD == COULOMB
}

/// Column of Coulomb friction: the direction of motion, with the `rounding` of each joint.
fn dry_column(model: &Model, b: usize, rows: &Rows, rounding: &[Rounding]) -> Column {
    let on = |joint: usize| {
        let turned = |log: &Log| {
            let moving = log.motion.qd.channel(joint).iter().zip(log.motion.qdd.channel(joint));
            moving.map(|(&v, &a)| rounding[joint].direction(v, a)).collect()
        };
        model.active(joint).contains(&b).then(|| rows.signal(turned))
    };
    Column::new((0..rows.dof()).map(|joint| on(joint).unwrap_or_default()))
}
