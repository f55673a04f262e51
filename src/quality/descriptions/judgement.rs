//! The judgement of a description: without the bodies of the arm first, then with them; then the scale of the torques.

use super::change::Description;
use super::fitting::{Fit, Physics, Rows};
use super::known::Known;
use super::scale::Scaled;
use super::search::{Found, Outcome, search};
use super::tried::Tried;
use super::verdict::{Alternative, Verdict};
use super::{compare, factors, jumps, scale};
use crate::quality::view::View;
use crate::robot::Robot;
use nalgebra::Vector3;

/// A log by itself allows to go on with a changed description where it lasts so long, s; a shorter one needs a second log:
/// one short motion is one observation, whatever its blocks show.
const LONG_ENOUGH_S: f64 = 30.0;

/// Torques of a rigid-body model are explained by one to this share: the noise of encoders makes accelerations, and so the model's
/// torque, uncertain by a few per cent.
const RIGID: f64 = 0.03;

/// Friction below this share of a torque is none. Drives have ten times as much, and noise of the allowed size passes for half of it.
const FRICTIONLESS: f64 = 0.005;

/// Whether all torques are those of a rigid-body model without any friction.
pub(crate) fn is_modelled(views: &[&View], robot: Option<&Robot>) -> bool {
    let modelled = || {
        let robot = robot?;
        let rows = Rows::new(views, Some(robot))?;
        let start = Description::as_given(robot.dof(), robot.gravity);
        let tables = Physics::free(robot).tables(&rows, &start);
        Fit::new(&tables, &rows, &start).residual_and_friction()
    };
    let rigid = |[left, friction]: &[f64; 2]| *left < RIGID && *friction < FRICTIONLESS;
    modelled().is_some_and(|shares| !shares.is_empty() && shares.iter().all(rigid))
}

/// Judges the description of some logs of one arm.
pub(crate) fn judge(views: &[&View], robot: Option<&Robot>) -> Option<Verdict> {
    let rows = Rows::new(views, robot)?;
    let dof = rows.measured.len();
    let gravity = robot.map_or(Vector3::zeros(), |robot| robot.gravity);
    let start = Description::as_given(dof, gravity);
    let seconds: f64 = views.iter().map(|view| view.log.duration()).sum();
    let replicated = |found: &Found| match views.len() {
        1 => seconds >= LONG_ENOUGH_S,
        _ => found.gain.least_of_logs > 0.0,
    };
    let with_motion = jumps::with_motion(views);
    let Some(robot) = robot else {
        let outcome = search(Known::alone(&Physics::Alone), &rows, &with_motion, start)?;
        return verdict(outcome, |_| false);
    };
    let (free, bodies) = (Physics::free(robot), Physics::bodies(robot));
    let known = Known { physics: &free, other: bodies.as_ref() };
    let outcome = search(known, &rows, &with_motion, start.clone())?;
    if let Some(Found { best, .. }) = &outcome.found {
        // Torques in another unit, with factors that differ by joint: what free bodies see of it is a factor of the joint that differs most.
        let only_factors = best.description.has_only_factors();
        let of_all = |bodies| scale::judge(bodies, &rows, &start);
        if let Some(Scaled { before, after, factors }) = bodies.as_ref().filter(|_| only_factors).and_then(of_all) {
            return Some(scaled_verdict(&before, after, factors));
        }
        let scaled = best.description.scaled().count();
        let each = |bodies| factors::of_all_joints(&free, bodies, &rows, &outcome.start, best);
        if let Some((after, factors)) = bodies.as_ref().filter(|_| scaled > 1).and_then(each) {
            return Some(scaled_verdict(&outcome.start, after, factors));
        }
        let settled = match bodies {
            Some(bodies) => settled(&bodies, &rows, outcome),
            None => outcome,
        };
        return verdict(settled, replicated);
    }
    let bodies = bodies?;
    if let Some(Scaled { before, after, factors }) = scale::judge(&bodies, &rows, &start) {
        return Some(scaled_verdict(&before, after, factors));
    }
    let outcome = search(Known { physics: &bodies, other: Some(&free) }, &rows, &with_motion, start)?;
    let credible = outcome.found.as_ref().is_some_and(|found| found.best.share() < scale::ALIKE);
    if credible { verdict(outcome, replicated) } else { None }
}

/// The verdict on torques of another scale, which the logs do not trace to a cause.
fn scaled_verdict(before: &Tried, after: Tried, factors: Vec<Option<f64>>) -> Verdict {
    Verdict {
        before: before.share(),
        after: after.share(),
        each: [before.evaluation.unexplained.clone(), after.evaluation.unexplained],
        alternatives: Vec::new(),
        next: None,
        description: after.description,
        factors,
        beyond_doubt: false,
    }
}

/// An outcome whose rivals are compared under the described bodies, where these explain the torques.
fn settled(bodies: &Physics, rows: &Rows, mut outcome: Outcome) -> Outcome {
    let Some(Found { best, rivals, next, gain }) = outcome.found.take() else { return outcome };
    let mut each: Vec<Tried> = std::iter::once(best).chain(rivals).collect();
    let under = |tried: &Tried| Tried::new(bodies, rows, tried.description.clone());
    let judged: Vec<Tried> = each.iter().filter_map(under).collect();
    let least = (0..judged.len()).min_by(|&a, &b| judged[a].share().total_cmp(&judged[b].share()));
    let least = least.filter(|&least| judged.len() == each.len() && judged[least].share() < scale::ALIKE);
    let worse = |place: usize| {
        let own = |least: usize| compare::compare(&judged[place].evaluation, &judged[least].evaluation, &rows.log);
        least.and_then(own).is_some_and(|comparison| comparison.is_distinct())
    };
    let worse: Vec<bool> = (0..each.len()).map(|place| judged.len() == each.len() && worse(place)).collect();
    let best = each.remove(least.unwrap_or(0));
    let mut worse = worse;
    worse.remove(least.unwrap_or(0));
    let mut next = next;
    let mut rivals = Vec::new();
    for (other, worse) in each.into_iter().zip(worse) {
        match worse {
            true => next = Some(next.filter(|next| next.share() < other.share()).unwrap_or(other)),
            false => rivals.push(other),
        }
    }
    outcome.found = Some(Found { best, rivals, next, gain }.simplest_first());
    outcome
}

fn verdict(outcome: Outcome, replicated: impl Fn(&Found) -> bool) -> Option<Verdict> {
    let Outcome { start, found } = outcome;
    let found = found?;
    // From what a factor comes the logs cannot show.
    let scaled = found.best.description.scaled().next();
    let beyond_doubt = found.rivals.is_empty() && scaled.is_none() && replicated(&found);
    let alternative =
        |tried: Tried| Alternative { unexplained: tried.share(), changes: tried.description.changes.clone() };
    Some(Verdict {
        before: start.share(),
        after: found.best.share(),
        each: [start.evaluation.unexplained, found.best.evaluation.unexplained.clone()],
        alternatives: found.rivals.into_iter().map(alternative).collect(),
        next: found.next.map(alternative),
        description: found.best.description,
        factors: Vec::new(),
        beyond_doubt,
    })
}
