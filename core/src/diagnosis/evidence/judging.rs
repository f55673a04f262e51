//! Judging candidates: score test, whether the estimate can be, and the shapes at which the test is largest.

use crate::diagnosis::criteria::Judgement;
use crate::diagnosis::model::{
    Candidate, Member, Moved, Session, extent, follows_estimate, is_gap, linear, prior, shapes,
};
use crate::diagnosis::noise::Whitener;
use crate::diagnosis::regression::{Column, Projection, Test};
use crate::effects::{Parameter, Placed, Role, Search, as_size, moved};
use crate::error::Result;
use rayon::prelude::*;
use std::sync::Arc;

/// Halvings of the step in the search for a shape.
const HALVINGS: usize = 6;

/// Angles all around a joint from which the search for a shape starts: steps of 11 degrees. From the grid of all shapes, with steps of 60
/// degrees, the search ended at a strut a quarter turn away from the true one.
const ANGLES: usize = 32;

/// Times the size at which a departure's column is taken is moved to its estimate.
const SECANTS: usize = 3;

/// A candidate with its test in some whitening.
#[derive(Debug, Clone)]
pub(crate) struct Judged {
    /// The candidate.
    pub candidate: Candidate,
    /// Its columns, whitened.
    pub whitened: Vec<Column>,
    /// Its test.
    pub test: Test,
}

impl Judged {
    /// The candidate as part of the model.
    pub(crate) fn member(&self) -> Member {
        Member::new(&self.candidate, &self.test.values)
    }

    /// Logarithm of the probability by chance, by which shapes and forms of one family compare; that of a form that is not the usual one
    /// must be lower by `log_odds`.
    pub(super) fn likeliness(&self, log_odds: f64) -> f64 {
        let placed = &self.candidate.placed;
        let unusual =
            |(parameter, value): (&Parameter, &f64)| parameter.role == Role::Held && *value != parameter.typical;
        let is_unusual = placed.effect.parameters().iter().zip(&placed.parameters).any(unusual);
        self.test.log_p() + if is_unusual { log_odds } else { 0.0 }
    }
}

impl Session<'_> {
    /// Tests a candidate; None where it is not separable from what the fit has, or its estimate makes no sense.
    pub(crate) fn judge(&self, candidate: &Candidate, whitener: &Whitener, fit: &Projection) -> Option<Judged> {
        self.tested(candidate, whitener, fit).ok()
    }

    /// Tests a candidate; else the logarithm of the probability of as good a fit by chance and the gate that its estimate fails, None where
    /// it is not separable from what the fit has.
    pub(super) fn tested(
        &self,
        candidate: &Candidate,
        whitener: &Whitener,
        fit: &Projection,
    ) -> std::result::Result<Judged, Option<(f64, Judgement)>> {
        let mut candidate = candidate.clone();
        let mut whitened = whitener.apply_all(&candidate.columns);
        let effect = candidate.placed.effect;
        let spread = prior(&candidate.placed, self.model.base.robot());
        let mut as_a_whole = None;
        loop {
            let test = fit.test_with_prior(&whitened, &spread).ok_or(as_a_whole)?;
            if !test.values.iter().all(|value| value.is_finite()) {
                return Err(as_a_whole);
            }
            let failed = self.out_of_bounds(&candidate, &test);
            if failed.is_none() {
                return match self.unbelievable(&candidate, &test) {
                    None => Ok(Judged { candidate, whitened, test }),
                    Some(failed) => Err(as_a_whole.or(Some((test.log_p(), failed)))),
                };
            }
            as_a_whole = as_a_whole.or(failed.map(|failed| (test.log_p(), failed)));
            // An amplitude beyond its bound is one that is not there; the others may do without it.
            let parameters = effect.parameters();
            let beyond = linear(effect).into_iter().enumerate().filter(|(k, index)| {
                let Parameter { role, lower, upper, .. } = parameters[*index];
                let there = role == Role::Amplitude && !whitened[*k].parts.is_empty();
                there && lower <= 0.0 && upper >= 0.0 && !(lower..=upper).contains(&test.values[*k])
            });
            let sure = |k: usize| (test.values[k] / test.std[k]).abs();
            let worst = beyond.max_by(|(a, _), (b, _)| sure(*a).total_cmp(&sure(*b)));
            let (worst, _) = worst.ok_or(as_a_whole)?;
            Arc::make_mut(&mut candidate.columns)[worst] = Column::default();
            whitened[worst] = Column::default();
            if !whitened.iter().any(Column::is_sound) {
                return Err(as_a_whole);
            }
        }
    }

    /// Tests effects at the parameters of each of `placed`.
    fn judged_at(
        &self,
        placed: &[Placed],
        log: Option<usize>,
        whitener: &Whitener,
        fit: &Projection,
    ) -> Result<Vec<Option<Judged>>> {
        let columns = self.logs.train.columns(&self.model.arm, log, placed, Moved::Tested)?;
        let candidates = placed.par_iter().cloned().zip(columns);
        let judged = candidates.map(|(placed, columns)| self.judge(&Candidate { placed, log, columns }, whitener, fit));
        Ok(judged.collect())
    }

    /// A candidate in the form of its law that is the likeliest, with its shapes and sizes where its test is largest.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub(crate) fn refined(&self, start: Judged, whitener: &Whitener, fit: &Projection) -> Result<Judged> {
        let start = self.turned(start, whitener, fit)?;
        let (placed, log) = (start.candidate.placed.clone(), start.candidate.log);
        let mut best = self.refined_in_form(start, whitener, fit)?;
        for index in 0..placed.effect.parameters().len() {
            for value in placed.effect.forms(index).iter().filter(|value| **value != placed.parameters[index]) {
                let mut other = placed.clone();
                other.parameters[index] = *value;
                let start = self.judged_at(&[other], log, whitener, fit)?;
                let Some(start) = start.into_iter().next().flatten() else { continue };
                let refined = self.refined_in_form(start, whitener, fit)?;
                let log_odds = self.criteria.levels.log_odds;
                if refined.likeliness(log_odds) < best.likeliness(log_odds) {
                    best = refined;
                }
            }
        }
        Ok(best)
    }

    /// A candidate at the angle about its joint at which its test is largest, where its law has one.
    fn turned(&self, start: Judged, whitener: &Whitener, fit: &Projection) -> Result<Judged> {
        let effect = start.candidate.placed.effect;
        let Some(angle) = shapes(effect).into_iter().find(|&index| effect.search(index) == Search::Angle) else {
            return Ok(start);
        };
        let Parameter { lower, upper, .. } = effect.parameters()[angle];
        let turned = |k: usize| {
            let mut placed = start.candidate.placed.clone();
            placed.parameters[angle] = lower + (upper - lower) * (k as f64 + 0.5) / ANGLES as f64;
            placed
        };
        let all: Vec<Placed> = (0..ANGLES).map(turned).collect();
        let all = self.judged_at(&all, start.candidate.log, whitener, fit)?.into_iter().flatten();
        let likeliest = |a: &Judged, b: &Judged| a.test.log_p().total_cmp(&b.test.log_p());
        let turned = all.min_by(likeliest).filter(|turned| likeliest(turned, &start).is_lt());
        Ok(turned.unwrap_or(start))
    }

    /// Moves the shapes and sizes of a candidate to where its test is largest.
    fn refined_in_form(&self, start: Judged, whitener: &Whitener, fit: &Projection) -> Result<Judged> {
        let effect = start.candidate.placed.effect;
        let (log, joint) = (start.candidate.log, start.candidate.placed.joint);
        let mut best = start;
        let gaps = linear(effect).into_iter().filter(|index| is_gap(effect, *index));
        let shapes: Vec<usize> = shapes(effect).into_iter().chain(gaps).collect();
        let extent = extent(&self.logs.train.rows, joint);
        let mut share = 0.25;
        for _ in 0..HALVINGS {
            for &index in &shapes {
                let sideways = |sign: f64| {
                    let mut placed = best.candidate.placed.clone();
                    let value = &mut placed.parameters[index];
                    let wanted = moved(effect, index, *value, sign * share);
                    *value = extent.within_bounds(effect, index, wanted);
                    effect.is_sensible(&placed.parameters).then_some(placed)
                };
                // Both sides at once: most steps succeed on neither.
                let sides: Vec<Placed> = [1.0, -1.0].into_iter().filter_map(sideways).collect();
                let judged = self.judged_at(&sides, log, whitener, fit)?;
                let better = |judged: &Judged| judged.test.statistic > best.test.statistic;
                if let Some(judged) = judged.into_iter().flatten().find(better) {
                    best = judged;
                }
            }
            share *= 0.5;
            if shapes.is_empty() {
                break;
            }
        }
        let follows = linear(effect).into_iter().any(|index| follows_estimate(effect, index));
        for _ in 0..if follows { SECANTS } else { 0 } {
            let mut placed = best.candidate.placed.clone();
            for (&index, &value) in linear(effect).iter().zip(&best.test.values) {
                placed.parameters[index] = as_size(&effect.parameters()[index], value);
            }
            match self.judged_at(&[placed], log, whitener, fit)?.into_iter().next().flatten() {
                Some(judged) => best = judged,
                None => break,
            }
        }
        Ok(best)
    }
}
