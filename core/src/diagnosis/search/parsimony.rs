//! Simple laws first: of two laws that explain nearly the same, the one with more parameters is taken only where it adds to the other.
//!
//! Whether it adds is judged as a winner is: adjusted for errors in variables and slow noise, with the scatter between blocks for the
//! covariance. In white noise every curve of a residual that no law has makes another parameter significant.

use super::comparison::{Chosen, Comparison, better_held_out, parameters, with_tangents};
use crate::diagnosis::evidence::{Judged, log_p_adjusted};
use crate::diagnosis::model::{Member, Session, linear, shapes};
use crate::error::Result;

/// The winner of a comparison once held-out logs and simplicity are taken into account.
///
/// # Errors
/// If a log is too short to differentiate.
pub(super) fn chosen(session: &Session, members: &[Member], comparison: &Comparison) -> Result<Chosen> {
    let chosen = better_held_out(session, members, comparison)?;
    simplest(session, members, chosen, &comparison.close)
}

/// The simplest of the winner and those `close` to it to which the winner adds nothing; the winner then stays as an alternative.
///
/// # Errors
/// If a log is too short to differentiate.
fn simplest(session: &Session, members: &[Member], chosen: Chosen, close: &[Judged]) -> Result<Chosen> {
    let winner = &chosen.winner;
    let joints = winner.candidate.joints();
    let is_simpler = |rival: &&Judged| {
        rival.candidate.log == winner.candidate.log
            && complexity(rival) < complexity(winner)
            && rival.test.statistic > session.criteria.comparison.close * winner.test.statistic
            && rival.candidate.joints().iter().all(|joint| joints.contains(joint))
    };
    let mut simpler: Vec<&Judged> = close.iter().filter(is_simpler).collect();
    if simpler.is_empty() {
        return Ok(chosen);
    }
    simpler.sort_by(|a, b| complexity(a).cmp(&complexity(b)).then(b.test.statistic.total_cmp(&a.test.statistic)));
    let present = session.model.columns(&session.logs.train, members)?;
    let whitener = match &chosen.whitener {
        Some(whitener) => whitener.clone(),
        None => session.noise_under(&[present.as_slice(), winner.candidate.columns.as_slice()].concat()),
    };
    let fit = whitener.fit(&present, &session.logs.train.torque);
    for rival in simpler {
        let in_its_presence = with_tangents(session, rival, &whitener, &fit)?;
        let log_p = log_p_adjusted(session, &whitener, &in_its_presence, winner);
        tracing::debug!(winner = ?winner.candidate.slot(), rival = ?rival.candidate.slot(), log_p, "added to a simpler law");
        if log_p > session.criteria.levels.sure_p.ln() {
            return Ok(chosen.instead(rival));
        }
    }
    Ok(Chosen { whitener: Some(whitener), ..chosen })
}

/// Parameters that are fitted, and those of the law: one whose other amplitudes have a sign that cannot be is fitted with fewer than it has, and
/// may then be the same as a simpler law.
fn complexity(judged: &Judged) -> (usize, usize) {
    let effect = judged.candidate.placed.effect;
    (parameters(judged), linear(effect).len() + shapes(effect).len())
}
