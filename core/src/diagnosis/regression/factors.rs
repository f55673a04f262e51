//! A regression factored joint by joint.
//!
//! Whitened columns of a model act on several joints, and the joints have no rows in common. QR factors of each joint's own rows therefore
//! give those of all rows from the small triangles alone (as tall-skinny QR does: Demmel, Grigori, Hoemmen and Langou, SIAM Journal on
//! Scientific Computing 34, 2012). What changes on one joint leaves the factors of the others as they are.

use crate::linear::{inner_product, product_of, thin_qr};
use nalgebra::{DMatrix, DVector};
use std::sync::{Arc, OnceLock};

/// The whitened columns that act on one joint and the whitened torque there, with what a regression takes of them: normal equations and QR
/// factors, each worked out once it is asked for.
#[derive(Debug)]
pub(crate) struct JointFactors {
    /// One after the other; those that are not finite are zero.
    columns: Vec<f64>,
    /// Their number, which a joint without rows has too.
    count: usize,
    unsound: Vec<usize>,
    torque: Vec<f64>,
    normal: OnceLock<Normal>,
    qr: OnceLock<Factors>,
}

/// Normal equations of a joint.
#[derive(Debug)]
pub(super) struct Normal {
    /// Inner products of the columns with each other.
    pub gram: DMatrix<f64>,
    /// Those with the torque.
    pub right: DVector<f64>,
    /// That of the torque with itself.
    pub square: f64,
}

/// QR factors of a joint.
#[derive(Debug)]
struct Factors {
    /// Orthonormal directions, one after the other.
    directions: Vec<f64>,
    /// Parts of the columns along the directions, `[direction][column]`.
    triangle: DMatrix<f64>,
    /// Parts of the torque along the directions.
    along: DVector<f64>,
}

impl JointFactors {
    /// Of `count` columns, one after the other, each as long as the `torque`.
    pub(crate) fn new(mut columns: Vec<f64>, count: usize, torque: Vec<f64>) -> Self {
        let mut unsound = Vec::new();
        for (place, column) in columns.chunks_exact_mut(torque.len().max(1)).enumerate() {
            if !column.iter().all(|x| x.is_finite()) {
                column.fill(0.0);
                unsound.push(place);
            }
        }
        JointFactors { columns, count, unsound, torque, normal: OnceLock::new(), qr: OnceLock::new() }
    }

    /// Most values that it comes to hold.
    pub(crate) fn size(&self) -> usize {
        2 * self.columns.len() + 2 * self.torque.len()
    }

    /// Number of rows.
    pub(super) fn rows(&self) -> usize {
        self.torque.len()
    }

    /// The whitened torque.
    pub(super) fn torque(&self) -> &[f64] {
        &self.torque
    }

    /// Number of orthonormal directions.
    pub(super) fn rank(&self) -> usize {
        self.qr().triangle.nrows()
    }

    /// Orthonormal directions, one after the other.
    pub(super) fn directions(&self) -> &[f64] {
        &self.qr().directions
    }

    /// The normal equations.
    pub(super) fn normal(&self) -> &Normal {
        self.normal.get_or_init(|| {
            let (rows, count) = (self.rows(), self.count);
            let gram = product_of(&self.columns, &self.columns, rows, [count, count]);
            let right = product_of(&self.columns, &self.torque, rows, [count, 1]).column(0).into_owned();
            Normal { gram, right, square: inner_product(&self.torque, &self.torque) }
        })
    }

    fn qr(&self) -> &Factors {
        self.qr.get_or_init(|| {
            let (directions, triangle) = thin_qr(&self.columns, self.rows());
            let along = product_of(&directions, &self.torque, self.rows(), [triangle.nrows(), 1]);
            Factors { directions, triangle, along: along.column(0).into_owned() }
        })
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
        let directions: usize = self.joints.iter().map(|own| own.factors.rank()).sum();
        let mut columns = vec![vec![0.0; directions]; self.columns];
        let mut torque = DVector::zeros(directions);
        let mut first = 0;
        for OfJoint { places, factors, weight, .. } in &self.joints {
            let Factors { triangle, along, .. } = factors.qr();
            let count = factors.rank();
            for (&place, part) in places.iter().zip(triangle.column_iter()) {
                columns[place][first..first + count].iter_mut().zip(part.iter()).for_each(|(x, y)| *x = weight * y);
            }
            torque.rows_mut(first, count).copy_from(&(along * *weight));
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
    use crate::diagnosis::regression::JointEquations;

    #[test]
    fn factors_have_the_inner_products_of_the_columns() {
        let columns = vec![1.0, 2.0, -1.0, 0.5, 0.0, 3.0];
        let factors = JointFactors::new(columns, 2, vec![2.0, 1.0, 1.0]);
        let Normal { gram, right, square } = factors.normal();
        let expected = DMatrix::from_row_slice(2, 2, &[6.0, -2.5, -2.5, 9.25]);
        assert!((gram - &expected).norm() < 1e-14 && *square == 6.0);
        assert!((right - DVector::from_vec(vec![3.0, 4.0])).norm() < 1e-14);
        let Factors { triangle, along, .. } = factors.qr();
        assert!((triangle.tr_mul(triangle) - expected).norm() < 1e-14);
        assert!((triangle.tr_mul(along) - right).norm() < 1e-14);
    }

    #[test]
    fn a_joint_without_rows_has_no_part_in_a_fit() {
        let own = |joint, columns: Vec<f64>, torque: Vec<f64>| OfJoint {
            joint,
            places: vec![0, 1],
            factors: Arc::new(JointFactors::new(columns, 2, torque)),
            weight: 1.0,
        };
        let joints = vec![own(0, Vec::new(), Vec::new()), own(1, vec![2.0, 0.0, 0.0, 4.0], vec![2.0, 2.0])];
        let Normal { gram, right, square } = joints[0].factors.normal();
        assert_eq!((gram.shape(), right.len(), *square), ((2, 2), 2, 0.0));
        let (columns, torque) = Factored { columns: 2, joints: joints.clone() }.condensed();
        assert_eq!((columns[0].len(), torque.len()), (2, 2));
        let solved = JointEquations::new(Factored { columns: 2, joints }).solved(|_| 1.0);
        assert!((solved.values[0] - 1.0).abs() < 1e-12 && (solved.values[1] - 0.5).abs() < 1e-12);
    }

    #[test]
    fn what_is_not_finite_on_one_joint_is_left_out_on_all() {
        let own = |joint, columns: Vec<f64>| OfJoint {
            joint,
            places: vec![0, 1],
            factors: Arc::new(JointFactors::new(columns, 2, vec![1.0, 1.0])),
            weight: 2.0,
        };
        let joints = vec![own(0, vec![3.0, 4.0, f64::NAN, 1.0]), own(1, vec![0.0, 1.0, 1.0, 0.0])];
        let (columns, torque) = Factored { columns: 2, joints }.condensed();
        assert_eq!(columns[1], [0.0; 4]);
        let length = columns[0].iter().map(|x| x * x).sum::<f64>();
        assert!((length - 4.0 * 26.0).abs() < 1e-12, "{columns:?}");
        // Two directions of a joint hold all of its two rows.
        assert!((torque.norm_squared() - 4.0 * 4.0).abs() < 1e-12);
    }
}
