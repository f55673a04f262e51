//! A search over the box of an encoding: CMA-ES from the best of some random points, with several starts.
//!
//! CMA-ES (N. Hansen and A. Ostermeier, Completely derandomized self-adaptation in evolution strategies, Evolutionary
//! Computation 9(2), 2001) is that of the crate `fcmaes-core`. Candidates of a generation are evaluated in parallel and
//! compared in their order, so a search that ends by its evaluations returns the same motion for the same seed on any
//! number of threads.

use super::envelope::Violation;
use super::problem::Worth;
use crate::excitation::Motion;
use crate::excitation::encoding::{Encoding, random_point};
use crate::random;
use fcmaes_core::{Cmaes, CmaesParams, Fitness};
use rand::Rng;
use rayon::prelude::*;

/// Random points of which the best starts a run.
const RANDOM_POINTS: usize = 60;

/// Standard deviation of the first generation, in units of the half box, from a random point and from a known one.
const FIRST_STEP: f64 = 0.3;
const REFINING_STEP: f64 = 0.05;

/// Candidates of a generation.
const POPULATION: usize = 24;

/// Penalty per square of the distance outside the box. An encoding reads such points as the nearest in the box; were they
/// clipped before CMA-ES sees them, its step size would grow without end as soon as many unknowns lie on the border.
const BOX_PENALTY: f64 = 0.01;

/// How long and from where to search.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Plan {
    /// Seed of all random numbers.
    pub seed: u64,
    /// Name of the random streams: searches with different labels are independent.
    pub label: String,
    /// Independent runs.
    pub starts: usize,
    /// Evaluations of all runs together; they end with the generation that reaches it.
    pub evaluations: usize,
    /// Where to start instead of from random points.
    pub from: Option<Vec<f64>>,
}

/// How far a search has come.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Evaluations so far.
    pub evaluations: usize,
    /// Value of the best motion inside the limits, if there is one yet.
    pub best: Option<f64>,
}

/// A point of the box with its motion and value.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Candidate {
    /// The point.
    pub x: Vec<f64>,
    /// The motion it stands for.
    pub motion: Motion,
    /// Its worth.
    pub worth: Worth,
}

/// Told after every generation; the candidate is given when it is the new best inside the limits. Returns whether to go on.
pub(crate) type Watch<'a> = dyn FnMut(Progress, Option<&Candidate>) -> bool + 'a;

/// What a search found.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Found {
    /// The best motion inside the limits; none when there was no such candidate.
    pub best: Option<Candidate>,
    /// The smallest violation seen: what stood in the way when `best` is none.
    pub least_violation: Option<Violation>,
    /// Evaluations made.
    pub evaluations: usize,
    /// Whether the search was stopped before its evaluations were used up.
    pub stopped: bool,
}

/// Minimises `worth` over the motions of `encoding`.
pub(crate) fn minimise(
    encoding: &dyn Encoding,
    worth: &(dyn Fn(&Motion) -> Worth + Sync),
    plan: &Plan,
    watch: &mut Watch,
) -> Found {
    let mut search = Search {
        encoding,
        worth,
        watch,
        found: Found { best: None, least_violation: None, evaluations: 0, stopped: false },
    };
    let starts = plan.starts.max(1);
    for start in 0..starts {
        let until = plan.evaluations * (start + 1) / starts;
        search.run(plan, start as u64, until);
        if search.found.stopped {
            break;
        }
    }
    search.found
}

struct Search<'a, 'w> {
    encoding: &'a dyn Encoding,
    worth: &'a (dyn Fn(&Motion) -> Worth + Sync),
    watch: &'a mut Watch<'w>,
    found: Found,
}

impl Search<'_, '_> {
    /// One run, which ends once `until` evaluations have been made in all.
    fn run(&mut self, plan: &Plan, start: u64, until: usize) {
        let (guess, step) = match &plan.from {
            Some(x) => (x.clone(), REFINING_STEP),
            None => {
                let label = format!("{} start {start}", plan.label);
                let points: Vec<Vec<f64>> =
                    (0..RANDOM_POINTS as u64).map(|k| random_point(self.encoding, plan.seed, &label, k)).collect();
                let values = self.evaluate(&points);
                if self.found.stopped {
                    return;
                }
                let best = (0..points.len()).min_by(|&a, &b| values[a].total_cmp(&values[b])).unwrap_or(0);
                (points[best].clone(), FIRST_STEP)
            }
        };
        let dimension = self.encoding.dimension();
        let parameters = CmaesParams {
            popsize: POPULATION as i32,
            max_evaluations: until.saturating_sub(self.found.evaluations).max(POPULATION) as u64,
            seed: random::stream(plan.seed, &format!("{} generations", plan.label), start).next_u64(),
            ..Default::default()
        };
        let unbounded = Fitness::new(dimension, 1, vec![], vec![]);
        let mut cmaes = Cmaes::new(unbounded, &guess, &[step], &parameters);
        while self.found.evaluations < until && !self.found.stopped {
            let points = cmaes.ask();
            let values = self.evaluate(&points);
            if cmaes.tell(&values) != 0 {
                break;
            }
        }
    }

    /// Values of one generation; keeps the best and reports.
    fn evaluate(&mut self, points: &[Vec<f64>]) -> Vec<f64> {
        let (encoding, worth) = (self.encoding, self.worth);
        let assessed: Vec<(Motion, Worth)> = points
            .par_iter()
            .map(|x| {
                let motion = encoding.decode(x);
                let worth = worth(&motion);
                (motion, worth)
            })
            .collect();
        let values = points.iter().zip(&assessed).map(|(x, (_, worth))| worth.value + outside_box(x)).collect();
        let mut improved = false;
        for (x, (motion, worth)) in points.iter().zip(assessed) {
            self.note_violation(worth.violation);
            let inside = worth.violation.is_none() && worth.value.is_finite();
            if inside && self.found.best.as_ref().is_none_or(|best| worth.value < best.worth.value) {
                self.found.best = Some(Candidate { x: x.clone(), motion, worth });
                improved = true;
            }
        }
        self.found.evaluations += points.len();
        let best = self.found.best.as_ref();
        let progress = Progress { evaluations: self.found.evaluations, best: best.map(|best| best.worth.value) };
        let go_on = (self.watch)(progress, best.filter(|_| improved));
        self.found.stopped |= !go_on;
        values
    }

    fn note_violation(&mut self, violation: Violation) {
        if self.found.least_violation.is_none_or(|least| violation.total() < least.total()) {
            self.found.least_violation = Some(violation);
        }
    }
}

fn outside_box(x: &[f64]) -> f64 {
    BOX_PENALTY * x.iter().map(|value| (value.abs() - 1.0).max(0.0).powi(2)).sum::<f64>()
}
