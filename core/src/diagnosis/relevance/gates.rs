//! The gates that a finding must pass to be reported.

use super::fit::HeldFit;
use crate::diagnosis::criteria::{Criteria, Gate, Judgement, Levels};
use crate::diagnosis::evidence::{Gains, Multiplicity, family_wise};
use crate::diagnosis::model::{Member, Session, is_level, is_shift, linear};
use crate::diagnosis::noise::Whitener;
use crate::diagnosis::regression::{Column, deviation, rms};
use crate::diagnosis::variance::{gain_over_generic_functions, torques};
use crate::effects::{Placed, Scope, Site};
use crate::error::Result;
use nalgebra::DMatrix;
use rayon::prelude::*;
use statrs::distribution::{ContinuousCDF, Normal, StudentsT};
use std::collections::HashMap;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// What the gates judge by.
#[derive(Debug)]
pub(super) struct Judge<'a> {
    session: &'a Session<'a>,
    members: &'a [Member],
    fit: HeldFit<'a>,
    /// The noise on the held-out logs.
    on_held_out: Whitener,
    /// Least size of a finding on each joint, N m.
    least: Vec<f64>,
    /// Standard deviation of the noise of each joint, N m.
    noise: Vec<f64>,
    /// Residual of the baseline on the held-out logs.
    baseline: Column,
    /// All logs, with the columns of the model along them.
    all_logs: Session<'a>,
    all_columns: Vec<Column>,
    /// Torque of the arm along them, `[joint][row]`, N m.
    torques: Vec<Vec<f64>>,
    /// How many independent tests each kind of effect is worth.
    multiplicity: &'a Multiplicity,
    /// What members explain beyond generic functions, as far as that was worked out: most of it is asked again after every elimination.
    beyond: Mutex<HashMap<LawOnJoint, Option<f64>>>,
}

/// A member, one of its joints, and the other members that have torque there.
type LawOnJoint = (usize, usize, Vec<usize>);

/// A finding with its judgements.
#[derive(Debug)]
pub(super) struct Judged {
    /// Its place among those kept.
    pub index: usize,
    /// Size on every joint: root of the difference of the mean squares with and without it, N m.
    pub size: Vec<f64>,
    /// The largest of these over the least size that matters.
    pub relative_size: f64,
    /// The gates, the first that fails first.
    pub judgements: Vec<Judgement>,
}

impl Judged {
    /// The first gate that fails.
    pub(super) fn failed(&self) -> Option<Judgement> {
        self.judgements.iter().copied().find(|judgement| !judgement.passed)
    }
}

impl<'a> Judge<'a> {
    /// The judge of `members` in the model of `session` under the noise of `whitener`; any size matters on the joints of `any_size`.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub(super) fn new(
        session: &'a Session<'a>,
        members: &'a [Member],
        whitener: &'a Whitener,
        multiplicity: &'a Multiplicity,
        any_size: &[usize],
    ) -> Result<Self> {
        let criteria = &session.criteria;
        let fit = HeldFit::new(session, members, whitener)?;
        let rows = &session.logs.train.rows;
        let [trained, baseline] = fit.residuals(&[]);
        let torque = rms(&rows.valid, &Column::new(rows.torque.iter().cloned()));
        let noise = whitener.noise_std();
        let residual = rms(&rows.valid, &trained);
        let least = residual.iter().zip(&noise).zip(&torque).map(|((r, n), t)| least_size(*r, *n, *t, criteria));
        let mut least: Vec<f64> = least.collect();
        any_size.iter().for_each(|&joint| least[joint] = 0.0);
        let on_held_out = whitener.on(&session.logs.test.rows);
        let all_logs = session.over_all_logs();
        let all_columns = all_logs.model.columns(&all_logs.logs.train, members)?;
        let torques = torques(&all_logs.model.arm, &all_logs.logs.train.rows);
        Ok(Judge {
            session,
            members,
            fit,
            on_held_out,
            least,
            noise,
            baseline,
            all_logs,
            all_columns,
            torques,
            multiplicity,
            beyond: Mutex::default(),
        })
    }

    /// Whether a member stays whatever the gates say: one that is held does not rest on residuals, and what the sampling makes is reported
    /// as no finding, and would be structure without it.
    fn stays(&self, member: usize) -> bool {
        let Member { held, placed, .. } = &self.members[member];
        *held || self.session.sampling_makes(placed)
    }

    /// Judges every member at `kept` but those that stay in any case.
    pub(super) fn of(&self, kept: &[usize]) -> Vec<Judged> {
        let with = self.fit.residuals(kept);
        let judged = (0..kept.len()).into_par_iter().filter(|&index| !self.stays(kept[index]));
        judged.map(|index| self.judged(kept, index, &with)).collect()
    }

    /// Judges the member at `kept[index]`.
    pub(super) fn one(&self, kept: &[usize], index: usize) -> Judged {
        self.judged(kept, index, &self.fit.residuals(kept))
    }

    fn judged(&self, kept: &[usize], index: usize, with: &[Column; 2]) -> Judged {
        let criteria = &self.session.criteria;
        let member = &self.members[kept[index]];
        let others: Vec<usize> = kept.iter().copied().filter(|&other| other != kept[index]).collect();
        let without = self.fit.residuals(&others);
        let valid = &self.session.logs.train.rows.valid;
        let [after, before] = [&with[0], &without[0]].map(|residual| rms(valid, residual));
        let size: Vec<f64> = before.iter().zip(&after).map(|(b, a)| (b * b - a * a).max(0.0).sqrt()).collect();
        let (joints, own) = (member.candidate.joints(), own_joints(member));
        let relative = |&joint: &usize| match size[joint] {
            0.0 => 0.0,
            size => size / self.least[joint],
        };
        let relative_size = own.iter().map(relative).fold(0.0, f64::max);
        let can_be = self.session.can_be(&member.placed, self.fit.torque(kept[index]));
        let mut judgements = vec![can_be, Judgement::at_least(Gate::Size, relative_size, 1.0)];
        if is_of_wrong_sign(member) && !self.session.logs.train.rows.of_change() {
            judgements.insert(0, Judgement::at_most(Gate::Believable, f64::INFINITY, 1.0));
        }
        let is_level = is_level(member.placed.effect);
        // Torque is cut off in a few rows of a few blocks, whose scatter indicates little.
        let strength = if is_level { None } else { self.fit.strength(kept, index) };
        if let Some([strength, std, freedom]) = strength {
            let p = StudentsT::new(0.0, 1.0, freedom).map_or(1.0, |law| 2.0 * law.sf((strength / std).abs()));
            judgements.push(Judgement::at_most(Gate::Strength, p, criteria.levels.strict_p));
        }
        // What happened in one training log shows in no other.
        if member.candidate.log.is_none() {
            // Held-out motions may stay below a limit of torque: it gains nothing there, and must only not be contradicted.
            if !is_level {
                judgements.push(self.on_own_joints(&own, [&without[1], &with[1]]));
            }
            judgements.push(self.on_held_out_logs(&joints, [&without[1], &with[1]]));
            let valid = &self.session.logs.test.rows.valid;
            let residuals = [&without[1], &with[1]].map(|residual| rms(valid, residual));
            judgements.push(predicts(&joints, &residuals, &self.noise, criteria));
            judgements.push(self.on_every_joint([&without[1], &with[1]], &residuals[1]));
        }
        if is_shift(member.placed.effect) && member.placed.effect.about().scope == Scope::Arm {
            judgements.push(self.undone_by_lags(kept, index));
        }
        Judged { index, size, relative_size, judgements }
    }

    /// Share of the held-out residual of its `own` joints that a finding explains.
    fn on_own_joints(&self, own: &[usize], [before, after]: [&Column; 2]) -> Judgement {
        let share = Gains::new(&self.on_held_out, before, after, own, self.session.logs.test.rows.len()).share();
        explains_own_joints(share)
    }

    /// Growth of the residual of the held-out log that agrees least, on `joints` together.
    fn on_held_out_logs(&self, joints: &[usize], [before, after]: [&Column; 2]) -> Judgement {
        let starts = &self.session.logs.test.rows.starts;
        let growths = starts.windows(2).map(|ends| {
            let [before, after] = [before, after].map(|residual| residual.within(ends[0]..ends[1]));
            Gains::new(&self.on_held_out, &before, &after, joints, self.session.logs.test.rows.len()).growth()
        });
        let worst = growths.fold(f64::NEG_INFINITY, f64::max);
        contradicted_by_none(worst, starts.len() - 1, &self.session.criteria.levels)
    }

    /// The largest factor on the baseline's residual of a joint of those that grow with a finding; `new` is the root mean square after.
    fn on_every_joint(&self, [before, after]: [&Column; 2], new: &[f64]) -> Judgement {
        let baseline = rms(&self.session.logs.test.rows.valid, &self.baseline);
        let factors = self.growing_joints([before, after]).map(|joint| new[joint] / baseline[joint]);
        predicts_every_joint(factors.fold(1.0, f64::max), &self.session.criteria)
    }

    /// Number of joints on which lags of single joints undo most of a shift of all torques: on these it is none, and of all it is none then.
    fn undone_by_lags(&self, kept: &[usize], index: usize) -> Judgement {
        let own = self.fit.torque(kept[index]);
        let mut together = own.clone();
        let lags = kept.iter().filter(|&&other| other != kept[index] && is_shift(self.members[other].placed.effect));
        lags.for_each(|&lag| together.add(1.0, self.fit.torque(lag)));
        let [own, together] = [own, &together].map(|torque| rms(&self.session.logs.train.rows.valid, torque));
        not_undone(&own, &together, &self.session.criteria.levels)
    }

    /// Joints whose held-out residual grows from `before` to `after`, at the level [`Criteria::worse_p`] for all joints together: of six
    /// that nothing changes but the errors of the estimates, one often grows by one standard deviation.
    fn growing_joints(&self, [before, after]: [&Column; 2]) -> impl Iterator<Item = usize> {
        let rows = &self.session.logs.test.rows;
        let level = self.session.criteria.worse_p() / rows.dof() as f64;
        let growth_p =
            move |joint: usize| Gains::new(&self.on_held_out, before, after, &[joint], rows.len()).growth_p();
        (0..rows.dof()).filter(move |&joint| {
            let growth_p = growth_p(joint);
            tracing::debug!(joint, growth_p, level, "growth of the held-out residual");
            growth_p < level
        })
    }

    /// The joint that the model with the members at `kept` predicts worst over the baseline, if it is predicted worse.
    pub(super) fn worse_than_baseline(&self, kept: &[usize]) -> Option<(usize, f64)> {
        let [_, after] = self.fit.residuals(kept);
        let [old, new] = [&self.baseline, &after].map(|residual| rms(&self.session.logs.test.rows.valid, residual));
        let worse = self.growing_joints([&self.baseline, &after]).map(|joint| (joint, new[joint] / old[joint]));
        worse.filter(|(_, factor)| *factor > self.session.criteria.worse()).max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// The place, of the members at `kept`, of that without which `joint` is predicted best.
    pub(super) fn without_which_best(&self, kept: &[usize], joint: usize) -> Option<usize> {
        let left = |index: &usize| {
            let mut others = kept.to_vec();
            others.remove(*index);
            rms(&self.session.logs.test.rows.valid, &self.fit.residuals(&others)[1])[joint]
        };
        let removable = (0..kept.len()).filter(|&index| !self.stays(kept[index]));
        let removable: Vec<(usize, f64)> = removable.map(|index| (index, left(&index))).collect();
        removable.into_iter().min_by(|a, b| a.1.total_cmp(&b.1)).map(|(index, _)| index)
    }

    /// Share of the held-out excess over the noise that the member at `kept[index]` explains with the `others` in the model, in squares, on
    /// that of its own joints where it is largest. A constant is explained by an offset alone: what other laws predict is measured about the
    /// mean, since each that has one predicts it.
    fn predicted(&self, kept: &[usize], others: &[usize], index: usize) -> f64 {
        let member = &self.members[kept[index]];
        if member.candidate.log.is_some() {
            return 0.0;
        }
        let valid = &self.session.logs.test.rows.valid;
        let residuals = [others, kept].map(|members| {
            let [_, held_out] = self.fit.residuals(members);
            held_out
        });
        let about_zero = residuals.each_ref().map(|residual| rms(valid, residual));
        let about_mean = residuals.each_ref().map(|residual| deviation(valid, residual));
        let share = |&joint: &usize| {
            let [before, after] = if self.fit.is_offset(kept[index], joint) { &about_zero } else { &about_mean };
            share_of_excess(before[joint], after[joint], self.noise[joint])
        };
        own_joints(member).iter().map(share).fold(0.0, f64::max)
    }

    /// Gain of a member over generic functions on one joint, with `others` in the model.
    fn gain(&self, member: usize, others: &[usize], joint: usize) -> Option<f64> {
        let has_torque = |other: &usize| {
            self.all_columns[self.fit.columns_of(*other)].iter().any(|column| column.part(joint).is_some())
        };
        let others: Vec<usize> = others.iter().copied().filter(has_torque).collect();
        let question = (member, joint, others);
        if let Some(known) = self.known_gains().get(&question) {
            return *known;
        }
        let fixed: Vec<Column> =
            self.fit.places(&question.2).into_iter().map(|place| self.all_columns[place].clone()).collect();
        let law = &self.all_columns[self.fit.law(member)];
        let (logs, resolved) = (&self.all_logs.logs.train, self.session.criteria.levels.most);
        let gain = gain_over_generic_functions(logs, &self.torques, &fixed, law, joint, resolved);
        self.known_gains().insert(question, gain);
        gain
    }

    fn known_gains(&self) -> MutexGuard<'_, HashMap<LawOnJoint, Option<f64>>> {
        self.beyond.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Number of independent tests that the kind of a member is worth on a joint. A law on one joint says nothing against the same on another:
    /// only what is looked at on the same joint shares the odds.
    fn shapes(&self, member: usize) -> f64 {
        let about = self.members[member].placed.effect.about();
        let joints = if about.scope == Scope::Arm { 1 } else { self.least.len() };
        (self.multiplicity.of_kind(about.name) / joints as f64).max(1.0)
    }

    /// Inner products of all columns with the structure of the residual of the model with the members at `kept`.
    pub(super) fn structure(&self, kept: &[usize]) -> DMatrix<f64> {
        self.fit.structure(kept)
    }

    /// Whether the member at `kept[index]` is more than `structure` makes of its factors. A level is no factor of a column.
    pub(super) fn under_structure(&self, kept: &[usize], index: usize, structure: &DMatrix<f64>) -> Option<Judgement> {
        if is_level(self.members[kept[index]].placed.effect) {
            return None;
        }
        let p = self.fit.structure_p(kept, index, structure)?;
        let of_all = family_wise(p.ln(), self.shapes(kept[index]));
        tracing::debug!(family = ?self.members[kept[index]].candidate.family(), p, of_all, "under structure");
        Some(Judgement::at_most(Gate::UnderStructure, of_all, self.session.criteria.levels.sure_p))
    }

    /// What the member at `kept[index]` explains beyond generic functions, with the others in the model, where each of the tests that its kind
    /// is worth on a joint, its shapes, is as likely beforehand; None where the rows of that comparison are too long for its law. A few numbers from the training logs that predict most of what the held-out ones have beyond
    /// the noise are a law, too, also where generic functions that are fitted to both explain as much.
    pub(super) fn beyond_structure(&self, kept: &[usize], index: usize) -> Option<Judgement> {
        let Criteria { levels, verdict, .. } = &self.session.criteria;
        let others: Vec<usize> = kept.iter().copied().filter(|&other| other != kept[index]).collect();
        let joints = self.members[kept[index]].candidate.joints().into_iter();
        let gain = joints.map(|joint| self.gain(kept[index], &others, joint)).sum::<Option<f64>>()?;
        let gained = Judgement::at_least(Gate::BeyondStructure, gain, levels.log_odds + self.shapes(kept[index]).ln());
        Some(gained.or(gained.passed || self.predicted(kept, &others, index) >= verdict.explained))
    }
}

/// Whether every amplitude of a law is of a sign that it cannot have, once its parameters that the logs do not determine are held: before
/// that, shapes on their way to these values may turn it.
fn is_of_wrong_sign(Member { placed: Placed { effect, parameters, .. }, fixed, .. }: &Member) -> bool {
    let amplitudes = linear(*effect).into_iter().filter(|&index| parameters[index] != 0.0);
    let mut wrong = amplitudes.map(|index| effect.parameters()[index].has_wrong_sign(parameters[index])).peekable();
    !fixed.is_empty() && wrong.peek().is_some() && wrong.all(|is_wrong| is_wrong)
}

/// Whether a finding explains some of the held-out residual of its own joints, by its `share`.
fn explains_own_joints(share: f64) -> Judgement {
    Judgement::above(Gate::OwnJoint, share, 0.0)
}

/// Whether none of `count` held-out logs contradicts a finding, by the standard deviations by which the residual of the worst one grows: the
/// level is shared among them.
fn contradicted_by_none(growth: f64, count: usize, levels: &Levels) -> Judgement {
    let most = Normal::standard().inverse_cdf(1.0 - levels.usual_p / count.max(1) as f64);
    Judgement::at_most(Gate::HeldOutLogs, growth, most)
}

/// Whether no joint is predicted worse, by the largest factor over the baseline.
pub(super) fn predicts_every_joint(factor: f64, criteria: &Criteria) -> Judgement {
    Judgement::at_most(Gate::EveryJoint, factor, criteria.worse())
}

/// Held-out residual of the `joints` that a finding acts on together with it over that without it, in squares over the `noise`: one that
/// fits the training logs alone is not what these joints have in common with the held-out ones. A slow residual grows by it without being
/// significant: such a finding belongs in no model. `residuals` are those before and after, and the noise, root mean squares, `[joint]`.
fn predicts(joints: &[usize], residuals: &[Vec<f64>; 2], noise: &[f64], criteria: &Criteria) -> Judgement {
    let [before, after] =
        residuals.each_ref().map(|rms| joints.iter().map(|&j| (rms[j] / noise[j]).powi(2)).sum::<f64>());
    // What does not grow is not worse, also where both are zero.
    Judgement::at_most(Gate::Predicts, after / before, criteria.worse().powi(2)).or(after <= before)
}

/// Whether lags undo most of a shift with so much torque of its `own` on every joint, which has `together` with them, on a single joint at
/// most: the time of a log is that of all its joints, and two that deny it are no coincidence.
fn not_undone(own: &[f64], together: &[f64], levels: &Levels) -> Judgement {
    let undone = own.iter().zip(together).filter(|(own, both)| **own > 0.0 && **both < levels.most * **own).count();
    Judgement::below(Gate::Undone, undone as f64, levels.few as f64)
}

/// Least size of a finding that matters on a joint with so much residual, noise and torque, root mean squares: a share of the torque, or of
/// what is missing beyond the noise, which is taken for no less than the noise, and never less than the floor of that torque.
fn least_size(residual: f64, noise: f64, torque: f64, criteria: &Criteria) -> f64 {
    let excess = (residual * residual - noise * noise).max(0.0).sqrt();
    let of_excess = (criteria.levels.minor * excess.max(noise)).max(criteria.floor(torque));
    (criteria.share_of_torque * torque).min(of_excess)
}

/// Share of an excess over the noise, in squares, that is gone from `before` to `after`, both root mean square; zero where there is none.
fn share_of_excess(before: f64, after: f64, noise: f64) -> f64 {
    let excess = before * before - noise * noise;
    if excess > 0.0 { (before * before - after * after) / excess } else { 0.0 }
}

/// Joints that a law is about: where it is in joints or gears, those; else all on which it has torque.
fn own_joints(member: &Member) -> Vec<usize> {
    let about = member.placed.effect.about();
    match about.site {
        Site::Joint | Site::Gear if about.scope != Scope::Arm => member.placed.joints(),
        _ => member.candidate.joints(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::model::Candidate;
    use crate::effects::find;

    /// On an arm whose torque follows its position a strut was named with a pull of -1606 +- 690 N m and no stiffness.
    #[test]
    fn a_law_of_the_wrong_sign_is_another_law() {
        let is_wrong = |effect: &str, amplitudes: &[f64], fixed: &[usize]| {
            let mut placed = Placed::typical(find(effect).unwrap(), 0);
            placed.parameters[..amplitudes.len()].copy_from_slice(amplitudes);
            let mut member = Member::new(&Candidate { placed, log: None, columns: Default::default() }, &[]);
            member.placed.parameters[..amplitudes.len()].copy_from_slice(amplitudes);
            member.fixed = fixed.to_vec();
            is_of_wrong_sign(&member)
        };
        assert!(
            is_wrong("gravity_balancer", &[-1606.0, 0.0], &[1]) && is_wrong("gravity_balancer", &[-1.0, -1.0], &[2])
        );
        // A preload below zero may be zero, where a stiffness is there; and while nothing is held, shapes may turn it.
        assert!(
            !is_wrong("gravity_balancer", &[-5.0, 600.0], &[2]) && !is_wrong("gravity_balancer", &[-1606.0, 0.0], &[])
        );
        assert!(is_wrong("stribeck_friction", &[-0.1], &[1]) && !is_wrong("stribeck_friction", &[0.1], &[1]));
        // Offsets go both ways.
        assert!(!is_wrong("torque_offset", &[-0.1], &[0]));
    }

    #[test]
    fn a_share_of_what_is_beyond_the_noise() {
        // 25 - 9 = 16 of 25 - 4 = 21 are gone; all of it at the noise; nothing where there is no more than noise.
        assert!((share_of_excess(5.0, 3.0, 2.0) - 16.0 / 21.0).abs() < 1e-12);
        assert!((share_of_excess(5.0, 2.0, 2.0) - 1.0).abs() < 1e-12);
        assert_eq!(share_of_excess(2.0, 1.0, 2.0), 0.0);
    }

    #[test]
    fn either_side_of_the_gates_on_held_out_logs() {
        let criteria = Criteria::default();
        assert!(explains_own_joints(1e-9).passed && !explains_own_joints(0.0).passed);
        // One-sided 5 % of the normal distribution, and half of that for each of two logs, from tables.
        for (count, most) in [(1, 1.644_853_627), (2, 1.959_963_985)] {
            assert!(contradicted_by_none(most - 1e-6, count, &criteria.levels).passed);
            assert!(!contradicted_by_none(most + 1e-6, count, &criteria.levels).passed);
        }
        let worse = criteria.worse();
        assert!(predicts_every_joint(worse, &criteria).passed && !predicts_every_joint(worse + 1e-9, &criteria).passed);
    }

    #[test]
    fn a_finding_that_predicts_its_joints_worse_belongs_in_no_model() {
        let criteria = Criteria::default();
        let on_first = |before: f64, after: f64, others: f64| {
            predicts(&[0], &[vec![before, 1.0], vec![after, others]], &[0.5, 0.5], &criteria).passed
        };
        // 1.2 and 1.11 times as much is worse, 1.09 is not; nor is what happens on another joint.
        assert!(!on_first(1.0, 1.2, 1.0) && !on_first(1.0, 1.11, 1.0));
        assert!(on_first(1.0, 1.09, 1.0) && on_first(1.0, 0.5, 3.0));
        assert!(on_first(0.0, 0.0, 1.0), "no residual grows");
        // Two joints together, each over its noise.
        let both = |after: [f64; 2]| predicts(&[0, 1], &[vec![1.0; 2], after.to_vec()], &[0.5, 5.0], &criteria).passed;
        assert!(both([1.0, 3.0]) && !both([1.2, 0.1]));
    }

    #[test]
    fn a_shift_that_lags_undo_on_two_joints_is_none() {
        let passes = |together: &[f64]| not_undone(&[1.0, 2.0, 3.0, 0.0], together, &Levels::default()).passed;
        // Half of it on a joint is the edge; where it has no torque, there is nothing to undo.
        assert!(passes(&[0.1, 1.0, 3.0, 0.0]) && !passes(&[0.1, 0.99, 3.0, 0.0]));
        assert!(passes(&[1.0, 2.0, 0.2, 0.0]) && !passes(&[0.0, 0.0, 0.0, 0.0]));
    }

    #[test]
    fn what_matters_is_a_share_of_the_torque_or_of_what_is_missing() {
        let of = |residual: f64, noise: f64, torque: f64| least_size(residual, noise, torque, &Criteria::default());
        // 2 % of 10; a tenth of 4, the root of 5^2 - 3^2; a tenth of the noise where nothing is missing.
        assert!((of(50.0, 1.0, 10.0) - 0.2).abs() < 1e-12);
        assert!((of(5.0, 3.0, 50.0) - 0.4).abs() < 1e-12);
        assert!((of(3.0, 3.0, 50.0) - 0.3).abs() < 1e-12 && (of(2.0, 3.0, 50.0) - 0.3).abs() < 1e-12);
        // However quiet the sensors, a tenth of that share of the torque; less where less is asked for.
        assert!((of(5.0, 3.0, 1e3) - 2.0).abs() < 1e-12 && (of(5.0, 3.0, 199.0) - 0.4).abs() < 1e-12);
        let asked = Criteria { share_of_torque: 1e-3, ..Criteria::default() };
        assert!((least_size(50.0, 1.0, 10.0, &asked) - 0.01).abs() < 1e-12);
    }

    #[test]
    fn a_gear_is_judged_on_its_joint_and_a_body_wherever_it_has_torque() {
        let columns = vec![Column::new(vec![vec![1.0]; 3])];
        let member = |name: &str| {
            let placed = Placed::typical(find(name).unwrap(), 1);
            Member::new(&Candidate { placed, log: None, columns: columns.clone().into() }, &[1.0])
        };
        assert_eq!(own_joints(&member("joint_elasticity")), [1]);
        assert_eq!(own_joints(&member("joint_coupling")), [1, 2]);
        assert_eq!(own_joints(&member("payload")), [0, 1, 2]);
        assert_eq!(own_joints(&member("external_contact")), [0, 1, 2]);
        assert_eq!(own_joints(&member("time_delay")), [0, 1, 2]);
    }
}
