//! What weighted least squares needs to know of each joint's rows [X y]: their Gram matrix, or where that has lost too many
//! digits their triangle. The solution for any weights of the joints follows without the rows.

use crate::error::{Error, Result};
use crate::identification::numerics::scaled_normal::ScaledNormal;
use crate::identification::numerics::tsqr::Triangle;
use nalgebra::{Cholesky, DMatrix, DVector};
use std::cell::OnceCell;

/// Condition number of the scaled regressor up to which the normal equations are trusted; half the digits are gone there.
const TRUSTED: f64 = 1e6;

/// Square of the smallest pivot of the scaled normal matrix above which its condition number needs no looking at.
const PIVOT: f64 = 1e-8;

/// Share of the torque's sum of squares down to which a residual's can be had from a Gram matrix, to 1e-9 of itself.
const RESOLVED: f64 = 1e-6;

/// The sums over one joint's rows.
#[derive(Debug, Clone)]
pub struct JointSums {
    /// Which parameters the columns belong to.
    pub parameters: Vec<usize>,
    /// Valid rows.
    pub rows: usize,
    /// [X y]'[X y]: the torque is last.
    pub gram: DMatrix<f64>,
}

impl JointSums {
    /// Sum of squares of the torque.
    fn torque(&self) -> f64 {
        self.gram[(self.parameters.len(), self.parameters.len())]
    }

    /// The smallest sum of squares of a residual that the Gram matrix resolves.
    pub(crate) fn least_residual(&self) -> f64 {
        RESOLVED * self.torque()
    }

    /// Sum of squares of y - X beta; None where the Gram matrix does not resolve it.
    pub(crate) fn residual(&self, beta: &[f64]) -> Option<f64> {
        let signed = self.parameters.iter().map(|&p| -beta[p]).chain([1.0]);
        let signed = DVector::from_iterator(self.parameters.len() + 1, signed);
        Some((&self.gram * &signed).dot(&signed)).filter(|&sum| sum > self.least_residual())
    }
}

/// The sums of all joints, and how to come by their triangles should they be wanted.
pub(crate) struct Sums<'a> {
    joints: Vec<JointSums>,
    triangles: OnceCell<Vec<DMatrix<f64>>>,
    /// Triangles of [X y] of all joints.
    make_triangles: Box<dyn Fn() -> Vec<DMatrix<f64>> + 'a>,
}

impl<'a> Sums<'a> {
    /// The sums of Gram matrices, with what makes the triangles from a second pass over the rows.
    pub(crate) fn new(joints: Vec<JointSums>, make_triangles: impl Fn() -> Vec<DMatrix<f64>> + 'a) -> Self {
        Sums { joints, triangles: OnceCell::new(), make_triangles: Box::new(make_triangles) }
    }

    /// The joints.
    pub(crate) fn joints(&self) -> &[JointSums] {
        &self.joints
    }

    /// X'WX with W = 1 / sigma^2 on each joint's rows.
    pub(crate) fn normal(&self, sigma: &[f64], parameters: usize) -> DMatrix<f64> {
        let mut normal = DMatrix::zeros(parameters, parameters);
        for (joint, s) in self.joints.iter().zip(sigma) {
            let weight = 1.0 / (s * s);
            for (&column, own) in joint.parameters.iter().zip(joint.gram.column_iter()) {
                let mut target = normal.column_mut(column);
                for (&row, sum) in joint.parameters.iter().zip(own.iter()) {
                    target[row] += weight * sum;
                }
            }
        }
        normal
    }

    /// X'W y.
    fn right(&self, sigma: &[f64], parameters: usize) -> DVector<f64> {
        let mut right = DVector::zeros(parameters);
        for (joint, s) in self.joints.iter().zip(sigma) {
            for (r, &row) in joint.parameters.iter().enumerate() {
                right[row] += joint.gram[(r, joint.parameters.len())] / (s * s);
            }
        }
        right
    }

    /// The solution alone, where the normal equations are far from losing too many digits; else by [`Sums::solve`].
    ///
    /// # Errors
    /// As [`Sums::solve`].
    pub(in crate::identification) fn solution(&self, sigma: &[f64], names: &[String]) -> Result<DVector<f64>> {
        let parameters = names.len();
        let normal = self.normal(sigma, parameters);
        let scale = normal.diagonal().map(|d| if d > 0.0 { 1.0 / d.sqrt() } else { 0.0 });
        let unit = DMatrix::from_fn(parameters, parameters, |r, c| normal[(r, c)] * scale[r] * scale[c]);
        // Pivots bound the smallest eigenvalue from above only: a cheap sign of trouble, hence the wide margin.
        let factor =
            Cholesky::new(unit).filter(|factor| factor.l_dirty().diagonal().iter().all(|pivot| pivot * pivot > PIVOT));
        match factor {
            Some(factor) => {
                let right = self.right(sigma, parameters).component_mul(&scale);
                Ok(factor.solve(&right).component_mul(&scale))
            }
            None => Ok(self.solve(sigma, names)?.0),
        }
    }

    /// The solution and the factored normal matrix: by Cholesky on columns of unit length, or from the triangles where the
    /// condition number is too high for that.
    ///
    /// # Errors
    /// Names the parameters that the motion does not separate.
    pub(in crate::identification) fn solve(
        &self,
        sigma: &[f64],
        names: &[String],
    ) -> Result<(DVector<f64>, ScaledNormal)> {
        let parameters = names.len();
        match ScaledNormal::new(&self.normal(sigma, parameters), names) {
            Ok(scaled) if scaled.condition_number <= TRUSTED => {
                Ok((scaled.solve(&self.right(sigma, parameters)), scaled))
            }
            _ => self.solve_by_triangles(sigma, names),
        }
    }

    pub(in crate::identification) fn solve_by_triangles(
        &self,
        sigma: &[f64],
        names: &[String],
    ) -> Result<(DVector<f64>, ScaledNormal)> {
        let parameters = names.len();
        let triangles = self.triangles.get_or_init(|| (self.make_triangles)());
        let mut all = Triangle::new(parameters + 1);
        for ((joint, triangle), s) in self.joints.iter().zip(triangles).zip(sigma) {
            let rows = triangle.nrows();
            let mut table = vec![0.0; (parameters + 1) * rows];
            let places = joint.parameters.iter().copied().chain([parameters]);
            for (place, column) in places.zip(triangle.column_iter()) {
                let target = &mut table[place * rows..][..rows];
                target.iter_mut().zip(column.iter()).for_each(|(t, value)| *t = value / s);
            }
            all.add(&table, rows);
        }
        let all = all.factor();
        let factor = all.view((0, 0), (parameters, parameters)).into_owned();
        let scaled = ScaledNormal::from_triangle(&factor, names)?;
        let right = all.view((0, parameters), (parameters, 1)).column(0).into_owned();
        let beta = factor.solve_upper_triangular(&right).ok_or_else(|| {
            Error::request("regression", "some parameters are not excited at all; use a richer motion")
        })?;
        Ok((beta, scaled))
    }
}
