//! Forward selection of effects: the best candidate is tested at a family-wise level, compared with its rivals in the same
//! whitening, and accepted if it also gains on held-out logs; at the end what became superfluous is dropped.

use super::acceptance::{Accepted, Outcome, Refusal, Trial, is_confirmable, strictness};
use super::all_logs;
use super::comparison::{Chosen, InOwnNoise, compare, without_rivals};
use super::eligible::{Contenders, Refused, Sizes, Standing};
use super::events::held_by_noise;
use super::found::{Found, Rejected, explained_by_play, in_the_end, members};
use super::pairs::simpler_pairs;
use super::parsimony::chosen;
use super::play::rattling_gears;
use super::reselection::reselect;
use super::round::{Round, settled};
use crate::diagnosis::Options;
use crate::diagnosis::criteria::{Gate, Judgement, Levels};
use crate::diagnosis::evidence::{Judged, Multiplicity, Ranked, Scan, Sensitivity, ranking};
use crate::diagnosis::model::{Candidate, Family, Member, Session, is_event, shapes};
use crate::diagnosis::noise::Whitener;
use crate::diagnosis::regression::{Column, rms};
use crate::diagnosis::watch::{Progress, Watch};
use crate::error::Result;
use std::collections::BTreeMap;

/// Candidates of each round that the log names.
const LOGGED: usize = 14;

/// Lasting laws that are compared with events before these are looked for.
const STANDING_AGAINST: usize = 3;

/// What the search came to.
#[derive(Debug)]
pub(crate) struct Selection {
    /// The effects found, in the order in which they were.
    pub found: Vec<Found>,
    /// Whether it ended with as many as were asked for: more may act.
    pub is_full: bool,
    /// The best candidates of rounds that failed a gate, and are not among them.
    pub rejected: Vec<Rejected>,
    /// The noise in the end.
    pub whitener: Whitener,
    /// The noise before anything was found.
    pub first_whitener: Whitener,
    /// Residual of the held-out logs with all of them.
    pub held_out: Column,
    /// How many independent tests the scan is worth.
    pub multiplicity: Multiplicity,
    /// The best of every family in the first scan, before anything was found; the best first.
    pub ranking: Vec<Ranked>,
    /// That to every family that could be tested last on the training logs.
    pub sensitivity: BTreeMap<Family, Sensitivity>,
}

/// Searches for effects until no more pass, or `watch` ends the search; it hears the number of effects found so far.
///
/// # Errors
/// If a log is too short to differentiate.
pub(crate) fn select(session: &mut Session, options: &Options, watch: &mut Watch) -> Result<Selection> {
    let mut found: Vec<Found> = Vec::new();
    let mut refused: Vec<Refused> = Vec::new();
    let (mut rejected, mut faint): (Vec<Rejected>, Vec<Rejected>) = Default::default();
    let (mut in_a_row, mut asked) = (0, 0);
    let mut in_own_noise = InOwnNoise::default();
    let mut round = Round::first(session, &mut found, options)?;
    let impacts = rattling_gears(session, options)?;
    found.extend(impacts.found);
    rejected.extend(impacts.rejected);
    session.leave_play_open(impacts.open_play);
    if let Some(logs) = impacts.logs {
        session.go_on_with(logs);
    }
    if !found.is_empty() {
        round = round.next(session, &mut found, options)?;
    }
    let first_whitener = round.whitener.clone();
    tracing::debug!(new = ?first_whitener.innovation_std(), rows = ?first_whitener.rows(), "noise");
    let multiplicity = round.scan.multiplicity(&round.fit, &round.whitener, options.seed);
    let ranking = ranking(&round.scan);
    let sizes = Sizes::new(session);
    // Events are looked for at first, and again once nothing else is found: every look fits each window of time anew.
    let (mut events_asked, mut postponed, mut exhausted) = (None, false, false);
    while found.len() < options.max_findings && !watch.is_over() {
        watch.tell(Progress::Found(found.len()));
        exhausted |= in_a_row >= session.criteria.search.refusals[0];
        if (events_asked.is_none() && !postponed) || exhausted {
            if events_asked == Some(found.len()) {
                break;
            }
            let present = members(&found);
            // Once nothing else is found, no law that lasts stands against them.
            let lasting = if exhausted { Vec::new() } else { clearest_lasting(&round.scan) };
            let (candidates, level) = ((&round.all[..], &round.whitener), (&multiplicity, options.alpha));
            let events = held_by_noise(session, &present, candidates, &lasting, level)?;
            rejected.extend(events.rejected);
            (events_asked, postponed) = if events.postponed { (None, true) } else { (Some(found.len()), false) };
            if let Some(accepted) = events.accepted {
                in_own_noise.clear();
                found.push(Found::new(accepted, Vec::new()));
                round = after_one_more(session, &mut found, round, options)?;
                (in_a_row, exhausted, events_asked) = (0, false, None);
                continue;
            }
            if exhausted {
                break;
            }
        }
        // Nothing confirms those that only the training logs can show.
        let standing = |judged: &Judged, level: f64| {
            let candidate = &judged.candidate;
            let limit = options.alpha * strictness(candidate, &session.criteria.search);
            let judgement = Judgement::at_most(Gate::FamilyWise, level, limit);
            match Standing::by(judgement.or(is_confirmable(candidate)), options.alpha) {
                Standing::MayWin => sizes.standing(judged, level <= options.alpha),
                other => other,
            }
        };
        let contenders = Contenders::new(&round.scan, &found, &refused, &multiplicity, standing);
        faint.clone_from(&contenders.rejected);
        if contenders.best.is_empty() {
            exhausted = true;
            continue;
        }
        let level = contenders.level;
        for judged in contenders.best.iter().take(LOGGED) {
            let (family, test) = (judged.candidate.family(), &judged.test);
            tracing::debug!(
                ?family,
                statistic = test.statistic,
                freedom = test.freedom,
                log_p = test.log_p(),
                "candidate"
            );
        }
        // What the training logs alone do not show may show together with the held-out ones.
        let tries = session.criteria.search.attempts().get(asked).copied();
        if level > options.alpha && (tries.is_none() || level > session.criteria.levels.even_p) {
            rejected.extend(contenders.not_significant(options.alpha));
            exhausted = true;
            continue;
        }
        let members = members(&found);
        let compared = compare(session, &members, &contenders, &round.scan, &multiplicity, &mut in_own_noise)?;
        watch.tell(Progress::Found(found.len()));
        let Chosen { winner, alternatives, whitener: under } = chosen(session, &members, &compared)?;
        tracing::debug!(winner = ?winner.candidate.slot(), at = ?winner.candidate.placed.parameters, level, ?alternatives, "comparison");
        let Round { whitener, fit, .. } = &round;
        let trial = Trial {
            session,
            members: &members,
            whitener,
            fit,
            multiplicity: &multiplicity,
            alpha: options.alpha,
            tries,
        };
        match trial.of(&winner, level, under)? {
            Outcome::Accepted(accepted) => {
                let alternatives = explained_by_play(session, &found, &accepted.member, alternatives);
                // What was refused where this acts was seen in a noise that did not know it.
                let joints = accepted.member.candidate.joints();
                refused.retain(|other| !other.joints.iter().any(|joint| joints.contains(joint)));
                (in_a_row, asked) = (0, 0);
                in_own_noise.clear();
                found.push(Found::new(*accepted, alternatives));
                round = after_one_more(session, &mut found, round, options)?;
            }
            Outcome::Refused(Refusal { may_be, asked: in_vain, failed }) => {
                refused.push(Refused::new(&winner.candidate, may_be));
                rejected.push(Rejected { slot: winner.candidate.slot(), failed });
                in_a_row += 1;
                asked += usize::from(in_vain);
            }
        }
    }
    let is_full = found.len() >= options.max_findings;
    // Of what held-out logs cannot confirm, what is significant with all that was found in the model.
    faint.retain(|one| rejected.iter().all(|other| other.slot != one.slot));
    rejected.extend(faint);
    let superfluous = drop_superfluous(session, &mut found)?;
    let dropped = !superfluous.is_empty();
    rejected.extend(superfluous);
    let simpler = simpler_pairs(session, &mut found, &round.all, &multiplicity, options, &mut rejected)?;
    let reselected = reselect(session, &mut found, &round.all, &multiplicity, options, &mut rejected, watch)?;
    let Round { mut whitener, scan, all, .. } = round;
    // What would be significant with an estimate that cannot be.
    for (slot, log_p, failed) in scan.impossible() {
        if multiplicity.level(slot.0.effect, log_p) <= options.alpha {
            rejected.push(Rejected { slot, failed });
        }
    }
    let sensitivity = scan.sensitivity(|column| sizes.least_factor(column));
    drop(scan);
    let more = all_logs::search(session, &mut found, all, &multiplicity, options, &mut rejected, watch)?;
    if more || simpler || reselected || dropped {
        (whitener, _) = settled(session, &mut found)?;
    }
    let held_out = held_out_steps(session, &mut found, &whitener)?;
    let rejected = in_the_end(rejected, &found);
    Ok(Selection { found, is_full, rejected, whitener, first_whitener, held_out, multiplicity, ranking, sensitivity })
}

/// The laws that last and are the likeliest of a scan, of different families.
fn clearest_lasting(scan: &Scan) -> Vec<&Candidate> {
    let best = scan.best_per_family().into_iter().map(|judged| &judged.candidate);
    best.filter(|candidate| !is_event(candidate.placed.effect)).take(STANDING_AGAINST).collect()
}

/// The next round, after one more effect was found: what was decided before it is decided again. Rows near the ends of an event are left
/// out, and the rounding of friction on the joints on which it acts is that of the residual with it.
fn after_one_more(session: &mut Session, found: &mut [Found], round: Round, options: &Options) -> Result<Round> {
    let members = members(found);
    let Some(last) = members.last() else { return round.next(session, found, options) };
    if is_event(last.placed.effect) {
        session.leave_out_ends(last);
        // Without those rows its times are known no better.
        if let Some(found) = found.last_mut() {
            found.member.fixed.extend(shapes(last.placed.effect));
        }
    }
    let is_rounded = |joint: &usize| session.model.arm.coulomb_rounding[*joint].width() > 0.0;
    let rounded = match last.candidate.joints().iter().any(is_rounded) {
        true => session.round_again(&members)?,
        false => Vec::new(),
    };
    round.rounded_anew(&rounded, session, found, options)
}

impl Selection {
    /// Fits the effects found once more, after some were taken out.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub(crate) fn settle(&mut self, session: &mut Session) -> Result<()> {
        (self.whitener, _) = settled(session, &mut self.found)?;
        self.held_out = held_out_steps(session, &mut self.found, &self.whitener)?;
        Ok(())
    }

    /// Takes the held-out residuals again, after the effects found were fitted again.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub(crate) fn take_held_out(&mut self, session: &Session) -> Result<()> {
        self.held_out = held_out_steps(session, &mut self.found, &self.whitener)?;
        Ok(())
    }
}

/// Effects that were given, in the model.
#[derive(Debug)]
pub(crate) struct Given {
    /// Those that can be estimated, as if they had been found: nothing tested them.
    pub found: Vec<Found>,
    /// The others, with the gate that the estimate fails; None where the logs do not separate it from the rest of the model.
    pub left_out: Vec<(Family, Option<Judgement>)>,
    /// The noise with them in the model.
    pub whitener: Whitener,
    /// The noise with none.
    pub first_whitener: Whitener,
}

/// Takes the effects `given` into the model, without a test whether they act: each as a search takes the winner of a comparison, the
/// likeliest first, until `watch` ends it.
///
/// # Errors
/// If a log is too short to differentiate.
pub(crate) fn take(session: &mut Session, given: &[Family], options: &Options, watch: &mut Watch) -> Result<Given> {
    let candidates = given.iter().map(|family| family.effect.to_owned()).collect();
    let options = &Options { candidates, ..options.clone() };
    let (mut found, mut left_out, mut open) = (Vec::new(), Vec::new(), given.to_vec());
    let mut round = Round::first(session, &mut found, options)?;
    let first_whitener = round.whitener.clone();
    while let Some(likeliest) = round.scan.likeliest_of(&open).filter(|_| !watch.is_over()) {
        let family = likeliest.candidate.family();
        open.retain(|other| *other != family);
        match without_rivals(session, &members(&found), likeliest, &round.all)? {
            Some(best) => {
                let accepted = Accepted { member: best.member(), gain_lower_bound: 0.0, level: 1.0 };
                found.push(Found::new(accepted, Vec::new()));
                round = after_one_more(session, &mut found, round, options)?;
                watch.tell(Progress::Found(found.len()));
            }
            None => left_out.push((family, None)),
        }
    }
    let impossible = round.scan.impossible();
    let failed = |family: &Family| impossible.iter().find(|(slot, ..)| slot.0 == *family).map(|(_, _, failed)| *failed);
    left_out.extend(open.into_iter().map(|family| (family, failed(&family))));
    Ok(Given { found, left_out, whitener: round.whitener, first_whitener })
}

/// Writes the held-out residual before and after each effect; returns the residual after all.
fn held_out_steps(session: &Session, found: &mut [Found], whitener: &Whitener) -> Result<Column> {
    let all = members(found);
    let rms = |residual: &Column| rms(&session.logs.test.rows.valid, residual);
    let mut left = session.baseline_residual_on(&session.logs.test, whitener)?;
    for (count, found) in found.iter_mut().enumerate() {
        let after = session.held_out_residual(&all[..=count], whitener)?;
        found.rms = [rms(&left), rms(&after)];
        left = after;
    }
    Ok(left)
}

/// Takes out the effects that the others have made superfluous, the least needed first.
fn drop_superfluous(session: &Session, found: &mut Vec<Found>) -> Result<Vec<Rejected>> {
    let mut dropped = Vec::new();
    while found.len() > 1 {
        let all = members(found);
        let whitener = session.noise_under(&session.model.columns(&session.logs.train, &all)?);
        let mut least = (f64::NEG_INFINITY, 0);
        for index in (0..all.len()).filter(|&index| !all[index].held) {
            let others: Vec<Member> =
                all.iter().enumerate().filter(|(k, _)| *k != index).map(|(_, member)| member.clone()).collect();
            let fit = whitener.fit(&session.model.columns(&session.logs.train, &others)?, &session.logs.train.torque);
            let log_p = fit.test(&whitener.apply_all(&all[index].candidate.columns)).map_or(0.0, |test| test.log_p());
            if log_p > least.0 {
                least = (log_p, index);
            }
        }
        let needed = is_needed(least.0, &session.criteria.levels);
        if needed.passed {
            break;
        }
        dropped.push(Rejected { slot: found.remove(least.1).member.candidate.slot(), failed: needed });
    }
    Ok(dropped)
}

/// Whether the others do not make a finding superfluous, by the logarithm of its p-value with them in the model.
fn is_needed(log_p: f64, levels: &Levels) -> Judgement {
    Judgement::at_most(Gate::Needed, log_p.exp(), levels.sure_p)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn either_side_of_superfluous() {
        let levels = Levels::default();
        let needed = |p: f64| is_needed(p.ln(), &levels).passed;
        assert!(needed(levels.sure_p * (1.0 - 1e-9)) && !needed(levels.sure_p * (1.0 + 1e-9)));
    }
}
