//! The last search, over all logs together: for what is too faint for the training logs alone.
//!
//! As long as training logs show enough, held-out logs judge what these chose. What neither kind shows by itself may be plain in
//! both together: all logs then choose, and each judges by what the others say of it (cross-validation; Stone, Journal of the
//! Royal Statistical Society B 36, 1974). What else explains a finding is asked of all logs too.

use super::Options;
use super::acceptance::{Outcome, Refusal, Trial, is_confirmable};
use super::candidates::{self, columns_in};
use super::column::rms;
use super::contest::{Contest, contest};
use super::eligible::{Eligible, Refused};
use super::found::{Found, beside_play, members};
use super::judging::Judged;
use super::multiplicity::Multiplicity;
use super::renaming::narrow;
use super::round::Round;
use super::session::{Member, Noise, Session};
use crate::error::Result;

/// Candidates that may be refused one after the other before the search ends.
const REFUSALS: usize = 3;

/// Searches all logs of `session` for more than was `found`, and asks them what else explains that; tells whether more
/// was found.
///
/// # Errors
/// If a log is too short to differentiate.
pub fn search(
    session: &Session,
    found: &mut Vec<Found>,
    multiplicity: &Multiplicity,
    options: &Options,
) -> Result<bool> {
    if !session.apart {
        return Ok(false);
    }
    let mut all_logs = session.over_all_logs();
    let mut known = found.clone();
    let mut refused: Vec<Refused> = Vec::new();
    let mut more = false;
    // What happens once is in one log.
    let mut round = Round::first(&mut all_logs, &mut known, candidates::lasting, options)?;
    while known.len() < options.max_findings && refused.len() < REFUSALS {
        // What the smoothing or extremes mimic is so in all of them.
        let best = round.scan.best_per_family();
        let unconfirmable = best.iter().filter(|judged| !is_confirmable(&judged.candidate));
        let never: Vec<Refused> =
            refused.iter().cloned().chain(unconfirmable.map(|judged| Refused::faint(judged))).collect();
        let eligible = Eligible::new(&known, &never, Vec::new());
        let mut best: Vec<&Judged> = best.into_iter().filter(|judged| eligible.may_win(&judged.candidate)).collect();
        best.sort_by(|a, b| multiplicity.expected(a).total_cmp(&multiplicity.expected(b)));
        let Some(first) = best.first() else { break };
        let level = multiplicity.level(first.candidate.family().effect, first.test.log_p());
        if level > options.alpha {
            break;
        }
        let before = members(&known);
        let Contest { winner, alternatives, .. } =
            contest(&all_logs, &before, &best, &round.all, multiplicity, &eligible)?;
        tracing::debug!(winner = ?winner.candidate.slot(), at = ?winner.candidate.placed.parameters, level, ?alternatives, "contest over all logs");
        let Round { whitener, fit, .. } = &round;
        let (alpha, session) = (options.alpha, &all_logs);
        let trial = Trial { session, members: &before, whitener, fit, multiplicity, alpha, tries: None };
        match trial.by_others(&winner, level)? {
            Outcome::Accepted(accepted) => {
                let alternatives = beside_play(&known, &accepted.member, alternatives);
                known.push(Found::new(*accepted, alternatives));
                refused.clear();
                more = true;
                round = round.next(&mut all_logs, &mut known, options)?;
            }
            Outcome::Refused(Refusal { may_be, .. }) => {
                refused.push(Refused { slot: winner.candidate.slot(), joints: winner.candidate.joints(), may_be });
            }
        }
    }
    narrow(&all_logs, &mut known, &round, multiplicity)?;
    for (finding, known) in found.iter_mut().zip(&known) {
        finding.set_alternatives(known.alternatives.clone());
    }
    for mut finding in known.into_iter().skip(found.len()) {
        finding.member = from_training(session, finding.member)?;
        finding.rms = held_out_rms(session, members(found), &finding.member)?;
        found.push(finding);
    }
    Ok(more)
}

/// A member with its columns along the training logs.
fn from_training(session: &Session, mut member: Member) -> Result<Member> {
    let (candidate, rows) = (&mut member.candidate, &session.train.rows);
    candidate.columns =
        columns_in(&session.arm, rows, candidate.log, std::slice::from_ref(&candidate.placed))?.concat();
    Ok(member)
}

/// Root mean square of what the held-out logs leave `before` a member and with it, both fitted to the training logs.
fn held_out_rms(session: &Session, before: Vec<Member>, member: &Member) -> Result<[Vec<f64>; 2]> {
    let with: Vec<Member> = before.iter().chain([member]).cloned().collect();
    let Noise { whitener, .. } = session.noise_under(&session.all_columns(&session.train, &with)?);
    let left = |members: &[Member]| -> Result<Vec<f64>> {
        Ok(rms(&session.test.rows.valid, &session.held_out_residual(members, &whitener)?))
    };
    Ok([left(&before)?, left(&with)?])
}
