//! The last search, over all logs together: for what is too faint for the training logs alone.
//!
//! As long as training logs show enough, held-out logs judge what these chose. What neither kind shows by itself may be plain in
//! both together: all logs then choose, and each judges by what the others predict for it (cross-validation; Stone, Journal of the
//! Royal Statistical Society B 36, 1974). What else explains a finding is asked of all logs too.

use super::acceptance::{Outcome, Refusal, Trial, is_confirmable};
use super::comparison::{Comparison, InOwnNoise, compare};
use super::eligible::{Contenders, Refused, Sizes, Standing};
use super::found::{Found, Rejected, explained_by_play, members};
use super::reselection::list_alternatives;
use super::round::{Round, settled};
use crate::diagnosis::Options;
use crate::diagnosis::evidence::{Judged, Multiplicity};
use crate::diagnosis::model::{Candidate, Session};
use crate::diagnosis::watch::{Progress, Watch};
use crate::error::Result;

/// Searches all logs of `session` for more than was `found`; returns whether more was found, and the candidates along all logs. The
/// `candidates` are those along the training logs.
///
/// # Errors
/// If a log is too short to differentiate.
pub(super) fn search(
    session: &Session,
    found: &mut Vec<Found>,
    candidates: Vec<Candidate>,
    multiplicity: &Multiplicity,
    options: &Options,
    rejected: &mut Vec<Rejected>,
    watch: &mut Watch,
) -> Result<(bool, Vec<Candidate>)> {
    if !session.logs.apart || watch.is_over() {
        return Ok((false, Vec::new()));
    }
    let mut all_logs = session.over_all_logs();
    let mut known = found.clone();
    let mut refused: Vec<Refused> = Vec::new();
    let mut in_own_noise = InOwnNoise::default();
    let (mut more, mut in_a_row) = (false, 0);
    let sizes = Sizes::new(&all_logs);
    // What happens once is in one log.
    let mut round = Round::over_all_logs(&mut all_logs, &mut known, candidates, options)?;
    while known.len() < options.max_findings && in_a_row < session.criteria.search.refusals[1] && !watch.is_over() {
        watch.tell(Progress::Found(known.len()));
        // What errors of the smoothing or extremes imitate is so in all of them.
        let standing = |judged: &Judged, level: f64| match is_confirmable(&judged.candidate) {
            true => sizes.standing(judged, level <= options.alpha),
            false => Standing::NotAsked,
        };
        let contenders =
            Contenders::new(&round.scan, &known, (&refused, &session.criteria.levels), multiplicity, standing);
        let level = contenders.level;
        if contenders.best.is_empty() || level > options.alpha {
            rejected.extend(contenders.not_significant(options.alpha));
            break;
        }
        let before = members(&known);
        let Comparison { winner, alternatives, .. } =
            compare(&all_logs, &before, &contenders, &round.scan, multiplicity, &mut in_own_noise)?;
        tracing::debug!(winner = ?winner.candidate.slot(), at = ?winner.candidate.placed.parameters, level, ?alternatives, "comparison over all logs");
        let Round { whitener, fit, .. } = &round;
        let (alpha, session) = (options.alpha, &all_logs);
        let trial = Trial { session, members: &before, whitener, fit, multiplicity, alpha, tries: None };
        match trial.by_others(&winner, level)? {
            Outcome::Accepted(accepted) => {
                let alternatives = explained_by_play(&all_logs, &known, &accepted.member, alternatives);
                let joints = accepted.member.candidate.joints();
                refused.iter_mut().for_each(|other| other.open_on(&joints));
                known.push(Found::new(*accepted, alternatives));
                in_own_noise.clear();
                (more, in_a_row) = (true, 0);
                round.renew(&[], &mut all_logs, &mut known, options)?;
            }
            Outcome::Refused(Refusal { may_be, failed, .. }) => {
                refused.retain(|other| other.slot != winner.candidate.slot());
                refused.push(contenders.refused(&winner, may_be));
                rejected.push(Rejected { slot: winner.candidate.slot(), failed });
                in_a_row += 1;
            }
        }
    }
    for mut finding in known.into_iter().skip(found.len()) {
        // Its columns along the training logs.
        let placed = finding.member.candidate.placed.clone();
        if let Some(candidate) = session.candidate_at(placed, &finding.member)? {
            finding.member.candidate = candidate;
        }
        found.push(finding);
    }
    Ok((more, round.all))
}

/// Asks all logs of `session` what else explains each finding, among the `candidates` along these.
///
/// # Errors
/// If a log is too short to differentiate.
pub(super) fn ask_for_alternatives(
    session: &Session,
    found: &mut [Found],
    candidates: &[Candidate],
    multiplicity: &Multiplicity,
    watch: &mut Watch,
) -> Result<()> {
    if candidates.is_empty() || found.is_empty() {
        return Ok(());
    }
    let mut all_logs = session.over_all_logs();
    let mut known = found.to_vec();
    let (whitener, _) = settled(&mut all_logs, &mut known)?;
    list_alternatives(&all_logs, &mut known, (candidates, &whitener), multiplicity, watch)?;
    for (finding, known) in found.iter_mut().zip(known) {
        finding.set_alternatives(known.alternatives);
    }
    Ok(())
}
