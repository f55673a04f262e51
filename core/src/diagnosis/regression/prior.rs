//! What the description of an arm says where the rows do not: a prior on some factors of a least-squares solution.
//!
//! Directions that the rows do not determine are taken from the description, all others stay as fitted. Most logs determine all that
//! their own torque needs; held-out logs may need more, as where a joint stands elsewhere.

use super::solution::{SINGULAR, Solved};
use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// Standard deviations of the description above which a direction is not determined by the rows: an estimate that is off by ten times its
/// size says nothing. Below, the description may be as wrong as the estimate.
const UNDETERMINED: f64 = 10.0;

/// Fewest factors that the rows determine by which the size of a description is judged.
const FEWEST: usize = 3;

/// A factor as described.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Described {
    /// Its place among the factors.
    pub place: usize,
    /// Its value.
    pub value: f64,
    /// How far off that may be: as far as parameters of its kind are large. More than zero.
    pub std: f64,
}

impl Solved {
    /// The solution with what is `described` where the rows say nothing: the posterior mean in those principal directions in which the
    /// standard deviation is many times that of the description. The description counts as a whole by a factor, and its deviations by another, as
    /// the factors that the rows determine show: bodies may be described twice too heavy.
    pub(crate) fn with_described(mut self, described: &[Described]) -> Solved {
        let [scale, spread] = self.sizes(described);
        let count = self.values.len();
        let (mut mean, mut precision) = (DVector::zeros(count), DVector::zeros(count));
        for one in described {
            mean[one.place] = scale * one.value * self.norms[one.place];
            precision[one.place] = (spread * one.std * self.norms[one.place]).powi(-2);
        }
        let known = |k: usize| if self.variances[k] > 0.0 { 1.0 / self.variances[k] } else { 0.0 };
        let described = self.directions.map(|part| part * part).tr_mul(&precision);
        let open: Vec<usize> = (0..count).filter(|&k| UNDETERMINED.powi(2) * known(k) < described[k]).collect();
        if open.is_empty() {
            return self;
        }
        let fitted = DVector::from_fn(count, |place, _| self.values[place] * self.norms[place]);
        let directions = self.directions.select_columns(&open);
        let along = directions.tr_mul(&fitted);
        let rest = &fitted - &directions * &along;
        let weighed = DMatrix::from_fn(count, open.len(), |place, k| precision[place] * directions[(place, k)]);
        let mut weight = directions.tr_mul(&weighed);
        let mut right = weighed.tr_mul(&(mean - rest));
        for (row, &k) in open.iter().enumerate() {
            weight[(row, row)] += known(k);
            right[row] += known(k) * along[row];
        }
        // Factors that neither knows, as the friction of a joint that stands, stay.
        let SymmetricEigen { eigenvectors, eigenvalues } = SymmetricEigen::new(weight.clone());
        let least = SINGULAR * eigenvalues.max();
        let inverse = eigenvalues.map(|value| if value > least { 1.0 / value } else { 0.0 });
        let step = right - &weight * &along;
        let moved = directions * (&eigenvectors * eigenvectors.tr_mul(&step).component_mul(&inverse));
        for (place, value) in self.values.iter_mut().enumerate() {
            *value += moved[place] / self.norms[place];
        }
        for &k in &open {
            self.expected[k] = 1.0 / (known(k) + described[k]);
        }
        self
    }

    /// The factor on the values described that brings them next to those that the rows determine better than the description, and the root
    /// mean square of what it leaves over what is expected, one at the least; both are one where there are too few of these.
    fn sizes(&self, described: &[Described]) -> [f64; 2] {
        let determined: Vec<[f64; 2]> = described
            .iter()
            .filter(|one| self.std(one.place) < one.std)
            .map(|one| [one.value / one.std, self.values[one.place] / one.std])
            .collect();
        if determined.len() < FEWEST {
            return [1.0, 1.0];
        }
        let sum = |of: fn(&[f64; 2]) -> f64| determined.iter().map(of).sum::<f64>();
        let scale = (sum(|[a, b]| a * b) / sum(|[a, _]| a * a).max(f64::MIN_POSITIVE)).max(0.0);
        let left: f64 = determined.iter().map(|[a, b]| (b - scale * a).powi(2)).sum();
        [scale, (left / determined.len() as f64).sqrt().max(1.0)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::regression::{Column, solve};

    /// Three factors that rows determine, of which the first is as described, and a fourth that only the sum with the third shows.
    fn solved(values: [f64; 3]) -> Solved {
        let axis = |k: usize| Column::on(0, (0..3).map(|row| if row == k { 100.0 } else { 0.0 }).collect());
        let torque = Column::on(0, values.iter().map(|value| 100.0 * value).collect());
        solve(&[axis(0), axis(1), axis(2), axis(2)], &torque)
    }

    fn described(values: [f64; 4]) -> Vec<Described> {
        let of = |(place, &value): (usize, &f64)| Described { place, value, std: 2.0 };
        values.iter().enumerate().map(of).collect()
    }

    #[test]
    fn what_the_rows_leave_open_is_as_described() {
        let plain = solved([1.0, 2.0, 3.0]);
        assert!((plain.values[2] - 1.5).abs() < 1e-9 && plain.std(3) == f64::INFINITY);
        let with = plain.clone().with_described(&described([1.0, 2.0, 3.5, -0.5]));
        let expected = [1.0, 2.0, 3.5, -0.5];
        assert!(with.values.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6), "{:?}", with.values);
        // The rows say what they said before; a prediction rests on the description too.
        assert_eq!(with.std(3), f64::INFINITY);
        let apart = [Column::default(), Column::default(), Column::on(0, vec![1.0]), Column::default()];
        let predicted = |solved: &Solved| solved.prediction_std(&apart, &[vec![true]])[0];
        assert!(predicted(&plain).is_infinite());
        // A third factor of 2 either way, of which half the difference to the fourth is open.
        assert!((predicted(&with) - 2.0 / 2f64.sqrt()).abs() < 0.02, "{}", predicted(&with));
    }

    #[test]
    fn a_factor_that_nothing_determines_hides_no_other() {
        // Its column is zero, as that of the third.
        let axis = |k: usize| Column::on(0, (0..4).map(|row| if row == k && k < 2 { 100.0 } else { 0.0 }).collect());
        let columns: Vec<Column> = (0..4).map(axis).collect();
        let plain = solve(&columns, &Column::on(0, vec![100.0, 200.0, 0.0, 0.0]));
        let with = plain.with_described(&described([1.0, 2.0, 3.0, 0.0])[..3]);
        let expected = [1.0, 2.0, 3.0, 0.0];
        assert!(with.values.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9), "{:?}", with.values);
    }

    #[test]
    fn what_the_rows_determine_stays() {
        let plain = solved([1.0, 2.0, 3.0]);
        let with = plain.clone().with_described(&described([5.0, -5.0, 3.0, 0.0]));
        assert!((with.values[0] - 1.0).abs() < 1e-12 && (with.values[1] - 2.0).abs() < 1e-12);
        assert_eq!(plain.clone().with_described(&[]).values, plain.values);
    }

    #[test]
    fn a_description_twice_too_large_counts_by_half() {
        let columns: Vec<Column> = (0..4)
            .map(|k| Column::on(0, (0..4).map(|row| if row == k && k < 3 { 100.0 } else { 0.0 }).collect()))
            .collect();
        let plain = solve(&columns, &Column::on(0, vec![100.0, 200.0, 300.0, 0.0]));
        let last = |solved: Solved| solved.values[3];
        assert!((last(plain.clone().with_described(&described([2.0, 4.0, 6.0, 8.0]))) - 4.0).abs() < 1e-9);
        // Too few are determined to tell.
        assert!((last(plain.with_described(&described([2.0, 4.0, 6.0, 8.0])[2..])) - 8.0).abs() < 1e-9);
    }
}
