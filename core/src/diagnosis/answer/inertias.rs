//! Whether it is not one effect but the description as a whole that is wrong: inertias believed, and none of them right.
//!
//! Against wrong inertias single effects explain a little each, and never all. Where trusted inertias leave structure or ask
//! for several wrong links, the search is made once more with all base parameters free; if that predicts the held-out logs
//! significantly better, and leaves less unexplained, the inertias are what is wrong. It is not made where free base parameters, with the
//! same effects, predict no better: what another search gains then is no gain of theirs.

use super::searched::Searched;
use crate::diagnosis::Options;
use crate::diagnosis::criteria::{Gate, Judgement};
use crate::diagnosis::evidence::Gains;
use crate::diagnosis::lack_of_fit::Unexplained;
use crate::diagnosis::model::{Known, Member, Session, is_candidate};
use crate::diagnosis::noise::Whitener;
use crate::diagnosis::preparation::prepare;
use crate::diagnosis::regression::{Column, rms};
use crate::diagnosis::search::Found;
use crate::diagnosis::watch::Watch;
use crate::effects::Site;
use crate::error::Result;
use crate::identification::effect_model::Trust;
use crate::recording::Recording;

/// What re-identified inertias gain on the held-out logs over those of the description.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::diagnosis::Gain;
///
/// // As `Diagnosis::inertias` has it where the described bodies are far too light: two joints, before and after.
/// let gain = Gain { lower_bound: 0.98, rms: [vec![0.11, 1.54], vec![0.10, 0.13]] };
/// let [before, after] = &gain.rms;
/// assert!(after.iter().zip(before).all(|(after, before)| after < before));
/// ```
#[derive(Debug, Clone)]
pub struct Gain {
    /// Lower bound (84 %) of the share of the whitened sum of squares.
    pub lower_bound: f64,
    /// Root mean square of the residual before and after, `[joint]`, N m.
    pub rms: [Vec<f64>; 2],
}

/// The search with all inertias free.
#[derive(Debug)]
pub(super) struct Free<'a> {
    /// Logs and arm.
    pub session: Session<'a>,
    /// What was found with the inertias free.
    pub searched: Searched,
    /// What it gains on the held-out logs over the search with inertias trusted.
    pub gain: Gain,
}

/// What came of the search with all inertias free.
#[derive(Debug)]
pub(super) enum Outcome<'a> {
    /// It was not made, or was ended before it was done.
    NotAsked,
    /// The inertias of the description are not what is wrong.
    Refused(Judgement),
    /// They are.
    Accepted(Box<Free<'a>>),
}

/// The search with all inertias free, which shows whether those of the description are what is wrong: what was found with them trusted,
/// and what that left unexplained, decides whether it is made.
///
/// # Errors
/// If a log is too short to differentiate.
pub(super) fn all_inertias<'a>(
    trusted: &Session<'a>,
    trusting: &Searched,
    known: Known<'a>,
    train: &[&Recording],
    test: &[&Recording],
    options: &Options,
    watch: &mut Watch,
) -> Result<Outcome<'a>> {
    let few = options.criteria.levels.few;
    let is_body = |found: &&Found| found.member.placed.effect.about().site == Site::Body;
    let Searched { selection, structure, .. } = trusting;
    let bodies = selection.found.iter().filter(is_body).count();
    let left = certain(&structure.unexplained);
    // What a search has not come to is no reason to doubt the inertias.
    if (bodies <= few && (left < few || selection.is_full)) || watch.is_over() {
        return Ok(Outcome::NotAsked);
    }
    let mut session = prepare(trusted.model.base, Trust::Structure, known, train, test, options.criteria)?;
    let (with_same_effects, whitener) = residual_with(&session, &selection.found)?;
    let gain = Gain::of([trusted, &session], [&selection.held_out, &with_same_effects], &whitener);
    let gains = Judgement::above(Gate::HeldOutGain, gain.lower_bound, options.criteria.search.share_of_misfit);
    if !gains.passed {
        return Ok(Outcome::Refused(gains));
    }
    let searched = Searched::new(&mut session, options, watch)?;
    let free = &searched.selection;
    let left_free = certain(&searched.structure.unexplained);
    // Half a search is no comparison.
    if watch.is_over() {
        return Ok(Outcome::NotAsked);
    }
    let simpler = are_simpler([left, left_free], [selection.found.len(), free.found.len()]);
    if let Some(failed) = Judgement::first_failed(simpler) {
        return Ok(Outcome::Refused(failed));
    }
    let gain = Gain::of([trusted, &session], [&selection.held_out, &free.held_out], &free.whitener);
    let gains = Judgement::above(Gate::HeldOutGain, gain.lower_bound, options.criteria.search.share_of_misfit);
    Ok(match gains.passed {
        true => Outcome::Accepted(Box::new(Free { session, searched, gain })),
        false => Outcome::Refused(gains),
    })
}

impl Gain {
    /// That of two held-out residuals, of sessions with trusted and with free inertias: on the rows valid for both, in the noise of the latter.
    fn of(sessions: [&Session; 2], [before, after]: [&Column; 2], whitener: &Whitener) -> Self {
        let [trusted, free] = sessions.map(|session| &session.logs.test.rows);
        let mut rows = free.clone();
        for (valid, other) in rows.valid.iter_mut().zip(&trusted.valid) {
            valid.iter_mut().zip(other).for_each(|(ok, other)| *ok &= *other);
        }
        let joints: Vec<usize> = (0..rows.dof()).collect();
        let gains = Gains::new(&whitener.on(&rows), before, after, &joints, rows.len());
        let rms = [before, after].map(|residual| rms(&rows.valid, residual));
        Gain { lower_bound: gains.lower_bound(&sessions[1].criteria.levels), rms }
    }
}

/// Held-out residual of the model of `session` with the effects `found` in another, and the noise under it. Bodies are among its own
/// parameters where those are free.
///
/// # Errors
/// If a log is too short to differentiate.
fn residual_with(session: &Session, found: &[Found]) -> Result<(Column, Whitener)> {
    let mut members = Vec::new();
    for Found { member, .. } in
        found.iter().filter(|one| is_candidate(one.member.placed.effect, session.model.trust, &[]))
    {
        if let Some(candidate) = session.candidate_at(member.candidate.placed.clone(), member)? {
            members.push(Member { candidate, ..member.clone() });
        }
    }
    let whitener = session.noise_under(&session.model.columns(&session.logs.train, &members)?);
    Ok((session.held_out_residual(&members, &whitener)?, whitener))
}

/// Whether estimated inertias need less to explain the logs than trusted ones, by the joints with unexplained structure and by the effects
/// found, with trusted inertias first.
fn are_simpler(unexplained: [usize; 2], found: [usize; 2]) -> [Judgement; 2] {
    let [[left, left_free], [found, found_free]] = [unexplained, found].map(|counts| counts.map(|count| count as f64));
    [
        Judgement::at_most(Gate::InertiasUnexplained, left_free, left),
        Judgement::below(Gate::InertiasFindings, found_free, found).or(left_free < left),
    ]
}

/// Number of joints with unexplained structure that is certain.
fn certain(unexplained: &[Unexplained]) -> usize {
    unexplained.iter().filter(|left| left.certain).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn estimated_inertias_leave_less_or_need_fewer_effects() {
        let failed = |unexplained: [usize; 2], found: [usize; 2]| {
            Judgement::first_failed(are_simpler(unexplained, found)).map(|failed| failed.gate)
        };
        assert_eq!(failed([2, 2], [5, 4]), None);
        assert_eq!(failed([2, 2], [5, 5]), Some(Gate::InertiasFindings));
        assert_eq!(failed([2, 1], [5, 5]), None);
        assert_eq!(failed([2, 3], [5, 0]), Some(Gate::InertiasUnexplained));
    }
}
