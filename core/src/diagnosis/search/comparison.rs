//! One round of the search: the scan of all candidates, and the model comparison of the best.

use super::eligible::Contenders;
use super::found::Alternative;
use crate::diagnosis::criteria::Criteria;
use crate::diagnosis::evidence::{Gains, Judged, Multiplicity, Scan};
use crate::diagnosis::model::{Candidate, Fit, Member, Session, Slot, shapes};
use crate::diagnosis::noise::Whitener;
use crate::diagnosis::regression::{Column, Projection, Test, log_survival};
use crate::effects::{Scope, Site};
use crate::error::Result;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Candidates that were seen in the noise under the model with them: criterion and candidate at its best shape there, None where it
/// cannot be. They hold as long as the rest of the model stays the same.
pub(super) type InOwnNoise = BTreeMap<Slot, Option<(f64, Candidate)>>;

/// Result of a model comparison.
#[derive(Debug)]
pub(super) struct Comparison {
    /// The effect that explains the training logs best.
    pub winner: Judged,
    /// What else explains them.
    pub alternatives: Vec<Alternative>,
    /// Those that come close, whether or not the training logs exclude them.
    pub close: Vec<Judged>,
}

/// The winner among `contenders`, what else of all candidates of the `scan` explains the same, and what comes close. What is looked for
/// in many places must fit better, by as many tests as its kind is worth by `multiplicity`, to win over what is looked for in few.
///
/// # Errors
/// If a log is too short to differentiate.
pub(super) fn compare(
    session: &Session,
    members: &[Member],
    contenders: &Contenders,
    scan: &Scan,
    multiplicity: &Multiplicity,
    in_own_noise: &mut InOwnNoise,
) -> Result<Comparison> {
    let Contenders { best, eligible, .. } = contenders;
    let Criteria { comparison: criteria, levels, .. } = &session.criteria;
    let looked_for = |judged: &Judged| multiplicity.looked_for(judged.candidate.family().effect);
    let present = session.model.columns(&session.logs.train, members)?;
    let seen = |judged: &Judged| -> Result<Option<(f64, Candidate)>> {
        let Some((Fit { whitener, projection: fit }, own)) = in_its_own_noise(session, &present, judged)? else {
            return Ok(None);
        };
        let left = fit.left() - own.test.statistic;
        let criterion = 2.0 * whitener.log_scale() + left + 2.0 * parameters(&own) as f64 + looked_for(&own);
        Ok(Some((criterion, own.candidate)))
    };
    let shortlist = &best[..best.len().min(criteria.shortlist)];
    let new = shortlist.par_iter().filter(|judged| !in_own_noise.contains_key(&judged.candidate.slot()));
    let new = new.map(|judged| Ok((judged.candidate.slot(), seen(judged)?)));
    let new: Vec<(Slot, Option<(f64, Candidate)>)> = new.collect::<Result<_>>()?;
    in_own_noise.extend(new);
    let seen = shortlist.iter().filter_map(|judged| Some((judged, in_own_noise[&judged.candidate.slot()].as_ref()?)));
    let first = seen.min_by(|(_, (a, _)), (_, (b, _))| a.total_cmp(b));
    let (leader, statistic) =
        first.map_or((&best[0].candidate, best[0].test.statistic), |(judged, (_, own))| (own, judged.test.statistic));

    // From here on all are seen in the same whitening, that under the leader.
    let Fit { whitener, projection: fit } = under(session, &present, leader);
    // What acts elsewhere is no other name for what is seen here, nor is what hardly explains any of it.
    let here = leader.joints();
    let rivals = scan.reaching(levels.minor * statistic);
    let rivals = rivals.filter(|candidate| candidate.acts_on(&here) && eligible.may_be(candidate));
    let again: Vec<Candidate> = rivals.cloned().chain([leader.clone()]).collect();
    let scan = Scan::new(session, &again, &whitener, &fit);
    let ranked = scan.best_per_family();
    let largest = ranked.iter().map(|judged| judged.test.statistic).fold(0.0, f64::max);
    let strong = ranked.into_par_iter().filter(|judged| judged.test.statistic > criteria.rival * largest);
    let mut strong: Vec<Judged> =
        strong.map(|judged| session.refined(judged.clone(), &whitener, &fit)).collect::<Result<_>>()?;
    strong.sort_by(|a, b| (criterion(a) + looked_for(a)).total_cmp(&(criterion(b) + looked_for(b))));
    let Some(first) = strong.iter().position(|judged| eligible.may_win(&judged.candidate)) else {
        return Ok(Comparison { winner: best[0].clone(), alternatives: Vec::new(), close: Vec::new() });
    };
    let winner = strong.remove(first);
    let with_winner = with_tangents(session, &winner, &whitener, &fit)?;
    let here = winner.candidate.joints();
    strong.retain(|rival| rival.candidate.acts_on(&here));
    let mut alternatives = Vec::new();
    for rival in &strong {
        // Nor is the same at another time.
        if rival.candidate.family() == winner.candidate.family() {
            continue;
        }
        let with_rival = with_tangents(session, rival, &whitener, &fit)?;
        let gap = criterion(rival) + looked_for(rival) - criterion(&winner) - looked_for(&winner);
        let needed = |test: Option<Test>, below: f64| test.is_some_and(|test| test.log_p() < below.ln());
        let winner_adds = needed(with_rival.test(&winner.whitened), levels.sure_p);
        let rival_adds = needed(with_winner.test(&rival.whitened), levels.usual_p);
        let larger = parameters(rival) > parameters(&winner);
        // What fits better, and was not sure enough to win, is not excluded by what the winner adds to it.
        let explains_as_much = !winner_adds
            && (!larger || (rival_adds && gap < session.criteria.criterion_gap()) || is_one_more(&winner, rival));
        if explains_as_much || gap < 0.0 {
            alternatives.push(Alternative {
                family: rival.candidate.family(),
                relative_likelihood: (-0.5 * gap.max(0.0)).exp(),
            });
        }
    }
    let least = criteria.close * winner.test.statistic;
    strong.retain(|rival| rival.test.statistic > least && eligible.may_win(&rival.candidate));
    Ok(Comparison { winner, alternatives, close: strong })
}

/// The fit of a model, in the noise under that with one candidate more.
fn under(session: &Session, present: &[Column], candidate: &Candidate) -> Fit {
    let with: Vec<Column> = present.iter().chain(candidate.columns.iter()).cloned().collect();
    let whitener = session.noise_under(&with);
    Fit { projection: whitener.fit(present, &session.logs.train.torque), whitener }
}

/// A candidate at its best shapes in the noise under the model with it, and the fit without it there; None where its estimate cannot be.
fn in_its_own_noise(session: &Session, present: &[Column], judged: &Judged) -> Result<Option<(Fit, Judged)>> {
    let fit = under(session, present, &judged.candidate);
    let Some(own) = session.judge(&judged.candidate, &fit.whitener, &fit.projection) else { return Ok(None) };
    let own = session.refined(own, &fit.whitener, &fit.projection)?;
    Ok(Some((fit, own)))
}

/// The best of the candidates `all` in the slot of `first`, with the shapes that it has as the winner of a comparison without rivals; None
/// where its estimate cannot be.
///
/// # Errors
/// If a log is too short to differentiate.
pub(super) fn without_rivals(
    session: &Session,
    members: &[Member],
    first: &Judged,
    all: &[Candidate],
) -> Result<Option<Judged>> {
    let present = session.model.columns(&session.logs.train, members)?;
    let Some((_, Judged { candidate: leader, .. })) = in_its_own_noise(session, &present, first)? else {
        return Ok(None);
    };
    let Fit { whitener, projection: fit } = under(session, &present, &leader);
    let (slot, own) = (leader.slot(), all.iter().filter(|candidate| candidate.slot() == leader.slot()));
    let again: Vec<Candidate> = own.cloned().chain([leader.clone()]).collect();
    let scan = Scan::new(session, &again, &whitener, &fit);
    scan.likeliest_of(&[slot.0]).map(|judged| session.refined(judged.clone(), &whitener, &fit)).transpose()
}

/// The best candidate of a model comparison once held-out logs are taken into account.
#[derive(Debug)]
pub(super) struct Chosen {
    /// The winner.
    pub winner: Judged,
    /// What else explains the same.
    pub alternatives: Vec<Alternative>,
    /// The noise under the model with the winner, if that was worked out.
    pub whitener: Option<Whitener>,
}

/// The one of those that come close that predicts the held-out rows significantly better than the winner, if any; the winner then
/// stays as an alternative. Where the residual is well above the noise, the training rows separate rivals by what is wrong with both.
pub(super) fn better_held_out(session: &Session, members: &[Member], comparison: &Comparison) -> Result<Chosen> {
    let Comparison { winner, alternatives, close } = comparison;
    let Criteria { comparison: criteria, levels, .. } = &session.criteria;
    let chosen = Chosen { winner: winner.clone(), alternatives: alternatives.clone(), whitener: None };
    if winner.candidate.log.is_some() {
        return Ok(chosen);
    }
    let with = |judged: &Judged| -> Vec<Member> { members.iter().cloned().chain([judged.member()]).collect() };
    let first = with(winner);
    let whitener = session.noise_under(&session.model.columns(&session.logs.train, &first)?);
    let on_held_out = whitener.on(&session.logs.test.rows);
    let before = session.held_out_residual(&first, &whitener)?;
    let rivals: Vec<&Judged> = close.iter().filter(|rival| rival.candidate.log.is_none()).collect();
    let gains = |rival: &&Judged| -> Result<Gains> {
        let mut joints = rival.candidate.joints();
        joints.extend(winner.candidate.joints());
        joints.sort_unstable();
        joints.dedup();
        let after = session.held_out_residual(&with(rival), &whitener)?;
        let gains = Gains::new(&on_held_out, &before, &after, &joints, session.logs.test.rows.len());
        let (bound, growth_p) = (gains.lower_bound(levels), gains.growth_p());
        tracing::debug!(rival = ?rival.candidate.slot(), bound, growth_p, "close rival on held-out rows");
        Ok(gains)
    };
    let gains: Vec<Gains> = rivals.par_iter().map(gains).collect::<Result<_>>()?;
    let better = gains.iter().zip(&rivals).filter(|(gains, _)| gains.lower_bound(levels) > criteria.clearly_better);
    let best = better.max_by(|(a, _), (b, _)| a.lower_bound(levels).total_cmp(&b.lower_bound(levels)));
    let likelier = || {
        let of_change = session.logs.train.rows.of_change();
        gains.iter().zip(&rivals).find(|(gains, rival)| {
            of_change && changes_sooner(&rival.candidate, &winner.candidate) && gains.growth_p() > levels.sure_p
        })
    };
    Ok(match best.or_else(likelier) {
        Some((_, rival)) => chosen.instead(rival),
        None => Chosen { whitener: Some(whitener), ..chosen },
    })
}

/// Whether of two changes of bodies the first is the likelier one before anything is measured: a load comes and goes at the flange, a link
/// stays what it is.
fn changes_sooner(candidate: &Candidate, other: &Candidate) -> bool {
    let others = other.placed.effect.about();
    candidate.placed.effect.is_load() && others.site == Site::Body && others.scope == Scope::Joint
}

impl Chosen {
    /// A rival in the place of the winner, which stays as an alternative.
    pub(super) fn instead(mut self, rival: &Judged) -> Chosen {
        self.alternatives.retain(|other| other.family != rival.candidate.family());
        let winner = Alternative { family: self.winner.candidate.family(), relative_likelihood: 1.0 };
        self.alternatives.insert(0, winner);
        Chosen { winner: rival.clone(), alternatives: self.alternatives, whitener: None }
    }
}

/// Whether the rival is the winner with one parameter more, from which motion alone cannot separate it.
fn is_one_more(winner: &Judged, rival: &Judged) -> bool {
    let (family, other) = (winner.candidate.family(), rival.candidate.family());
    let effect = winner.candidate.placed.effect;
    family.joint == other.joint && effect.indistinguishable_from() == Some(other.effect)
}

/// The fit with a candidate and the derivatives to its shapes.
pub(super) fn with_tangents(
    session: &Session,
    judged: &Judged,
    whitener: &Whitener,
    fit: &Projection,
) -> Result<Projection> {
    let tangents = session.model.tangents(&session.logs.train, &judged.candidate, &judged.test.values)?;
    Ok(fit.with(&judged.whitened).with(&whitener.apply_all(&tangents)))
}

pub(super) fn parameters(judged: &Judged) -> usize {
    judged.test.freedom + shapes(judged.candidate.placed.effect).len()
}

/// Akaike's criterion, of which only differences matter.
fn criterion(judged: &Judged) -> f64 {
    // Many directions are held to the level of a few by the tail of the test itself.
    let shapes = shapes(judged.candidate.placed.effect).len() as f64;
    (2.0 * log_survival(judged.test.statistic, judged.test.freedom)).max(-f64::MAX) + 2.0 * shapes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::{Placed, find};

    #[test]
    fn a_load_changes_sooner_than_a_link_and_no_other_law_does() {
        let candidate = |name: &str| {
            let placed = Placed::typical(find(name).unwrap(), 0);
            Candidate { placed, log: None, columns: Default::default() }
        };
        let sooner = |one: &str, other: &str| changes_sooner(&candidate(one), &candidate(other));
        assert!(sooner("payload", "link_inertia_error") && !sooner("link_inertia_error", "payload"));
        assert!(!sooner("payload", "coulomb_friction") && !sooner("base_tilt", "link_inertia_error"));
    }
}
