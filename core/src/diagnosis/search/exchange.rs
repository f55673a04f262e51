//! One law in the place of several findings. A flexible law that is taken first, a wrong body further out, may leave a second law to
//! explain what it cannot; the law that explains all of it then makes the parameters of that second law unidentifiable. Two wrong bodies
//! may together be nearly what a third alone is.

use super::acceptance::{Outcome, Trial};
use super::found::{Found, Rejected, members};
use crate::diagnosis::criteria::{Gate, Judgement};
use crate::diagnosis::evidence::{Gains, Judged, Multiplicity};
use crate::diagnosis::model::{Candidate, Fit, Member, Session};
use crate::diagnosis::regression::Column;
use crate::error::Result;
use rayon::prelude::*;

/// A law, and the findings that it replaces.
#[derive(Debug)]
pub(super) struct Exchange {
    /// The law as a finding.
    pub by: Found,
    /// Places of the findings that it replaces, in ascending order.
    pub places: Vec<usize>,
}

impl Exchange {
    /// Makes the exchange among what was `found`: the law takes the place of the last finding of those that it replaces and that come up to
    /// `index`. Returns that place.
    pub(super) fn make(self, found: &mut Vec<Found>, index: usize) -> usize {
        let at = index + 1 - self.places.iter().filter(|&&place| place <= index).count();
        self.places.into_iter().rev().for_each(|place| drop(found.remove(place)));
        found.insert(at, self.by);
        at
    }
}

/// The winner of a model comparison in the place of the finding at `index` and of all others whose parameters it makes unidentifiable,
/// where it passes all gates without them and held-out logs do not contradict it; else the gate that it fails is added to `rejected`. A
/// constant torque, which one of them may have explained too, does not count.
///
/// # Errors
/// If a log is too short to differentiate.
pub(super) fn exchanged(
    session: &Session,
    found: &[Found],
    index: usize,
    winner: &Judged,
    (multiplicity, alpha): (&Multiplicity, f64),
    rejected: &mut Vec<Rejected>,
) -> Result<Option<Exchange>> {
    let train = &session.logs.train;
    let others: Vec<usize> = (0..found.len()).filter(|&place| place != index).collect();
    let of_others = staying(found, &[index]);
    let with: Vec<Member> = of_others.iter().cloned().chain([winner.member()]).collect();
    let whitener = session.noise_under(&session.model.columns(train, &with)?);
    let solved = [session.solved(&of_others, &whitener)?, session.solved(&with, &whitener)?];
    let undone = session.undetermined_by_one_more(&of_others, &solved);
    let mut places: Vec<usize> = undone.into_iter().map(|k| others[k]).chain([index]).collect();
    places.sort_unstable();
    places.dedup();
    if places.len() < 2 || !places.iter().all(|&place| found[place].can_be_asked()) {
        return Ok(None);
    }

    in_place_of(session, found, places, &winner.candidate, (multiplicity, alpha), rejected)
}

/// One body in the place of two that were found, where it fits the training logs as well: it loses no more of the sum of squares than
/// its fewer parameters make up for (Akaike's criterion). What fails that, or a gate, is added to `rejected`.
///
/// # Errors
/// If a log is too short to differentiate.
pub(super) fn one_body(
    session: &Session,
    found: &[Found],
    everywhere: &[Candidate],
    (multiplicity, alpha): (&Multiplicity, f64),
    rejected: &mut Vec<Rejected>,
) -> Result<Option<Exchange>> {
    let is_body = |&place: &usize| found[place].member.placed.effect.is_body() && found[place].can_be_asked();
    let bodies: Vec<usize> = (0..found.len()).filter(is_body).collect();
    if bodies.len() < 2 {
        return Ok(None);
    }
    let train = &session.logs.train;
    let whitener = session.noise_under(&session.model.columns(train, &members(found))?);
    for (k, &first) in bodies.iter().enumerate() {
        for &second in &bodies[k + 1..] {
            let stay = staying(found, &[first, second]);
            let fit = whitener.fit(&session.model.columns(train, &stay)?, &train.torque);
            let both: Vec<Column> = [first, second]
                .into_iter()
                .flat_map(|place| found[place].member.candidate.columns.iter().cloned())
                .collect();
            let Some(both) = fit.test(&whitener.apply_all(&both)) else { continue };
            let singles = everywhere.par_iter().filter(|candidate| candidate.placed.effect.is_body());
            let best = singles
                .filter_map(|candidate| session.judge(candidate, &whitener, &fit))
                .max_by(|a, b| a.test.statistic.total_cmp(&b.test.statistic));
            let Some(best) = best else { continue };
            let fewer = both.freedom.saturating_sub(best.test.freedom) as f64;
            let lost = both.statistic - best.test.statistic;
            tracing::debug!(body = ?best.candidate.slot(), lost, fewer, "one body in place of two");
            if fewer == 0.0 {
                continue;
            }
            let simpler = is_simpler(lost, fewer);
            if !simpler.passed {
                rejected.push(Rejected { slot: best.candidate.slot(), failed: simpler });
                continue;
            }
            let (places, asked) = (vec![first, second], (multiplicity, alpha));
            let exchange = in_place_of(session, found, places, &best.candidate, asked, rejected)?;
            if exchange.is_some() {
                return Ok(exchange);
            }
        }
    }
    Ok(None)
}

/// Whether `fewer` parameters make up for what is `lost` of the statistic: Akaike's criterion takes two for each.
fn is_simpler(lost: f64, fewer: f64) -> Judgement {
    Judgement::at_most(Gate::Parsimony, 0.5 * lost / fewer, 1.0)
}

/// The members but those found at some places.
fn staying(found: &[Found], places: &[usize]) -> Vec<Member> {
    let stay = found.iter().enumerate().filter(|(place, _)| !places.contains(place));
    stay.map(|(_, found)| found.member.clone()).collect()
}

/// A candidate in the place of the findings at `places`, where it passes all gates without them and held-out logs do not contradict it; else
/// the gate that it fails is added to `rejected`.
fn in_place_of(
    session: &Session,
    found: &[Found],
    places: Vec<usize>,
    candidate: &Candidate,
    (multiplicity, alpha): (&Multiplicity, f64),
    rejected: &mut Vec<Rejected>,
) -> Result<Option<Exchange>> {
    let (train, test) = (&session.logs.train, &session.logs.test);
    let stay = staying(found, &places);
    let Fit { whitener, projection: fit } = session.fit_under(&session.model.columns(train, &stay)?);
    let Some(judged) = session.judge(candidate, &whitener, &fit) else { return Ok(None) };
    let level = multiplicity.level(judged.candidate.family().effect, judged.test.log_p());
    let trial = Trial { session, members: &stay, whitener: &whitener, fit: &fit, multiplicity, alpha, tries: None };
    let accepted = match trial.of(&judged, level, None)? {
        Outcome::Accepted(accepted) => accepted,
        Outcome::Refused(refusal) => {
            rejected.push(Rejected { slot: judged.candidate.slot(), failed: refusal.failed });
            return Ok(None);
        }
    };

    let before = members(found);
    let after: Vec<Member> = stay.iter().cloned().chain([accepted.member.clone()]).collect();
    let whitener = session.noise_under(&session.model.columns(train, &before)?);
    let mut joints: Vec<usize> = places
        .iter()
        .flat_map(|&place| found[place].member.candidate.joints())
        .chain(judged.candidate.joints())
        .collect();
    joints.sort_unstable();
    joints.dedup();
    let residual = |members: &[Member]| session.held_out_residual(members, &whitener);
    let (before, after) = (residual(&before)?, residual(&after)?);
    let gains = Gains::adjusted_for_constants(&whitener.on(&test.rows), &before, &after, &joints, &test.rows);
    tracing::debug!(winner = ?judged.candidate.slot(), ?places, share = gains.share(), "one law in place of several");
    let agrees = Judgement::at_least(Gate::HeldOutGain, gains.upper_bound(&session.criteria.levels), 0.0);
    if !agrees.passed {
        rejected.push(Rejected { slot: judged.candidate.slot(), failed: agrees });
        return Ok(None);
    }
    Ok(Some(Exchange { by: Found::new(*accepted, Vec::new()), places }))
}

#[cfg(test)]
mod tests {
    use super::super::acceptance::Accepted;
    use super::*;
    use crate::diagnosis::evidence::Scan;
    use crate::diagnosis::model::all_candidates;
    use crate::diagnosis::test_logs::log;
    use crate::effects::{Placed, find};
    use crate::identification::effect_model::{Arm, Trust};
    use crate::identification::model::Model;
    use crate::robot::{InertiaCheck, load};

    /// Which findings one body replaces, and that body's joint, where links 2 and 4 were found and these `links` are wrong.
    fn replaced(links: &[usize]) -> std::result::Result<(Vec<usize>, usize), Vec<Rejected>> {
        let robot =
            load(concat!(env!("CARGO_MANIFEST_DIR"), "/../urdf/irb1600_6_120.urdf"), InertiaCheck::Required).unwrap();
        let effect = find("link_inertia_error").unwrap();
        let mut wrong = robot.clone();
        for &link in links {
            effect.alter(&Placed::typical(effect, link).parameters, link, &mut wrong);
        }
        let logs = [1, 2, 3].map(|seed| log(&Arm::new(&wrong, Trust::Nominal), seed));
        let model = Model::new(&robot);
        let session = Session::new(&model, Trust::Nominal, &[&logs[0], &logs[1]], &[&logs[2]]).unwrap();
        let train = &session.logs.train;
        let names = ["link_inertia_error".to_owned()];
        let all = all_candidates(&session.model.arm, &train.rows, session.model.asked(&names)).unwrap();
        let Fit { whitener, projection } = session.fit_under(&train.baseline);
        let multiplicity = Scan::new(&session, &all, &whitener, &projection).multiplicity(&projection, &whitener, 0);
        let on = |joint: usize| {
            let candidate = all.iter().find(|candidate| candidate.family().joint == joint).unwrap();
            let test = projection.test(&whitener.apply_all(&candidate.columns)).unwrap();
            let member = Member::new(candidate, &test.values);
            Found::new(Accepted { member, gain_lower_bound: 0.0, level: 0.0 }, Vec::new())
        };
        let found = [on(1), on(3)];
        let mut rejected = Vec::new();
        let exchange = one_body(&session, &found, &all, (&multiplicity, 0.05), &mut rejected).unwrap();
        exchange.map(|made| (made.places, made.by.member.candidate.family().joint)).ok_or(rejected)
    }

    #[test]
    fn one_wrong_link_takes_the_place_of_two_that_are_nearly_it() {
        assert_eq!(replaced(&[2]), Ok((vec![0, 1], 2)));
        // Two that are wrong lose too much, which is listed.
        let rejected = replaced(&[1, 3]).unwrap_err();
        assert!(
            rejected.iter().any(|one| one.failed.gate == Gate::Parsimony && one.failed.value > 1.0),
            "{rejected:?}"
        );
    }

    #[test]
    fn a_parameter_is_worth_two_of_the_statistic() {
        assert!(is_simpler(8.0, 4.0).passed && is_simpler(-1.0, 4.0).passed && !is_simpler(8.01, 4.0).passed);
    }
}
