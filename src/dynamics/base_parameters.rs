//! Base parameters: the combinations of standard parameters that torque can tell apart.

use crate::linear::{OrthonormalBasis, inner_product, length};
use nalgebra::DMatrix;

/// Part of a unit column that must be left after projecting out the kept columns for it to count as new.
///
/// Lengths and angles of a description have six digits or so: what the seventh makes of a column is no property of the arm. And
/// no log would show it: over a torque noise of a thousandth it takes some ten thousand rows to see a part of 1e-5.
const INDEPENDENT: f64 = 1e-5;

/// Regrouping coefficients below this are rounding of the factorisation.
const NEGLIGIBLE: f64 = 1e-9;

/// What rounding leaves of a unit column that is a combination of others.
const ROUNDING: f64 = 1e-9;

/// One base parameter as a sum of standard parameters.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Grouping {
    /// The sum in words: "Izz1 + Ia1 + 0.0225 m2".
    pub name: String,
    /// Index of the standard parameter that leads the sum, with coefficient 1.
    pub leader: usize,
    /// Standard parameter and its coefficient, the leader first.
    pub terms: Vec<(usize, f64)>,
}

/// A set of base parameters beta = K phi and the columns of the regressor that carry them: Y phi = Y[:, kept] beta
/// (Gautier and Khalil 1990; Gautier 1991 for the numerical QR method).
#[derive(Debug, Clone, PartialEq)]
pub struct BaseParameters {
    kept: Vec<usize>,
    regrouping: DMatrix<f64>,
    groupings: Vec<Grouping>,
}

impl BaseParameters {
    /// Finds the base parameters that `observation` (rows of the regressor at random, noise-free states; one column per
    /// standard parameter) can tell apart. Columns are taken in their order: a column that depends on those kept before it
    /// is regrouped into them, so the base stays on the proximal side. `names` are the standard parameters' symbols.
    ///
    /// The factorisation is a QR of columns of unit length ([`OrthonormalBasis`]); a column counts as dependent when less than 1e-5 of its length is left, and as nothing when it is shorter than 1e-5 of the longest.
    ///
    /// # Panics
    /// If there is not one name per column.
    pub fn new(observation: &DMatrix<f64>, names: &[String]) -> Self {
        let columns = observation.ncols();
        assert_eq!(names.len(), columns, "one name per standard parameter");
        let norms: Vec<f64> = (0..columns).map(|c| observation.column(c).norm()).collect();
        let largest = norms.iter().copied().fold(0.0, f64::max);
        let counts: Vec<usize> = (0..columns).filter(|&c| norms[c] > INDEPENDENT * largest).collect();
        let rows = observation.nrows();
        let column = |c: usize| &observation.as_slice()[c * rows..][..rows];
        let basis = OrthonormalBasis::new(&counts.iter().map(|&c| column(c)).collect::<Vec<_>>(), INDEPENDENT);
        let kept: Vec<usize> = basis.kept.iter().map(|&k| counts[k]).collect();
        // Row r of `triangle` holds q_r . column c, of unit columns.
        let mut triangle = DMatrix::zeros(columns, columns);
        for (own, along) in kept.iter().zip(&basis.along) {
            along.iter().enumerate().for_each(|(r, &part)| triangle[(r, *own)] = part);
        }
        // Residuals of the columns that are regrouped.
        let mut apart = vec![0.0; columns];
        for c in counts.into_iter().filter(|c| !kept.contains(c)) {
            let mut rest: Vec<f64> = column(c).iter().map(|x| x / norms[c]).collect();
            let before = kept.iter().take_while(|&&own| own < c).count();
            for (r, q) in basis.directions[..before].iter().enumerate() {
                triangle[(r, c)] = inner_product(q, &rest);
                rest.iter_mut().zip(q).for_each(|(x, q)| *x -= triangle[(r, c)] * q);
            }
            apart[c] = length(&rest);
        }
        let regrouping = regrouping_matrix(&triangle, &kept, &norms, &apart);
        let groupings = groupings(&regrouping, &kept, names);
        BaseParameters { kept, regrouping, groupings }
    }

    /// Number of base parameters: the rank of the model.
    pub fn len(&self) -> usize {
        self.kept.len()
    }

    /// Whether nothing can be told apart at all.
    pub fn is_empty(&self) -> bool {
        self.kept.is_empty()
    }

    /// Standard parameters whose columns carry the base parameters, ascending.
    pub fn kept(&self) -> &[usize] {
        &self.kept
    }

    /// K in beta = K phi, one row per base parameter, one column per standard parameter.
    pub fn regrouping(&self) -> &DMatrix<f64> {
        &self.regrouping
    }

    /// The base parameters as sums.
    pub fn groupings(&self) -> &[Grouping] {
        &self.groupings
    }

    /// Values of the base parameters for given standard parameters.
    pub fn values(&self, standard: &[f64]) -> Vec<f64> {
        (&self.regrouping * nalgebra::DVector::from_column_slice(standard)).as_slice().to_vec()
    }
}

/// Solves R_kept P = R for all columns and undoes the scaling of the columns. Coefficients of unit columns that are smaller than
/// what the regrouping leaves `apart` say nothing.
fn regrouping_matrix(triangle: &DMatrix<f64>, kept: &[usize], norms: &[f64], apart: &[f64]) -> DMatrix<f64> {
    let (rank, columns) = (kept.len(), norms.len());
    let mut k = DMatrix::zeros(rank, columns);
    for column in 0..columns {
        if let Some(own) = kept.iter().position(|&index| index == column) {
            k[(own, column)] = 1.0;
            continue;
        }
        let mut part = triangle.view((0, column), (rank, 1)).into_owned();
        for row in (0..rank).rev() {
            let mut value: f64 = part[(row, 0)];
            for later in row + 1..rank {
                value -= triangle[(row, kept[later])] * k[(later, column)] * norms[kept[later]]
                    / norms[column].max(f64::MIN_POSITIVE);
            }
            value /= triangle[(row, kept[row])];
            part[(row, 0)] = value;
            let physical = value * norms[column] / norms[kept[row]];
            let says_nothing = physical.abs() < NEGLIGIBLE || (apart[column] > ROUNDING && value.abs() < apart[column]);
            k[(row, column)] = if says_nothing { 0.0 } else { physical };
        }
    }
    k
}

fn groupings(regrouping: &DMatrix<f64>, kept: &[usize], names: &[String]) -> Vec<Grouping> {
    kept.iter()
        .enumerate()
        .map(|(row, &leader)| {
            let mut terms = vec![(leader, 1.0)];
            terms.extend(
                (0..names.len())
                    .filter(|&c| c != leader && regrouping[(row, c)] != 0.0)
                    .map(|c| (c, regrouping[(row, c)])),
            );
            let mut name = names[leader].clone();
            for &(index, coefficient) in &terms[1..] {
                let sign = if coefficient < 0.0 { '-' } else { '+' };
                let size = coefficient.abs();
                if (size - 1.0).abs() < NEGLIGIBLE {
                    name += &format!(" {sign} {}", names[index]);
                } else {
                    name += &format!(" {sign} {} {}", short(size), names[index]);
                }
            }
            Grouping { name, leader, terms }
        })
        .collect()
}

/// Six significant digits without trailing zeros.
fn short(value: f64) -> String {
    let text = format!("{value:.6}");
    let trimmed = text.trim_end_matches('0').trim_end_matches('.');
    if trimmed == "0" { format!("{value:.3e}") } else { trimmed.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The third column is a combination of the others but for the last digits of a description.
    #[test]
    fn columns_that_are_apart_by_rounded_digits_are_regrouped() {
        let digits = |apart: f64| {
            let rows = [
                [1.0, 0.0, 2.0 + apart, 0.0],
                [0.0, 1.0, 1.0, 1.0],
                [2.0, 0.0, 4.0, 1.0],
                [1.0, 1.0, 3.0 - apart, 0.0],
            ];
            let observation = DMatrix::from_fn(4, 4, |r, c| rows[r][c]);
            BaseParameters::new(&observation, &["a", "b", "c", "d"].map(str::to_owned))
        };
        assert_eq!(digits(0.0).kept(), [0, 1, 3]);
        assert_eq!(digits(3e-6).kept(), [0, 1, 3]);
        assert_eq!(digits(1e-3).kept(), [0, 1, 2, 3]);
        let (exact, rounded) = (digits(0.0), digits(3e-6));
        for (exact, rounded) in exact.regrouping().iter().zip(rounded.regrouping().iter()) {
            assert!((exact - rounded).abs() < 1e-5, "{exact} {rounded}");
            assert_eq!(*exact == 0.0, *rounded == 0.0);
        }
    }

    #[test]
    fn groups_by_hand() {
        // Columns: a, b, 2 a - 0.5 b, zero, c.
        let a = [1.0, 0.0, 2.0, 1.0];
        let b = [0.0, 1.0, 1.0, -1.0];
        let c = [1.0, 1.0, 0.0, 0.0];
        let rows = DMatrix::from_fn(4, 5, |r, col| [a[r], b[r], 2.0 * a[r] - 0.5 * b[r], 0.0, c[r]][col]);
        let names: Vec<String> = ["a", "b", "d", "z", "c"].iter().map(|s| s.to_string()).collect();
        let base = BaseParameters::new(&rows, &names);
        assert_eq!(base.kept(), [0, 1, 4]);
        assert_eq!(base.groupings()[0].name, "a + 2 d");
        assert_eq!(base.groupings()[1].name, "b - 0.5 d");
        let values = base.values(&[1.0, 2.0, 3.0, 100.0, 5.0]);
        for (value, expected) in values.iter().zip([7.0, 0.5, 5.0]) {
            assert!((value - expected).abs() < 1e-12, "{value} {expected}");
        }
    }
}
