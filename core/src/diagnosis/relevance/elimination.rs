//! Backward elimination of findings that do not matter.

use super::fit::HeldFit;
use super::gates::{Judge, Judged, predicts_every_joint};
use crate::diagnosis::criteria::{Criteria, Gate, Judgement};
use crate::diagnosis::evidence::Multiplicity;
use crate::diagnosis::model::{Member, Session, is_event, is_level, shapes};
use crate::diagnosis::noise::Whitener;
use crate::diagnosis::search::{Found, members};
use crate::error::Result;
use rayon::prelude::*;

/// A finding that is not reported as one.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::diagnosis::{Criteria, Diagnosis, Gate, Levels, Options};
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Ignored)?;
/// # let log = |name: &str| recording::load(format!("../tests/reference/pendulum/{name}.csv"), None);
/// # let (train, test) = (log("train")?, log("test")?);
///
/// // Where only what exceeds 15 % of the torque matters no finding passes: the ripple, of 10 %, is minor.
/// let levels = Levels { minor: 1.0, ..Levels::default() };
/// let criteria = Criteria { share_of_torque: 0.15, levels, ..Criteria::default() };
/// let options = Options { criteria, candidates: vec!["torque_ripple".to_owned()], ..Options::default() };
/// let answer = Diagnosis::of(&robot).train([&train]).test([&test]).options(options).run()?;
/// let minor = &answer.diagnosis().expect("the logs are good").minor[0];
/// assert_eq!(minor.failed.gate, Gate::Size);
/// assert_eq!(minor.found.member.placed.effect.about().name, "torque_ripple");
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Minor {
    /// What was found.
    pub found: Found,
    /// The gate that it failed.
    pub failed: Judgement,
    /// Its size on every joint: root of the difference of the training logs' mean squares with and without it, N m (N).
    pub size: Vec<f64>,
}

/// The largest finding on a joint, of those that generic functions explain as well, whose size differs from block to block or that fit the
/// training logs alone: the law that comes nearest to what stays unexplained there.
pub(crate) fn nearest(minor: &[Minor], joint: usize) -> Option<&Minor> {
    let alike = minor.iter().filter(|one| {
        matches!(one.failed.gate, Gate::BeyondStructure | Gate::UnderStructure | Gate::Strength | Gate::Predicts)
    });
    let own = alike.filter(|one| one.found.member.candidate.joints().contains(&joint));
    own.max_by(|a, b| a.size[joint].total_cmp(&b.size[joint]))
}

/// Takes the findings that do not matter out of `found`, and returns them; on the joints of `any_size` the smallest matters.
///
/// # Errors
/// If a log is too short to differentiate.
pub(crate) fn eliminate(
    session: &Session,
    found: &mut Vec<Found>,
    whitener: &Whitener,
    multiplicity: &Multiplicity,
    any_size: &[usize],
) -> Result<Vec<Minor>> {
    if found.is_empty() {
        return Ok(Vec::new());
    }
    let members = members(found);
    let judge = Judge::new(session, &members, whitener, multiplicity, any_size)?;
    let mut kept: Vec<usize> = (0..members.len()).collect();
    let mut out: Vec<(usize, Judgement, Vec<f64>)> = Vec::new();
    let mut returned: Vec<usize> = Vec::new();
    loop {
        while let Some((index, failed, size)) = least_that_fails(&judge, &kept, &session.criteria) {
            let member = kept.remove(index);
            tracing::debug!(family = ?members[member].candidate.family(), ?failed, "does not matter");
            out.push((member, failed, size));
        }
        // What was refused in view of structure, or of laws that are out by now, is asked again with those that stay, once.
        let open = out.iter().enumerate().filter(|(_, (member, failed, _))| {
            matches!(failed.gate, Gate::UnderStructure | Gate::BeyondStructure) && !returned.contains(member)
        });
        let Some((place, _)) = open.rev().find(|(_, (member, ..))| matters(&judge, &kept, *member)) else { break };
        let (member, ..) = out.remove(place);
        tracing::debug!(family = ?members[member].candidate.family(), "matters with those that stay");
        returned.push(member);
        kept.push(member);
    }
    let minor = out.into_iter().map(|(member, failed, size)| Minor { found: found[member].clone(), failed, size });
    let minor = minor.collect();
    let mut member = 0;
    found.retain(|_| {
        member += 1;
        kept.contains(&(member - 1))
    });
    Ok(minor)
}

/// Gives all findings standard deviations that hold their scatter between blocks of the training logs.
///
/// # Errors
/// If a log is too short to differentiate.
pub(crate) fn with_scatter(session: &Session, found: &mut [Found], whitener: &Whitener) -> Result<()> {
    if found.is_empty() {
        return Ok(());
    }
    let members = members(found);
    let fit = HeldFit::new(session, &members, whitener)?;
    let all: Vec<usize> = (0..found.len()).collect();
    let by_structure = fit.variances_by_structure(&all, &fit.structure(&all));
    for (found, variances) in found.iter_mut().zip(by_structure.iter().flatten()) {
        let noise = &found.member.std;
        let together = |(index, variance): (usize, &f64)| noise[index].hypot(variance.sqrt());
        let std: Vec<f64> = found.member.places().zip(variances).map(together).collect();
        tracing::debug!(family = ?found.member.candidate.family(), ?noise, ?std, "standard deviations with structure");
        widen(&mut found.member, &std);
    }
    if let Some(scatters) = fit.scatters(&all) {
        found.iter_mut().zip(&scatters).for_each(|(found, scatter)| widen(&mut found.member, scatter));
    }
    Ok(())
}

/// Whether a member passes all gates with those `kept`.
fn matters(judge: &Judge, kept: &[usize], member: usize) -> bool {
    let with = [kept, &[member]].concat();
    let passes = |judgement: Option<Judgement>| judgement.is_none_or(|judgement| judgement.passed);
    judge.one(&with, kept.len()).failed().is_none()
        && passes(judge.under_structure(&with, kept.len(), &judge.structure(&with)))
        && passes(judge.beyond_structure(&with, kept.len()))
}

/// The finding to take out next: its place among those kept, the gate it fails and its size.
fn least_that_fails(judge: &Judge, kept: &[usize], criteria: &Criteria) -> Option<(usize, Judgement, Vec<f64>)> {
    let mut judged = judge.of(kept);
    let failing = judged.iter().filter_map(|one| Some((one, one.failed()?)));
    if let Some((one, failed)) = failing.min_by(|(a, _), (b, _)| a.relative_size.total_cmp(&b.relative_size)) {
        return Some((one.index, failed, one.size.clone()));
    }
    let structure = judge.structure(kept);
    let failing = judged.iter().filter_map(|one| Some((one, judge.under_structure(kept, one.index, &structure)?)));
    let failing = failing.filter(|(_, significant)| !significant.passed);
    if let Some((one, failed)) = failing.max_by(|(_, a), (_, b)| a.value.total_cmp(&b.value)) {
        return Some((one.index, failed, one.size.clone()));
    }
    let beyond: Vec<_> = judged.par_iter().map(|one| judge.beyond_structure(kept, one.index)).collect();
    let failing = beyond.into_iter().enumerate().filter_map(|(place, gained)| Some((place, gained?)));
    let failing = failing.filter(|(_, gained)| !gained.passed);
    if let Some((place, failed)) = failing.min_by(|(_, a), (_, b)| a.value.total_cmp(&b.value)) {
        let Judged { index, size, .. } = judged.swap_remove(place);
        return Some((index, failed, size));
    }
    let (joint, factor) = judge.worse_than_baseline(kept)?;
    let index = judge.without_which_best(kept, joint)?;
    let one = judged.into_iter().find(|one| one.index == index)?;
    Some((index, predicts_every_joint(factor, criteria), one.size))
}

/// Makes the standard deviations of a member at least those of its scatter between blocks, in the order of its columns.
fn widen(member: &mut Member, scatter: &[f64]) {
    let effect = member.placed.effect;
    // A level is no factor of a column: its deviation comes from the rows at it; and the times of an event are in rows that are left out.
    let has_no_scatter = |index: usize| is_level(effect) || is_event(effect) && shapes(effect).contains(&index);
    for (index, &std) in member.places().zip(scatter).filter(|(index, _)| !has_no_scatter(*index)) {
        member.std[index] = member.std[index].max(std);
    }
}
