//! The tests of all candidates against one fit.

use super::judging::Judged;
use super::multiplicity::{Multiplicity, Scanned};
use crate::diagnosis::criteria::Judgement;
use crate::diagnosis::model::{Candidate, Family, Session, Slot, is_shift, linear};
use crate::diagnosis::noise::Whitener;
use crate::diagnosis::regression::{Column, Projection};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::sync::OnceLock;

/// From which size on a scan sees a family.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sensitivity {
    /// Index of its first linear parameter.
    pub index: usize,
    /// Standard deviation of that.
    pub std: f64,
    /// Its value at which the torque of the effect matters.
    pub floor: f64,
}

/// The tests of all candidates against one fit.
#[derive(Debug)]
pub(crate) struct Scan {
    judged: Vec<Judged>,
    /// The likeliest of every family among those whose estimate makes no sense: logarithm of its probability by chance, and the gate.
    impossible: BTreeMap<Slot, (f64, Judgement)>,
    /// Which of them may be a name: all but lags and delays that are not significant once adjusted for errors in variables. These look
    /// more significant than anything where encoders are coarse, and would be alternatives to every finding.
    stand: Vec<bool>,
    /// Whether a change is looked for, which may go either way.
    change: bool,
    /// Least difference of the logarithms of two likelihoods at which an unusual form is preferred.
    log_odds: f64,
}

impl Scan {
    /// Tests all candidates; those that are not separable from the model or make no sense are left out.
    pub(crate) fn new(session: &Session, all: &[Candidate], whitener: &Whitener, fit: &Projection) -> Self {
        let tested: Vec<_> = all.par_iter().map(|candidate| session.tested(candidate, whitener, fit)).collect();
        let (mut judged, mut impossible) = (Vec::with_capacity(tested.len()), BTreeMap::new());
        for (candidate, tested) in all.iter().zip(tested) {
            match tested {
                Ok(one) => judged.push(one),
                Err(Some(failed)) => {
                    let likeliest = impossible.entry(candidate.slot()).or_insert(failed);
                    if failed.0 < likeliest.0 {
                        *likeliest = failed;
                    }
                }
                Err(None) => {}
            }
        }
        let adjusted_for_errors = OnceLock::new();
        let stands = |judged: &Judged| {
            let placed = &judged.candidate.placed;
            if !is_shift(placed.effect) {
                return true;
            }
            // The errors are the same for all of them.
            let fit: &Projection = adjusted_for_errors
                .get_or_init(|| session.errors_with(&session.logs.train, placed).adjust(fit, whitener));
            fit.test(&judged.whitened).is_some_and(|test| test.log_p() < session.criteria.levels.sure_p.ln())
        };
        let stand = judged.iter().map(stands).collect();
        let (change, log_odds) = (session.logs.train.rows.of_change(), session.criteria.levels.log_odds);
        Scan { judged, impossible, stand, change, log_odds }
    }

    /// Gives back the memory of tests that no longer count.
    pub(crate) fn clear(&mut self) {
        (self.judged, self.stand) = (Vec::new(), Vec::new());
        self.impossible.clear();
    }

    /// How many independent tests the scan is worth.
    pub(crate) fn multiplicity(&self, fit: &Projection, whitener: &Whitener, seed: u64) -> Multiplicity {
        let scanned: Vec<Scanned> = self
            .judged
            .iter()
            .map(|one| Scanned {
                kind: one.candidate.family().effect,
                columns: &one.whitened,
                test: &one.test,
                one_sided: one.candidate.one_sided() && !self.change,
            })
            .collect();
        Multiplicity::new(fit, &scanned, &whitener.rows(), seed)
    }

    /// The likeliest candidate that may be a name of every family, the best first.
    pub(crate) fn best_per_family(&self) -> Vec<&Judged> {
        let mut best: BTreeMap<Slot, &Judged> = BTreeMap::new();
        for (judged, _) in self.judged.iter().zip(&self.stand).filter(|(_, stands)| **stands) {
            let place = best.entry(judged.candidate.slot()).or_insert(judged);
            if judged.likeliness(self.log_odds) < place.likeliness(self.log_odds) {
                *place = judged;
            }
        }
        let mut best: Vec<&Judged> = best.into_values().collect();
        best.sort_by(|a, b| a.test.log_p().total_cmp(&b.test.log_p()));
        best
    }

    /// The candidates whose statistic is at least `least`.
    pub(crate) fn reaching(&self, least: f64) -> impl Iterator<Item = &Candidate> {
        self.judged.iter().filter(move |judged| judged.test.statistic >= least).map(|judged| &judged.candidate)
    }

    /// The likeliest candidate of some families: of those that may be names, else of all.
    pub(crate) fn likeliest_of(&self, families: &[Family]) -> Option<&Judged> {
        let is_wanted = |judged: &&Judged| families.contains(&judged.candidate.family());
        let likeliest = |a: &&Judged, b: &&Judged| a.test.log_p().total_cmp(&b.test.log_p());
        let named = self.best_per_family().into_iter().find(is_wanted);
        named.or_else(|| self.judged.iter().filter(is_wanted).min_by(likeliest))
    }

    /// What is likelier than all candidates of its family that can be, and has an estimate that cannot: logarithm of the probability by
    /// chance, and the gate that it fails.
    pub(crate) fn impossible(&self) -> Vec<(Slot, f64, Judgement)> {
        let mut possible: BTreeMap<Slot, f64> = BTreeMap::new();
        for judged in &self.judged {
            let best = possible.entry(judged.candidate.slot()).or_insert(f64::INFINITY);
            *best = best.min(judged.test.log_p());
        }
        let all = self.impossible.iter().map(|(slot, (log_p, failed))| (*slot, *log_p, *failed));
        all.filter(|(slot, log_p, _)| possible.get(slot).is_none_or(|best| log_p + self.log_odds < *best)).collect()
    }

    /// The sensitivity to every family, where its grid has the smallest standard deviation. `floor` gives the size from which a torque
    /// matters, by that per unit.
    pub(crate) fn sensitivity(&self, floor: impl Fn(&Column) -> f64) -> BTreeMap<Family, Sensitivity> {
        let mut smallest: BTreeMap<Family, (usize, f64, &Column)> = BTreeMap::new();
        for Judged { candidate, test, .. } in &self.judged {
            let own = (linear(candidate.placed.effect)[0], test.std[0], &candidate.columns[0]);
            let place = smallest.entry(candidate.family()).or_insert(own);
            if own.1 > 0.0 && own.1 < place.1 {
                *place = own;
            }
        }
        let of = |(family, (index, std, column))| (family, Sensitivity { index, std, floor: floor(column) });
        smallest.into_iter().map(of).collect()
    }
}

/// The likeliest candidate of a family and its test.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// # use tauscope::diagnosis::Diagnosis;
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Ignored)?;
/// # let log = |name: &str| recording::load(format!("../tests/reference/pendulum/{name}.csv"), None);
/// # let (train, test) = (log("train")?, log("test")?);
/// # let answer = Diagnosis::of(&robot).train([&train]).test([&test]).candidates(["torque_ripple"]).run()?;
/// # let diagnosis = answer.diagnosis().expect("the logs are good");
///
/// // Before anything was found, a ripple explained most.
/// let best = &diagnosis.evidence.ranking[0];
/// assert_eq!(best.family.effect, "torque_ripple");
/// assert!(best.log_p < -20.0 && best.statistic > best.freedom as f64);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Ranked {
    /// What and where.
    pub family: Family,
    /// Whitened sum of squares it takes: chi-square without the effect.
    pub statistic: f64,
    /// Degrees of freedom of that.
    pub freedom: usize,
    /// Logarithm of the probability of as much without the effect, not corrected for the number of candidates.
    pub log_p: f64,
}

/// The tests of a scan, one per family, the best first.
pub(crate) fn ranking(scan: &Scan) -> Vec<Ranked> {
    scan.best_per_family()
        .into_iter()
        .map(|judged| Ranked {
            family: judged.candidate.family(),
            statistic: judged.test.statistic,
            freedom: judged.test.freedom,
            log_p: judged.test.log_p(),
        })
        .collect()
}
