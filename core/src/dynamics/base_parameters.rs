//! Base parameters: the combinations of standard parameters that torque determines.

use super::nearly_dependent::{self, Kept, Near};
use crate::linear::{OrthonormalBasis, inner_product, length};
use nalgebra::DMatrix;

/// Part of a unit column that must be left after projecting out the kept columns for it to count as new.
///
/// Lengths and angles of a description have six digits or so: what the seventh makes of a column is no property of the arm. And
/// no log would show it: over a torque noise of a thousandth it takes some ten thousand rows to see a part of 1e-5.
const INDEPENDENT: f64 = 1e-5;

/// Part of a unit column that must be left over the columns before it for it to be kept as it is.
///
/// Below, the column is nearly a combination of others: angles rounded to two decimals leave 5e-3, axes as they were measured
/// leave 1e-3. Its own column would make coefficients of a hundred and more, and no log would separate its parameter from theirs.
const SEPARATE: f64 = 1e-2;

/// Length of a column, over the longest, from which it is kept before those it depends on. Friction has unit columns, and the mass at
/// the end of a long arm one of some hundreds; what only the tilt of an axis makes is shorter.
const SHORT: f64 = 1e-4;

/// Regrouping coefficients below this are rounding of the factorisation.
const NEGLIGIBLE: f64 = 1e-9;

/// What rounding leaves of a unit column that is a combination of others.
const ROUNDING: f64 = 1e-9;

/// One base parameter as a sum of standard parameters.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::identification::model::Model;
/// use tauscope::robot::{self, InertiaCheck};
///
/// // Torque of a pendulum shows the inertias of rod and rotor only as a sum.
/// let model = Model::new(&robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Required)?);
/// let sum = model.base().groupings().iter().find(|grouping| grouping.terms.len() == 2).expect("there is one");
/// let members: Vec<&str> = sum.terms.iter().map(|&(standard, _)| &model.names()[standard][..]).collect();
/// assert_eq!((&sum.name[..], &members[..]), ("Iyy1 + Ia1", &["Iyy1", "Ia1"][..]));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Grouping {
    /// The sum in words: "Izz1 + Ia1 + 0.0225 m2".
    pub name: String,
    /// Index of the standard parameter that leads the sum, with coefficient 1.
    pub leader: usize,
    /// Standard parameter and its coefficient, the leader first.
    pub terms: Vec<(usize, f64)>,
}

/// A set of base parameters beta = K phi and the columns that carry them: Y phi = W beta (Gautier and Khalil 1990; Gautier 1991
/// for the numerical QR method).
///
/// A column of W is that of the regressor for the standard parameter that leads the sum. Where that one is nearly a combination of
/// other kept columns, as under rounded angles and small tilts, the others take its parameter into their sums, as if it depended on them
/// altogether, and its own column is what the combination leaves of it ([`BaseParameters::merged`]). So no two columns are
/// nearly dependent, and the sums of a tilted arm are those of the same arm without the tilt.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use nalgebra::dmatrix;
/// use tauscope::dynamics::BaseParameters;
///
/// // Three columns at random states; the third is twice the first.
/// let observation = dmatrix![1.0, 0.0, 2.0; 0.0, 1.0, 0.0; 1.0, 1.0, 2.0];
/// let base = BaseParameters::new(&observation, &["a", "b", "c"].map(str::to_owned));
/// assert_eq!((base.len(), base.kept()), (2, &[0, 1][..]));
/// assert_eq!(base.groupings()[0].name, "a + 2 c");
///
/// // beta = K phi.
/// let beta = base.values(&[1.0, 5.0, 3.0]);
/// assert!((beta[0] - 7.0).abs() < 1e-12 && (beta[1] - 5.0).abs() < 1e-12);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct BaseParameters {
    kept: Vec<usize>,
    merged: Vec<Vec<(usize, f64)>>,
    regrouping: DMatrix<f64>,
    groupings: Vec<Grouping>,
}

impl BaseParameters {
    /// Finds the base parameters that `observation` (rows of the regressor at random, noise-free states; one column per
    /// standard parameter) can separate. Columns are taken in their order: a column that depends on those kept before it
    /// is regrouped into them, so the base stays on the proximal side. `names` are the standard parameters' symbols.
    ///
    /// The factorisation is a QR of columns of unit length ([`OrthonormalBasis`]); a column counts as dependent when less than 1e-5 of
    /// its length is left, as merged when less than 1e-2 is, and as nothing when it is shorter than 1e-5 of the longest.
    ///
    /// # Panics
    /// If there is not one name per column.
    pub fn new(observation: &DMatrix<f64>, names: &[String]) -> Self {
        let columns = observation.ncols();
        assert_eq!(names.len(), columns, "one name per standard parameter");
        let norms: Vec<f64> = (0..columns).map(|c| observation.column(c).norm()).collect();
        let largest = norms.iter().copied().fold(0.0, f64::max);
        let counts: Vec<usize> = (0..columns).filter(|&c| norms[c] > INDEPENDENT * largest).collect();
        let long: Vec<usize> = counts.iter().copied().filter(|&c| norms[c] > SHORT * largest).collect();
        let rows = observation.nrows();
        let column = |c: usize| &observation.as_slice()[c * rows..][..rows];
        let basis = OrthonormalBasis::new(&long.iter().map(|&c| column(c)).collect::<Vec<_>>(), SEPARATE);
        let separate: Vec<usize> = basis.kept.iter().map(|&k| long[k]).collect();
        // Row r of `triangle` holds q_r . column c, of unit columns.
        let mut triangle = DMatrix::zeros(columns, columns);
        for (own, along) in separate.iter().zip(&basis.along) {
            along.iter().enumerate().for_each(|(r, &part)| triangle[(r, *own)] = part);
        }
        // Residuals of the columns that are regrouped, and of those that are nearly so.
        let mut apart = vec![0.0; columns];
        let mut near = Vec::new();
        for c in counts.into_iter().filter(|c| !separate.contains(c)) {
            let mut rest: Vec<f64> = column(c).iter().map(|x| x / norms[c]).collect();
            let before = separate.iter().take_while(|&&own| own < c).count();
            for (r, q) in basis.directions.iter().enumerate() {
                if r == before && length(&rest) <= INDEPENDENT {
                    break;
                }
                triangle[(r, c)] = inner_product(q, &rest);
                rest.iter_mut().zip(q).for_each(|(x, q)| *x -= triangle[(r, c)] * q);
            }
            match length(&rest) {
                left if left <= INDEPENDENT => apart[c] = left,
                _ => near.push(Near { column: c, size: norms[c], rest }),
            }
        }
        let mut regrouping = regrouping_matrix(&triangle, &separate, &norms, &apart);
        let lengths: Vec<f64> = separate.iter().map(|&own| norms[own]).collect();
        let near = nearly_dependent::reduce(near, INDEPENDENT, &mut regrouping, &lengths);
        Self::assembled(&separate, &regrouping, near, names)
    }

    /// The same with the columns taken in another `order`, which holds each of them once.
    ///
    /// A parameter is regrouped into those before it. Where a body stands behind what it carries, the carried mass would stand for
    /// both, and hardly any motion tells its column from those of the links before: the order must be from the base outwards.
    ///
    /// # Panics
    /// If there is not one name per column.
    pub(crate) fn taken_in(observation: &DMatrix<f64>, names: &[String], order: &[usize]) -> Self {
        let ordered: Vec<String> = order.iter().map(|&column| names[column].clone()).collect();
        let found = Self::new(&observation.select_columns(order), &ordered);
        let mut rows: Vec<usize> = (0..found.len()).collect();
        rows.sort_unstable_by_key(|&row| order[found.kept[row]]);
        let mut places = vec![0; rows.len()];
        rows.iter().enumerate().for_each(|(place, &row)| places[row] = place);
        let mut regrouping = DMatrix::zeros(rows.len(), order.len());
        for (place, &row) in rows.iter().enumerate() {
            for (own, &column) in order.iter().enumerate() {
                regrouping[(place, column)] = found.regrouping[(row, own)];
            }
        }
        let into = |&(other, share): &(usize, f64)| (places[other], share);
        let merged = rows.iter().map(|&row| found.merged[row].iter().map(into).collect()).collect();
        let kept: Vec<usize> = rows.iter().map(|&row| order[found.kept[row]]).collect();
        let groupings = groupings(&regrouping, &kept, names);
        BaseParameters { kept, merged, regrouping, groupings }
    }

    /// The base parameters of columns that are kept as they are, the `regrouping` of all columns into them, and columns that are merged
    /// into them.
    fn assembled(separate: &[usize], regrouping: &DMatrix<f64>, near: Vec<Kept>, names: &[String]) -> Self {
        let mut kept: Vec<usize> = separate.iter().copied().chain(near.iter().map(|near| near.column)).collect();
        kept.sort_unstable();
        let place = |column: usize| kept.iter().take_while(|&&other| other < column).count();
        let mut all = DMatrix::zeros(kept.len(), names.len());
        for (row, &column) in separate.iter().enumerate() {
            all.row_mut(place(column)).copy_from(&regrouping.row(row));
        }
        let mut merged = vec![Vec::new(); kept.len()];
        for Kept { column, shares } in near {
            let own = place(column);
            let into = separate.iter().enumerate().map(|(row, &other)| (place(other), regrouping[(row, column)]));
            merged[own] = into.filter(|(_, share)| *share != 0.0).collect();
            shares.into_iter().for_each(|(other, share)| all[(own, other)] = share);
        }
        let groupings = groupings(&all, &kept, names);
        BaseParameters { kept, merged, regrouping: all, groupings }
    }

    /// Number of base parameters: the rank of the model.
    pub fn len(&self) -> usize {
        self.kept.len()
    }

    /// Whether nothing is determined at all.
    pub fn is_empty(&self) -> bool {
        self.kept.is_empty()
    }

    /// Standard parameters whose columns carry the base parameters, ascending.
    pub fn kept(&self) -> &[usize] {
        &self.kept
    }

    /// The base parameters that a parameter is merged into, with its share in each of their sums; empty for most. Its column is the
    /// regressor's less these shares of theirs.
    pub fn merged(&self, parameter: usize) -> &[(usize, f64)] {
        &self.merged[parameter]
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

    /// Changes of the standard parameters that change no base parameter: one for each that is not kept.
    pub fn unseen(&self) -> Vec<Vec<f64>> {
        let count = self.regrouping.ncols();
        let change = |parameter: usize| {
            let mut change = vec![0.0; count];
            change[parameter] = 1.0;
            let shares = self.carried(self.regrouping.column(parameter).as_slice());
            self.kept.iter().zip(shares).for_each(|(&kept, share)| change[kept] -= share);
            change
        };
        (0..count).filter(|parameter| !self.kept.contains(parameter)).map(change).collect()
    }

    /// Values of the standard parameters that are kept with which base parameters come to `sums` where all others are zero:
    /// what a parameter is merged into holds less of it.
    pub fn carried(&self, sums: &[f64]) -> Vec<f64> {
        let mut values = sums.to_vec();
        for (merged, sum) in self.merged.iter().zip(sums) {
            merged.iter().for_each(|&(into, share)| values[into] -= share * sum);
        }
        values
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
                match short(coefficient.abs()).as_str() {
                    "1" => name += &format!(" {sign} {}", names[index]),
                    size => name += &format!(" {sign} {size} {}", names[index]),
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
    use rand::RngExt;

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
    fn changes_that_are_unseen_change_no_base_parameter() {
        // Columns: a, b, 2 a - 0.5 b, zero.
        let columns = DMatrix::from_row_slice(3, 4, &[1.0, 0.0, 2.0, 0.0, 0.0, 1.0, -0.5, 0.0, 1.0, 1.0, 1.5, 0.0]);
        let base = BaseParameters::new(&columns, &["a", "b", "c", "z"].map(str::to_owned));
        let unseen = base.unseen();
        assert_eq!(unseen.len(), 2);
        for change in &unseen {
            assert!(base.values(change).iter().all(|value| value.abs() < 1e-12), "{change:?}");
            assert!(change.contains(&1.0));
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

    #[test]
    fn columns_are_taken_in_the_order_asked_for() {
        // Columns: 2 a - 0.5 b, a, zero, b.
        let (a, b) = ([1.0, 0.0, 2.0, 1.0], [0.0, 1.0, 1.0, -1.0]);
        let rows = DMatrix::from_fn(4, 4, |r, col| [2.0 * a[r] - 0.5 * b[r], a[r], 0.0, b[r]][col]);
        let names: Vec<String> = ["d", "a", "z", "b"].iter().map(|s| s.to_string()).collect();
        let base = BaseParameters::taken_in(&rows, &names, &[3, 1, 2, 0]);
        assert_eq!(base.kept(), [1, 3]);
        assert_eq!([0, 1].map(|own| base.groupings()[own].name.as_str()), ["a + 2 d", "b - 0.5 d"]);
        assert_eq!(base.groupings()[1].leader, 3);
        for (value, expected) in base.values(&[3.0, 1.0, 100.0, 2.0]).iter().zip([7.0, 0.5]) {
            assert!((value - expected).abs() < 1e-12, "{value} {expected}");
        }
        // In the order in which they stand nothing changes, columns that are nearly combinations of others included.
        for with_p in [false, true] {
            let (columns, base) = tilted(1e-3, with_p);
            let names = ["a", "b", "c", "d", "p", "e"].map(str::to_owned);
            assert_eq!(BaseParameters::taken_in(&columns, &names, &[0, 1, 2, 3, 4, 5]), base);
        }
        // What is merged is merged in any order: d and e are nearly combinations of those before.
        let (columns, base) = tilted(1e-3, false);
        let moved = columns.select_columns(&[4, 3, 5, 0, 1, 2]);
        let names = ["p", "d", "e", "a", "b", "c"].map(str::to_owned);
        let again = BaseParameters::taken_in(&moved, &names, &[3, 4, 5, 1, 0, 2]);
        assert_eq!(again.kept(), [1, 2, 3, 4, 5]);
        let leads = |base: &BaseParameters, own: usize| base.groupings()[own].name.chars().next();
        let named = |base: &BaseParameters, own: usize| -> Vec<_> {
            base.merged(own).iter().map(|&(other, share)| (leads(base, other), share)).collect()
        };
        assert_eq!([named(&again, 0), named(&again, 1)], [named(&base, 3), named(&base, 4)]);
    }

    /// Columns a, b, c, d = a + b + tilt (p + q), p or nothing, e = c + 2 tilt q.
    fn tilted(tilt: f64, with_p: bool) -> (DMatrix<f64>, BaseParameters) {
        let mut source = crate::random::stream(3, "nearly dependent", 0);
        let [a, b, c, p, q] = [0; 5].map(|_| nalgebra::DVector::from_fn(60, |_, _| source.random_range(-1.0..1.0)));
        let sum = &a + &b + tilt * (&p + &q);
        let second = &c + 2.0 * tilt * &q;
        let last = if with_p { p } else { nalgebra::DVector::zeros(60) };
        let columns = DMatrix::from_columns(&[a, b, c, sum, last, second]);
        let names = ["a", "b", "c", "d", "p", "e"].map(str::to_owned);
        let base = BaseParameters::new(&columns, &names);
        (columns, base)
    }

    /// The columns of the base parameters.
    fn carriers(columns: &DMatrix<f64>, base: &BaseParameters) -> DMatrix<f64> {
        let own = |b: usize| {
            let mut column = columns.column(base.kept()[b]).into_owned();
            for &(other, share) in base.merged(b) {
                column -= share * columns.column(base.kept()[other]);
            }
            column
        };
        DMatrix::from_columns(&(0..base.len()).map(own).collect::<Vec<_>>())
    }

    #[test]
    fn nearly_dependent_columns_are_merged() {
        let names = |tilt, with_p| -> Vec<String> {
            let terms = |grouping: &Grouping| {
                let name = |&(own, share): &(usize, f64)| {
                    assert!((share - 1.0).abs() < tilt, "{tilt}: {share}");
                    ["a", "b", "c", "d", "p", "e"][own]
                };
                grouping.terms.iter().map(name).collect::<Vec<_>>().join(" + ")
            };
            tilted(tilt, with_p).1.groupings().iter().map(terms).collect()
        };
        for tilt in [1e-9, 1e-6] {
            assert_eq!(names(tilt, false), ["a + d", "b + d", "c + e"], "{tilt}");
        }
        for tilt in [3e-5, 1e-3, 4e-3] {
            assert_eq!(names(tilt, false), ["a + d", "b + d", "c + e", "d", "e"], "{tilt}");
            // What p explains of the fourth is p's; the rest is explained by the sixth, of which more is left.
            let found = tilted(tilt, true).1;
            assert_eq!(found.kept(), [0, 1, 2, 4, 5], "{tilt}");
            assert_eq!(found.merged(4).len(), 1, "{tilt}");
            assert!((found.regrouping()[(4, 3)] - 0.5).abs() < 1e-9, "{tilt}");
        }
        // Enough of the sixth column is left, of the fourth it is not.
        let merged = |tilt| tilted(tilt, false).1.merged.iter().filter(|merged| !merged.is_empty()).count();
        assert_eq!([4e-3, 7e-3, 3e-2].map(merged), [2, 1, 0]);
        assert!(tilted(3e-2, false).1.merged.iter().all(Vec::is_empty));
    }

    #[test]
    fn merged_parameters_make_the_same_torque() {
        for tilt in [0.0, 3e-5, 1e-3, 4e-3, 1e-2, 3e-2] {
            for with_p in [false, true] {
                let (columns, base) = tilted(tilt, with_p);
                let standard = [1.0, -2.0, 3.0, 0.7, 5.0, -4.0];
                let beta = base.values(&standard);
                let carriers = carriers(&columns, &base);
                let made = &carriers * nalgebra::DVector::from_column_slice(&beta);
                let wanted = &columns * nalgebra::DVector::from_column_slice(&standard);
                assert!((made - wanted).norm() < 1e-4 * 60f64.sqrt(), "{tilt} {with_p}");
                // No two of the columns are alike at unit length.
                let unit: Vec<_> = carriers.column_iter().map(|column| column.normalize()).collect();
                let singular = DMatrix::from_columns(&unit).svd(false, false).singular_values;
                assert!(singular.min() > 5e-3 * singular.max(), "{tilt} {with_p}: {singular}");
                let mut carried = [0.0; 6];
                base.kept().iter().zip(base.carried(&beta)).for_each(|(&own, value)| carried[own] = value);
                for (again, value) in base.values(&carried).iter().zip(&beta) {
                    assert!((again - value).abs() < 1e-12, "{tilt} {with_p}");
                }
            }
        }
    }
}
