//! Columns of the tests: a torque per joint over the rows, held only for the joints on which it acts.

use crate::linear::inner_product;
use std::collections::BTreeSet;
use std::ops::Range;

/// Departure from a level, over it, that rounding makes.
const ROUNDING: f64 = 1e-9;

/// A torque over the rows, `(joint, values)` for every joint on which it is not zero, in the order of the joints.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::diagnosis::{Column, Diagnosis};
///
/// // Joints on which an effect found has torque.
/// fn joints(diagnosis: &Diagnosis) -> Vec<usize> {
///     let columns = diagnosis.found.iter().flat_map(|found| found.member.candidate.columns.iter());
///     columns.flat_map(|Column { parts, .. }| parts.iter().map(|(joint, _)| *joint)).collect()
/// }
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Column {
    /// Joints with their values.
    pub parts: Vec<(usize, Vec<f64>)>,
    /// Values in rows of no joint: observations that stand for what is known of factors before anything is measured.
    pub beforehand: Vec<f64>,
}

impl Column {
    /// From one signal per joint; those that are zero throughout are left out.
    pub fn new(signals: impl IntoIterator<Item = Vec<f64>>) -> Self {
        let parts = signals.into_iter().enumerate();
        Self::of(parts.filter(|(_, signal)| signal.iter().any(|&v| v != 0.0)).collect())
    }

    /// A torque on one joint.
    pub fn on(joint: usize, signal: Vec<f64>) -> Self {
        Self::of(vec![(joint, signal)])
    }

    /// Of joints with their values, in the order of the joints.
    pub fn of(parts: Vec<(usize, Vec<f64>)>) -> Self {
        Column { parts, beforehand: Vec::new() }
    }

    /// The values on a joint.
    pub fn part(&self, joint: usize) -> Option<&[f64]> {
        self.parts.iter().find(|(own, _)| *own == joint).map(|(_, values)| values.as_slice())
    }

    /// The values on a joint, zero over so many `rows` where there are none.
    pub(super) fn part_mut(&mut self, joint: usize, rows: usize) -> &mut Vec<f64> {
        let place = match self.parts.binary_search_by_key(&joint, |(own, _)| *own) {
            Ok(place) => place,
            Err(place) => {
                self.parts.insert(place, (joint, vec![0.0; rows]));
                place
            }
        };
        &mut self.parts[place].1
    }

    /// Inner product over all joints and rows.
    pub fn dot(&self, other: &Column) -> f64 {
        let parts = self.parts.iter().filter_map(|(joint, a)| Some(inner_product(a, other.part(*joint)?)));
        parts.sum::<f64>() + self.dot_beforehand(other)
    }

    /// The same over the rows of what is known beforehand alone.
    pub(crate) fn dot_beforehand(&self, other: &Column) -> f64 {
        self.beforehand.iter().zip(&other.beforehand).map(|(a, b)| a * b).sum()
    }

    /// Adds `factor` times `other`.
    pub fn add(&mut self, factor: f64, other: &Column) {
        for (joint, values) in &other.parts {
            let own = self.part_mut(*joint, values.len());
            own.iter_mut().zip(values).for_each(|(x, y)| *x += factor * y);
        }
        self.beforehand.resize(self.beforehand.len().max(other.beforehand.len()), 0.0);
        self.beforehand.iter_mut().zip(&other.beforehand).for_each(|(x, y)| *x += factor * y);
    }

    /// All values times `factor`.
    pub fn scale(&mut self, factor: f64) {
        self.parts.iter_mut().flat_map(|(_, values)| values).chain(&mut self.beforehand).for_each(|x| *x *= factor);
    }

    /// The same with zeros in the rows that do not count, `[joint][row]`.
    pub fn masked(&self, valid: &[Vec<bool>]) -> Self {
        let parts = self.parts.iter().map(|(joint, values)| {
            let values = values.iter().zip(&valid[*joint]);
            (*joint, values.map(|(&x, &ok)| if ok { x } else { 0.0 }).collect())
        });
        Self::of(parts.collect())
    }

    /// This over the first of two blocks of rows of these lengths, and `other` over the second.
    pub fn then(&self, other: &Column, [first, second]: [usize; 2]) -> Self {
        let joints = self.parts.iter().chain(&other.parts).map(|(joint, _)| *joint);
        let joints: BTreeSet<usize> = joints.collect();
        let of = |column: &Column, joint, rows| column.part(joint).map_or_else(|| vec![0.0; rows], <[f64]>::to_vec);
        let parts =
            joints.into_iter().map(|joint| (joint, [of(self, joint, first), of(other, joint, second)].concat()));
        Self::of(parts.collect())
    }

    /// The same with zeros outside a range of rows.
    pub fn within(&self, rows: Range<usize>) -> Self {
        let mut column = self.clone();
        for (_, values) in &mut column.parts {
            let end = rows.end.min(values.len());
            values[..rows.start.min(end)].fill(0.0);
            values[end..].fill(0.0);
        }
        column
    }

    /// The values in a range of rows alone.
    pub fn rows(&self, rows: Range<usize>) -> Self {
        Self::of(self.parts.iter().map(|(joint, values)| (*joint, values[rows.clone()].to_vec())).collect())
    }

    /// The same on some joints only, without what is known beforehand.
    pub fn only(&self, joints: &[usize]) -> Self {
        Self::of(self.parts.iter().filter(|(joint, _)| joints.contains(joint)).cloned().collect())
    }

    /// Whether all values are numbers and not all are zero.
    pub(crate) fn is_sound(&self) -> bool {
        !self.parts.is_empty() && self.parts.iter().flat_map(|(_, values)| values).all(|v| v.is_finite())
    }
}

/// Joints on which any of `columns` acts.
pub(crate) fn joints_of(columns: &[Column]) -> BTreeSet<usize> {
    columns.iter().flat_map(|column| column.parts.iter().map(|(joint, _)| *joint)).collect()
}

/// Which of `columns` act on a joint, and their values there.
pub(crate) fn parts_on(columns: &[Column], joint: usize) -> (Vec<usize>, Vec<&[f64]>) {
    columns.iter().enumerate().filter_map(|(place, column)| Some((place, column.part(joint)?))).unzip()
}

/// The sum of `columns` with their `values`.
pub(crate) fn combined(columns: &[Column], values: &[f64]) -> Column {
    let mut sum = Column::default();
    for (column, &value) in columns.iter().zip(values) {
        sum.add(value, column);
    }
    sum
}

/// Root mean square over the valid rows, `[joint]`.
pub fn rms(valid: &[Vec<bool>], residual: &Column) -> Vec<f64> {
    valid
        .iter()
        .enumerate()
        .map(|(joint, valid)| {
            let values = residual.part(joint).into_iter().flatten().zip(valid);
            let (sum, count) = values.filter(|(_, ok)| **ok).fold((0.0, 0usize), |(s, n), (r, _)| (s + r * r, n + 1));
            (sum / count.max(1) as f64).sqrt()
        })
        .collect()
}

/// Standard deviation of a residual about its mean over the valid rows, `[joint]`.
pub(crate) fn deviation(valid: &[Vec<bool>], residual: &Column) -> Vec<f64> {
    let spread = |(joint, valid): (usize, &Vec<bool>)| {
        let values = residual.part(joint).into_iter().flatten().zip(valid);
        let of_valid = || values.clone().filter(|(_, ok)| **ok).map(|(x, _)| *x);
        let count = of_valid().count().max(1) as f64;
        let mean = of_valid().sum::<f64>() / count;
        (of_valid().map(|x| (x - mean).powi(2)).sum::<f64>() / count).sqrt()
    };
    valid.iter().enumerate().map(spread).collect()
}

/// Whether a signal is the same everywhere but for rounding.
pub(crate) fn is_constant(signal: &[f64]) -> bool {
    let first = signal.first().copied().unwrap_or_default();
    signal.iter().all(|x| (x - first).abs() <= ROUNDING * first.abs())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joints_without_torque_are_left_out() {
        let mut a = Column::new([vec![0.0, 0.0], vec![1.0, 2.0]]);
        let b = Column::new([vec![3.0, 1.0], vec![0.0, 4.0]]);
        assert_eq!(a.parts.len(), 1);
        assert_eq!(a.dot(&b), 8.0);
        a.add(2.0, &b);
        assert_eq!(a.parts, [(0, vec![6.0, 2.0]), (1, vec![1.0, 10.0])]);
        assert_eq!(combined(&[b.clone(), b.clone()], &[1.0, -1.0]).dot(&b), 0.0);
        assert!(!Column::default().is_sound());
    }

    #[test]
    fn one_column_after_another() {
        let (a, b) = (Column::on(0, vec![1.0, 2.0]), Column::on(2, vec![3.0]));
        let both = a.then(&b, [2, 1]);
        assert_eq!(both.parts, [(0, vec![1.0, 2.0, 0.0]), (2, vec![0.0, 0.0, 3.0])]);
        assert_eq!(both.within(0..2).part(2), Some(&[0.0, 0.0, 0.0][..]));
    }

    #[test]
    fn an_inner_product_of_any_length() {
        for length in 0..40 {
            let a: Vec<f64> = (0..length).map(f64::from).collect();
            let b: Vec<f64> = (0..length).map(|k| f64::from(k) - 3.0).collect();
            // Sums of whole numbers are exact.
            let expected: i64 = (0..i64::from(length)).map(|k| k * (k - 3)).sum();
            assert_eq!(inner_product(&a, &b), expected as f64);
        }
    }

    #[test]
    fn rms_counts_valid_rows_only() {
        let residual = Column::on(1, vec![3.0, 100.0, 4.0]);
        let valid = vec![vec![true; 3], vec![true, false, true]];
        assert_eq!(rms(&valid, &residual), [0.0, 12.5f64.sqrt()]);
        assert_eq!(deviation(&valid, &residual), [0.0, 0.5]);
        assert!(is_constant(&[3.0, 3.0 + 1e-12]) && !is_constant(&[3.0, 3.1]) && !is_constant(&[0.0, 1.0]));
    }
}
