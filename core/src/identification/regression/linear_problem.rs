//! The weighted linear regression as a problem for Levenberg-Marquardt, equations (11)-(12) of the paper on the spatial model.

use super::joint_regression::JointRegression;
use crate::error::Result;
use crate::identification::levenberg_marquardt::{LeastSquaresProblem, NormalEquations};
use crate::identification::numerics::scaled_normal::ScaledNormal;
use nalgebra::{DMatrix, DVector};

/// Rows of all joints, weighted by the joints' standard deviations, with the normal matrix worked out once.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::identification::least_squares::{residual_sigma, weighted_least_squares};
/// use tauscope::identification::levenberg_marquardt::{Options, minimize};
/// use tauscope::identification::linear_problem::LinearProblem;
/// use tauscope::identification::model::Model;
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/payload/arm.urdf", InertiaCheck::Ignored)?;
/// # let log = recording::load("../tests/reference/payload/before.csv", None)?;
/// # use tauscope::identification::prepare::{self, Smoothing};
/// # use tauscope::identification::reversals::Band;
/// # let smoothing = Smoothing::SavitzkyGolay { window: 11, order: 4, decimation: 2 };
///
/// // An iterative search on the rows of a log ends where weighted least squares is at once.
/// let model = Model::new(&robot);
/// let rows = prepare::measured(&log, smoothing, Band::OfNoise)?.regression(&model)?;
/// let names: Vec<String> = model.base().groupings().iter().map(|grouping| grouping.name.clone()).collect();
/// let direct = weighted_least_squares(&rows, &names)?;
/// let mut problem = LinearProblem::new(&rows, &direct.sigma, names.len());
/// let searched = minimize(&mut problem, &vec![0.0; names.len()], &Options::default())?.parameters;
/// assert!(searched.iter().zip(&direct.beta).all(|(a, b)| (a - b).abs() < 1e-4 * (1.0 + b.abs())));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
pub struct LinearProblem<'a> {
    joints: &'a [JointRegression],
    sigma: &'a [f64],
    normal: DMatrix<f64>,
}

impl<'a> LinearProblem<'a> {
    /// The problem of `parameters` unknowns with W = 1 / sigma^2 on each joint's rows.
    pub fn new(joints: &'a [JointRegression], sigma: &'a [f64], parameters: usize) -> Self {
        let mut normal = DMatrix::zeros(parameters, parameters);
        for (joint, s) in joints.iter().zip(sigma) {
            joint.add_gram(1.0 / (s * s), &mut normal);
        }
        LinearProblem { joints, sigma, normal }
    }

    /// The problem whose normal matrix is known.
    pub(in crate::identification) fn with_normal(
        joints: &'a [JointRegression],
        sigma: &'a [f64],
        normal: DMatrix<f64>,
    ) -> Self {
        LinearProblem { joints, sigma, normal }
    }

    /// J'WJ.
    pub fn normal(&self) -> &DMatrix<f64> {
        &self.normal
    }

    /// J'W r for one residual per joint.
    pub fn right(&self, residuals: &[Vec<f64>]) -> DVector<f64> {
        let mut right = DVector::zeros(self.normal.nrows());
        for ((joint, s), residual) in self.joints.iter().zip(self.sigma).zip(residuals) {
            for (&parameter, value) in joint.parameters.iter().zip(joint.products(residual)) {
                right[parameter] += value / (s * s);
            }
        }
        right
    }

    /// (J'WJ)^-1 of a right side.
    ///
    /// # Errors
    /// Names the parameters that the motion does not separate.
    pub(in crate::identification) fn solve(&self, right: &DVector<f64>, names: &[String]) -> Result<DVector<f64>> {
        Ok(ScaledNormal::new(&self.normal, names)?.solve(right))
    }

    fn residuals(&self, p: &[f64]) -> Vec<Vec<f64>> {
        self.joints.iter().map(|joint| joint.residual(p)).collect()
    }

    fn weighted_sum(&self, residuals: &[Vec<f64>]) -> f64 {
        let joints = self.joints.iter().zip(self.sigma).zip(residuals);
        joints.map(|((joint, s), residual)| joint.dot(residual, residual) / (s * s)).sum()
    }
}

impl LeastSquaresProblem for LinearProblem<'_> {
    fn parameters(&self) -> usize {
        self.normal.nrows()
    }

    fn measurements(&self) -> usize {
        self.joints.iter().map(JointRegression::rows).sum()
    }

    fn normal_equations(&mut self, p: &[f64]) -> Result<NormalEquations> {
        let residuals = self.residuals(p);
        Ok(NormalEquations {
            jtwj: self.normal.clone(),
            jtwr: self.right(&residuals),
            chi2: self.weighted_sum(&residuals),
        })
    }

    fn chi2(&mut self, p: &[f64]) -> Result<f64> {
        Ok(self.weighted_sum(&self.residuals(p)))
    }
}
