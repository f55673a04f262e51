//! Forward selection of effects: the best candidate is tested at a family-wise level, compared with its rivals in the same
//! whitening, and accepted if it also gains on held-out logs; at the end what became superfluous is dropped.

use super::Options;
use super::acceptance::{Accepted, Trial};
use super::candidates::{self, Candidate, Family, Slot};
use super::contest::{Alternative, Contest, Scan, contest};
use super::evidence::{Ranked, ranking};
use super::held_out::Gains;
use super::impacts::Play;
use super::judging::Judged;
use super::multiplicity::Multiplicity;
use super::play::rattling_gears;
use super::score::Projection;
use super::session::{Member, Noise, Session};
use super::verdict::Verdict;
use super::whitening::Whitener;
use crate::error::Result;
use std::collections::BTreeMap;

/// Effects are dropped in the end when what they take is more likely than this without them.
const KEPT: f64 = 1e-4;

/// Share of the held-out sum of squares, surely gained, for which a rival takes the winner's place: less may come of a further
/// parameter or of chance.
const CLEARLY_BETTER: f64 = 0.02;

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
    /// How many independent tests the scan is worth.
    pub multiplicity: Multiplicity,
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
    let multiplicity = round.scan.multiplicity(&round.fit, &round.whitener, options.seed);
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
        let expected = |judged: &Judged| {
            let kind = judged.candidate.family().effect;
            judged.test.log_p() + multiplicity.tests(kind).ln()
        };
        best.sort_by(|a, b| expected(a).total_cmp(&expected(b)));
        let Some(first) = best.first() else { break };
        let level = multiplicity.level(first.candidate.family().effect, first.test.log_p());
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
        // What the training logs alone do not show may show together with the held-out ones; it is tried once.
        if level > options.alpha && in_a_row > 0 {
            break;
        }
        let members = members(&found);
        let Contest { winner, alternatives, close } =
            contest(session, &members, &best, &round.all, &multiplicity, &open)?;
        let (winner, alternatives) = better_unseen(session, &members, winner, alternatives, &close)?;
        tracing::debug!(winner = ?winner.candidate.slot(), at = ?winner.candidate.placed.parameters, level, ?alternatives, "contest");
        let Round { whitener, fit, .. } = &round;
        let trial =
            Trial { session, members: &members, whitener, fit, multiplicity: &multiplicity, alpha: options.alpha };
        match trial.of(&winner, level)? {
            Some(Accepted { member, gain, level }) => {
                let alternatives = beside_play(&found, &member, alternatives);
                let verdict = if alternatives.is_empty() { Verdict::Named } else { Verdict::OneOf };
                // What was refused where this acts was seen in a noise that did not know it.
                let joints = member.candidate.joints();
                refused.retain(|(_, others)| !others.iter().any(|joint| joints.contains(joint)));
                in_a_row = 0;
                found.push(Found {
                    member,
                    alternatives,
                    family_wise_p: level,
                    gain_lower_bound: gain.lower_bound,
                    rms: gain.rms,
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
    Ok(Selection { found, whitener: round.whitener, first_whitener, multiplicity, ranking, sensitivity })
}

/// The alternatives of a new member, and the play of its gear if that has one: how the teeth give under load looks like more of
/// either.
fn beside_play(found: &[Found], member: &Member, mut alternatives: Vec<Alternative>) -> Vec<Alternative> {
    let Candidate { placed, .. } = &member.candidate;
    if placed.effect.gear(&placed.parameters).is_some() {
        let rattling =
            found.iter().filter(|other| other.impacts.is_some()).map(|other| other.member.candidate.family());
        let own = rattling.filter(|family| family.joint == placed.joint);
        alternatives.extend(own.map(|family| Alternative { family, relative_likelihood: 1.0 }));
    }
    alternatives
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
