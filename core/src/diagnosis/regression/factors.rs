//! A regression factored joint by joint.
//!
//! Whitened columns of a model act on several joints, and the joints have no rows in common. QR factors of each joint's own rows therefore
//! give those of all rows from the small triangles alone (as tall-skinny QR does: Demmel, Grigori, Hoemmen and Langou, SIAM Journal on
//! Scientific Computing 34, 2012). What changes on one joint leaves the factors of the others as they are.

use crate::linear::{product_of, thin_qr};
use nalgebra::{DMatrix, DVector};
use std::sync::Arc;

/// QR factors of the whitened columns that act on one joint, and the whitened torque there.
#[derive(Debug)]
pub(crate) struct JointFactors {
    rows: usize,
    /// Columns that are not finite; they are zero in the factors.
    unsound: Vec<usize>,
    /// Orthonormal directions, one after the other.
    directions: Vec<f64>,
    /// Parts of the columns along the directions, `[direction][column]`.
    triangle: DMatrix<f64>,
    torque: Vec<f64>,
    /// Parts of the torque along the directions.
    along: DVector<f64>,
}

impl JointFactors {
    /// Of `columns`, one after the other, each as long as the `torque`.
    pub(crate) fn new(mut columns: Vec<f64>, torque: Vec<f64>) -> Self {
        let rows = torque.len();
        let mut unsound = Vec::new();
        for (place, column) in columns.chunks_exact_mut(rows.max(1)).enumerate() {
            if !column.iter().all(|x| x.is_finite()) {
                column.fill(0.0);
                unsound.push(place);
            }
        }
        let (directions, triangle) = thin_qr(&columns, rows);
        let along = product_of(&directions, &torque, rows, [triangle.nrows(), 1]);
        JointFactors { rows, unsound, directions, along: along.column(0).into_owned(), triangle, torque }
    }

    /// Number of values held.
    pub(crate) fn size(&self) -> usize {
        self.directions.len() + self.triangle.len() + 2 * self.torque.len()
    }

    /// Number of rows.
    pub(super) fn rows(&self) -> usize {
        self.rows
    }

    /// Orthonormal directions, one after the other.
    pub(super) fn directions(&self) -> &[f64] {
        &self.directions
    }

    /// The whitened torque.
    pub(super) fn torque(&self) -> &[f64] {
        &self.torque
    }

    /// Inner products of the columns with each other, those with the torque, and that of the torque with itself.
    pub(super) fn normal(&self) -> (DMatrix<f64>, DVector<f64>, f64) {
        let square = self.torque.iter().map(|x| x * x).sum();
        (self.triangle.tr_mul(&self.triangle), self.triangle.tr_mul(&self.along), square)
    }
}

/// Factors of a joint in the regression on all joints.
#[derive(Debug, Clone)]
pub(crate) struct OfJoint {
    /// The joint.
    pub joint: usize,
    /// The columns that act on it, by their places among all.
    pub places: Vec<usize>,
    /// Their factors.
    pub factors: Arc<JointFactors>,
    /// Factor on all rows of the joint.
    pub weight: f64,
}

/// A regression of the torque of all joints on the columns of a model.
#[derive(Debug, Clone)]
pub(crate) struct Factored {
    /// Number of columns.
    pub columns: usize,
    /// The joints.
    pub joints: Vec<OfJoint>,
}

impl Factored {
    /// Columns and torque over the directions of all joints instead of over the rows, `[column][direction]`; a column that is not finite
    /// somewhere is zero throughout.
    pub(super) fn condensed(&self) -> (Vec<Vec<f64>>, DVector<f64>) {
        let directions: usize = self.joints.iter().map(|own| own.factors.triangle.nrows()).sum();
        let mut columns = vec![vec![0.0; directions]; self.columns];
        let mut torque = DVector::zeros(directions);
        let mut first = 0;
        for OfJoint { places, factors, weight, .. } in &self.joints {
            let count = factors.triangle.nrows();
            for (&place, part) in places.iter().zip(factors.triangle.column_iter()) {
                columns[place][first..first + count].iter_mut().zip(part.iter()).for_each(|(x, y)| *x = weight * y);
            }
            torque.rows_mut(first, count).copy_from(&(&factors.along * *weight));
            first += count;
        }
        let unsound = self.joints.iter().flat_map(|own| own.factors.unsound.iter().map(|&place| own.places[place]));
        unsound.for_each(|place| columns[place].fill(0.0));
        (columns, torque)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_have_the_inner_products_of_the_columns() {
        let columns = vec![1.0, 2.0, -1.0, 0.5, 0.0, 3.0];
        let factors = JointFactors::new(columns, vec![2.0, 1.0, 1.0]);
        let (gram, right, square) = factors.normal();
        let expected = DMatrix::from_row_slice(2, 2, &[6.0, -2.5, -2.5, 9.25]);
        assert!((gram - expected).norm() < 1e-14 && square == 6.0);
        assert!((right - DVector::from_vec(vec![3.0, 4.0])).norm() < 1e-14);
    }

    #[test]
    fn what_is_not_finite_on_one_joint_is_left_out_on_all() {
        let own = |joint, columns: Vec<f64>| OfJoint {
            joint,
            places: vec![0, 1],
            factors: Arc::new(JointFactors::new(columns, vec![1.0, 1.0])),
            weight: 2.0,
        };
        let joints = vec![own(0, vec![3.0, 4.0, f64::NAN, 1.0]), own(1, vec![0.0, 1.0, 1.0, 0.0])];
        let (columns, torque) = Factored { columns: 2, joints }.condensed();
        assert_eq!(columns[1], [0.0; 4]);
        let length = columns[0].iter().map(|x| x * x).sum::<f64>();
        assert!((length - 4.0 * 26.0).abs() < 1e-12, "{columns:?}");
        // The torque has parts outside the span.
        assert!(torque.norm_squared() < 4.0 * 4.0);
    }
}
