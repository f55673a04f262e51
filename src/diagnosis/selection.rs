//! Forward selection of effects: the best candidate is tested at a family-wise level, compared with its rivals in the same
//! whitening, and accepted if it also gains on held-out logs; at the end what became superfluous is dropped.

use super::Options;
use super::beside::beside;
use super::candidates::{self, Candidate, Family, Slot};
use super::column::rms;
use super::contest::{Alternative, Contest, Scan, contest};
use super::evidence::{Ranked, ranking};
use super::held_out::Gains;
use super::impacts::Play;
use super::judging::Judged;
use super::play::rattling_gears;
use super::roles::is_level;
use super::score::{Projection, family_wise};
use super::session::{Member, Noise, Session};
use super::stretches::without_best_stretches;
use super::verdict::Verdict;
use super::whitening::Whitener;
use crate::error::Result;
use std::collections::BTreeMap;

/// Effects are dropped in the end when what they take is more likely than this without them.
const KEPT: f64 = 1e-4;

/// Level at which the training logs leave so little to chance that held-out logs need only gain, however surely.
const BEYOND_CHANCE: f64 = 1e-6;

/// What an effect takes outside the stretches that show it best must be less likely than this by chance.
const SEEN_ELSEWHERE: f64 = 0.01;

/// Share of the level at which any effect is believed: the tests take the noise for known, and it is estimated.
const NOISE_IS_ESTIMATED: f64 = 0.2;

/// The same for an event in one log.
const ONCE: f64 = 1e-7;

/// The same for what is between motor and link: it lives where smooth positions err most, around reversals and jerks.
const GEARS: f64 = 1e-7;

/// The same for a level: the rows in which the model's torque is extreme are also those in which its error is, which looks as
/// if the torque had been cut off.
const EXTREMES: f64 = 1e-9;

/// Share of the held-out sum of squares, surely gained, for which a rival takes the winner's place: less may come of a further
/// parameter or of chance.
const CLEARLY_BETTER: f64 = 0.02;

/// What a model leaves over the noise from which an effect must take a share of it to be worth a name, and that share:
/// where much is wrong, all that is little fits a little.
const MUCH_LEFT: f64 = 1.5;
const WORTH_A_NAME: f64 = 0.05;

/// Candidates of each round that the log names.
const LOGGED: usize = 14;

/// Candidates that may be refused one after the other before the search ends.
const REFUSALS: usize = 12;

/// An effect that was found.
#[derive(Debug, Clone)]
pub struct Found {
    /// The effect in the model.
    pub member: Member,
    /// What else explains the data, the likeliest first; empty where the data name the effect.
    pub alternatives: Vec<Alternative>,
    /// Probability of as good a best candidate without any effect.
    pub family_wise_p: f64,
    /// Lower bound (84 %) of the share of the held-out sum of squares that it takes away.
    pub gain_lower_bound: f64,
    /// Root mean square of the held-out residual before and after, `[joint]`, N m.
    pub rms: [Vec<f64>; 2],
    /// Named, one of a few, or unexplained: the best name there is for something that it explains in part only.
    pub verdict: Verdict,
    /// What its impacts say, where these are what shows it.
    pub impacts: Option<Play>,
}

/// What the search came to.
#[derive(Debug)]
pub struct Selection {
    /// The effects found, in the order in which they were.
    pub found: Vec<Found>,
    /// The noise in the end.
    pub whitener: Whitener,
    /// The noise before anything was found.
    pub first_whitener: Whitener,
    /// Number of independent tests that the scan is worth.
    pub tests: f64,
    /// The best of every family in the first scan, before anything was found; the best first.
    pub ranking: Vec<Ranked>,
    /// Of every family that could be tested in the end: index of its first linear parameter and its standard deviation.
    pub sensitivity: BTreeMap<Family, (usize, f64)>,
}

/// A round's view of the data: the noise, the fit so far, and the tests of all candidates against it.
struct Round {
    whitener: Whitener,
    fit: Projection,
    all: Vec<Candidate>,
    scan: Scan,
}

/// Searches for effects until no more pass. `progress` is told the number of effects found so far.
///
/// # Errors
/// If a log is too short to differentiate.
pub fn select(session: &mut Session, options: &Options, progress: &mut dyn FnMut(usize)) -> Result<Selection> {
    let mut found: Vec<Found> = Vec::new();
    let mut refused: Vec<(Slot, Vec<usize>)> = Vec::new();
    let mut in_a_row = 0;
    let mut round = look(session, &mut found, options)?;
    found.extend(rattling_gears(session, &round.whitener, options)?);
    if !found.is_empty() {
        round = look(session, &mut found, options)?;
    }
    let first_whitener = round.whitener.clone();
    let tests = round.scan.effective_tests(&round.fit, &round.whitener, options.seed);
    let ranking = ranking(&round.scan);
    while found.len() < options.max_findings && in_a_row < REFUSALS {
        progress(found.len());
        let taken: Vec<Slot> = found.iter().map(|found| found.member.candidate.slot()).collect();
        let open = |candidate: &Candidate| {
            let slot = candidate.slot();
            !refused.iter().any(|(other, _)| *other == slot)
                && !taken.iter().any(|(family, log)| *family == slot.0 && (*log == slot.1 || log.is_none()))
        };
        let mut best = round.scan.best_per_family();
        best.retain(|judged| open(&judged.candidate));
        let Some(first) = best.first() else { break };
        let level = family_wise(first.test.log_p(), tests);
        for judged in best.iter().take(LOGGED) {
            let (family, test) = (judged.candidate.family(), &judged.test);
            tracing::debug!(
                ?family,
                statistic = test.statistic,
                freedom = test.freedom,
                log_p = test.log_p(),
                "candidate"
            );
        }
        if level > options.alpha {
            break;
        }
        let members = members(&found);
        let Contest { winner, alternatives, close } = contest(session, &members, &best, &round.all, &open)?;
        let (winner, alternatives) = better_unseen(session, &members, winner, alternatives, &close)?;
        // What is significant only in the noise model that does not know it is an error of that noise model.
        let limit = options.alpha * strictness(&winner.candidate);
        let mut level = level.max(family_wise(winner.test.log_p(), tests));
        tracing::debug!(winner = ?winner.candidate.slot(), at = ?winner.candidate.placed.parameters, level, ?alternatives, "contest");
        if level <= limit {
            let beside = beside(session, &round.whitener, &round.fit, &winner)?;
            level = level.max(family_wise(beside, tests));
            tracing::debug!(level, beside, "beside slow noise and the error of the smoothing");
        }
        let stands = level <= limit
            && (is_level(winner.candidate.placed.effect)
                || without_best_stretches(session, &members, &round.whitener, &winner)? < SEEN_ELSEWHERE.ln());
        let accepted = if stands { accepted(session, &members, &winner, level)? } else { None };
        match accepted {
            Some((member, Gain { lower_bound: gain_lower_bound, rms })) => {
                let verdict = if alternatives.is_empty() { Verdict::Named } else { Verdict::OneOf };
                // What was refused where this acts was seen in a noise that did not know it.
                let joints = member.candidate.joints();
                refused.retain(|(_, others)| !others.iter().any(|joint| joints.contains(joint)));
                in_a_row = 0;
                found.push(Found {
                    member,
                    alternatives,
                    family_wise_p: level,
                    gain_lower_bound,
                    rms,
                    verdict,
                    impacts: None,
                });
                round = look(session, &mut found, options)?;
            }
            None => {
                refused.push((winner.candidate.slot(), winner.candidate.joints()));
                in_a_row += 1;
            }
        }
    }
    if drop_superfluous(session, &mut found)? {
        round = look(session, &mut found, options)?;
    }
    let sensitivity = round.scan.sensitivity();
    Ok(Selection { found, whitener: round.whitener, first_whitener, tests, ranking, sensitivity })
}

/// Fits what was found so far, with estimates written back, and tests all candidates against the fit.
fn look(session: &mut Session, found: &mut [Found], options: &Options) -> Result<Round> {
    let mut members = members(found);
    let present = session.all_columns(&session.train, &members)?;
    let Noise { whitener, .. } = session.noise_under(&present);
    session.settle(&mut members, &whitener)?;
    found.iter_mut().zip(members.clone()).for_each(|(found, member)| found.member = member);
    let all = candidates::all(&session.arm, &session.train.rows, session.trust, &options.candidates)?;
    let columns = session.all_columns(&session.train, &members)?;
    let fit = whitener.fit(&columns, &session.train.torque);
    let scan = Scan::new(session, &all, &whitener, &fit);
    Ok(Round { whitener, fit, all, scan })
}

fn members(found: &[Found]) -> Vec<Member> {
    found.iter().map(|found| found.member.clone()).collect()
}

/// Share of the level at which a candidate is believed.
fn strictness(candidate: &Candidate) -> f64 {
    if candidate.log.is_some() {
        // No other log can confirm what happened once.
        ONCE
    } else if is_level(candidate.placed.effect) {
        EXTREMES
    } else if candidate.placed.effect.gear(&candidate.placed.parameters).is_some() {
        GEARS
    } else {
        NOISE_IS_ESTIMATED
    }
}

/// The one of those that come close that predicts the held-out rows surely better than the winner, if any; the winner then
/// stays as an alternative. Where much is left unexplained, the training rows tell rivals apart by what is wrong with both.
fn better_unseen(
    session: &Session,
    members: &[Member],
    winner: Judged,
    mut alternatives: Vec<Alternative>,
    close: &[Judged],
) -> Result<(Judged, Vec<Alternative>)> {
    if winner.candidate.log.is_some() {
        return Ok((winner, alternatives));
    }
    let with = |judged: &Judged| -> Vec<Member> { members.iter().cloned().chain([judged.member()]).collect() };
    let first = with(&winner);
    let Noise { whitener, .. } = session.noise_under(&session.all_columns(&session.train, &first)?);
    let unseen = whitener.on(&session.test.rows);
    let before = session.held_out_residual(&first, &whitener)?;
    let mut best: Option<(f64, &Judged)> = None;
    for rival in close.iter().filter(|rival| rival.candidate.log.is_none()) {
        let mut joints = rival.candidate.joints();
        joints.extend(winner.candidate.joints());
        joints.sort_unstable();
        joints.dedup();
        let after = session.held_out_residual(&with(rival), &whitener)?;
        let bound = Gains::new(&unseen, &before, &after, &joints, session.test.rows.len()).lower_bound();
        tracing::debug!(rival = ?rival.candidate.slot(), at = ?rival.candidate.placed.parameters, bound, "close rival on held-out rows");
        if bound > best.as_ref().map_or(CLEARLY_BETTER, |(best, _)| *best) {
            best = Some((bound, rival));
        }
    }
    let Some((_, rival)) = best else { return Ok((winner, alternatives)) };
    alternatives.retain(|other| other.family != rival.candidate.family());
    alternatives.insert(0, Alternative { family: winner.candidate.family(), relative_likelihood: 1.0 });
    Ok((rival.clone(), alternatives))
}

/// What held-out rows say of an effect.
#[derive(Debug, Clone)]
pub struct Gain {
    /// Lower bound (84 %) of the share of the whitened sum of squares that it takes away.
    pub lower_bound: f64,
    /// Root mean square of the residual before and after, `[joint]`, N m.
    pub rms: [Vec<f64>; 2],
}

/// The winner as a member of the model with its gain on the held-out rows, if that is surely positive. An event of one
/// training log shows in no other: its gain is that on the training rows.
fn accepted(session: &Session, members: &[Member], winner: &Judged, level: f64) -> Result<Option<(Member, Gain)>> {
    let member = winner.member();
    let with: Vec<Member> = members.iter().cloned().chain([member.clone()]).collect();
    let Noise { whitener, .. } = session.noise_under(&session.all_columns(&session.train, &with)?);
    let before = session.held_out_residual(members, &whitener)?;
    let after = session.held_out_residual(&with, &whitener)?;
    let joints = winner.candidate.joints();
    let gains = match winner.candidate.log {
        None => Gains::new(&whitener.on(&session.test.rows), &before, &after, &joints, session.test.rows.len()),
        Some(_) => {
            let [before, after] =
                [members, &with].map(|members| session.residual_on(&session.train, members, &whitener));
            Gains::new(&whitener, &before?, &after?, &joints, session.train.rows.len())
        }
    };
    let bound = gains.lower_bound();
    let rms = [rms(&session.test.rows.valid, &before), rms(&session.test.rows.valid, &after)];
    tracing::debug!(bound, share = gains.share(), before = ?rms[0], after = ?rms[1], "held-out gain");
    let enough = match joints.iter().any(|&joint| whitener.misfit(joint) > MUCH_LEFT) {
        true => bound > WORTH_A_NAME,
        // A torque is cut off in a few rows, where the smoothing errs most: their scatter says little.
        false if level < BEYOND_CHANCE && (gains.is_calm() || is_level(winner.candidate.placed.effect)) => {
            gains.share() > 0.0
        }
        false => bound > 0.0,
    };
    Ok(enough.then_some((member, Gain { lower_bound: bound, rms })))
}

/// Drops effects that the others have made superfluous, the least needed first; tells whether it did.
fn drop_superfluous(session: &Session, found: &mut Vec<Found>) -> Result<bool> {
    let mut dropped = false;
    while found.len() > 1 {
        let all = members(found);
        let Noise { whitener, .. } = session.noise_under(&session.all_columns(&session.train, &all)?);
        let mut least = (f64::NEG_INFINITY, 0);
        for index in (0..all.len()).filter(|&index| !all[index].held) {
            let others: Vec<Member> =
                all.iter().enumerate().filter(|(k, _)| *k != index).map(|(_, member)| member.clone()).collect();
            let fit = whitener.fit(&session.all_columns(&session.train, &others)?, &session.train.torque);
            let log_p = fit.test(&whitener.apply_all(&all[index].candidate.columns)).map_or(0.0, |test| test.log_p());
            if log_p > least.0 {
                least = (log_p, index);
            }
        }
        if least.0 < KEPT.ln() {
            break;
        }
        found.remove(least.1);
        dropped = true;
    }
    Ok(dropped)
}
