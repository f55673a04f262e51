//! The logs and the arm under diagnosis, and fits of the baseline with a few effects on top.

mod changes;
mod shapes;

use crate::diagnosis::criteria::Criteria;
use crate::diagnosis::model::arm_columns::Moved;
use crate::diagnosis::model::arm_model::ArmModel;
use crate::diagnosis::model::blocks::ParameterBlocks;
use crate::diagnosis::model::cut_off::flat_level;
use crate::diagnosis::model::data_set::DataSet;
use crate::diagnosis::model::errors_in_variables::{ErrorsInVariables, Nuisances};
use crate::diagnosis::model::member::Member;
use crate::diagnosis::model::prepared::PreparedLogs;
use crate::diagnosis::model::roles::{ENDS_OF_EVENT_S, is_event, is_gap, is_level, is_shift, linear, prior, shapes};
use crate::diagnosis::noise::{NoiseMemory, Whitener};
use crate::diagnosis::regression::{Column, Described, Projection, Solved, combined};
use crate::effects::Placed;
use crate::error::Result;
use crate::identification::effect_model::Arm;
use std::ops::Deref;
use std::sync::Arc;

/// Mean square of a joint's whitened residual up to which the noise is as large as the residual, and rounds of scaling it up to that: the
/// iteration ends there. From where a joint is misfit is decided by [`crate::diagnosis::Levels::misfit`].
const MISFIT: f64 = 1.2;
const MISFIT_ROUNDS: usize = 2;

/// Prepared logs, and the model of the arm as fitted to them. Who has a session reads its [`State`]; only its methods change it.
#[derive(Debug)]
pub struct Session<'a> {
    /// What can be read.
    state: State<'a>,
    /// Errors in variables along the training and the held-out logs: torque from errors of the positions, for the arm as last estimated.
    errors: [ErrorsInVariables; 2],
    /// Noises estimated so far, here and over all logs.
    noises: Arc<NoiseMemory>,
}

/// Standard deviation of a gear's play over its value that remains whatever the logs: teeth that yield as much as they have play meet later
/// and softer than stiff ones, and how much they yield is not known.
const SOFT_TEETH: f64 = 0.15;

/// Standard deviation of a gear's play by the `std` of its column's factor `value`. When teeth meet says `size`, how hard says the value;
/// they differ by what is not known of the gear.
fn std_of_gap(std: f64, size: f64, value: f64) -> f64 {
    std.hypot(size - value).hypot(SOFT_TEETH * value)
}

/// The logs, the model and the thresholds of a session.
#[derive(Debug)]
pub struct State<'a> {
    /// The logs.
    pub logs: PreparedLogs,
    /// The model.
    pub model: ArmModel<'a>,
    /// Thresholds that decide about what is found in it.
    pub criteria: Criteria,
}

impl<'a> Deref for Session<'a> {
    type Target = State<'a>;

    fn deref(&self) -> &State<'a> {
        &self.state
    }
}

/// A fit of a model to the training logs, in units of the noise under that model.
#[derive(Debug, Clone)]
pub(crate) struct Fit {
    /// Makes the noise white.
    pub whitener: Whitener,
    /// Projection of the torque on the columns of the model, and the residual.
    pub projection: Projection,
}

impl<'a> Session<'a> {
    /// A model that is not yet fitted to the logs.
    pub(crate) fn unfitted(logs: PreparedLogs, model: ArmModel<'a>, criteria: Criteria) -> Self {
        let state = State { logs, model, criteria };
        Session { state, errors: Default::default(), noises: Arc::default() }
    }

    /// What it holds, at its end.
    pub(crate) fn into_state(self) -> State<'a> {
        self.state
    }

    /// The same with all logs to identify from.
    pub(crate) fn over_all_logs(&self) -> Session<'a> {
        let pooled = Self::unfitted(self.logs.pooled(), self.model.clone(), self.criteria);
        Session { noises: self.noises.clone(), ..pooled }
    }

    /// Errors in variables along a data set of this session.
    pub(crate) fn errors(&self, data: &DataSet) -> &ErrorsInVariables {
        &self.errors[usize::from(!data.training)]
    }

    /// Nuisance regressors that a test of an effect is adjusted for: for one that shifts torque in time also the bands, since the noise
    /// in them is in the torque against the accelerations.
    pub(crate) fn errors_with(&self, data: &DataSet, placed: &Placed) -> Nuisances {
        let mut errors = self.errors(data).of_effect(placed, &data.rows);
        if is_shift(placed.effect) {
            errors.add(&data.bands, f64::INFINITY);
        }
        errors
    }

    /// Time between two samples of the first training log, s.
    pub(crate) fn sample_s(&self) -> f64 {
        self.logs.train.rows.logs.first().map_or(0.0, |log| log.period)
    }

    /// Whether an effect moves torque by no more than the sampling of the loop does, whatever the noise.
    pub(crate) fn sampling_makes(&self, placed: &Placed) -> bool {
        let most_s = self.sample_s().min(self.criteria.verdict.sampling_s);
        is_shift(placed.effect) && placed.amount().abs() <= most_s
    }

    /// Places of the parameters of the model with `members`.
    pub(crate) fn blocks(&self, members: &[Member]) -> ParameterBlocks {
        self.model.blocks(&self.logs.train, members)
    }

    /// The noise under the columns of a model, each joint's scaled up to its residual where that is more: a joint
    /// that is understood badly must not lend its excess to what is tested on it, nor pull at parameters it shares.
    pub(crate) fn noise_under(&self, present: &[Column]) -> Whitener {
        let DataSet { rows, torque, .. } = &self.logs.train;
        self.scaled(Whitener::remembered(&self.noises, rows, torque, present), present)
    }

    /// The same where more was added on one joint alone to what `whitener` is the noise under.
    pub(crate) fn noise_with_more_on(&self, joint: usize, whitener: &Whitener, present: &[Column]) -> Whitener {
        self.scaled(whitener.anew_on(joint, &self.logs.train.rows, &self.logs.train.torque, present), present)
    }

    /// The columns of a model fitted to the training logs, in units of the noise under them.
    pub(crate) fn fit_under(&self, present: &[Column]) -> Fit {
        let whitener = self.noise_under(present);
        Fit { projection: whitener.fit(present, &self.logs.train.torque), whitener }
    }

    /// A noise scaled up to the residual.
    fn scaled(&self, whitener: Whitener, present: &[Column]) -> Whitener {
        let equations = whitener.equations(present, &self.logs.train.torque);
        let counts = whitener.rows();
        let mut factors = vec![1.0; counts.len()];
        for _ in 0..MISFIT_ROUNDS {
            let left = equations.squared_residuals(&factors);
            let excess: Vec<f64> = left.iter().zip(&counts).map(|(left, &count)| left / count.max(1) as f64).collect();
            if excess.iter().all(|mean| *mean < MISFIT) {
                break;
            }
            factors.iter_mut().zip(excess).for_each(|(factor, mean)| *factor *= mean.max(1.0).sqrt());
        }
        whitener.with_misfit(&factors)
    }

    /// All parameters of the model with `members`, fitted at once to the training rows, in the order of
    /// [`ArmModel::columns`]; those of bodies that these rows do not determine are as described.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub(crate) fn solved(&self, members: &[Member], whitener: &Whitener) -> Result<Solved> {
        let columns = self.model.columns(&self.logs.train, members)?;
        let mut described = self.model.described(&self.logs.train);
        described.extend(self.known_of(members));
        Ok(whitener.solve(&columns, &self.logs.train.torque).with_described(&described))
    }

    /// What is known of the amplitudes of `members` beforehand: that a body differs from the described one by no more than such bodies do. A
    /// mass without a lever would come out as any number.
    fn known_of(&self, members: &[Member]) -> Vec<Described> {
        let robot = self.model.base.robot();
        let blocks = self.blocks(members).members;
        let each = members.iter().zip(blocks).flat_map(|(member, block)| {
            let spread = prior(&member.placed, robot);
            block.amplitudes.zip(spread).map(|(place, std)| Described { place, value: 0.0, std })
        });
        each.filter(|one| one.std.is_finite() && one.std > 0.0).collect()
    }

    /// Solves for all parameters with the members in the model and writes the estimates back; the arm takes its own, and with it
    /// what errors of the positions do.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub fn settle(&mut self, members: &mut [Member], whitener: &Whitener) -> Result<()> {
        let solved = self.solved(members, whitener)?;
        self.state.model.arm = self.arm_with(&solved);
        let blocks = self.blocks(members);
        for (member, block) in members.iter_mut().zip(&blocks.members).filter(|(member, _)| !member.held) {
            let effect = member.placed.effect;
            for ((k, index), place) in linear(effect).into_iter().enumerate().zip(block.amplitudes.clone()) {
                let is_fixed = member.fixed.contains(&index);
                member.factors[k] = if is_fixed { 0.0 } else { solved.values[place] };
                if !is_level(effect) {
                    member.placed.parameters[index] = member.factors[k];
                    let std = solved.std(place);
                    let size = member.candidate.placed.parameters[index];
                    let of_size = if is_gap(effect, index) { std_of_gap(std, size, solved.values[place]) } else { std };
                    member.std[index] = if is_fixed { f64::INFINITY } else { of_size };
                }
            }
            for ((k, index), place) in shapes(effect).into_iter().enumerate().zip(block.shapes.clone()) {
                let stays = member.fixed.contains(&index) || is_event(effect) || is_level(effect);
                member.shifts[k] = if stays { 0.0 } else { solved.values[place] };
                let fitted = member.candidate.placed.parameters[index];
                let std = if member.fixed.contains(&index) { f64::INFINITY } else { solved.std(place) };
                // The rows near the ends of an event are left out: where in them it begins is not determined.
                let std = if is_event(effect) { ENDS_OF_EVENT_S / 3f64.sqrt() } else { std };
                (member.placed.parameters[index], member.std[index]) = (fitted, std);
                if is_level(effect)
                    && let Some(flat) = flat_level(&self.model.arm, &self.logs.train.rows, member.placed.joint, fitted)
                {
                    member.placed.parameters[index] = flat.level;
                    member.std[index] = member.std[index].max(flat.std);
                }
            }
        }
        let parameters = self.errors_of_prediction(&solved, members, whitener)?;
        self.renew_errors(members, parameters)
    }

    /// Errors of the fitted parameters that change the prediction of the held-out rows of a joint by more than its noise.
    fn errors_of_prediction(&self, solved: &Solved, members: &[Member], whitener: &Whitener) -> Result<Nuisances> {
        let test = &self.logs.test;
        let columns = self.model.columns(test, members)?;
        let mut errors = Nuisances::default();
        for (factors, spread) in solved.errors_of_prediction(&columns, &test.rows.valid, &whitener.noise_std()) {
            errors.add(&[combined(&columns, &factors)], spread);
        }
        Ok(errors)
    }

    /// Takes errors in variables along the logs for the arm as it is, with the loads among `members` and `parameters`, errors of the fit
    /// that matter along the held-out logs.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub(crate) fn renew_errors(&mut self, members: &[Member], parameters: Nuisances) -> Result<()> {
        let ArmModel { arm, .. } = &self.model;
        let along = |data: &DataSet, parameters: Nuisances| {
            let mut loads = Column::default();
            for Member { candidate, factors, .. } in members.iter().filter(|member| member.placed.effect.is_load()) {
                let placed = std::slice::from_ref(&candidate.placed);
                for columns in data.columns(arm, candidate.log, placed, Moved::Modelled)? {
                    loads.add(1.0, &combined(&columns, factors));
                }
            }
            ErrorsInVariables::new(arm, &data.rows, loads, parameters)
        };
        self.errors = [along(&self.logs.train, Nuisances::default())?, along(&self.logs.test, parameters)?];
        Ok(())
    }

    /// Torque of a fit along either data set that comes of the noise of the encoders: of what positions hold in the bands.
    pub(crate) fn of_bands(&self, data: &DataSet, solved: &Solved) -> Column {
        let bands = self.logs.bands.clone();
        combined(&data.baseline[bands.clone()], &solved.values[bands])
    }

    /// The arm with the parameters of its baseline from a fit; differences from before a change leave it as it was then.
    pub(crate) fn arm_with(&self, solved: &Solved) -> Arm {
        let mut arm = self.model.arm.clone();
        if self.logs.train.rows.equal_states.is_none() {
            arm.take(self.model.base, &solved.values);
        }
        arm
    }

    /// Number of those found before that have one sign only and whose sign the last of `members` turns: both then describe the same, and
    /// the former with a law that cannot be. `solved` is the fit of all of them.
    pub(crate) fn turns_unphysical(&self, members: &[Member], solved: &Solved) -> usize {
        let earlier = &members[..members.len().saturating_sub(1)];
        let blocks = self.blocks(earlier).members;
        let turned = earlier.iter().zip(&blocks).filter(|(member, _)| !member.held).filter(|(member, block)| {
            let is_positive = member.candidate.one_sided() && member.factors[0] > 0.0;
            is_positive && solved.values[block.amplitudes.start] < 0.0
        });
        turned.inspect(|(member, _)| tracing::debug!(family = ?member.candidate.family(), "turns unphysical")).count()
    }

    /// For each amplitude that the training rows determine in the fit `without` one more member, and not in that `with` it: which of the
    /// `earlier` members it belongs to.
    pub(crate) fn undetermined_by_one_more(&self, earlier: &[Member], [without, with]: &[Solved; 2]) -> Vec<usize> {
        let undone = |&place: &usize| without.std(place).is_finite() && with.std(place).is_infinite();
        let blocks = self.blocks(earlier).members.into_iter().enumerate();
        blocks.flat_map(|(member, block)| block.amplitudes.filter(undone).map(move |_| member)).collect()
    }

    /// Residual of the held-out rows when the model is fitted to the training rows.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub(crate) fn held_out_residual(&self, members: &[Member], whitener: &Whitener) -> Result<Column> {
        self.residual_on(&self.logs.test, members, whitener)
    }

    /// Residual of either data set.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub(crate) fn residual_on(&self, data: &DataSet, members: &[Member], whitener: &Whitener) -> Result<Column> {
        self.residual_of(data, members, &self.solved(members, whitener)?)
    }

    /// Residual of either data set under a fit of the model with `members`.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub(crate) fn residual_of(&self, data: &DataSet, members: &[Member], solved: &Solved) -> Result<Column> {
        Ok(data.residual(&self.model.columns(data, members)?, &solved.values))
    }

    /// Residual of the baseline on either data set: as it was before the change, where one is in question.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub(crate) fn baseline_residual_on(&self, data: &DataSet, whitener: &Whitener) -> Result<Column> {
        match self.logs.train.rows.before {
            0 => self.residual_on(data, &[], whitener),
            _ => Ok(data.residual(&data.baseline, &self.baseline_before(whitener))),
        }
    }

    /// Parameters of the baseline by the training logs from before the change alone.
    pub(crate) fn baseline_before(&self, whitener: &Whitener) -> Vec<f64> {
        let DataSet { rows, baseline, torque, .. } = &self.logs.train;
        let mut before = rows.clone();
        before.valid.iter_mut().for_each(|valid| valid[rows.changed_from()..].fill(false));
        let whitener = whitener.on(&before);
        whitener.solve(baseline, torque).values
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::model::Candidate;
    use crate::diagnosis::test_logs::log;
    use crate::effects::find;
    use crate::identification::effect_model::Trust;
    use crate::identification::model::Model;
    use crate::robot::{InertiaCheck, load};

    /// About a vertical axis one moment of inertia of the first link has torque. Its mass hardly has any here, and came out as 900 kg.
    #[test]
    fn the_mass_of_a_link_without_a_lever_stays_as_described() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../urdf/irb1600_6_120.urdf");
        let robot = load(path, InertiaCheck::Required).unwrap();
        let arm = Arm::new(&robot, Trust::Nominal);
        let logs = [1, 2].map(|seed| log(&arm, seed));
        let model = Model::new(&robot);
        let session = Session::new(&model, Trust::Nominal, &[&logs[0]], &[&logs[1]]).unwrap();
        let placed = Placed::typical(find("link_inertia_error").unwrap(), 0);
        let columns = session.model.arm.baseline(&model, &session.logs.train.rows);
        let rows = columns[0].part(0).unwrap().len();
        let mut of_link = vec![Column::default(); 10];
        of_link[0] = Column::on(0, (0..rows).map(|row| 1e-9 * (0.7 * row as f64).sin()).collect());
        of_link[9] = Column::on(0, session.logs.train.rows.signal(|log| log.motion.qdd.channel(0).to_vec()));
        let factors = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.1];
        let member = Member::new(&Candidate { placed, log: None, columns: of_link.into() }, &factors);
        let known = session.known_of(std::slice::from_ref(&member));
        assert_eq!(known.len(), 10);
        assert!(known.iter().all(|one| one.value == 0.0) && known[0].std == robot.joints[0].inertia.mass());
        let whitener = session.fit_under(&session.logs.train.baseline).whitener;
        let solved = session.solved(&[member], &whitener).unwrap();
        let mass = solved.values[known[0].place];
        assert!(mass.abs() < robot.joints[0].inertia.mass(), "{mass}");
        let gain = Placed::typical(find("torque_gain").unwrap(), 0);
        let gain = Member::new(&Candidate { placed: gain, log: None, columns: vec![Column::default()].into() }, &[0.0]);
        assert!(session.known_of(&[gain]).is_empty());
    }

    #[test]
    fn two_estimates_of_a_gap_are_as_uncertain_as_they_differ() {
        // 0.2, 0.3 from 1.2 to 1.5, and 15 % of 1.5.
        assert!((std_of_gap(0.2, 1.2, 1.5) - (0.04f64 + 0.09 + 0.225 * 0.225).sqrt()).abs() < 1e-12);
    }
}
