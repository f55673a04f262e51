//! Simple laws first, two at a time. A search that takes one law after the other may reach by two curved laws of a joint what two linear ones
//! explain, of which neither alone comes near: wear that raises viscous friction and lowers Coulomb friction looks like a power of the
//! speed before anything is in the model, and like a Stribeck curve after that.

use super::acceptance::{Outcome, Trial};
use super::comparison::parameters;
use super::found::{Found, Rejected, members};
use crate::diagnosis::Options;
use crate::diagnosis::evidence::{Judged, Multiplicity, log_p_adjusted};
use crate::diagnosis::model::{Candidate, Member, Session, shapes};
use crate::diagnosis::noise::Whitener;
use crate::diagnosis::regression::{Column, Projection};
use crate::error::Result;

/// Puts two linear laws in the place of two findings of their joint that have more parameters, where these add nothing to them; among the
/// candidates `everywhere`. Returns whether it did; the gate that one of two such laws fails is added to `rejected`.
///
/// # Errors
/// If a log is too short to differentiate.
pub(super) fn simpler_pairs(
    session: &Session,
    found: &mut [Found],
    everywhere: &[Candidate],
    multiplicity: &Multiplicity,
    options: &Options,
    rejected: &mut Vec<Rejected>,
) -> Result<bool> {
    let mut changed = false;
    for joint in 0..session.model.base.dof() {
        let here: Vec<usize> = (0..found.len()).filter(|&index| is_curved_on(&found[index], joint)).collect();
        for (k, &first) in here.iter().enumerate() {
            for &second in &here[k + 1..] {
                let pair = Pair { session, found: &*found, places: [first, second], multiplicity, options };
                if let Some(simpler) = pair.simpler(everywhere, joint, rejected)? {
                    let [a, b] = simpler;
                    (found[first], found[second]) = (a, b);
                    changed = true;
                    break;
                }
            }
        }
    }
    Ok(changed)
}

/// Whether a finding is a law of this joint alone, at all times, with a shape that was searched.
fn is_curved_on(found: &Found, joint: usize) -> bool {
    let candidate = &found.member.candidate;
    !found.member.held
        && candidate.log.is_none()
        && candidate.joints() == [joint]
        && !shapes(candidate.placed.effect).is_empty()
}

/// Two findings of a joint.
struct Pair<'a> {
    session: &'a Session<'a>,
    found: &'a [Found],
    places: [usize; 2],
    multiplicity: &'a Multiplicity,
    options: &'a Options,
}

impl Pair<'_> {
    /// The two linear laws of the joint that explain as much with fewer parameters.
    fn simpler(
        &self,
        everywhere: &[Candidate],
        joint: usize,
        rejected: &mut Vec<Rejected>,
    ) -> Result<Option<[Found; 2]>> {
        let session = self.session;
        let kept = self.found.iter().enumerate().filter(|(index, _)| !self.places.contains(index));
        let others: Vec<Member> = kept.map(|(_, found)| found.member.clone()).collect();
        let torque = &session.logs.train.torque;
        let whitener = session.noise_under(&session.model.columns(&session.logs.train, &members(self.found))?);
        let fit = whitener.fit(&session.model.columns(&session.logs.train, &others)?, torque);
        let judged = |candidate: &Candidate, fit: &Projection| session.judge(candidate, &whitener, fit);
        let old: Option<Vec<Judged>> =
            self.places.iter().map(|&index| judged(&self.found[index].member.candidate, &fit)).collect();
        let Some(old) = old else { return Ok(None) };
        let explained = |pair: [&Judged; 2]| {
            let columns: Vec<Column> = pair.iter().flat_map(|judged| judged.whitened.clone()).collect();
            fit.test(&columns).map_or(0.0, |test| test.statistic)
        };
        let most: usize = old.iter().map(parameters).sum();
        let known =
            |candidate: &Candidate| self.found.iter().any(|f| f.member.candidate.family() == candidate.family());
        let is_linear = |candidate: &&Candidate| {
            candidate.log.is_none()
                && candidate.joints() == [joint]
                && shapes(candidate.placed.effect).is_empty()
                && !known(candidate)
        };
        let linear: Vec<Judged> = everywhere.iter().filter(is_linear).filter_map(|one| judged(one, &fit)).collect();
        let pairs = linear.iter().enumerate().flat_map(|(k, a)| linear[k + 1..].iter().map(move |b| [a, b]));
        let pairs =
            pairs.filter(|[a, b]| a.candidate.family() != b.candidate.family() && parameters(a) + parameters(b) < most);
        let pairs = pairs.map(|pair| (explained(pair), pair));
        let Some((statistic, pair)) = pairs.max_by(|(a, _), (b, _)| a.total_cmp(b)) else { return Ok(None) };
        if statistic <= session.criteria.comparison.close * explained([&old[0], &old[1]]) {
            return Ok(None);
        }
        let with = pair.iter().fold(fit.clone(), |fit, judged| fit.with(&judged.whitened));
        let added: Vec<f64> = old.iter().map(|judged| log_p_adjusted(session, &whitener, &with, judged)).collect();
        let names = pair.map(|judged| judged.candidate.family());
        tracing::debug!(?names, statistic, ?added, "two linear laws in place of two curved ones");
        if added.iter().any(|log_p| *log_p <= session.criteria.levels.sure_p.ln()) {
            return Ok(None);
        }
        self.accepted(pair, &others, &whitener, rejected)
    }

    /// Both laws, where each passes all gates with the other in the model; else the gate that one fails is added to `rejected`.
    fn accepted(
        &self,
        pair: [&Judged; 2],
        others: &[Member],
        whitener: &Whitener,
        rejected: &mut Vec<Rejected>,
    ) -> Result<Option<[Found; 2]>> {
        let session = self.session;
        let mut accepted = Vec::new();
        for (judged, other) in [(pair[0], pair[1]), (pair[1], pair[0])] {
            let with: Vec<Member> = others.iter().cloned().chain([other.member()]).collect();
            let fit = whitener.fit(&session.model.columns(&session.logs.train, &with)?, &session.logs.train.torque);
            let Some(judged) = session.judge(&judged.candidate, whitener, &fit) else { return Ok(None) };
            let (members, alpha) = (&with[..], self.options.alpha);
            let trial =
                Trial { session, members, whitener, fit: &fit, multiplicity: self.multiplicity, alpha, tries: None };
            let level = self.multiplicity.level(judged.candidate.family().effect, judged.test.log_p());
            match trial.of(&judged, level, None)? {
                Outcome::Accepted(one) => accepted.push(Found::new(*one, Vec::new())),
                Outcome::Refused(refusal) => {
                    rejected.push(Rejected { slot: judged.candidate.slot(), failed: refusal.failed });
                    return Ok(None);
                }
            }
        }
        Ok(accepted.try_into().ok())
    }
}
