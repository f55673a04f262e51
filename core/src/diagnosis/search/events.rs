//! Events that the noise model holds. Whoever pushes the arm for some seconds makes a torque that is slow noise to a noise model that does
//! not know it, and whitened rows show little of it. Plain least squares shows it; whether it is significant is asked in the noise that is
//! estimated with it in the model, at the strict level of what held-out logs cannot confirm.

use super::acceptance::{Accepted, Outcome, Refusal, Trial};
use super::found::Rejected;
use crate::diagnosis::criteria::{Gate, Judgement};
use crate::diagnosis::evidence::{Judged, Multiplicity};
use crate::diagnosis::model::{Candidate, ENDS_OF_EVENT_S, Member, Session, Slot, is_event};
use crate::diagnosis::noise::Whitener;
use crate::diagnosis::regression::rms;
use crate::error::Result;
use crate::identification::noise::AutoregressiveNoise;
use rayon::prelude::*;
use std::collections::BTreeMap;

impl Session<'_> {
    /// Leaves out the training rows near the beginning and the end of an event: as noise they would be the largest of all, and as torque
    /// they would pull at all parameters.
    pub(super) fn leave_out_ends(&mut self, member: &Member) {
        let Candidate { placed, log, .. } = &member.candidate;
        for index in (0..self.logs.train.rows.logs.len()).filter(|index| log.is_none_or(|own| own == *index)) {
            for end in placed.effect.acts_between(&placed.parameters) {
                let time = &self.logs.train.rows.logs[index].time;
                let sample = |t: f64| time.partition_point(|own| *own < t);
                let [from, to] = [-ENDS_OF_EVENT_S, ENDS_OF_EVENT_S].map(|apart| sample(end + apart));
                self.leave_out_samples(index, from, to);
            }
        }
    }
}

/// What came of a search for events.
#[derive(Debug, Default)]
pub(super) struct Searched {
    /// One that is significant.
    pub accepted: Option<Accepted>,
    /// Those that failed a gate.
    pub rejected: Vec<Rejected>,
    /// Whether a lasting law explains more than any of them: none was tried.
    pub postponed: bool,
}

/// An event of `all` candidates that the noise under the model with `members`, that of `whitener`, holds, or why the clearest was rejected.
/// The clearest are tried first, as many as may be refused in a search that adds to another ([`crate::diagnosis::SearchCriteria::refusals`]).
/// None is looked for where no joint's residual is far above the noise of its sensor, nor where one of the `lasting` laws explains more by
/// plain least squares than any event: what a load does looks like one event after the other. `alpha` is the family-wise level.
///
/// # Errors
/// If a log is too short to differentiate.
pub(super) fn held_by_noise(
    session: &Session,
    members: &[Member],
    (all, whitener): (&[Candidate], &Whitener),
    lasting: &[Candidate],
    (multiplicity, alpha): (&Multiplicity, f64),
) -> Result<Searched> {
    let criteria = &session.criteria;
    let rows = &session.logs.train.rows;
    let residual = rms(&rows.valid, &session.residual_on(&session.logs.train, members, whitener)?);
    let is_far = |joint: usize| residual[joint] > criteria.levels.far * rows.sensor_noise(joint, 1);
    if !(0..rows.dof()).any(is_far) {
        return Ok(Searched::default());
    }
    let present = session.model.columns(&session.logs.train, members)?;
    let white =
        |std: &f64| AutoregressiveNoise { coefficients: Vec::new(), innovation_std: std.max(f64::MIN_POSITIVE) };
    let plain = Whitener::of_known(rows, residual.iter().map(white).collect());
    let fit = plain.fit(&present, &session.logs.train.torque);
    let events: Vec<&Candidate> = all.iter().filter(|candidate| is_event(candidate.placed.effect)).collect();
    let judged: Vec<Judged> = events.into_par_iter().filter_map(|event| session.judge(event, &plain, &fit)).collect();
    let explained = |candidate: &Candidate| session.judge(candidate, &plain, &fit).map(|judged| judged.test.statistic);
    let of_lasting = lasting.iter().filter_map(explained).fold(0.0, f64::max);
    let of_events = judged.iter().map(|judged| judged.test.statistic).fold(0.0, f64::max);
    if of_lasting > of_events {
        tracing::debug!(of_lasting, of_events, "a lasting law explains more than any event");
        return Ok(Searched { postponed: true, ..Searched::default() });
    }
    let mut rejected = Vec::new();
    for seen in clearest(judged).into_iter().take(criteria.search.refusals[1]) {
        let seen = session.refined(seen, &plain, &fit)?;
        let with: Vec<_> = present.iter().chain(seen.candidate.columns.iter()).cloned().collect();
        let own = session.noise_under(&with);
        let fit = own.fit(&present, &session.logs.train.torque);
        let Some(winner) = session.judge(&seen.candidate, &own, &fit) else { continue };
        let level = multiplicity.level(winner.candidate.family().effect, winner.test.log_p());
        tracing::debug!(slot = ?winner.candidate.slot(), at = ?winner.candidate.placed.parameters, level, "event held by the noise");
        let slot = winner.candidate.slot();
        let significant = Judgement::at_most(Gate::FamilyWise, level, alpha * criteria.search.unconfirmable);
        if !significant.passed {
            rejected.push(Rejected { slot, failed: significant });
            continue;
        }
        let trial = Trial { session, members, whitener: &own, fit: &fit, multiplicity, alpha, tries: None };
        match trial.of(&winner, level, Some(own.clone()))? {
            Outcome::Accepted(accepted) => {
                return Ok(Searched { accepted: Some(*accepted), rejected, postponed: false });
            }
            Outcome::Refused(Refusal { failed, .. }) => rejected.push(Rejected { slot, failed }),
        }
    }
    Ok(Searched { accepted: None, rejected, postponed: false })
}

/// The best of each slot, the largest statistic first; of equal ones that in all logs first, which held-out logs can confirm.
fn clearest(judged: Vec<Judged>) -> Vec<Judged> {
    let mut best: BTreeMap<Slot, Judged> = BTreeMap::new();
    for one in judged {
        let slot = one.candidate.slot();
        if best.get(&slot).is_none_or(|best| best.test.statistic < one.test.statistic) {
            best.insert(slot, one);
        }
    }
    // The map has those in all logs first, and the order of equals stays.
    let mut best: Vec<Judged> = best.into_values().collect();
    best.sort_by(|a, b| b.test.statistic.total_cmp(&a.test.statistic));
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::regression::Test;
    use crate::effects::{Placed, find};
    use nalgebra::DMatrix;

    #[test]
    fn the_clearest_event_of_every_log_comes_first() {
        let judged = |log: Option<usize>, statistic: f64| Judged {
            candidate: Candidate {
                placed: Placed::typical(find("external_contact").unwrap(), 0),
                log,
                columns: Default::default(),
            },
            whitened: Vec::new(),
            test: Test {
                statistic,
                freedom: 3,
                values: vec![1.0; 3],
                std: vec![1.0; 3],
                along: DMatrix::zeros(0, 3),
                directions: DMatrix::zeros(3, 3),
                norms: vec![1.0; 3],
            },
        };
        let all = vec![judged(Some(0), 9.0), judged(Some(1), 5.0), judged(Some(0), 4.0), judged(None, 9.0)];
        let found: Vec<(Option<usize>, f64)> =
            clearest(all).iter().map(|one| (one.candidate.log, one.test.statistic)).collect();
        assert_eq!(found, [(None, 9.0), (Some(0), 9.0), (Some(1), 5.0)]);
    }
}
