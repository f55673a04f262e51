//! The logs and the arm under diagnosis, and fits of the baseline with a few effects on top.

use super::arm::{Arm, Moved};
use super::blocks::ParameterBlocks;
use super::candidates::{Candidate, columns_in};
use super::cut_off::flat_level;
use super::data_set::DataSet;
use super::errors_in_variables::ErrorsInVariables;
use super::known::Known;
use super::member::Member;
use super::roles::{is_level, linear, shapes};
use crate::diagnosis::logs::LowPass;
use crate::diagnosis::noise::Whitener;
use crate::diagnosis::regression::{Column, Projection, Solved, combined, solve};
use crate::effects::Parameter;
use crate::error::Result;
use crate::identification::effect_model::Trust;
use crate::identification::model::Model;
use crate::robot::Robot;

/// Mean square of a joint's whitened residual from which it counts as misfit, and rounds of growing the noise to it.
const MISFIT: f64 = 1.2;
const MISFIT_ROUNDS: usize = 2;

/// Share of a shape's value over which its derivative is taken.
const DIFFERENCE: f64 = 0.02;

/// What is under diagnosis.
#[derive(Debug)]
pub struct Session<'a> {
    /// The model of the arm.
    pub model: &'a Model,
    /// Whether its inertias are estimated or taken from the URDF.
    pub trust: Trust,
    /// What is known before anything is tested.
    pub known: Known<'a>,
    /// The arm as found so far.
    pub arm: Arm,
    /// Logs that are identified from.
    pub train: DataSet,
    /// Logs to judge by.
    pub test: DataSet,
    /// Whether these are others than those identified from.
    pub apart: bool,
    /// Joints whose gears may have play: impacts show some, but not significantly.
    pub open_play: Vec<usize>,
    /// Cut-off of the low-pass of each joint's positions, Hz.
    pub cutoffs_hz: Vec<f64>,
    /// The low-pass that torque went through before it was logged, if any.
    pub passband: Option<LowPass>,
}

/// The noise under a model and the model's fit in its units.
#[derive(Debug, Clone)]
pub struct Noise {
    /// Makes the noise white.
    pub whitener: Whitener,
    /// The fit of the model.
    pub fit: Projection,
}

impl<'a> Session<'a> {
    /// The same with all logs to identify from.
    pub fn over_all_logs(&self) -> Session<'a> {
        let Session { model, trust, passband, .. } = *self;
        let (known, arm, test) = (self.known.clone(), self.arm.clone(), self.test.clone());
        let cutoffs_hz = self.cutoffs_hz.clone();
        let (train, open_play) = (self.train.and(&test), self.open_play.clone());
        Session { model, trust, known, arm, train, test, apart: false, open_play, cutoffs_hz, passband }
    }

    /// Places of the parameters of the model with `members`.
    pub fn blocks(&self, members: &[Member]) -> ParameterBlocks {
        ParameterBlocks::new(self.train.baseline.len(), self.known.fitted().len(), members)
    }

    /// Takes the arm's parameters from `robot` instead of from a fit.
    pub fn take_parameters_of(&mut self, robot: &Robot) {
        self.arm = Arm::new(robot, self.trust).with_sign_widths(self.arm.sign_widths.clone());
    }

    /// Largest torque of a joint of the arm as found, on the training rows, N m.
    pub fn largest_torque(&self, joint: usize) -> f64 {
        let torque = self.arm.all_torque(&self.train.rows);
        torque.part(joint).unwrap_or_default().iter().fold(0.0f64, |m, v| m.max(v.abs()))
    }

    /// Columns of the model with effects: baseline, every effect's columns, derivatives to their shapes.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub fn all_columns(&self, data: &DataSet, members: &[Member]) -> Result<Vec<Column>> {
        let mut all = data.baseline.clone();
        for member in members.iter().filter(|member| !member.held) {
            if data.training || member.candidate.log.is_none() {
                let Candidate { placed, log, .. } = &member.candidate;
                let mut own =
                    columns_in(&self.arm, &data.rows, *log, std::slice::from_ref(placed), Moved::Modelled)?.concat();
                own.extend(self.tangents(data, &member.candidate, &member.factors)?);
                for (column, index) in own.iter_mut().zip(member.places()) {
                    if member.fixed.contains(&index) {
                        *column = Column::default();
                    }
                }
                all.extend(own);
            } else {
                // What happened in a training log did not happen here.
                all.extend(member.places().map(|_| Column::default()));
            }
        }
        Ok(all)
    }

    /// Derivatives of an effect's torque to its shapes.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub fn tangents(&self, data: &DataSet, candidate: &Candidate, factors: &[f64]) -> Result<Vec<Column>> {
        let Candidate { placed, log, .. } = candidate;
        let mut tangents = Vec::new();
        for index in shapes(placed.effect) {
            let parameter = &placed.effect.parameters()[index];
            let step = DIFFERENCE * placed.parameters[index].abs().max(0.1 * parameter.typical.abs());
            let moved = |by: f64| {
                let mut moved = placed.clone();
                moved.parameters[index] = bounded(parameter, placed.parameters[index] + by);
                moved
            };
            let (ahead, behind) = (moved(step), moved(-step));
            let apart = ahead.parameters[index] - behind.parameters[index];
            let both = columns_in(&self.arm, &data.rows, *log, &[ahead, behind], Moved::Modelled)?;
            let mut tangent = combined(&both[0], factors);
            tangent.add(-1.0, &combined(&both[1], factors));
            tangent.scale(1.0 / apart);
            tangents.push(tangent);
        }
        Ok(tangents)
    }

    /// The noise under the columns of a model, each joint's scaled up to its residual where that is more: a joint
    /// that is understood badly must not lend its excess to what is tested on it, nor pull at parameters it shares.
    pub fn noise_under(&self, present: &[Column]) -> Noise {
        self.grown(Whitener::new(&self.train.rows, &self.train.torque, present), present)
    }

    /// The same where more was added on one joint alone to what `whitener` is the noise under.
    pub fn noise_with_more_on(&self, joint: usize, whitener: &Whitener, present: &[Column]) -> Noise {
        self.grown(whitener.anew_on(joint, &self.train.rows, &self.train.torque, present), present)
    }

    /// A noise scaled up to the residual.
    fn grown(&self, mut whitener: Whitener, present: &[Column]) -> Noise {
        let mut fit = whitener.fit(present, &self.train.torque);
        for _ in 0..MISFIT_ROUNDS {
            let excess: Vec<f64> = whitener
                .rows()
                .into_iter()
                .enumerate()
                .map(|(joint, count)| {
                    let left: f64 = fit.residual.part(joint).unwrap_or_default().iter().map(|r| r * r).sum();
                    left / count.max(1) as f64
                })
                .collect();
            if excess.iter().all(|mean| *mean < MISFIT) {
                break;
            }
            let factors: Vec<f64> = excess.iter().map(|mean| mean.max(1.0).sqrt()).collect();
            whitener = whitener.with_misfit(&factors);
            fit = whitener.fit(present, &self.train.torque);
        }
        Noise { whitener, fit }
    }

    /// All parameters of the model with `members`, fitted at once to the training rows, in the order of
    /// [`Session::all_columns`].
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub fn solved(&self, members: &[Member], whitener: &Whitener) -> Result<Solved> {
        let columns = self.all_columns(&self.train, members)?;
        Ok(solve(&whitener.apply_all(&columns), &whitener.apply(&self.train.torque)))
    }

    /// Solves for all parameters with the members in the model and writes the estimates back; the arm takes its own, and with it
    /// what errors of the positions do.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub fn settle(&mut self, members: &mut [Member], whitener: &Whitener) -> Result<()> {
        let solved = self.solved(members, whitener)?;
        self.arm.take(self.model, &solved.values);
        for data in [&mut self.train, &mut self.test] {
            data.errors = ErrorsInVariables::new(&self.arm, &data.rows)?;
        }
        let blocks = self.blocks(members);
        for (member, block) in members.iter_mut().zip(&blocks.members).filter(|(member, _)| !member.held) {
            let effect = member.placed.effect;
            for ((k, index), place) in linear(effect).into_iter().enumerate().zip(block.amplitudes.clone()) {
                let is_fixed = member.fixed.contains(&index);
                member.factors[k] = if is_fixed { 0.0 } else { solved.values[place] };
                if !is_level(effect) {
                    member.placed.parameters[index] = member.factors[k];
                    member.std[index] = if is_fixed { f64::INFINITY } else { solved.std(place) };
                }
            }
            for (index, place) in shapes(effect).into_iter().zip(block.shapes.clone()) {
                let fitted = member.candidate.placed.parameters[index];
                let std = if member.fixed.contains(&index) { f64::INFINITY } else { solved.std(place) };
                (member.placed.parameters[index], member.std[index]) = (fitted, std);
                if is_level(effect)
                    && let Some(flat) = flat_level(&self.arm, &self.train.rows, member.placed.joint, fitted)
                {
                    member.placed.parameters[index] = flat.level;
                    member.std[index] = member.std[index].max(flat.std);
                }
            }
        }
        Ok(())
    }

    /// Whether the last of `members` turns the sign of one found before that has one sign only: both then describe the same, and
    /// the former with a law that cannot be.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub fn turns_unphysical(&self, members: &[Member], whitener: &Whitener) -> Result<bool> {
        let solved = self.solved(members, whitener)?;
        let earlier = &members[..members.len().saturating_sub(1)];
        let blocks = self.blocks(earlier).members;
        let turned = earlier.iter().zip(&blocks).filter(|(member, _)| !member.held).find(|(member, block)| {
            let is_positive = member.candidate.one_sided() && member.factors[0] > 0.0;
            is_positive && solved.values[block.amplitudes.start] < 0.0
        });
        if let Some((member, _)) = turned {
            tracing::debug!(family = ?member.candidate.family(), "turns unphysical");
        }
        Ok(turned.is_some())
    }

    /// Residual of the held-out rows when the model is fitted to the training rows.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub fn held_out_residual(&self, members: &[Member], whitener: &Whitener) -> Result<Column> {
        self.residual_on(&self.test, members, whitener)
    }

    /// Residual of either data set.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub fn residual_on(&self, data: &DataSet, members: &[Member], whitener: &Whitener) -> Result<Column> {
        Ok(left(data, &self.all_columns(data, members)?, &self.solved(members, whitener)?))
    }

    /// Residual of the baseline on either data set: as it was before the change, where one is in question.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub fn baseline_residual_on(&self, data: &DataSet, whitener: &Whitener) -> Result<Column> {
        let DataSet { rows, baseline, torque, .. } = &self.train;
        if rows.before == 0 {
            return self.residual_on(data, &[], whitener);
        }
        let mut before = rows.clone();
        before.valid.iter_mut().for_each(|valid| valid[rows.changed_from()..].fill(false));
        let whitener = whitener.on(&before);
        Ok(left(data, &data.baseline, &solve(&whitener.apply_all(baseline), &whitener.apply(torque))))
    }
}

/// Residual of the torque of `data` under `columns` with their factors.
fn left(data: &DataSet, columns: &[Column], solved: &Solved) -> Column {
    let mut left = data.torque.clone();
    columns.iter().zip(&solved.values).for_each(|(column, value)| left.add(-value, column));
    left
}

/// A value within the bounds of its parameter.
pub fn bounded(parameter: &Parameter, value: f64) -> f64 {
    value.clamp(parameter.lower, parameter.upper)
}
