//! From a solution to an [`Estimate`]: covariance with the colour of the residual, weights, condition number.

use crate::error::{Error, Result};
use crate::identification::numerics::scaled_normal::ScaledNormal;
use crate::identification::regression::joint_regression::JointRegression;
use crate::identification::regression::least_squares::{Estimate, NOISE_ORDER, residual_sigma};
use crate::identification::regression::noise::{AutoregressiveNoise, autocovariance};
use nalgebra::{DMatrix, DVector, LU};

/// The moment equations H beta = Z'W tau of rows X and instruments Z with W = 1 / sigma^2 on each joint's rows.
pub(super) struct MomentEquations {
    /// H = Z'W X.
    pub matrix: DMatrix<f64>,
    /// Z'W tau.
    pub right: DVector<f64>,
}

impl MomentEquations {
    /// The equations over the valid rows for the instruments. Both must have the same parameters and number of rows;
    /// with the rows as their own instruments these are the normal equations.
    pub(super) fn new(
        instruments: &[JointRegression],
        rows: &[JointRegression],
        sigma: &[f64],
        parameters: usize,
    ) -> Self {
        let mut matrix = DMatrix::zeros(parameters, parameters);
        let mut right = DVector::zeros(parameters);
        for ((z, x), s) in instruments.iter().zip(rows).zip(sigma) {
            let weight = 1.0 / (s * s);
            let table = |joint: &JointRegression| {
                let masked = joint.columns.map(|_, column| z.masked(column));
                DMatrix::from_row_slice(joint.parameters.len(), masked.samples(), masked.as_slice())
            };
            let product = table(z) * table(x).transpose();
            for (r, &row) in z.parameters.iter().enumerate() {
                right[row] += weight * z.dot(z.columns.channel(r), &x.torque);
                for (c, &column) in x.parameters.iter().enumerate() {
                    matrix[(row, column)] += weight * product[(r, c)];
                }
            }
        }
        MomentEquations { matrix, right }
    }

    /// The solution.
    ///
    /// # Errors
    /// If H is singular: the instruments do not determine some parameters.
    pub(super) fn solve(&self) -> Result<Vec<f64>> {
        let solution = LU::new(self.matrix.clone()).solve(&self.right);
        solution.map(|beta| beta.as_slice().to_vec()).ok_or_else(uninformed)
    }
}

fn uninformed() -> Error {
    Error::request(
        "moment equations",
        "singular: the simulated motion does not determine some parameters; use a richer motion",
    )
}

/// The estimate of a solution `beta` of the moment equations of `instruments` and `rows` under `sigma`, with covariance
/// H^-1 Z'W Cov(noise) W Z H^-T, the noise of each joint modelled as autoregressive from its residual.
///
/// # Errors
/// Names the parameters that the motion does not separate.
pub(super) fn assemble(
    instruments: &[JointRegression],
    rows: &[JointRegression],
    beta: Vec<f64>,
    sigma: &[f64],
    names: &[String],
) -> Result<Estimate> {
    let parameters = beta.len();
    let mut meat = DMatrix::zeros(parameters, parameters);
    let mut gram = DMatrix::zeros(parameters, parameters);
    for ((z, x), s) in instruments.iter().zip(rows).zip(sigma) {
        let residual = x.residual(&beta);
        let noise = AutoregressiveNoise::from_autocovariance(&autocovariance(&residual, &z.valid, NOISE_ORDER));
        let mut colored = z.masked_columns();
        noise.color_backward(&mut colored);
        z.scatter_gram(s.powi(-4), &colored, &mut meat);
        z.add_gram(1.0 / (s * s), &mut gram);
    }
    let moments = MomentEquations::new(instruments, rows, sigma, parameters);
    let inverse = LU::new(moments.matrix).try_inverse().ok_or_else(uninformed)?;
    Ok(Estimate {
        covariance: &inverse * meat * inverse.transpose(),
        condition_number: ScaledNormal::new(&gram, names)?.condition_number,
        sigma: residual_sigma(rows, &beta),
        rows: instruments.iter().map(JointRegression::rows).collect(),
        beta,
    })
}
