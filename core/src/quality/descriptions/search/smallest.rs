//! The search for the smallest set of changes that explains all logs.
//!
//! Sets grow by one change at a time. Those of one size are sorted by a fit of all rows, the best are judged on held-out
//! blocks, and a set replaces a smaller one only where the paired comparison finds it clearly better. Sets of the same size
//! that are not separable from the best are its rivals.

use super::found::Found;
use super::mirrored::or_mirrored;
use super::needed;
use crate::quality::descriptions::change::Description;
use crate::quality::descriptions::compare::{Comparison, EXPLAINED, EXPLAINED_ALONE, compare};
use crate::quality::descriptions::fitting::{Fit, Physics, Rows};
use crate::quality::descriptions::jumps::contradicts;
use crate::quality::descriptions::known::Known;
use crate::quality::descriptions::shares::ALIKE;
use crate::quality::descriptions::sizes::factors;
use crate::quality::descriptions::sizes::tilt;
use crate::quality::descriptions::sizes::zeros;
use crate::quality::descriptions::tried::Tried;
use nalgebra::Vector3;
use rayon::prelude::*;

/// Most changes of a set. Each must be clearly better than the set without it, so that only logs with as many faults come here.
const MOST: usize = 6;

/// Sets of one size that are judged on held-out blocks.
const JUDGED: usize = 8;

/// Sets of one size that are grown, whether or not they are clearly better: two changes may only help together.
const GROWN: usize = 3;

/// Gain over the best so far from which a set that is not clearly better is grown all the same ..
const PROMISING: f64 = 0.3;

/// .. by so many changes in a row.
const PATIENCE: usize = 2;

/// Where the residual share of every torque is below this, nothing is wrong with the description.
pub(in crate::quality::descriptions) const CLEAN: f64 = 0.04;

/// The outcome of a search.
pub(in crate::quality::descriptions) struct Outcome {
    /// The logs as they are.
    pub start: Tried,
    /// What explains them clearly better.
    pub found: Option<Found>,
    /// Gravity of a base that is tilted a little, in base coordinates, m/s2, where that was found alone: it is asked of the physics.
    pub tilt: Option<Vector3<f64>>,
}

impl Found {
    /// The same without tilts of the base that are asked of the physics; none where there is nothing else.
    fn without_tilts(mut self, physics: &Physics, rows: &Rows, start: &Tried) -> Option<Found> {
        let gravity = start.description.gravity;
        if let Some(description) = tilt::without_tilt(&self.best.description, gravity) {
            if description.same_as(&start.description) {
                return None;
            }
            self.best = Tried::new(physics, rows, description)?;
            self.gain = compare(&start.evaluation, &self.best.evaluation, &rows.log)?;
        }
        let is_other = |rival: &Tried| {
            let rest = tilt::without_tilt(&rival.description, gravity);
            rest.is_none_or(|rest| !rest.same_as(&self.best.description))
        };
        self.rivals.retain(is_other);
        Some(self)
    }

    /// The same with the simplest of the best and its rivals in front.
    pub(in crate::quality::descriptions) fn simplest_first(mut self) -> Found {
        let rank = |tried: &Tried| tried.description.changes.iter().map(|change| change.rank()).sum::<usize>();
        for rival in &mut self.rivals {
            if rank(rival) < rank(&self.best) {
                std::mem::swap(rival, &mut self.best);
            }
        }
        self
    }
}

/// Searches from the description `start` under what is `known` of the arm.
/// `with_motion` are the torques that jump with the motion at reversals.
pub(in crate::quality::descriptions) fn search(
    known: Known,
    rows: &Rows,
    with_motion: &[bool],
    start: Description,
) -> Option<Outcome> {
    let physics = known.physics;
    let start = Tried::new(physics, rows, start)?;
    let explained = |tried: &Tried| tried.evaluation.unexplained.iter().flatten().all(|share| *share < CLEAN);
    let mut found: Option<Found> = None;
    if explained(&start) {
        return Some(Outcome { start, found, tilt: None });
    }
    let (mut seen, mut grown) = (vec![start.description.clone()], vec![start.description.clone()]);
    let whole = rows.whole();
    let (mut tried, mut without_gain) = (0, 0);
    // The largest gain of a smaller set, whether or not that was credible: more changes that explain less are not the cause.
    let mut of_smaller = 0.0;
    for size in 0..MOST {
        let mut candidates: Vec<Description> = Vec::new();
        // A factor that this search found takes a torque out of the fit of the others.
        let as_scaled = grown.iter().filter(|from| from.torque_scale == start.description.torque_scale);
        for next in as_scaled.flat_map(|from| from.neighbours(&rows.measured, !matches!(physics, Physics::Alone))) {
            let known = seen.iter().chain(&candidates).any(|other| other.same_as(&next));
            if !known && !contradicts(with_motion, &next) {
                candidates.push(next);
            }
        }
        if size == 0 && matches!(physics, Physics::Free(_)) {
            candidates.extend(tilt::free_directions(physics, &whole, &start.description));
        }
        if size == 0 && matches!(physics, Physics::Free(_) | Physics::Bodies(_)) {
            candidates.extend(tilt::tilted(physics, &whole, &start.description));
        }
        // Where joints move in turns, few blocks show to free bodies which is which; those described know their sizes.
        if size == 0 && !matches!(physics, Physics::Alone) {
            candidates.extend(start.description.in_reverse_order(&rows.measured));
        }
        // A factor or an offset takes many fits: only the best is grown by one.
        let sized = |from: &Description| {
            let factors = factors::of_single_joints(physics, &whole, from, &start.description);
            [factors, zeros::of_single_joints(physics, &whole, from)].concat()
        };
        for next in grown.first().map_or(Vec::new(), sized) {
            if !seen.iter().chain(&candidates).any(|other| other.same_but_for_sizes(&next)) {
                candidates.push(next);
            }
        }
        tried += candidates.len();
        let mut judged = judged(physics, [rows, &whole], &candidates, &start);
        refine(physics, [rows, &whole], &mut judged, &start);
        seen.extend(candidates);
        grown = judged.iter().take(GROWN).map(|(tried, _)| tried.description.clone()).collect();
        let reached = found.as_ref().map_or(0.0, |found| found.gain.gain);
        let own = judged.first().map_or(0.0, |(_, gain)| gain.gain);
        let (promising, explains_more) = (own > reached + PROMISING, own > of_smaller);
        of_smaller = own.max(of_smaller);
        let reference = found.as_ref().map_or(&start, |found| &found.best);
        let better = chosen(judged, &known, (reference, found.is_none()), rows, tried).filter(|_| explains_more);
        match better {
            Some(better) => (found, without_gain) = (Some(better), 0),
            None if !promising || without_gain == PATIENCE => break,
            None => without_gain += 1,
        }
        if found.as_ref().is_some_and(|found| explained(&found.best)) {
            break;
        }
    }
    let found = found.map(|found| needed::only(physics, [rows, &whole], &start, found));
    let found = found.map(|found| or_mirrored(&known, [rows, &whole], &start, found));
    let gravity = found.as_ref().map(|found| found.best.description.gravity);
    let rest = found.and_then(|found| found.without_tilts(physics, rows, &start));
    let tilt = gravity.filter(|_| rest.is_none());
    Some(Outcome { start, found: rest, tilt })
}

/// The best candidates with their gains over the start, the best first; the rows are those in blocks, and whole.
fn judged(
    physics: &Physics,
    [rows, whole]: [&Rows; 2],
    candidates: &[Description],
    start: &Tried,
) -> Vec<(Tried, Comparison)> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for place in 0..candidates.len() {
        match groups.iter_mut().find(|group| candidates[group[0]].same_motion(&candidates[place])) {
            Some(group) => group.push(place),
            None => groups.push(vec![place]),
        }
    }
    let merits = |group: &Vec<usize>| -> Vec<(usize, f64)> {
        let tables = physics.tables(whole, &candidates[group[0]]);
        let merit = |&place: &usize| Some((place, Fit::new(&tables, whole, &candidates[place]).merit()?));
        group.iter().filter_map(merit).collect()
    };
    let mut order: Vec<(usize, f64)> = groups.par_iter().map(merits).collect::<Vec<_>>().concat();
    // Of equal merit, the simplest kind of change first.
    order.sort_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
    order.truncate(JUDGED);
    order.sort_by_key(|(place, _)| *place);
    let judge = |&(place, _): &(usize, f64)| {
        let tried = Tried::new(physics, rows, candidates[place].clone())?;
        // A torque that is given the motion of a joint at rest is not explained: it only drops out.
        let lacks = |(before, after): (&Option<f64>, &Option<f64>)| before.is_some() && after.is_none();
        if start.evaluation.unexplained.iter().zip(&tried.evaluation.unexplained).any(lacks) {
            return None;
        }
        let gain = compare(&start.evaluation, &tried.evaluation, &rows.log)?;
        Some((tried, gain))
    };
    let mut judged: Vec<(Tried, Comparison)> = order.par_iter().filter_map(judge).collect();
    judged.sort_by(|a, b| b.1.gain.total_cmp(&a.1.gain));
    for (tried, gain) in &judged {
        let changes = &tried.description.changes;
        tracing::debug!(?changes, unexplained = ?tried.evaluation.unexplained, gain = gain.gain, p = gain.p, "judged");
    }
    judged
}

/// Fits the zeros of the best again, which were fitted before the last change was added; the best first.
fn refine(physics: &Physics, [rows, whole]: [&Rows; 2], judged: &mut [(Tried, Comparison)], start: &Tried) {
    let better = |(tried, gain): &(Tried, Comparison)| {
        let refined = zeros::refined(physics, whole, &tried.description)?;
        let own = Tried::new(physics, rows, refined)?;
        let own_gain = compare(&start.evaluation, &own.evaluation, &rows.log)?;
        (own_gain.gain > gain.gain).then_some((own, own_gain))
    };
    for own in judged.iter_mut().take(GROWN) {
        if let Some(refined) = better(own) {
            *own = refined;
        }
    }
    judged.sort_by(|a, b| b.1.gain.total_cmp(&a.1.gain));
}

/// The best of the judged ones that is clearly better than `reference`, with its rivals and the next. Of the `first` changes that are not
/// separable from the very best, another may be what is known of the arm otherwise; a change to what explains the torques already must be
/// the best.
fn chosen(
    mut judged: Vec<(Tried, Comparison)>,
    known: &Known,
    (reference, first): (&Tried, bool),
    rows: &Rows,
    tried: usize,
) -> Option<Found> {
    let limit = if matches!(known.physics, Physics::Alone) { EXPLAINED_ALONE } else { EXPLAINED };
    let is_credible = |own: &Tried| {
        let Some(top) = compare(&reference.evaluation, &own.evaluation, &rows.log) else { return false };
        let explains = |channel: usize| own.evaluation.unexplained[channel].is_some_and(|share| share < limit);
        let gains = |channel: usize| top.channels[channel].unwrap_or(f64::NEG_INFINITY);
        let most = (0..top.channels.len()).max_by(|&a, &b| gains(a).total_cmp(&gains(b)));
        // What leaves most of the torques unexplained is not the arm's.
        let of_the_arm = matches!(known.physics, Physics::Alone) || own.share() < ALIKE;
        of_the_arm
            && top.is_better(tried, limit)
            && most.is_some_and(explains)
            && known.supports(reference, own, &top, rows)
    };
    let distinct = |other: &Tried, best: &Tried| {
        compare(&other.evaluation, &best.evaluation, &rows.log).is_none_or(|worse| worse.is_distinct())
    };
    let top = &judged.first()?.0;
    let place = (0..judged.len()).find(|&place| {
        let own = &judged[place].0;
        (place == 0 || first && !distinct(own, top)) && is_credible(own)
    })?;
    let (best, gain) = judged.remove(place);
    let (mut rivals, mut next) = (Vec::new(), None);
    for (other, _) in judged {
        match distinct(&other, &best) {
            false => rivals.push(other),
            true if next.is_none() => next = Some(other),
            true => {}
        }
    }
    Some(Found { best, rivals, next, gain, is_determined: true }.simplest_first())
}
