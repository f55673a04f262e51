//! Names given again once all is known: what was named first was named beside everything that was found after it.

use super::Options;
use super::acceptance::{Outcome, Trial};
use super::candidates::{self, Candidate};
use super::contest::{Alternative, Contest, Scan, better_unseen, contest};
use super::eligible::Eligible;
use super::found::{Found, beside_play, members};
use super::multiplicity::Multiplicity;
use super::session::{Noise, Session};
use crate::error::Result;

/// Holds the contest for the name of every finding once more beside all others; tells whether a name has changed.
///
/// # Errors
/// If a log is too short to differentiate.
pub fn rename(session: &Session, found: &mut [Found], multiplicity: &Multiplicity, options: &Options) -> Result<bool> {
    let mut changed = false;
    if found.len() < 2 {
        return Ok(changed);
    }
    let everywhere = candidates::all(&session.arm, &session.train.rows, session.trust, &options.candidates)?;
    for index in 0..found.len() {
        let member = &found[index].member;
        if member.held || member.candidate.log.is_some() {
            continue;
        }
        let others: Vec<Found> =
            found.iter().enumerate().filter(|(k, _)| *k != index).map(|(_, other)| other.clone()).collect();
        let of_others = members(&others);
        let present = session.all_columns(&session.train, &of_others)?;
        let Noise { whitener, fit } = session.noise_under(&present);
        // What acts elsewhere is no other name for what is seen here.
        let here = member.candidate.joints();
        let acts_here = |candidate: &&Candidate| candidate.joints().iter().any(|joint| here.contains(joint));
        let all: Vec<Candidate> = everywhere.iter().filter(acts_here).cloned().collect();
        let scan = Scan::new(session, &all, &whitener, &fit);
        let eligible = Eligible::new(&others, &[], Vec::new());
        let mut best = scan.best_per_family();
        best.retain(|judged| eligible.may_win(&judged.candidate));
        if best.is_empty() {
            continue;
        }
        let Contest { winner, alternatives, close } =
            contest(session, &of_others, &best, &all, multiplicity, &eligible)?;
        let (winner, alternatives) = better_unseen(session, &of_others, winner, alternatives, &close)?;
        let (old, new) = (found[index].member.candidate.family(), winner.candidate.family());
        tracing::debug!(?old, ?new, ?alternatives, "name beside the others");
        let known = &mut found[index];
        if old == new {
            known.set_alternatives(beside_play(&others, &known.member, alternatives));
        } else {
            let trial = Trial {
                session,
                members: &of_others,
                whitener: &whitener,
                fit: &fit,
                multiplicity,
                alpha: options.alpha,
                tries: None,
            };
            let level = multiplicity.level(new.effect, winner.test.log_p());
            match trial.of(&winner, level)? {
                Outcome::Accepted(accepted) => {
                    let alternatives = beside_play(&others, &accepted.member, alternatives);
                    *known = Found::new(*accepted, alternatives);
                    changed = true;
                }
                // It explains what is left better than the name does, and is not sure enough to take its place.
                Outcome::Refused(refusal) if refusal.may_be => {
                    let mut alternatives = known.alternatives.clone();
                    alternatives.retain(|other| other.family != new);
                    alternatives.insert(0, Alternative { family: new, relative_likelihood: 1.0 });
                    known.set_alternatives(alternatives);
                }
                Outcome::Refused(_) => {}
            }
        }
    }
    Ok(changed)
}
