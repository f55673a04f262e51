//! The family-wise level of the best of many tests: what each kind of effect is worth in tests, found by sending noise through
//! the scan.
//!
//! A ripple is looked for at many orders on every joint and a contact at every time, a tilted base once. Were all tests held to
//! one threshold, the many would pay for little and the few for everything: the level is shared among the kinds in equal parts,
//! each kind's part among its own tests (weighted Bonferroni; Genovese, Roeder and Wasserman, Biometrika 93, 2006).

use super::judging::Judged;
use crate::diagnosis::regression::{Column, Projection, Test, log_survival};
use crate::linear::product_of;
use crate::random;
use nalgebra::DMatrix;
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Draws of noise from which the level of the best of many tests is found.
const DRAWS: usize = 200;

/// Groups of columns that noise is sent through at once.
const AT_ONCE: usize = 24;

/// Probabilities above this hold no information on the tail: one-sided tests have none in half of all draws.
const TAIL: f64 = 0.5;

/// Fewest tests that a kind can be worth: one that is one-sided.
const FEWEST: f64 = 0.5;

/// A group of columns in a scan.
#[derive(Debug)]
pub(super) struct Scanned<'a> {
    /// Name of the effect.
    pub kind: &'static str,
    /// Its columns, whitened.
    pub columns: &'a [Column],
    /// Its test.
    pub test: &'a Test,
    /// Whether only positive values make sense of its only column.
    pub one_sided: bool,
}

/// How many independent tests a scan is worth, kind by kind.
#[derive(Debug, Clone)]
pub(crate) struct Multiplicity {
    /// Tests of each kind.
    of_kind: BTreeMap<&'static str, f64>,
    /// How many independent kinds there are.
    kinds: f64,
}

impl Multiplicity {
    /// From the groups of a scan adjusted for `fit`, with so many whitened `rows` of each joint: noise is sent through all of them,
    /// and the smallest probability of each kind taken from each draw. With m independent tests -ln(1 - p_min) is exponential
    /// with rate m, of which the maximum-likelihood estimate carries the level into tails that no number of draws would reach.
    pub(super) fn new(fit: &Projection, scanned: &[Scanned], rows: &[usize], seed: u64) -> Self {
        let noise: Vec<DMatrix<f64>> = rows
            .iter()
            .enumerate()
            .map(|(joint, &count)| {
                let mut source = random::stream(seed, "level of the scan", joint as u64);
                DMatrix::from_fn(count, DRAWS, |_, _| StandardNormal.sample(&mut source))
            })
            .collect();
        let basis = fit.basis();
        let along_basis = through(&noise, &basis.iter().collect::<Vec<_>>(), &vec![1.0; basis.len()]);
        let smallest = scanned
            .par_chunks(AT_ONCE)
            .flat_map_iter(|groups| {
                let columns: Vec<&Column> = groups.iter().flat_map(|one| one.columns).collect();
                let norms: Vec<f64> = groups.iter().flat_map(|one| one.test.norms.iter().copied()).collect();
                let through = through(&noise, &columns, &norms);
                let mut first = 0;
                let along_basis = &along_basis;
                groups.iter().map(move |one| {
                    let own = through.rows(first, one.columns.len());
                    first += one.columns.len();
                    BTreeMap::from([(one.kind, one.log_p(own.into_owned(), along_basis))])
                })
            })
            .reduce(BTreeMap::new, |mut all, other| {
                for (kind, log_p) in other {
                    let place = all.entry(kind).or_insert_with(|| vec![0.0; DRAWS]);
                    place.iter_mut().zip(log_p).for_each(|(x, y): (&mut f64, f64)| *x = x.min(y));
                }
                all
            });
        let of_kind: BTreeMap<&'static str, f64> =
            smallest.iter().map(|(kind, log_p)| (*kind, rate(log_p).max(FEWEST))).collect();
        let best: Vec<f64> = (0..DRAWS)
            .map(|draw| {
                let each = smallest.iter().map(|(kind, log_p)| family_wise(log_p[draw], of_kind[kind]).ln());
                each.fold(0.0, f64::min)
            })
            .collect();
        Multiplicity { of_kind, kinds: rate(&best).max(1.0) }
    }

    /// How many independent tests an effect has to be compared with.
    pub(crate) fn tests(&self, kind: &str) -> f64 {
        self.kinds * self.of_kind.get(kind).copied().unwrap_or(1.0)
    }

    /// How many independent tests of one kind there are, one at the least: places and shapes of a law.
    pub(crate) fn of_kind(&self, kind: &str) -> f64 {
        self.of_kind.get(kind).map_or(1.0, |tests| tests.max(1.0))
    }

    /// Probability that the best of all kinds is as good without any effect, where one of this kind has `log_p`.
    pub(crate) fn level(&self, kind: &str, log_p: f64) -> f64 {
        family_wise(log_p, self.tests(kind))
    }

    /// Twice the logarithm of [`Multiplicity::tests`]: by how much what is looked for in many places must fit better, in terms of
    /// an information criterion.
    pub(crate) fn looked_for(&self, kind: &str) -> f64 {
        2.0 * self.tests(kind).ln()
    }

    /// Logarithm of how often something as good as this is expected among all without any effect.
    pub(crate) fn expected(&self, judged: &Judged) -> f64 {
        judged.test.log_p() + 0.5 * self.looked_for(judged.candidate.family().effect)
    }

    /// How many independent tests all kinds are worth.
    pub(crate) fn all(&self) -> f64 {
        self.of_kind.values().sum()
    }
}

impl Scanned<'_> {
    /// Logarithm of the probability of the test of each draw of noise, whose inner products with the columns are those of `through`, and
    /// with the directions of the fit those `along_basis`.
    fn log_p(&self, through: DMatrix<f64>, along_basis: &DMatrix<f64>) -> Vec<f64> {
        let right = through - self.test.along.tr_mul(along_basis);
        let scores = self.test.directions.tr_mul(&right);
        let of = |draw: usize| match self.one_sided && right[(0, draw)] < 0.0 {
            true => 0.0,
            false => log_survival(scores.column(draw).norm_squared(), self.test.freedom),
        };
        (0..DRAWS).map(of).collect()
    }
}

/// Inner products of columns over their norms with every draw of noise (`[joint]`, row by draw).
fn through(noise: &[DMatrix<f64>], columns: &[&Column], norms: &[f64]) -> DMatrix<f64> {
    let mut sum = DMatrix::zeros(columns.len(), DRAWS);
    for (joint, noise) in noise.iter().enumerate() {
        let parts: Vec<(usize, &[f64])> =
            columns.iter().enumerate().filter_map(|(k, column)| Some((k, column.part(joint)?))).collect();
        if parts.is_empty() {
            continue;
        }
        let table: Vec<f64> = parts.iter().flat_map(|(_, part)| part.iter().copied()).collect();
        let product = product_of(&table, noise.as_slice(), noise.nrows(), [parts.len(), DRAWS]);
        for (r, (k, _)) in parts.iter().enumerate() {
            for draw in 0..DRAWS {
                sum[(*k, draw)] += product[(r, draw)] / norms[*k];
            }
        }
    }
    sum
}

/// Rate of the exponential law that -ln(1 - p) follows in its tail: the others are only known to be smaller there.
fn rate(log_p: &[f64]) -> f64 {
    let censored = -(-TAIL).ln_1p();
    let seen = log_p.iter().filter(|log_p| log_p.exp() < TAIL).count();
    let sum: f64 = log_p.iter().map(|log_p| (-(-log_p.exp()).ln_1p()).min(censored)).sum();
    seen as f64 / sum
}

/// Probability that the best of so many independent tests is as good without any effect.
pub(crate) fn family_wise(log_p: f64, tests: f64) -> f64 {
    -(tests * (-log_p.exp().min(1.0 - 1e-15)).ln_1p()).exp_m1()
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROWS: usize = 600;

    fn wave(k: usize) -> Column {
        let values = (0..ROWS).map(|t| (k as f64 * t as f64 * std::f64::consts::PI / ROWS as f64).cos());
        Column::on(0, values.collect())
    }

    /// A scan of waves, each of a kind.
    fn scan(waves: &[(&'static str, usize)], one_sided: bool) -> Multiplicity {
        let fit = Projection::new(&[wave(0)], &wave(0));
        let columns: Vec<Vec<Column>> = waves.iter().map(|(_, k)| vec![wave(*k)]).collect();
        let tests: Vec<Test> = columns.iter().map(|c| fit.test(c).unwrap()).collect();
        let each = waves.iter().zip(&columns).zip(&tests);
        let scanned: Vec<Scanned> =
            each.map(|(((kind, _), columns), test)| Scanned { kind, columns, test, one_sided }).collect();
        Multiplicity::new(&fit, &scanned, &[ROWS], 1)
    }

    #[test]
    fn orthogonal_tests_count_one_by_one_and_copies_once() {
        let many: Vec<(&str, usize)> = (1..=50).map(|k| ("a", k)).collect();
        let scan_of_many = scan(&many, false);
        assert!((40.0..63.0).contains(&scan_of_many.tests("a")), "{scan_of_many:?}");
        assert!((40.0..63.0).contains(&scan_of_many.of_kind("a")) && scan_of_many.of_kind("none") == 1.0);
        assert!(scan(&[("a", 4); 50], false).tests("a") < 1.3);
    }

    #[test]
    fn tests_of_one_side_count_half() {
        let six: Vec<(&str, usize)> = (1..=6).map(|k| ("a", k)).collect();
        let [both, one] = [false, true].map(|one_sided| scan(&six, one_sided).tests("a"));
        assert!((4.5..7.8).contains(&both) && (2.2..3.9).contains(&one), "{both} {one}");
        // Half a test is one all the same where it divides prior odds.
        assert_eq!(scan(&six[..1], true).of_kind("a"), 1.0);
    }

    #[test]
    fn many_tests_of_one_kind_leave_the_others_their_part() {
        let kinds: Vec<(&str, usize)> = (1..=60).map(|k| ("many", k)).chain([("few", 61)]).collect();
        let scan = scan(&kinds, false);
        assert!((1.3..3.0).contains(&scan.tests("few")), "{scan:?}");
        assert!((80.0..180.0).contains(&scan.tests("many")), "{scan:?}");
        assert!((scan.level("few", 0.01f64.ln()) - (1.0 - 0.99f64.powf(scan.tests("few")))).abs() < 1e-12);
        assert!((50.0..75.0).contains(&scan.all()));
    }
}
