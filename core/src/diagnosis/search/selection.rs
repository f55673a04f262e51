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
use super::play::{rattling_gears, rotors_behind_play};
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
    /// The candidates along all logs; none where these were not searched.
    everywhere: Vec<Candidate>,
}

/// Searches for effects until no more pass, or `watch` ends the search; it hears the number of effects found so far.
///
/// # Errors
/// If a log is too short to differentiate.
pub(crate) fn select(session: &mut Session, options: &Options, watch: &mut Watch) -> Result<Selection> {
    let mut found: Vec<Found> = Vec::new();
    let mut rejected: Vec<Rejected> = Vec::new();
    let mut fitted = settled(session, &mut found)?;
    let impacts = rattling_gears(session, options)?;
    found.extend(impacts.found);
    rejected.extend(impacts.rejected);
    let divided = rotors_behind_play(session, &impacts.open_play, &fitted)?;
    session.leave_play_open(impacts.open_play);
    if let Some(logs) = impacts.logs {
        session.go_on_with(logs);
    }
    if divided || !found.is_empty() {
        fitted = settled(session, &mut found)?;
    }
    let round = Round::first(session, fitted, options)?;
    let first_whitener = round.whitener.clone();
    tracing::debug!(new = ?first_whitener.innovation_std(), rows = ?first_whitener.rows(), "noise");
    let multiplicity = round.scan.multiplicity(&round.fit, &round.whitener, options.seed);
    let ranking = ranking(&round.scan);
    let sizes = Sizes::new(session);
    let mut forward = Forward {
        session,
        options,
        multiplicity: &multiplicity,
        sizes: &sizes,
        round,
        found,
        refused: Vec::new(),
        rejected,
        faint: Vec::new(),
        in_a_row: 0,
        asked: 0,
        events: Events::NotYet,
        in_own_noise: InOwnNoise::default(),
    };
    while forward.found.len() < options.max_findings && !watch.is_over() {
        if !forward.step(watch)? {
            break;
        }
    }
    let Forward { round, mut found, mut rejected, mut faint, .. } = forward;
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
    let (more, everywhere) = all_logs::search(session, &mut found, all, &multiplicity, options, &mut rejected, watch)?;
    if more || simpler || reselected || dropped {
        (whitener, _) = settled(session, &mut found)?;
    }
    let held_out = held_out_steps(session, &mut found, &whitener)?;
    let rejected = in_the_end(rejected, &found);
    Ok(Selection {
        found,
        is_full,
        rejected,
        whitener,
        first_whitener,
        held_out,
        multiplicity,
        ranking,
        sensitivity,
        everywhere,
    })
}

/// Whether events were looked for: every look fits each window of time anew.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Events {
    /// Not since the last that was found.
    NotYet,
    /// A lasting law explained more than any of them.
    Postponed,
    /// When so many effects were found.
    LookedFor(usize),
}

/// Forward selection at work.
struct Forward<'a, 's> {
    session: &'a mut Session<'s>,
    options: &'a Options,
    multiplicity: &'a Multiplicity,
    sizes: &'a Sizes,
    /// The tests of all candidates with what was found in the model.
    round: Round,
    found: Vec<Found>,
    /// Winners that failed a gate, as long as nothing new is found where they act.
    refused: Vec<Refused>,
    /// All that failed a gate.
    rejected: Vec<Rejected>,
    /// What is significant in the last scan and held-out logs cannot confirm.
    faint: Vec<Rejected>,
    /// Winners refused since the last one that was accepted.
    in_a_row: usize,
    /// How often held-out logs were asked in vain since then.
    asked: usize,
    events: Events,
    in_own_noise: InOwnNoise,
}

impl Forward<'_, '_> {
    /// Looks for one more effect: an event at first and once nothing else is found, else the best candidate of the scan. Returns whether
    /// anything is left to look for.
    fn step(&mut self, watch: &mut Watch) -> Result<bool> {
        watch.tell(Progress::Found(self.found.len()));
        if self.in_a_row >= self.session.criteria.search.refusals[0] {
            return self.last_event();
        }
        if self.events == Events::NotYet {
            let lasting: Vec<Candidate> = clearest_lasting(&self.round.scan).cloned().collect();
            if self.takes_event(&lasting)? {
                return Ok(true);
            }
        }
        let (session, alpha, multiplicity, sizes) = (&*self.session, self.options.alpha, self.multiplicity, self.sizes);
        // Nothing confirms those that only the training logs can show.
        let standing = |judged: &Judged, level: f64| {
            let candidate = &judged.candidate;
            let limit = alpha * strictness(candidate, &session.criteria.search);
            let judgement = Judgement::at_most(Gate::FamilyWise, level, limit);
            match Standing::by(judgement.or(is_confirmable(candidate)), alpha) {
                Standing::MayWin => sizes.standing(judged, level <= alpha),
                other => other,
            }
        };
        let Round { scan, whitener, fit, .. } = &self.round;
        let contenders =
            Contenders::new(scan, &self.found, (&self.refused, &session.criteria.levels), multiplicity, standing);
        self.faint.clone_from(&contenders.rejected);
        if contenders.best.is_empty() {
            return self.last_event();
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
        let tries = session.criteria.search.attempts().get(self.asked).copied();
        if level > alpha && (tries.is_none() || level > session.criteria.levels.even_p) {
            self.rejected.extend(contenders.not_significant(alpha));
            return self.last_event();
        }
        let members = members(&self.found);
        let compared = compare(session, &members, &contenders, scan, multiplicity, &mut self.in_own_noise)?;
        watch.tell(Progress::Found(self.found.len()));
        let Chosen { winner, alternatives, whitener: under } = chosen(session, &members, &compared)?;
        tracing::debug!(winner = ?winner.candidate.slot(), at = ?winner.candidate.placed.parameters, level, ?alternatives, "comparison");
        let trial = Trial { session, members: &members, whitener, fit, multiplicity, alpha, tries };
        match trial.of(&winner, level, under)? {
            Outcome::Accepted(accepted) => {
                let alternatives = explained_by_play(session, &self.found, &accepted.member, alternatives);
                let joints = accepted.member.candidate.joints();
                self.refused.iter_mut().for_each(|other| other.open_on(&joints));
                self.take(Found::new(*accepted, alternatives))?;
            }
            Outcome::Refused(Refusal { may_be, asked: in_vain, failed }) => {
                self.refused.retain(|other| other.slot != winner.candidate.slot());
                self.refused.push(contenders.refused(&winner, may_be));
                self.rejected.push(Rejected { slot: winner.candidate.slot(), failed });
                self.in_a_row += 1;
                self.asked += usize::from(in_vain);
            }
        }
        Ok(true)
    }

    /// Takes an event that the noise holds, once nothing else is found and no law that lasts stands against it; false where there is none.
    fn last_event(&mut self) -> Result<bool> {
        Ok(self.events != Events::LookedFor(self.found.len()) && self.takes_event(&[])?)
    }

    /// Takes an event that the noise holds and that explains more than the `lasting` laws; false where there is none.
    fn takes_event(&mut self, lasting: &[Candidate]) -> Result<bool> {
        let (candidates, level) =
            ((&self.round.all[..], &self.round.whitener), (self.multiplicity, self.options.alpha));
        let searched = held_by_noise(self.session, &members(&self.found), candidates, lasting, level)?;
        self.rejected.extend(searched.rejected);
        self.events = if searched.postponed { Events::Postponed } else { Events::LookedFor(self.found.len()) };
        let Some(accepted) = searched.accepted else { return Ok(false) };
        self.events = Events::NotYet;
        self.take(Found::new(accepted, Vec::new()))?;
        Ok(true)
    }

    /// Goes on with one more effect in the model.
    fn take(&mut self, found: Found) -> Result<()> {
        (self.in_a_row, self.asked) = (0, 0);
        self.in_own_noise.clear();
        self.found.push(found);
        after_one_more(self.session, &mut self.found, &mut self.round, self.options)
    }
}

/// The laws that last and are the likeliest of a scan, of different families.
fn clearest_lasting(scan: &Scan) -> impl Iterator<Item = &Candidate> {
    let best = scan.best_per_family().into_iter().map(|judged| &judged.candidate);
    best.filter(|candidate| !is_event(candidate.placed.effect)).take(STANDING_AGAINST)
}

/// Goes on to the next round after one more effect was found: what was decided before it is decided again. Rows near the ends of an event
/// are left out, and the rounding of friction on the joints on which it acts is that of the residual with it.
fn after_one_more(session: &mut Session, found: &mut [Found], round: &mut Round, options: &Options) -> Result<()> {
    let members = members(found);
    let Some(last) = members.last() else { return round.renew(&[], session, found, options) };
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
    round.renew(&rounded, session, found, options)
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

    /// Asks all logs what else explains each of the effects found: once what does not matter is out.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub(crate) fn ask_for_alternatives(&mut self, session: &Session, watch: &mut Watch) -> Result<()> {
        all_logs::ask_for_alternatives(session, &mut self.found, &self.everywhere, &self.multiplicity, watch)
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
    let fitted = settled(session, &mut found)?;
    let mut round = Round::first(session, fitted, options)?;
    let first_whitener = round.whitener.clone();
    while let Some(likeliest) = round.scan.likeliest_of(&open).filter(|_| !watch.is_over()) {
        let family = likeliest.candidate.family();
        open.retain(|other| *other != family);
        match without_rivals(session, &members(&found), likeliest, &round.all)? {
            Some(best) => {
                let accepted = Accepted { member: best.member(), gain_lower_bound: 0.0, level: 1.0 };
                found.push(Found::new(accepted, Vec::new()));
                after_one_more(session, &mut found, &mut round, options)?;
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
