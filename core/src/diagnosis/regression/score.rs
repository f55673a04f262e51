//! Score tests of candidate columns against the residual of a fit.

use super::basis::{Basis, Mixed};
use super::column::Column;
use super::factors::{Factored, OfJoint};
use crate::linear::{OrthonormalBasis, subtract_product};
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use statrs::distribution::{ChiSquared, ContinuousCDF};
use statrs::function::gamma::ln_gamma;

/// Share of a direction's squared norm that must be orthogonal to the baseline for the direction to be testable.
const TESTABLE: f64 = 1e-5;

/// The same for a direction to count as mostly left. It chooses regressors of slow noise, not findings.
const MOSTLY_LEFT: f64 = 0.3;

/// Share of a factor's direction that must be testable for the factor to count as determined: of the others the standard deviation is
/// infinite. It is an identifiability of the regression, like its rank.
const DETERMINED: f64 = 0.5;

/// Share of its norm that a basis column must keep beyond those before it.
const INDEPENDENT: f64 = 1e-7;

/// Columns that are made orthogonal to a basis at once.
const AT_ONCE: usize = 8;

/// A least-squares fit on whitened rows.
#[derive(Debug, Clone)]
pub struct Projection {
    basis: Basis,
    /// Factors of which something is known beforehand.
    known: usize,
    /// Residual of the fit.
    pub residual: Column,
}

impl Projection {
    /// Fits `torque` by `columns`, both whitened.
    pub fn new(columns: &[Column], torque: &Column) -> Self {
        let mut fit = Projection { basis: Basis::default(), known: 0, residual: torque.clone() };
        fit.extend(columns);
        fit
    }

    /// The same of a regression that is factored joint by joint.
    pub(crate) fn of(factored: &Factored) -> Self {
        let (columns, torque) = factored.condensed();
        let columns: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
        let OrthonormalBasis { directions, .. } = OrthonormalBasis::new(&columns, INDEPENDENT);
        let mix = DMatrix::from_fn(torque.len(), directions.len(), |row, k| directions[k][row]);
        let fitted = &mix * mix.tr_mul(&torque);
        let mut first = 0;
        let (mut residual, mut model) = (Column::default(), Vec::new());
        for OfJoint { joint, factors, weight, .. } in &factored.joints {
            let mut left: Vec<f64> = factors.torque().iter().map(|x| weight * x).collect();
            let count = factors.rank();
            let own = DMatrix::from_column_slice(count, 1, fitted.rows(first, count).as_slice());
            subtract_product(&mut left, factors.directions(), factors.rows(), &own);
            residual.parts.push((*joint, left));
            let mix = mix.rows(first, count).into_owned();
            model.push(Mixed { joint: *joint, factors: factors.clone(), mix });
            first += count;
        }
        Projection { basis: Basis::of_model(model, directions.len()), known: 0, residual }
    }

    /// The same fit with more columns.
    pub fn with(&self, columns: &[Column]) -> Self {
        let mut fit = self.clone();
        fit.extend(columns);
        fit
    }

    /// The same fit with more columns whose factors are known beforehand to lie near zero, with these standard deviations (infinite where
    /// nothing is known): an observation of zero is added for each (mixed estimation; Theil and Goldberger, International Economic
    /// Review 2, 1961).
    pub(crate) fn with_prior(&self, columns: &[Column], spread: &[f64]) -> Self {
        let observed = columns.iter().zip(spread).enumerate().map(|(k, (column, spread))| {
            let mut beforehand = vec![0.0; self.known + columns.len()];
            beforehand[self.known + k] = 1.0 / spread;
            Column { parts: column.parts.clone(), beforehand }
        });
        let mut fit = self.with(&observed.collect::<Vec<_>>());
        fit.known += columns.len();
        fit
    }

    fn extend(&mut self, columns: &[Column]) {
        let norm = |column: &Column| column.dot(column).sqrt();
        let usable = columns.iter().map(|column| (column, norm(column)));
        let usable: Vec<(&Column, f64)> = usable.filter(|(_, norm)| *norm > 0.0 && norm.is_finite()).collect();
        for together in usable.chunks(AT_ONCE) {
            let rests = self.left_of(together.iter().map(|(column, _)| (*column).clone()).collect());
            let mut new: Vec<Column> = Vec::new();
            for (mut rest, (_, norm)) in rests.into_iter().zip(together) {
                // Twice, since the first time leaves rounding of what it takes away.
                for direction in new.iter().chain(&new) {
                    let along = direction.dot(&rest);
                    rest.add(-along, direction);
                }
                let left = rest.dot(&rest).sqrt();
                if left > INDEPENDENT * norm {
                    rest.scale(1.0 / left);
                    let along = rest.dot(&self.residual);
                    self.residual.add(-along, &rest);
                    new.push(rest);
                }
            }
            self.basis.extend(new);
        }
    }

    /// Orthonormal columns that span what was fitted.
    pub fn basis(&self) -> Vec<Column> {
        self.basis.columns()
    }

    /// The parts of whitened columns that are orthogonal to the fit.
    pub(crate) fn left_of(&self, mut columns: Vec<Column>) -> Vec<Column> {
        for _ in 0..2 {
            let along = self.basis.along(&columns);
            self.basis.subtract(&mut columns, &along);
        }
        columns
    }

    /// Sum of squares of the residual.
    pub fn left(&self) -> f64 {
        self.residual.dot(&self.residual)
    }

    /// The score test of a group of whitened columns; None where the baseline can do all they can.
    pub fn test(&self, columns: &[Column]) -> Option<Test> {
        self.test_with_prior(columns, &vec![f64::INFINITY; columns.len()])
    }

    /// The same of only those directions of the group that are mostly orthogonal to the baseline: what remains of the others may be
    /// anything but like the columns themselves.
    pub(crate) fn test_of_what_is_mostly_left(&self, columns: &[Column]) -> Option<Test> {
        self.test_of(columns, &vec![f64::INFINITY; columns.len()], MOSTLY_LEFT)
    }

    /// The score test of columns whose factors are known beforehand to lie near zero, with these standard deviations: an
    /// observation of zero is added for each.
    pub(crate) fn test_with_prior(&self, columns: &[Column], spread: &[f64]) -> Option<Test> {
        self.test_of(columns, spread, TESTABLE)
    }

    /// The test of the directions of which at least a share of the squared norm is orthogonal to the baseline.
    fn test_of(&self, columns: &[Column], spread: &[f64], least: f64) -> Option<Test> {
        let norms: Vec<f64> = columns.iter().map(|column| column.dot(column).sqrt()).collect();
        if norms.is_empty() || !norms.iter().all(|norm| norm.is_finite()) {
            return None;
        }
        // A column that does nothing must not hide the others of its group.
        let norms: Vec<f64> = norms.into_iter().map(|norm| if norm > 0.0 { norm } else { 1.0 }).collect();
        let count = columns.len();
        let mut along = self.basis.along(columns);
        along.column_iter_mut().zip(&norms).for_each(|(mut column, norm)| column /= *norm);
        let mut gram = DMatrix::from_fn(count, count, |r, c| {
            if r <= c { columns[r].dot(&columns[c]) / (norms[r] * norms[c]) } else { 0.0 }
        });
        gram.fill_lower_triangle_with_upper_triangle();
        gram -= along.tr_mul(&along);
        let known = DMatrix::from_fn(count, count, |r, c| if r == c { (norms[c] * spread[c]).powi(-2) } else { 0.0 });
        let eigen = SymmetricEigen::new(&gram + &known);
        let kept: Vec<usize> = (0..count).filter(|&k| eigen.eigenvalues[k] > least).collect();
        // Directions that the prior holds more than the rows do are not free.
        let free: f64 = kept
            .iter()
            .map(|&k| {
                let direction = eigen.eigenvectors.column(k);
                direction.dot(&(&gram * direction)) / eigen.eigenvalues[k]
            })
            .sum();
        if free < 0.5 {
            return None;
        }
        let directions = DMatrix::from_fn(count, kept.len(), |r, k| {
            eigen.eigenvectors[(r, kept[k])] / eigen.eigenvalues[kept[k]].sqrt()
        });
        let right = DVector::from_fn(count, |c, _| columns[c].dot(&self.residual) / norms[c]);
        let scores = directions.tr_mul(&right);
        let values = &directions * &scores;
        let covariance = &directions * directions.transpose();
        Some(Test {
            statistic: scores.norm_squared(),
            freedom: free.round() as usize,
            values: values.iter().zip(&norms).map(|(v, norm)| v / norm).collect(),
            std: (0..count)
                .map(|c| {
                    let determined: f64 = kept.iter().map(|&k| eigen.eigenvectors[(c, k)].powi(2)).sum();
                    if determined > DETERMINED { covariance[(c, c)].sqrt() / norms[c] } else { f64::INFINITY }
                })
                .collect(),
            along,
            directions,
            norms,
        })
    }
}

/// A score test.
#[derive(Debug, Clone)]
pub struct Test {
    /// Sum of squares that the columns take beyond the baseline: chi-square where they are not needed.
    pub statistic: f64,
    /// Directions that could be tested.
    pub freedom: usize,
    /// Estimates of the columns' factors.
    pub values: Vec<f64>,
    /// Their standard deviations; infinite where the rows do not determine a factor.
    pub std: Vec<f64>,
    /// Inner products of the baseline's directions with the columns over their norms.
    pub along: DMatrix<f64>,
    /// Directions tested, in units of their standard deviations.
    pub directions: DMatrix<f64>,
    /// Norms of the columns.
    pub norms: Vec<f64>,
}

impl Test {
    /// Logarithm of the probability of as large a statistic without an effect.
    pub fn log_p(&self) -> f64 {
        log_survival(self.statistic, self.freedom)
    }
}

/// Logarithm of the probability that chi-square exceeds `x`.
pub(crate) fn log_survival(x: f64, freedom: usize) -> f64 {
    if freedom == 0 || x <= 0.0 {
        return 0.0;
    }
    let half = 0.5 * freedom as f64;
    match ChiSquared::new(freedom as f64).map(|law| law.sf(x)) {
        Ok(p) if p > 1e-250 => p.ln(),
        // Far out the incomplete gamma function is its leading term.
        _ => (half - 1.0) * (0.5 * x).ln() - 0.5 * x - ln_gamma(half) - (1.0 - (half - 1.0) / (0.5 * x)).ln(),
    }
}

/// Logarithm of the probability of independent probabilities, given by their logarithms, whose product is as small
/// (Fisher, Statistical Methods for Research Workers, 1925).
pub(crate) fn fisher(log_p: impl IntoIterator<Item = f64>) -> f64 {
    let (sum, count) = log_p.into_iter().fold((0.0, 0), |(sum, count), log_p| (sum - 2.0 * log_p, count + 1));
    log_survival(sum, 2 * count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::regression::basis::on_joint;
    use crate::diagnosis::regression::factors::JointFactors;
    use std::sync::Arc;

    fn wave(k: usize, rows: usize) -> Column {
        Column::on(0, (0..rows).map(|t| (k as f64 * t as f64 * std::f64::consts::PI / rows as f64).cos()).collect())
    }

    #[test]
    fn chi_square_tails_agree_with_tables() {
        for (x, freedom, p) in [(3.841_459, 1, 0.05), (9.487_729, 4, 0.05), (23.209_25, 10, 0.01)] {
            assert!((log_survival(x, freedom).exp() / p - 1.0).abs() < 1e-5);
        }
        // scipy: chi2.logsf(1200, 3), and norm.logsf(sqrt(2000)) + log(2) for one degree of freedom
        for (x, freedom, log_p) in [(1200.0, 3, -596.679_921), (2000.0, 1, -1_004.026_742)] {
            assert!((log_survival(x, freedom) - log_p).abs() < 1e-3, "{}", log_survival(x, freedom));
        }
    }

    #[test]
    fn two_probabilities_by_hand() {
        // The area under x y = 1/4 within the unit square: 1/4 + ln(4)/4.
        assert!((fisher([0.5f64.ln(); 2]).exp() - 0.25 * (1.0 + 4f64.ln())).abs() < 1e-12);
        assert_eq!(fisher([0.0, 0.0]), 0.0);
        assert!((fisher([-3.0]) + 3.0).abs() < 1e-9);
        assert!(fisher([f64::MIN_POSITIVE.ln(), 0.3f64.ln()]) < -690.0);
    }

    #[test]
    fn a_known_amount_is_found_beyond_the_baseline() {
        let rows = 400;
        let (base, extra) = (wave(1, rows), wave(3, rows));
        let mut torque = base.clone();
        torque.scale(5.0);
        torque.add(0.7, &extra);
        let fit = Projection::new(std::slice::from_ref(&base), &torque);
        let test = fit.test(std::slice::from_ref(&extra)).unwrap();
        assert!((test.values[0] - 0.7).abs() < 1e-9);
        let perpendicular = extra.dot(&extra) - extra.dot(&base).powi(2) / base.dot(&base);
        assert!((test.statistic - 0.49 * perpendicular).abs() < 1e-9 * test.statistic);
        assert!((test.std[0] * perpendicular.sqrt() - 1.0).abs() < 1e-9);
        assert!(fit.test(std::slice::from_ref(&base)).is_none() && fit.test(&[]).is_none());
        assert!(fit.with(&[extra]).left() < 1e-18 * torque.dot(&torque));
    }

    /// Columns on two joints, one of them on both and one a multiple of another: the fit is that of all rows at once.
    #[test]
    fn factors_of_joints_give_the_fit_of_all_rows() {
        let rows = [60, 40];
        let part = |joint: usize, k: usize| wave(k, rows[joint]).parts.remove(0).1;
        let on = |joint, k| Column::on(joint, part(joint, k));
        let both = Column::of(vec![(0, part(0, 2)), (1, part(1, 5))]);
        let mut multiple = on(0, 1);
        multiple.scale(-2.0);
        let columns = [on(0, 1), both, multiple, on(1, 4)];
        let mut torque = Column::of(vec![(0, part(0, 7)), (1, part(1, 3))]);
        columns.iter().for_each(|column| torque.add(0.8, column));
        let weights = [1.0, 0.5];
        let weighed = |column: &Column| {
            let mut column = column.clone();
            column.parts.iter_mut().for_each(|(joint, values)| values.iter_mut().for_each(|x| *x *= weights[*joint]));
            column
        };
        let of_all_rows = Projection::new(&columns.each_ref().map(weighed), &weighed(&torque));
        let joints = (0..2).map(|joint| {
            let (places, values) = on_joint(&columns, joint);
            let factors = Arc::new(JointFactors::new(values, places.len(), torque.part(joint).unwrap().to_vec()));
            OfJoint { joint, places, factors, weight: weights[joint] }
        });
        let of_factors = Projection::of(&Factored { columns: columns.len(), joints: joints.collect() });

        let close = |a: &Column, b: &Column| {
            let mut difference = a.clone();
            difference.add(-1.0, b);
            assert!(difference.dot(&difference) < 1e-20, "{difference:?}");
        };
        close(&of_factors.residual, &of_all_rows.residual);
        assert_eq!(of_factors.basis().len(), 3);
        of_factors.basis().iter().zip(&of_all_rows.basis()).for_each(|(a, b)| close(a, b));
        let more = [Column::of(vec![(0, part(0, 9)), (1, part(1, 6))]), on(1, 8)];
        let rests = [&of_factors, &of_all_rows].map(|fit| fit.left_of(more.to_vec()));
        rests[0].iter().zip(&rests[1]).for_each(|(a, b)| close(a, b));
        let tests = [&of_factors, &of_all_rows].map(|fit| fit.test(&more).unwrap());
        assert!((tests[0].statistic - tests[1].statistic).abs() < 1e-10);
        assert!((&tests[0].along - &tests[1].along).norm() < 1e-12);
        let further = [&of_factors, &of_all_rows].map(|fit| fit.with(&more).left());
        assert!((further[0] - further[1]).abs() < 1e-10);
    }

    /// What is known of a factor beforehand is one more observation: with one of zero, a norm of 2 gives 4 / (4 + 1 / spread^2) of it.
    #[test]
    fn a_factor_that_is_known_takes_no_more_than_it_can() {
        let rows = 400;
        let (error, extra) = (wave(3, rows), wave(5, rows));
        let mut torque = error.clone();
        torque.scale(2.0);
        torque.add(0.7, &extra);
        let fit = Projection::new(&[], &torque);
        let norm = error.dot(&error);
        let left = |spread: f64| {
            let adjusted = fit.with_prior(std::slice::from_ref(&error), &[spread]);
            1.0 - adjusted.residual.dot(&error) / (2.0 * norm)
        };
        for spread in [0.01, 0.1, 1.0] {
            let share = norm / (norm + 1.0 / (spread * spread));
            assert!((left(spread) - share).abs() < 1e-9, "{} {share}", left(spread));
        }
        assert!((left(f64::INFINITY) - 1.0).abs() < 1e-9);
        // What is known of the same factor twice adds up.
        let twice =
            fit.with_prior(std::slice::from_ref(&error), &[0.1]).with_prior(std::slice::from_ref(&error), &[0.1]);
        let left = twice.residual.dot(&error) / (2.0 * norm);
        assert!((left - 1.0 / (1.0 + 2.0 * norm * 0.01)).abs() < 1e-9, "{left}");
        // Nothing else is touched.
        let adjusted = fit.with_prior(&[error], &[0.1]);
        assert!((adjusted.test(&[extra]).unwrap().values[0] - 0.7).abs() < 1e-9);
    }

    /// A baseline of a wave with a little of another: the sum of waves that it nearly is shows the other alone.
    #[test]
    fn what_remains_of_a_group_is_not_the_group() {
        let rows = 400;
        let mut base = wave(2, rows);
        base.add(0.1, &wave(90, rows));
        // Much of the fast wave is in the torque, and nothing slow beyond the baseline.
        let mut torque = base.clone();
        torque.add(5.0, &wave(90, rows));
        let fit = Projection::new(&[base], &torque);
        let slow: Vec<Column> = (1..6).map(|k| wave(2 * k, rows)).collect();
        let all = fit.test(&slow).unwrap();
        let mostly = fit.test_of_what_is_mostly_left(&slow).unwrap();
        assert!(all.freedom == 5 && all.statistic > 1000.0, "{all:?}");
        assert!(mostly.freedom == 4 && mostly.statistic < 1e-9, "{mostly:?}");
    }
}
