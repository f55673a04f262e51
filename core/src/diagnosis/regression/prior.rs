//! What the description of an arm says where the rows do not: a prior on some factors of a least-squares solution.
//!
//! Combinations that the rows do not determine are taken from the description, all others stay as fitted. Most logs determine all that
//! their own torque needs; held-out logs may need more, as where a joint stands elsewhere.

use super::solution::{Independent, Solved};
use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// Information of the rows along a combination over that of the description from which the rows alone count: below, the estimate is ten
/// times as uncertain as described, and says nothing. Above, the description may be as wrong as the estimate.
const LEAST: f64 = 0.01;

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
    /// The solution with what is `described` where the rows say nothing: the posterior mean along those combinations of described factors
    /// whose standard deviation by the rows is many times that of the description. The combinations are those along which both are independent
    /// (the generalised eigenvectors of the two covariances), with every other factor fitted anew. The description counts as a whole by
    /// a factor, and its deviations by another, as the factors that the rows determine show: bodies may be described twice too heavy.
    pub(crate) fn with_described(mut self, described: &[Described]) -> Solved {
        if described.is_empty() {
            return self;
        }
        let [scale, spread] = self.sizes(described);
        let places: Vec<usize> = described.iter().map(|one| one.place).collect();
        let others: Vec<usize> = (0..self.values.len()).filter(|place| !places.contains(place)).collect();
        let stds = DVector::from_iterator(
            described.len(),
            described.iter().map(|one| spread * one.std * self.norms[one.place]),
        );
        let information = self.information();
        // Factors of all others where one of a described factor is one standard deviation of its description.
        let unit = DMatrix::from_diagonal(&stds);
        let mixed = information.select_rows(&others).select_columns(&places) * &unit;
        let rest = Independent::of(information.select_rows(&others).select_columns(&others));
        let answer = -rest.times(&mixed);
        let own = &unit * information.select_rows(&places).select_columns(&places) * &unit + mixed.tr_mul(&answer);
        let SymmetricEigen { eigenvectors, eigenvalues } = SymmetricEigen::new(own);
        // Of unit variance as described.
        let known = eigenvalues.map(|value| value.max(0.0));
        if known.min() >= LEAST {
            return self;
        }
        let apart = |one: &Described| (scale * one.value - self.values[one.place]) / (spread * one.std);
        let apart = DVector::from_iterator(described.len(), described.iter().map(apart));
        let step = |known: f64, apart: f64| if known < LEAST { apart / (1.0 + known) } else { 0.0 };
        let along = known.zip_map(&eigenvectors.tr_mul(&apart), step);
        let to_all = |own: &DMatrix<f64>| {
            let (described, fitted) = (&unit * own, &answer * own);
            let mut all = DMatrix::zeros(self.values.len(), own.ncols());
            places.iter().enumerate().for_each(|(k, &place)| all.set_row(place, &described.row(k)));
            others.iter().enumerate().for_each(|(k, &place)| all.set_row(place, &fitted.row(k)));
            all
        };
        let moved = to_all(&DMatrix::from_column_slice(along.len(), 1, (&eigenvectors * &along).as_slice()));
        let combinations = to_all(&eigenvectors);
        let count = self.values.len();
        let mut directions = DMatrix::zeros(count, count);
        directions.columns_mut(0, places.len()).copy_from(&combinations);
        for (row, &place) in others.iter().enumerate() {
            directions.view_mut((place, places.len()), (1, others.len())).copy_from(&rest.directions.row(row));
        }
        let of_combination = |known: &f64| if *known < LEAST { 1.0 / (1.0 + known) } else { 1.0 / known };
        let variances = known.iter().map(of_combination).chain(rest.variances.iter().copied());
        self.expected = Independent { directions, variances: DVector::from_iterator(count, variances) };
        self.values.iter_mut().enumerate().for_each(|(place, value)| *value += moved[place] / self.norms[place]);
        self
    }

    /// The normal matrix of columns of unit length, without what does not determine anything.
    fn information(&self) -> DMatrix<f64> {
        let Independent { directions, variances } = &self.by_rows;
        let roots = variances.map(|variance| if variance > 0.0 { variance.sqrt().recip() } else { 0.0 });
        let scaled = directions * DMatrix::from_diagonal(&roots);
        &scaled * scaled.transpose()
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
    use crate::random;
    use rand_distr::{Distribution, StandardNormal};

    /// Three factors that rows determine, of which the first is as described, and a fourth that only the sum with the third shows.
    fn solved(values: [f64; 3]) -> Solved {
        let axis = |k: usize| Column::on(0, (0..3).map(|row| if row == k { 100.0 } else { 0.0 }).collect());
        let torque = Column::on(0, values.iter().map(|value| 100.0 * value).collect());
        solve(&[axis(0), axis(1), axis(2), axis(2)], &torque)
    }

    fn described(values: &[f64]) -> Vec<Described> {
        let of = |(place, &value): (usize, &f64)| Described { place, value, std: 2.0 };
        values.iter().enumerate().map(of).collect()
    }

    #[test]
    fn what_the_rows_leave_open_is_as_described() {
        let plain = solved([1.0, 2.0, 3.0]);
        assert!((plain.values[2] - 1.5).abs() < 1e-9 && plain.std(3) == f64::INFINITY);
        let with = plain.clone().with_described(&described(&[1.0, 2.0, 3.5, -0.5]));
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
        let with = plain.with_described(&described(&[1.0, 2.0, 3.0, 0.0])[..3]);
        let expected = [1.0, 2.0, 3.0, 0.0];
        assert!(with.values.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9), "{:?}", with.values);
    }

    #[test]
    fn a_factor_too_small_to_be_seen_leaves_those_it_resembles_as_fitted() {
        // The third is described as a thousandth, which no row shows, and its column is nearly that of the second.
        let columns = [vec![100.0, 0.0, 0.0], vec![0.0, 100.0, 0.0], vec![0.0, 100.0, 1.0]].map(|v| Column::on(0, v));
        let plain = solve(&columns, &Column::on(0, vec![100.0, 200.0, 0.5]));
        assert!((plain.values[2] - 0.5).abs() < 1e-6 && (plain.values[1] - 1.5).abs() < 1e-6);
        let small = Described { place: 2, value: 0.0, std: 1e-3 };
        let with = plain.with_described(&[&described(&[5.0, -5.0])[..], &[small]].concat());
        let expected = [1.0, 2.0, 0.0];
        assert!(with.values.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-4), "{:?}", with.values);
    }

    /// Where the description is right, nothing that the rows determine moves by more than their noise allows.
    #[test]
    fn no_combination_moves_by_much_more_than_its_standard_deviation() {
        for seed in 0..40 {
            let mut source = random::stream(seed, "prior", 0);
            let mut drawn = || -> f64 { StandardNormal.sample(&mut source) };
            let stds: Vec<f64> = (0..6).map(|_| 10f64.powf(1.5 * drawn())).collect();
            let near: Vec<f64> = (0..30).map(|_| drawn()).collect();
            let rows: Vec<Vec<f64>> = (0..6).map(|_| near.iter().map(|near| near + 0.03 * drawn()).collect()).collect();
            let truth: Vec<f64> = stds.iter().map(|std| std * drawn()).collect();
            let torque = (0..30).map(|row| drawn() + (0..6).map(|k| rows[k][row] * truth[k]).sum::<f64>()).collect();
            let columns: Vec<Column> = rows.into_iter().map(|values| Column::on(0, values)).collect();
            let plain = solve(&columns, &Column::on(0, torque));
            let described: Vec<Described> =
                (0..6).map(|place| Described { place, value: 0.0, std: stds[place] }).collect();
            let with = plain.clone().with_described(&described);
            for _ in 0..20 {
                let slopes: Vec<(usize, f64)> = (0..6).map(|place| (place, drawn())).collect();
                let moved: f64 = slopes.iter().map(|&(k, slope)| slope * (with.values[k] - plain.values[k])).sum();
                let std = plain.deviation(&slopes);
                assert!(moved.abs() < 5.0 * std, "{seed}: {moved} of {std}");
            }
        }
    }

    #[test]
    fn what_the_rows_determine_stays() {
        let plain = solved([1.0, 2.0, 3.0]);
        let with = plain.clone().with_described(&described(&[5.0, -5.0, 3.0, 0.0]));
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
        assert!((last(plain.clone().with_described(&described(&[2.0, 4.0, 6.0, 8.0]))) - 4.0).abs() < 1e-9);
        // Too few are determined to tell.
        assert!((last(plain.with_described(&described(&[2.0, 4.0, 6.0, 8.0])[2..])) - 8.0).abs() < 1e-9);
    }
}
