//! Whether the winner of a contest is taken into the model: by what the training logs show beside all that is not physics, and
//! by what it gains on the held-out logs.

use crate::diagnosis::evidence::{
    Gains, Judged, Multiplicity, SEEN_AGAIN, left_by_others, log_p_adjusted, without_influential_blocks,
};
use crate::diagnosis::logs::Rows;
use crate::diagnosis::model::{Candidate, Member, Noise, Session, is_flat, is_level};
use crate::diagnosis::noise::Whitener;
use crate::diagnosis::regression::{Column, Projection};
use crate::effects::{Hidden, Nature, Placed, Site};
use crate::error::Result;
use crate::identification::effect_model::Trust;

/// Level at which the training logs leave so little to chance that held-out logs need only gain, however surely.
const BEYOND_CHANCE: f64 = 1e-6;

/// What an effect takes outside the blocks that show it best must be less likely than this by chance, or it is seen again on
/// the held-out logs.
const SEEN_ELSEWHERE: f64 = 0.01;

/// The same where held-out logs confirm it.
const SEEN_ELSEWHERE_TOO: f64 = 0.05;

/// Share of the level at which any effect is believed: the tests take the noise for known, and it is estimated.
const NOISE_IS_ESTIMATED: f64 = 0.2;

/// The same for an event in one log.
const ONCE: f64 = 1e-7;

/// The same for what is between motor and link: it lives where smooth positions err most, around reversals and jerks.
const GEARS: f64 = 1e-7;

/// The same for a level: the rows in which the model's torque is extreme are also those in which its error is, which looks as
/// if the torque had been cut off.
const EXTREMES: f64 = 1e-9;

/// The same for friction that comes up after reversals, near which smooth positions err most.
const SUDDEN: f64 = 1e-4;

/// The same for friction over speed beside another law of it on the same joint: books write such curves in many forms, and none is
/// that of a gear.
const ANOTHER_FORM: f64 = 1e-5;

/// The same for what acts in a joint and re-identified bodies hide in part: the little that is left of it is also what smooth positions
/// make of the part that is hidden.
const HIDDEN: f64 = 1e-3;

/// Share of the level at which is believed what logs confirm that did not choose it, held-out ones or each of all in its turn: there
/// the scatter over blocks stands in for the noise.
const CONFIRMED: f64 = 0.5;

/// The same for either where something else was found before: what is not quite right with that is left, too. Delays do not count, which
/// sampling brings with it.
const LATER: f64 = 0.02;

/// Level of the training logs beyond which they say nothing that held-out logs could confirm. Together both would keep the level all
/// the same, but what then decides is one log alone.
const NOTHING_SAID: f64 = 0.3;

/// Chance beyond which held-out logs confirm nothing, however sure the training logs are: what goes with noise alone as often speaks
/// against it as for it.
const NOTHING_CONFIRMED: f64 = 0.2;

/// Share of what is left that an effect must take to be worth a name where much is: there all that is little fits a little.
/// Beside constants, the second look, it must be twice the share.
const WORTH_A_NAME: f64 = 0.05;

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
    /// Whether it may be so all the same, and the logs are too few to tell.
    pub may_be: bool,
    /// Whether held-out logs were asked to confirm what the training logs left open.
    pub asked: bool,
}

/// A candidate that is taken.
#[derive(Debug)]
pub struct Accepted {
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

/// What the training logs say of a candidate.
#[derive(Debug, Clone, Copy)]
pub(super) struct Seen {
    /// Probability of as good a best candidate without any effect.
    level: f64,
    /// The level at which they alone are believed.
    limit: f64,
    /// Logarithm of the probability of what is seen outside the blocks that show it best.
    elsewhere: f64,
    /// Whether held-out logs can confirm it.
    confirmable: bool,
}

impl Trial<'_> {
    /// The winner of a contest as a member of the model, if it is to be one. `level` is the probability of as good a best
    /// candidate in the noise that does not know it, `under` the noise that does, if it was worked out before.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub fn of(&self, winner: &Judged, level: f64, under: Option<Whitener>) -> Result<Outcome> {
        match self.seen(winner, level)? {
            Ok(seen) => self.unseen(winner, seen, under),
            Err(refusal) => Ok(Outcome::Refused(refusal)),
        }
    }

    /// The same where all logs are identified from: what each shows is judged by what the others say of it.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub fn by_others(&self, winner: &Judged, level: f64) -> Result<Outcome> {
        let Seen { level, limit, elsewhere, confirmable } = match self.seen(winner, level)? {
            Ok(seen) => seen,
            Err(refusal) => return Ok(Outcome::Refused(refusal)),
        };
        let limit = if confirmable { self.level_at(CONFIRMED) } else { limit };
        let Trial { session, members, .. } = *self;
        let with: Vec<Member> = members.iter().cloned().chain([winner.member()]).collect();
        let Noise { whitener, .. } = session.noise_under(&session.all_columns(&session.train, &with)?);
        let joints = winner.candidate.joints();
        let much_left = whitener.much_is_left(&joints);
        let left = |members: &[Member]| left_by_others(session, members, &whitener);
        let (before, after, rows) = (left(members)?, left(&with)?, session.train.rows.len());
        let errors = session.train.errors_beside(&winner.candidate.placed);
        let gains = Gains::beside(&whitener, &before, &after, &joints, &errors, rows);
        let (lower_bound, chance) = (gains.lower_bound(), gains.chance());
        tracing::debug!(level, elsewhere, much_left, lower_bound, share = gains.share(), chance, "gain by the others");
        let believed = level <= limit && elsewhere < SEEN_ELSEWHERE.ln() && chance < SEEN_AGAIN;
        if much_left || !believed || gains.share() <= 0.0 {
            return Ok(Outcome::Refused(Refusal { may_be: gains.share() > 0.0, asked: false }));
        }
        Ok(accepted(winner, lower_bound, level))
    }

    /// What the logs identified from say of the winner, or why it is refused by them alone.
    fn seen(&self, winner: &Judged, level: f64) -> Result<std::result::Result<Seen, Refusal>> {
        let refused = |may_be| Ok(Err(Refusal { may_be, asked: false }));
        let another_form = self.is_another_form(&winner.candidate);
        let is_hidden = self.is_hidden(&winner.candidate);
        let share = strictness(&winner.candidate).min(if is_hidden { HIDDEN } else { 1.0 });
        let limit = self.level_at(if another_form { share.min(ANOTHER_FORM) } else { share });
        let confirmable = is_confirmable(&winner.candidate) && !another_form && !is_hidden;
        let highest = if confirmable { 1.0 } else { limit };
        // What is significant only in the noise model that does not know it is an error of that noise model.
        let kind = winner.candidate.family().effect;
        let mut level = level.max(self.multiplicity.level(kind, winner.test.log_p()));
        if level > highest {
            return refused(!is_level(winner.candidate.placed.effect));
        }
        let adjusted = log_p_adjusted(self.session, self.whitener, self.fit, winner);
        level = level.max(self.multiplicity.level(kind, adjusted));
        tracing::debug!(level, adjusted, "adjusted for slow noise and errors of the smoothing");
        if level > highest {
            return refused(!is_level(winner.candidate.placed.effect));
        }
        let Placed { effect, joint, parameters } = &winner.candidate.placed;
        let elsewhere = if is_level(*effect) {
            let flat = is_flat(&self.session.arm, &self.session.train.rows, *joint, parameters[0]);
            tracing::debug!(flat, level = parameters[0], "torque beyond a level");
            if !flat {
                return refused(false);
            }
            f64::NEG_INFINITY
        } else {
            without_influential_blocks(self.session, self.members, self.whitener, winner)?
        };
        Ok(Ok(Seen { level, limit, elsewhere, confirmable }))
    }

    /// The level at which something is believed: a share of that of the whole, no more than [`LATER`] where something was found before.
    fn level_at(&self, share: f64) -> f64 {
        let counts = |member: &Member| member.placed.effect.about().nature != Nature::Delay;
        self.alpha * if self.members.iter().any(counts) { share.min(LATER) } else { share }
    }

    /// Whether a candidate says how friction goes with speed on a joint of which the model says so in another way.
    fn is_another_form(&self, candidate: &Candidate) -> bool {
        let is_of_speed = |placed: &Placed| placed.effect.about().nature == Nature::OfSpeed;
        let is_there = |member: &Member| member.placed.joint == candidate.placed.joint && is_of_speed(&member.placed);
        is_of_speed(&candidate.placed) && self.members.iter().any(is_there)
    }

    /// Whether a candidate acts in a joint and is hidden in part by the bodies that are identified with it.
    fn is_hidden(&self, candidate: &Candidate) -> bool {
        let Session { trust, train, .. } = self.session;
        let about = candidate.placed.effect.about();
        let is_free = *trust == Trust::Structure && train.rows.before == 0;
        is_free && about.site == Site::Joint && about.hidden_by_base_parameters == Hidden::InPart
    }

    /// The winner as a member of the model if the held-out rows agree. What the training logs leave open the held-out logs may
    /// confirm: the two are independent.
    fn unseen(&self, winner: &Judged, seen: Seen, under: Option<Whitener>) -> Result<Outcome> {
        let Seen { level, limit, elsewhere, confirmable } = seen;
        let held_out = self.held_out(winner, under)?;
        let HeldOut { gains, beside_errors, .. } = &held_out;
        // What rests on a moment or two of the training logs is no accident if it is there again.
        let there = confirmable && beside_errors.chance() < SEEN_AGAIN && gains.without_most_influential_block() > 0.0;
        let alone = level <= limit && (there || elsewhere < SEEN_ELSEWHERE.ln());
        let bound = gains.lower_bound();
        let refused = |asked| Ok(Outcome::Refused(Refusal { may_be: gains.share() > 0.0, asked }));
        if held_out.whitener.much_is_left(&winner.candidate.joints()) {
            if !alone || self.session.turns_unphysical(&held_out.with, &held_out.whitener)? {
                return refused(false);
            }
            if bound > WORTH_A_NAME {
                return Ok(accepted(winner, bound, level));
            }
            let bound = held_out.beside_constants(&self.session.test.rows, &winner.candidate.joints()).lower_bound();
            let enough = winner.candidate.log.is_none() && bound > 2.0 * WORTH_A_NAME;
            return if enough { Ok(accepted(winner, bound, level)) } else { refused(false) };
        }
        // A torque is cut off in a few rows, where the smoothing errs most: their scatter says little, and held-out motions that stay below
        // the level say nothing.
        let is_level = is_level(winner.candidate.placed.effect);
        let sure = level < BEYOND_CHANCE && (gains.is_calm() || is_level);
        let gained = gains.share() > 0.0 || (is_level && !gains.is_contradicted());
        if alone && (bound > 0.0 || (sure && gained)) {
            return Ok(accepted(winner, bound, level));
        }
        let Some(tries) = self.tries.filter(|_| confirmable && level <= NOTHING_SAID) else { return refused(false) };
        let together = beside_errors.together(level, tries);
        tracing::debug!(together, chance = beside_errors.chance(), "training and held-out logs together");
        let confirmed = beside_errors.chance() <= NOTHING_CONFIRMED && together <= self.level_at(CONFIRMED);
        let believed = confirmed && (there || elsewhere < SEEN_ELSEWHERE_TOO.ln());
        if believed && gains.share() > 0.0 { Ok(accepted(winner, bound, together)) } else { refused(true) }
    }

    /// What the held-out rows say of the winner. An event of one training log shows in no other: its gain is that on the
    /// training rows.
    fn held_out(&self, winner: &Judged, under: Option<Whitener>) -> Result<HeldOut> {
        let Trial { session, members, .. } = *self;
        let with: Vec<Member> = members.iter().cloned().chain([winner.member()]).collect();
        let whitener = match under {
            Some(whitener) => whitener,
            None => session.noise_under(&session.all_columns(&session.train, &with)?).whitener,
        };
        let before = session.held_out_residual(members, &whitener)?;
        let after = session.held_out_residual(&with, &whitener)?;
        let joints = winner.candidate.joints();
        let test = &session.test.rows;
        let unseen = whitener.on(test);
        let gains = match winner.candidate.log {
            None => Gains::new(&unseen, &before, &after, &joints, test.len()),
            Some(_) => {
                let before = session.residual_on(&session.train, members, &whitener)?;
                let after = session.residual_on(&session.train, &with, &whitener)?;
                Gains::new(&whitener, &before, &after, &joints, session.train.rows.len())
            }
        };
        let errors = session.test.errors_beside(&winner.candidate.placed);
        let beside_errors = Gains::beside(&unseen, &before, &after, &joints, &errors, test.len());
        let bound = gains.lower_bound();
        tracing::debug!(bound, share = gains.share(), "held-out gain");
        Ok(HeldOut { with, whitener, unseen, residuals: [before, after], gains, beside_errors })
    }
}

/// What held-out rows say of a candidate.
struct HeldOut {
    /// The model with it.
    with: Vec<Member>,
    /// The noise as that sees it, on either kind of logs.
    whitener: Whitener,
    unseen: Whitener,
    /// What is left on the held-out rows before and after.
    residuals: [Column; 2],
    /// What it gains.
    gains: Gains,
    /// The same beside what errors of the positions put into the torque.
    beside_errors: Gains,
}

impl HeldOut {
    /// What it gains on the held-out rows beside a constant torque on every joint that it acts on.
    fn beside_constants(&self, test: &Rows, joints: &[usize]) -> Gains {
        let [before, after] = &self.residuals;
        Gains::beside_constants(&self.unseen, before, after, joints, test)
    }
}

fn accepted(winner: &Judged, gain_lower_bound: f64, level: f64) -> Outcome {
    Outcome::Accepted(Box::new(Accepted { member: winner.member(), gain_lower_bound, level }))
}

/// Whether held-out logs can confirm what training logs leave open: what is taken for something else too easily is so on all logs.
pub(super) fn is_confirmable(candidate: &Candidate) -> bool {
    strictness(candidate) == NOISE_IS_ESTIMATED
}

/// Share of the level at which a candidate is believed.
pub(super) fn strictness(candidate: &Candidate) -> f64 {
    if candidate.log.is_some() {
        // No other log can confirm what happened once.
        ONCE
    } else if is_level(candidate.placed.effect) {
        EXTREMES
    } else if candidate.placed.effect.gear(&candidate.placed.parameters).is_some() {
        GEARS
    } else if candidate.placed.effect.about().nature == Nature::AfterReversals {
        SUDDEN
    } else {
        NOISE_IS_ESTIMATED
    }
}
