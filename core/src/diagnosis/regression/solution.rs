//! Least squares on whitened columns; directions that the rows do not determine stay at zero.

use super::basis::on_joint;
use super::column::{Column, joints_of};
use super::factors::{Factored, Normal, OfJoint};
use crate::linear::gram_matrix;
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use rayon::prelude::*;

/// Smallest eigenvalue of the scaled normal matrix, over its largest, that still counts.
pub(super) const SINGULAR: f64 = 1e-12;

/// Squared share of a direction in undetermined ones from which it is undetermined.
const UNDETERMINED: f64 = 1e-6;

/// A least-squares solution with its covariance.
#[derive(Debug, Clone)]
pub(crate) struct Solved {
    /// Factors of the columns.
    pub values: Vec<f64>,
    /// Lengths of the columns.
    pub(super) norms: Vec<f64>,
    /// Covariance by the rows alone.
    pub(super) by_rows: Independent,
    /// Covariance of what is expected, by the description too.
    pub(super) expected: Independent,
}

/// The covariance of the factors of columns of unit length, as directions along which errors are independent.
#[derive(Debug, Clone)]
pub(super) struct Independent {
    /// `[factor][direction]`.
    pub directions: DMatrix<f64>,
    /// Variances along these; zero where nothing determines them.
    pub variances: DVector<f64>,
}

impl Independent {
    /// Principal directions of a normal matrix; eigenvalues below [`SINGULAR`] of the largest determine nothing.
    pub(super) fn of(normal: DMatrix<f64>) -> Independent {
        if normal.is_empty() {
            return Independent { directions: normal, variances: DVector::zeros(0) };
        }
        let SymmetricEigen { eigenvectors, eigenvalues } = SymmetricEigen::new(normal);
        let least = SINGULAR * eigenvalues.max();
        let variances = eigenvalues.map(|value| if value > least { 1.0 / value } else { 0.0 });
        Independent { directions: eigenvectors, variances }
    }

    /// The covariance times `right`.
    pub(super) fn times(&self, right: &DMatrix<f64>) -> DMatrix<f64> {
        let mut along = self.directions.tr_mul(right);
        along.column_iter_mut().for_each(|mut column| column.component_mul_assign(&self.variances));
        &self.directions * along
    }
}

/// Fits whitened torque by whitened columns; directions that the rows do not determine stay at zero.
pub(crate) fn solve(columns: &[Column], torque: &Column) -> Solved {
    let right = DVector::from_iterator(columns.len(), columns.iter().map(|column| column.dot(torque)));
    solve_normal(gram(columns), right)
}

/// The same from the inner products of the columns with each other and with the torque.
pub(crate) fn solve_normal(mut normal: DMatrix<f64>, mut right: DVector<f64>) -> Solved {
    let norms: Vec<f64> = normal.diagonal().iter().map(|&n| if n > 0.0 { n.sqrt() } else { 1.0 }).collect();
    for (r, row_norm) in norms.iter().enumerate() {
        for (c, norm) in norms.iter().enumerate() {
            normal[(r, c)] /= row_norm * norm;
        }
    }
    right.iter_mut().zip(&norms).for_each(|(value, norm)| *value /= norm);
    // Differences from before a change have no baseline: nothing is fitted there.
    let by_rows = Independent::of(normal);
    let Independent { directions, variances } = &by_rows;
    let values = directions * directions.tr_mul(&right).component_mul(variances);
    let values = values.iter().zip(&norms).map(|(value, norm)| value / norm).collect();
    Solved { values, norms, expected: by_rows.clone(), by_rows }
}

impl Solved {
    /// Standard deviation of a linear function of the factors, whose slopes are not zero at these places only; infinite where the
    /// rows do not separate it from other columns.
    pub(crate) fn deviation(&self, slopes: &[(usize, f64)]) -> f64 {
        let Independent { directions, variances } = &self.by_rows;
        let mut along = DVector::zeros(variances.len());
        for &(place, slope) in slopes {
            along += directions.row(place).transpose() * (slope / self.norms[place]);
        }
        let (mut determined, mut open) = (0.0, 0.0);
        for (part, variance) in along.iter().zip(variances) {
            determined += part * part * variance;
            open += if *variance == 0.0 { part * part } else { 0.0 };
        }
        if open > UNDETERMINED * along.norm_squared() { f64::INFINITY } else { determined.sqrt() }
    }

    /// Root mean square, over the rows of each joint that count (`valid`, `[joint][row]`), of the standard deviation of what `columns`
    /// predict there with these factors; infinite where that rests on directions that neither the rows nor the description determine.
    pub(crate) fn prediction_std(&self, columns: &[Column], valid: &[Vec<bool>]) -> Vec<f64> {
        let of_joint = |(joint, valid): (usize, &Vec<bool>)| {
            let Along { squares, all, rows } = self.along(columns, joint, valid);
            let (mut determined, mut open) = (0.0, 0.0);
            for (square, variance) in squares.iter().zip(&self.expected.variances) {
                determined += square * variance;
                open += if *variance == 0.0 { *square } else { 0.0 };
            }
            let mean = (determined / rows.max(1) as f64).sqrt();
            if open > UNDETERMINED * all { f64::INFINITY } else { mean }
        };
        valid.iter().enumerate().map(of_joint).collect()
    }

    /// Errors of the factors that matter to what the first `columns` predict: along principal directions, one standard deviation each, where
    /// they change the prediction on the rows of some joint that count by more than `limit`, root mean square. With the prior standard
    /// deviation of their size: one, or infinite where nothing determines the direction.
    pub(crate) fn errors_of_prediction(
        &self,
        columns: &[Column],
        valid: &[Vec<bool>],
        limit: &[f64],
    ) -> Vec<(Vec<f64>, f64)> {
        let shares: Vec<(Along, f64)> =
            (0..valid.len()).map(|joint| (self.along(columns, joint, &valid[joint]), limit[joint])).collect();
        let Independent { directions, variances } = &self.expected;
        let most = variances.max();
        let matters = |k: usize| {
            let (variance, spread) = match variances[k] {
                0.0 => (most, f64::INFINITY),
                variance => (variance, 1.0),
            };
            let exceeds = |(along, limit): &(Along, f64)| {
                let square = along.squares[k];
                let is_open = spread == 1.0 || square > UNDETERMINED * along.all;
                is_open && (square * variance / along.rows.max(1) as f64).sqrt() > *limit
            };
            shares.iter().any(exceeds).then(|| {
                let factor = |place: usize| directions[(place, k)] * variance.sqrt() / self.norms[place];
                ((0..columns.len()).map(factor).collect(), spread)
            })
        };
        (0..variances.len()).filter_map(matters).collect()
    }

    /// What the first `columns` make of the directions of the errors that are expected, on the valid rows of a joint.
    fn along(&self, columns: &[Column], joint: usize, valid: &[bool]) -> Along {
        let rows: Vec<usize> = (0..valid.len()).filter(|&row| valid[row]).collect();
        let mut own = DMatrix::zeros(rows.len(), columns.len());
        for (place, column) in columns.iter().enumerate() {
            let Some(values) = column.part(joint) else { continue };
            rows.iter().enumerate().for_each(|(k, &row)| own[(k, place)] = values[row] / self.norms[place]);
        }
        let along = &own * self.expected.directions.rows(0, columns.len());
        let squares = along.column_iter().map(|column| column.norm_squared()).collect();
        Along { squares, all: own.norm_squared(), rows: rows.len() }
    }

    /// Standard deviation of a factor.
    pub(crate) fn std(&self, place: usize) -> f64 {
        self.deviation(&[(place, 1.0)])
    }
}

/// Torque of a joint on its valid rows, N m, by errors of the factors of columns of unit length.
struct Along {
    /// Sum of squares of what one unit of each direction of the errors makes.
    squares: Vec<f64>,
    /// Sum of squares of what one unit of each factor makes.
    all: f64,
    /// Number of valid rows.
    rows: usize,
}

/// Normal equations of a fit joint by joint, so that each joint's rows can be weighed anew without going through them again.
#[derive(Debug)]
pub(crate) struct JointEquations(Factored);

impl JointEquations {
    /// Of a regression that is factored joint by joint.
    pub(crate) fn new(factored: Factored) -> Self {
        factored.joints.par_iter().for_each(|own| {
            own.factors.normal();
        });
        JointEquations(factored)
    }

    /// The least-squares solution, where each joint's noise is `factor` times stronger.
    pub(crate) fn solved(&self, factor: impl Fn(usize) -> f64) -> Solved {
        let Factored { columns, joints } = &self.0;
        let mut normal = DMatrix::zeros(*columns, *columns);
        let mut right = DVector::zeros(*columns);
        for OfJoint { joint, places, factors, weight } in joints {
            let Normal { gram, right: own, .. } = factors.normal();
            let weight = (weight / factor(*joint)).powi(2);
            places.iter().zip(own.iter()).for_each(|(&column, own)| right[column] += weight * own);
            add_at(&mut normal, places, gram, weight);
        }
        solve_normal(normal, right)
    }

    /// Sum of squared residuals of each joint, where its noise is so many times `stronger`, in units of that noise.
    pub(crate) fn squared_residuals(&self, stronger: &[f64]) -> Vec<f64> {
        let values = self.solved(|joint| stronger[joint]).values;
        let mut squares = vec![0.0; stronger.len()];
        for OfJoint { joint, places, factors, weight } in &self.0.joints {
            let Normal { gram, right, square } = factors.normal();
            let own = DVector::from_iterator(places.len(), places.iter().map(|&place| values[place]));
            let left = square - 2.0 * own.dot(right) + own.dot(&(gram * &own));
            squares[*joint] = left.max(0.0) * (weight / stronger[*joint]).powi(2);
        }
        squares
    }
}

/// Inner products of all columns.
pub(crate) fn gram(columns: &[Column]) -> DMatrix<f64> {
    let count = columns.len();
    let known = |r: usize, c: usize| columns[r].dot_beforehand(&columns[c]);
    let mut gram = DMatrix::from_fn(count, count, known);
    for joint in joints_of(columns) {
        let (places, values) = on_joint(columns, joint);
        let matrix = DMatrix::from_vec(values.len() / places.len(), places.len(), values);
        add_at(&mut gram, &places, &gram_matrix(&matrix), 1.0);
    }
    gram
}

/// Adds `weight` times the inner products of some columns at their places among all.
fn add_at(all: &mut DMatrix<f64>, places: &[usize], own: &DMatrix<f64>, weight: f64) {
    for (c, &column) in places.iter().enumerate() {
        for (r, &row) in places.iter().enumerate() {
            all[(row, column)] += weight * own[(r, c)];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::regression::JointFactors;
    use std::sync::Arc;

    /// The second and third column are one, the fourth is nothing.
    fn solved() -> Solved {
        let columns = [vec![2.0, 0.0], vec![0.0, 1.0], vec![0.0, 1.0], vec![0.0, 0.0]].map(|v| Column::on(0, v));
        solve(&columns, &Column::on(0, vec![4.0, 3.0]))
    }

    #[test]
    fn what_the_rows_do_not_tell_has_no_finite_deviation() {
        let solved = solved();
        let expected = [2.0, 1.5, 1.5, 0.0];
        assert!(solved.values.iter().zip(expected).all(|(value, expected)| (value - expected).abs() < 1e-12));
        assert!((solved.std(0) - 0.5).abs() < 1e-12);
        assert!((1..4).all(|place| solved.std(place) == f64::INFINITY));
    }

    #[test]
    fn a_prediction_is_as_sure_as_the_factors_it_rests_on() {
        let solved = solved();
        let valid = [vec![true, true, false], vec![true; 3]];
        let on_both = |a: Vec<f64>, b: Vec<f64>| Column::of(vec![(0, a), (1, b)]);
        let none = || vec![0.0; 3];
        // The first factor by half: 3 and 4 halves in the valid rows; of the second and third only the sum is determined.
        let first = on_both(vec![3.0, 4.0, 100.0], none());
        let alike = [on_both(none(), vec![1.0; 3]), on_both(none(), vec![1.0; 3])];
        let std =
            solved.prediction_std(&[std::slice::from_ref(&first), &alike[..], &[Column::default()]].concat(), &valid);
        assert!((std[0] - (0.25f64 * 25.0 / 2.0).sqrt()).abs() < 1e-12 && (std[1] - 1.0).abs() < 1e-12, "{std:?}");
        let apart = [first, on_both(none(), vec![1.0; 3]), Column::default(), Column::default()];
        assert_eq!(solved.prediction_std(&apart, &valid)[1], f64::INFINITY);
    }

    #[test]
    fn errors_of_a_prediction_matter_beyond_a_limit() {
        let solved = solved();
        let valid = [vec![true; 2]];
        let on = |values: [f64; 2]| Column::on(0, values.to_vec());
        // One standard deviation of the first factor, a half, is 1.5 and 2: a root mean square of 1.77.
        let columns = [on([3.0, 4.0]), Column::default(), Column::default(), Column::default()];
        let matter = |limit: f64| solved.errors_of_prediction(&columns, &valid, &[limit]);
        let [(factors, spread)] = &matter(1.76)[..] else { panic!("{:?}", matter(1.76)) };
        assert!((factors[0].abs() - 0.5).abs() < 1e-12 && *spread == 1.0);
        assert!(matter(1.78).is_empty());
        // Of the second and the third only the sum is determined, by a standard deviation of one.
        let apart = [Column::default(), on([1.0, 1.0]), Column::default(), Column::default()];
        let open: Vec<f64> =
            solved.errors_of_prediction(&apart, &valid, &[0.1]).iter().map(|(_, spread)| *spread).collect();
        assert!(open.contains(&f64::INFINITY), "{open:?}");
    }

    #[test]
    fn the_sum_of_two_factors_is_told_where_neither_is() {
        let solved = solved();
        assert!((solved.deviation(&[(1, 1.0), (2, 1.0)]) - 1.0).abs() < 1e-12);
        // Independent of the first: 3 * 0.5 and 4 * 1 together.
        assert!((solved.deviation(&[(0, 3.0), (1, 4.0), (2, 4.0)]) - 1.5f64.hypot(4.0)).abs() < 1e-12);
        assert_eq!(solved.deviation(&[(1, 1.0), (2, -1.0)]), f64::INFINITY);
    }

    #[test]
    fn a_joint_of_stronger_noise_weighs_less() {
        // One factor of both joints: 1 by the first, whose four rows scatter by 1, and 3 by the second.
        let columns = [Column::of(vec![(0, vec![1.0; 4]), (1, vec![1.0; 2])])];
        let torque = Column::of(vec![(0, vec![0.0, 2.0, 0.0, 2.0]), (1, vec![3.0, 3.0])]);
        let own = |joint: usize| {
            let [column, torque] = [&columns[0], &torque].map(|column| column.part(joint).unwrap().to_vec());
            OfJoint { joint, places: vec![0], factors: Arc::new(JointFactors::new(column, 1, torque)), weight: 1.0 }
        };
        let equations = JointEquations::new(Factored { columns: 1, joints: vec![own(0), own(1)] });
        let close = |factors: [f64; 2], expected: [f64; 2]| {
            let left = equations.squared_residuals(&factors);
            assert!(left.iter().zip(expected).all(|(left, expected)| (left - expected).abs() < 1e-9), "{left:?}");
        };
        // The mean of all rows is 10/6; weighed by 1 and 1/4 it is 5.5/4.5.
        let of = |mean: f64, factor: f64| [4.0 + 4.0 * (mean - 1.0).powi(2), 2.0 * ((mean - 3.0) / factor).powi(2)];
        close([1.0, 1.0], of(10.0 / 6.0, 1.0));
        close([1.0, 2.0], of(5.5 / 4.5, 2.0));
    }
}
