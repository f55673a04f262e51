//! Whether the best candidate of a comparison is taken into the model: by what the training logs show once adjusted for all that is not
//! physics, and by its gain on the held-out logs.

use crate::diagnosis::criteria::{Criteria, Gate, Judgement, Levels, SearchCriteria};
use crate::diagnosis::evidence::{
    Gains, Judged, Multiplicity, cross_validated_residual, log_p_adjusted, without_influential_blocks,
};
use crate::diagnosis::logs::Rows;
use crate::diagnosis::model::{Candidate, DataSet, FlatLevel, Member, Session, flat_level, is_level, slope_beyond};
use crate::diagnosis::noise::Whitener;
use crate::diagnosis::regression::{Column, Projection, Solved};
use crate::effects::{Hidden, Nature, Placed, Site};
use crate::error::Result;
use crate::identification::effect_model::Trust;

/// What came of a trial.
#[derive(Debug)]
pub(super) enum Outcome {
    /// The candidate is taken.
    Accepted(Box<Accepted>),
    /// It is not.
    Refused(Refusal),
}

/// How a candidate was refused.
#[derive(Debug, Clone, Copy)]
pub(super) struct Refusal {
    /// Whether it may act all the same, and the logs are too few to decide.
    pub may_be: bool,
    /// Whether held-out logs were asked to confirm what the training logs left open.
    pub asked: bool,
    /// The gate that it failed.
    pub failed: Judgement,
}

/// A candidate that is taken.
#[derive(Debug)]
pub(crate) struct Accepted {
    /// As part of the model.
    pub member: Member,
    /// Lower bound (84 %) of the share of the whitened sum of squares that it takes away on rows it was not fitted to.
    pub gain_lower_bound: f64,
    /// Probability of as good a best candidate without any effect.
    pub level: f64,
}

/// What a candidate is tried against.
#[derive(Debug, Clone, Copy)]
pub(super) struct Trial<'a> {
    /// Logs and arm.
    pub session: &'a Session<'a>,
    /// What the model has already.
    pub members: &'a [Member],
    /// The noise as the model with these sees it.
    pub whitener: &'a Whitener,
    /// Their fit to the training logs.
    pub fit: &'a Projection,
    /// How many independent tests the scan was worth.
    pub multiplicity: &'a Multiplicity,
    /// Family-wise level.
    pub alpha: f64,
    /// By how much less likely than by itself what the held-out logs show must be to confirm it, as they are asked more than once;
    /// None where they are not asked any more.
    pub tries: Option<f64>,
}

/// Evidence of the training logs for a candidate.
#[derive(Debug, Clone, Copy)]
pub(super) struct Seen {
    /// Probability of as good a best candidate without any effect.
    level: f64,
    /// The level at which they alone decide.
    limit: f64,
    /// Logarithm of the probability of what is seen outside the blocks that show it best.
    elsewhere: f64,
    /// Whether held-out logs can confirm it.
    confirmable: bool,
}

impl Trial<'_> {
    /// The best candidate of a comparison as a member of the model, if it is to be one. `level` is the probability of as good a best
    /// candidate in the noise that does not know it, `under` the noise that does, if it was worked out before.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub(super) fn of(&self, winner: &Judged, level: f64, under: Option<Whitener>) -> Result<Outcome> {
        match self.seen(winner, level)? {
            Ok(seen) => self.on_held_out_logs(winner, seen, under),
            Err(refusal) => Ok(Outcome::Refused(refusal)),
        }
    }

    /// The same where all logs are identified from: each is judged by what the others predict for it.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub(super) fn by_others(&self, winner: &Judged, level: f64) -> Result<Outcome> {
        let Seen { level, limit, elsewhere, confirmable } = match self.seen(winner, level)? {
            Ok(seen) => seen,
            Err(refusal) => return Ok(Outcome::Refused(refusal)),
        };
        let limit = if confirmable { self.level_at(self.session.criteria.search.pooled) } else { limit };
        let Trial { session, members, .. } = *self;
        let with: Vec<Member> = members.iter().cloned().chain([winner.member()]).collect();
        let whitener = session.noise_under(&session.model.columns(&session.logs.train, &with)?);
        let joints = winner.candidate.joints();
        let misfit = whitener.largest_misfit(&joints);
        let left = |members: &[Member]| cross_validated_residual(session, members, &whitener);
        let (before, after, rows) = (left(members)?, left(&with)?, session.logs.train.rows.len());
        let errors = session.errors_with(&session.logs.train, &winner.candidate.placed);
        let gains = Gains::adjusted_for(&whitener, &before, &after, &joints, &errors, rows);
        let (lower_bound, chance, share) = (gains.lower_bound(&session.criteria.levels), gains.chance(), gains.share());
        tracing::debug!(level, elsewhere, misfit, lower_bound, share, chance, "gain by the others");
        let gates = [
            Judgement::at_most(Gate::FamilyWise, level, limit),
            Judgement::at_most(Gate::Influence, elsewhere.exp(), self.session.criteria.levels.strict_p),
            Judgement::at_most(Gate::OtherLogs, chance, self.session.criteria.levels.usual_p),
            Judgement::at_most(Gate::Misfit, misfit, self.session.criteria.levels.misfit),
            Judgement::above(Gate::HeldOutGain, share, 0.0),
        ];
        Ok(match Judgement::first_failed(gates) {
            Some(failed) => Outcome::Refused(Refusal { may_be: share > 0.0, asked: false, failed }),
            None => accepted(winner, lower_bound, level),
        })
    }

    /// Whether the torque of a joint stays within the level at which it is cut off, which is about `limit`, to a share that matters and the
    /// noise of its sensor. What is cut off has one level: the lowest within its scatter counts.
    fn exceeded(&self, joint: usize, limit: f64) -> Judgement {
        let (rows, criteria) = (&self.session.logs.train.rows, &self.session.criteria);
        let lowest = |flat: FlatLevel| flat.level - criteria.levels.significant_std() * flat.std;
        let level = flat_level(&self.session.model.arm, rows, joint, limit).map_or(limit, lowest);
        let largest = rows.torque[joint].iter().fold(0.0f64, |most, torque| most.max(torque.abs()));
        let noise = criteria.levels.far * rows.sensor_noise(joint, 1);
        within_limit(largest - noise, level, criteria)
    }

    /// Evidence of the logs identified from for the winner, or why it is refused by them alone.
    fn seen(&self, winner: &Judged, level: f64) -> Result<std::result::Result<Seen, Refusal>> {
        let placed = &winner.candidate.placed;
        let Placed { effect, joint, .. } = placed;
        let refused = |failed, may_be| Ok(Err(Refusal { may_be, asked: false, failed }));
        let another_form = self.is_another_form(&winner.candidate);
        let is_hidden = self.is_hidden(&winner.candidate);
        let mut share = strictness(&winner.candidate, &self.session.criteria.search);
        if is_hidden {
            share = share.min(self.session.criteria.search.in_part);
        }
        if another_form {
            share = share.min(self.session.criteria.search.in_part);
        }
        let limit = self.level_at(share);
        let confirmable = is_confirmable(&winner.candidate) && !another_form && !is_hidden;
        let highest = if confirmable { 1.0 } else { limit };
        // What is significant only in the noise model that does not know it is an error of that noise model.
        let kind = winner.candidate.family().effect;
        let mut level = level.max(self.multiplicity.level(kind, winner.test.log_p()));
        if level > highest {
            return refused(Judgement::at_most(Gate::FamilyWise, level, highest), !is_level(*effect));
        }
        let adjusted = log_p_adjusted(self.session, self.whitener, self.fit, winner);
        level = level.max(self.multiplicity.level(kind, adjusted));
        tracing::debug!(level, adjusted, "adjusted for slow noise and errors of the smoothing");
        if level > highest {
            return refused(Judgement::at_most(Gate::FamilyWise, level, highest), !is_level(*effect));
        }
        let lost = self.session.lost_inside_bounds(winner, self.whitener, self.fit)?;
        let inside = Judgement::at_most(Gate::AtBound, lost, self.session.criteria.at_bound());
        if !inside.passed {
            return refused(inside, false);
        }
        if effect.about().nature == Nature::OfSpeed {
            // The rounding has one parameter less, and most arms that are simulated have it.
            let of_rounding = self.session.model.rounding_gains.get(*joint).copied().unwrap_or_default();
            let beyond = likelier_than_rounding(winner.test.statistic, of_rounding, &self.session.criteria.levels);
            if !beyond.passed {
                return refused(beyond, false);
            }
        }
        let elsewhere = if is_level(*effect) {
            let level = placed.amount();
            let slope = slope_beyond(&self.session.model.arm, &self.session.logs.train.rows, *joint, level);
            tracing::debug!(slope, level, "torque beyond a level");
            let flat = is_flat(slope, &self.session.criteria.levels);
            if let Some(failed) = Judgement::first_failed([flat, self.exceeded(*joint, level)]) {
                return refused(failed, false);
            }
            f64::NEG_INFINITY
        } else {
            without_influential_blocks(self.session, self.members, self.whitener, winner)?
        };
        Ok(Ok(Seen { level, limit, elsewhere, confirmable }))
    }

    /// The level of a share of alpha, which is limited where something was found before.
    fn level_at(&self, share: f64) -> f64 {
        let counts = |member: &Member| member.placed.effect.about().nature != Nature::Delay;
        self.alpha
            * if self.members.iter().any(counts) { share.min(self.session.criteria.levels.certain) } else { share }
    }

    /// Whether a candidate is a law of friction over speed on a joint that has another such law in the model.
    fn is_another_form(&self, candidate: &Candidate) -> bool {
        let is_of_speed = |placed: &Placed| placed.effect.about().nature == Nature::OfSpeed;
        let is_there = |member: &Member| member.placed.joint == candidate.placed.joint && is_of_speed(&member.placed);
        is_of_speed(&candidate.placed) && self.members.iter().any(is_there)
    }

    /// Whether a candidate acts in a joint and is hidden in part by the bodies that are identified with it.
    fn is_hidden(&self, candidate: &Candidate) -> bool {
        let about = candidate.placed.effect.about();
        let is_free = self.session.model.trust == Trust::Structure && !self.session.logs.train.rows.of_change();
        is_free && about.site == Site::Joint && about.hidden_by_base_parameters == Hidden::InPart
    }

    /// The winner as a member of the model if the held-out rows agree. What the training logs leave open the held-out logs may
    /// confirm: the two are independent.
    fn on_held_out_logs(&self, winner: &Judged, seen: Seen, under: Option<Whitener>) -> Result<Outcome> {
        let Seen { level, limit, elsewhere, confirmable } = seen;
        let Criteria { search: criteria, levels, .. } = &self.session.criteria;
        let held_out = self.held_out(winner, under)?;
        let HeldOut { gains, adjusted_for_errors, .. } = &held_out;
        // What rests on a moment or two of the training logs is no accident if it is there again.
        let chance = adjusted_for_errors.chance();
        let there = confirmable && chance < levels.usual_p && gains.without_most_influential_block() > 0.0;
        let elsewhere = elsewhere.exp();
        let alone = Judgement::first_failed([
            Judgement::at_most(Gate::FamilyWise, level, limit),
            Judgement::at_most(Gate::Influence, elsewhere, levels.strict_p).or(there),
        ]);
        let bound = gains.lower_bound(levels);
        let refused = |failed, asked| Ok(Outcome::Refused(Refusal { may_be: gains.share() > 0.0, asked, failed }));
        let undetermined = self.session.undetermined_by_one_more(self.members, &held_out.solved);
        let earlier = Judgement::at_most(Gate::EarlierParameters, undetermined.len() as f64, 0.0);
        if !earlier.passed {
            return refused(earlier, false);
        }
        if held_out.whitener.is_misfit(&winner.candidate.joints(), levels.misfit) {
            let turned = self.session.turns_unphysical(&held_out.with, &held_out.solved[1]);
            let signs = Judgement::at_most(Gate::EarlierSigns, turned as f64, 0.0);
            if let Some(failed) = Judgement::first_failed(alone.into_iter().chain([signs])) {
                return refused(failed, false);
            }
            let mut gain = Judgement::above(Gate::HeldOutGain, bound, criteria.share_of_misfit);
            if !gain.passed && winner.candidate.log.is_none() {
                let joints = winner.candidate.joints();
                let bound = held_out.adjusted_for_constants(&self.session.logs.test.rows, &joints).lower_bound(levels);
                gain = Judgement::above(Gate::HeldOutGain, bound, criteria.share_of_misfit);
            }
            return if gain.passed { Ok(accepted(winner, gain.value, level)) } else { refused(gain, false) };
        }
        // A torque is cut off in a few rows, where the smoothing errs most: their scatter indicates little, and held-out motions that stay
        // below the level have no information on it.
        let is_level = is_level(winner.candidate.placed.effect);
        let sure = level < criteria.unconfirmable && (gains.is_of_noise(levels) || is_level);
        let gained = gains.share() > 0.0 || (is_level && !gains.is_contradicted(levels));
        let gain = Judgement::above(Gate::HeldOutGain, bound, 0.0).or(sure && gained);
        let Some(failed) = Judgement::first_failed(alone.into_iter().chain([gain])) else {
            return Ok(accepted(winner, bound, level));
        };
        let Some(tries) = self.tries.filter(|_| confirmable && level <= levels.leaning_p) else {
            return refused(failed, false);
        };
        let together = adjusted_for_errors.together(level, tries);
        tracing::debug!(together, chance, "training and held-out logs together");
        let confirmed = Judgement::first_failed([
            Judgement::at_most(Gate::Confirmation, together, self.level_at(criteria.confirmed)),
            Judgement::at_most(Gate::Confirmation, chance, levels.leaning_p),
            Judgement::at_most(Gate::Influence, elsewhere, levels.usual_p).or(there),
            Judgement::above(Gate::HeldOutGain, gains.share(), 0.0),
        ]);
        confirmed.map_or(Ok(accepted(winner, bound, together)), |failed| refused(failed, true))
    }

    /// Evidence of the held-out rows for the winner. An event of one training log shows in no other: its gain is that on the
    /// training rows.
    fn held_out(&self, winner: &Judged, under: Option<Whitener>) -> Result<HeldOut> {
        let Trial { session, members, .. } = *self;
        let with: Vec<Member> = members.iter().cloned().chain([winner.member()]).collect();
        let whitener = match under {
            Some(whitener) => whitener,
            None => session.noise_under(&session.model.columns(&session.logs.train, &with)?),
        };
        let solved = [session.solved(members, &whitener)?, session.solved(&with, &whitener)?];
        let residuals = |data: &DataSet| -> Result<[Column; 2]> {
            Ok([session.residual_of(data, members, &solved[0])?, session.residual_of(data, &with, &solved[1])?])
        };
        let [before, after] = residuals(&session.logs.test)?;
        let joints = winner.candidate.joints();
        let test = &session.logs.test.rows;
        let on_held_out = whitener.on(test);
        let gains = match winner.candidate.log {
            None => Gains::new(&on_held_out, &before, &after, &joints, test.len()),
            Some(_) => {
                let [before, after] = residuals(&session.logs.train)?;
                Gains::new(&whitener, &before, &after, &joints, session.logs.train.rows.len())
            }
        };
        let errors = session.errors_with(&session.logs.test, &winner.candidate.placed);
        let adjusted_for_errors = Gains::adjusted_for(&on_held_out, &before, &after, &joints, &errors, test.len());
        let bound = gains.lower_bound(&session.criteria.levels);
        tracing::debug!(bound, share = gains.share(), "held-out gain");
        Ok(HeldOut { with, solved, whitener, on_held_out, residuals: [before, after], gains, adjusted_for_errors })
    }
}

/// Evidence of held-out rows for a candidate.
struct HeldOut {
    /// The model with it.
    with: Vec<Member>,
    /// The fits to the training logs without and with it.
    solved: [Solved; 2],
    /// The noise as that sees it, on either kind of logs.
    whitener: Whitener,
    on_held_out: Whitener,
    /// Residual of the held-out rows before and after.
    residuals: [Column; 2],
    /// What it gains.
    gains: Gains,
    /// The same adjusted for errors in variables.
    adjusted_for_errors: Gains,
}

impl HeldOut {
    /// What it gains on the held-out rows, adjusted for a constant torque on every joint that it acts on.
    fn adjusted_for_constants(&self, test: &Rows, joints: &[usize]) -> Gains {
        let [before, after] = &self.residuals;
        Gains::adjusted_for_constants(&self.on_held_out, before, after, joints, test)
    }
}

/// Whether the `largest` torque stays within a saturation limit, to a share that matters.
fn within_limit(largest: f64, limit: f64, criteria: &Criteria) -> Judgement {
    Judgement::at_most(Gate::Exceeded, largest / limit, 1.0 + criteria.share_of_torque)
}

/// Whether a law of friction over speed, by its score statistic, is likelier than a rounded sign of friction, whose gain of the
/// log-likelihood is `of_rounding`.
fn likelier_than_rounding(statistic: f64, of_rounding: f64, levels: &Levels) -> Judgement {
    Judgement::above(Gate::Rounding, 0.5 * statistic, of_rounding + levels.log_odds)
}

/// Whether torque is flat where the model exceeds a saturation limit, by its slope over the model's.
fn is_flat(slope: f64, levels: &Levels) -> Judgement {
    Judgement::below(Gate::Flat, slope, levels.most)
}

fn accepted(winner: &Judged, gain_lower_bound: f64, level: f64) -> Outcome {
    Outcome::Accepted(Box::new(Accepted { member: winner.member(), gain_lower_bound, level }))
}

/// Whether held-out logs can confirm what training logs leave open: what errors of the smoothing imitate is so on all logs.
pub(super) fn is_confirmable(candidate: &Candidate) -> bool {
    imitated(candidate).is_none()
}

/// Share of alpha at which a candidate is taken on the training logs alone.
pub(super) fn strictness(candidate: &Candidate, criteria: &SearchCriteria) -> f64 {
    match imitated(candidate) {
        None => criteria.training,
        Some(Imitated::Wholly) => criteria.unconfirmable,
        Some(Imitated::InPart) => criteria.in_part,
    }
}

/// How much of an effect errors of the smoothing, or of the model in a few rows, imitate.
enum Imitated {
    /// All of it: an event in one log, torque saturation, a gear.
    Wholly,
    /// A part: friction that builds up after reversals.
    InPart,
}

fn imitated(candidate: &Candidate) -> Option<Imitated> {
    let Placed { effect, parameters, .. } = &candidate.placed;
    if candidate.log.is_some() || is_level(*effect) || effect.gear(parameters).is_some() {
        Some(Imitated::Wholly)
    } else if effect.about().nature == Nature::AfterReversals {
        Some(Imitated::InPart)
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::find;

    #[test]
    fn either_side_of_the_gates_of_saturation_and_of_friction_over_speed() {
        let criteria = Criteria::default();
        let most = 1.0 + criteria.share_of_torque;
        assert!(within_limit(100.0 * most - 1e-9, 100.0, &criteria).passed);
        assert!(!within_limit(100.0 * most + 1e-9, 100.0, &criteria).passed);
        let Levels { most, log_odds, .. } = criteria.levels;
        assert!(is_flat(most - 1e-9, &criteria.levels).passed && !is_flat(most, &criteria.levels).passed);
        // A statistic is twice a logarithm of a likelihood ratio.
        let likelier = |statistic: f64| likelier_than_rounding(statistic, 4.0, &criteria.levels).passed;
        assert!(likelier(2.0 * (4.0 + log_odds) + 1e-9) && !likelier(2.0 * (4.0 + log_odds)));
    }

    #[test]
    fn what_errors_imitate_must_be_surer_and_is_not_confirmed() {
        let criteria = SearchCriteria::default();
        let candidate = |name: &str| {
            let placed = Placed::typical(find(name).unwrap(), 0);
            Candidate { placed, log: None, columns: Default::default() }
        };
        let plain = candidate("stribeck_friction");
        assert!(is_confirmable(&plain) && strictness(&plain, &criteria) == criteria.training);
        let once = Candidate { log: Some(1), ..plain };
        let stricter = [
            (once, criteria.unconfirmable),
            (candidate("torque_saturation"), criteria.unconfirmable),
            (candidate("joint_elasticity"), criteria.unconfirmable),
            (candidate("presliding_hysteresis"), criteria.in_part),
        ];
        for (candidate, share) in stricter {
            assert!(!is_confirmable(&candidate) && strictness(&candidate, &criteria) == share, "{candidate:?}");
        }
    }
}
