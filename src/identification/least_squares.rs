//! Weighted least squares on base parameters, with weights per joint and standard deviations that allow for coloured noise.

use super::noise::AutoregressiveNoise;
use crate::channels::Channels;
use crate::error::{Error, Result};
use nalgebra::{Cholesky, DMatrix, DVector, Dyn, SymmetricEigen};

/// Order of the noise model behind the standard deviations.
const NOISE_ORDER: usize = 12;

/// Times the weights are taken anew from the residual.
const REWEIGHTINGS: usize = 3;

/// Smallest eigenvalue of the scaled normal matrix, over its largest, that still counts as identifiable.
const SINGULAR: f64 = 1e-13;

/// The 97.5 % point of the normal distribution.
pub const NORMAL_95: f64 = 1.959_963_984_540_054;

/// One joint's share of a linear regression: torque = columns * parameters.
#[derive(Debug, Clone)]
pub struct JointRegression {
    /// Which parameters the columns belong to.
    pub parameters: Vec<usize>,
    /// Columns, [active parameter][row].
    pub columns: Channels,
    /// Measured torque of each row.
    pub torque: Vec<f64>,
    /// Rows that count; the others are kept in place so that noise can be followed over time.
    pub valid: Vec<bool>,
}

impl JointRegression {
    /// Number of rows that count.
    pub fn rows(&self) -> usize {
        self.valid.iter().filter(|&&ok| ok).count()
    }

    /// Torque that `beta` predicts, for every row.
    pub fn predict(&self, beta: &[f64]) -> Vec<f64> {
        let mut torque = vec![0.0; self.columns.samples()];
        for (&parameter, column) in self.parameters.iter().zip(self.columns.iter()) {
            for (value, x) in torque.iter_mut().zip(column) {
                *value += x * beta[parameter];
            }
        }
        torque
    }

    /// Torque minus prediction, for every row.
    pub fn residual(&self, beta: &[f64]) -> Vec<f64> {
        self.torque.iter().zip(self.predict(beta)).map(|(measured, model)| measured - model).collect()
    }

    /// Root mean square of the residual over the rows that count.
    pub fn residual_rms(&self, beta: &[f64]) -> f64 {
        let residual = self.residual(beta);
        let sum: f64 = residual.iter().zip(&self.valid).filter(|(_, ok)| **ok).map(|(r, _)| r * r).sum();
        (sum / self.rows().max(1) as f64).sqrt()
    }

    /// X'X and X'y over the rows that count, on the joint's own parameters.
    pub(super) fn gram(&self) -> (DMatrix<f64>, DVector<f64>) {
        let masked = self.columns.map(|_, column| self.masked(column));
        let n = self.parameters.len();
        let matrix = DMatrix::from_row_slice(n, self.columns.samples(), masked.as_slice());
        let torque = DVector::from_vec(self.masked(&self.torque));
        (&matrix * matrix.transpose(), &matrix * torque)
    }

    fn masked(&self, signal: &[f64]) -> Vec<f64> {
        signal.iter().zip(&self.valid).map(|(&value, &ok)| if ok { value } else { 0.0 }).collect()
    }
}

/// What identification found.
#[derive(Debug, Clone)]
pub struct Estimate {
    /// Base parameters.
    pub beta: Vec<f64>,
    /// Covariance of the base parameters, with the colour of the residual taken into account.
    pub covariance: DMatrix<f64>,
    /// Standard deviation of the residual of each joint, the inverse root of its weight, N m.
    pub sigma: Vec<f64>,
    /// Condition number of the regressor with rows divided by sigma and columns of unit length.
    pub condition_number: f64,
    /// Rows used of each joint.
    pub rows: Vec<usize>,
}

impl Estimate {
    /// Standard deviation of each base parameter.
    pub fn std(&self) -> Vec<f64> {
        self.covariance.diagonal().iter().map(|v| v.max(0.0).sqrt()).collect()
    }

    /// 95 % confidence intervals of the base parameters.
    pub fn intervals(&self) -> Vec<[f64; 2]> {
        let half = |std: f64| NORMAL_95 * std;
        self.beta.iter().zip(self.std()).map(|(&b, s)| [b - half(s), b + half(s)]).collect()
    }
}

/// Weighted least squares over all joints; the weights come from each joint's own residual (Gautier 1997).
///
/// `names` are the parameters' names, for errors.
///
/// # Errors
/// Names the parameters the motion does not excite, or the joint without rows.
pub fn weighted_least_squares(joints: &[JointRegression], names: &[String]) -> Result<Estimate> {
    for (index, joint) in joints.iter().enumerate() {
        if joint.rows() < 2 * joint.parameters.len() {
            let problem = format!(
                "{} usable samples for {} parameters; the log is too short or the joint hardly moves",
                joint.rows(),
                joint.parameters.len()
            );
            return Err(Error::request(format!("joint {}", index + 1), problem));
        }
    }
    let grams: Vec<_> = joints.iter().map(JointRegression::gram).collect();
    let mut sigma = vec![1.0; joints.len()];
    let mut beta = vec![0.0; names.len()];
    for _ in 0..=REWEIGHTINGS {
        beta = solution(joints, &grams, &sigma, names)?;
        sigma = residual_sigma(joints, &beta);
    }
    let (normal, _) = weighted_normal_equations(joints, &grams, &sigma, names.len());
    let scaled = ScaledNormal::new(&normal, names)?;
    Ok(Estimate {
        covariance: sandwich(joints, &beta, &sigma, &scaled),
        condition_number: scaled.condition_number,
        rows: joints.iter().map(JointRegression::rows).collect(),
        beta,
        sigma,
    })
}

/// The parameters that fit best when the residuals of the joints have the standard deviations `sigma`.
///
/// # Errors
/// Names the parameters the motion does not excite.
pub fn weighted_solution(joints: &[JointRegression], sigma: &[f64], names: &[String]) -> Result<Vec<f64>> {
    let grams: Vec<_> = joints.iter().map(JointRegression::gram).collect();
    solution(joints, &grams, sigma, names)
}

fn solution(
    joints: &[JointRegression],
    grams: &[(DMatrix<f64>, DVector<f64>)],
    sigma: &[f64],
    names: &[String],
) -> Result<Vec<f64>> {
    let (normal, right) = weighted_normal_equations(joints, grams, sigma, names.len());
    Ok(ScaledNormal::new(&normal, names)?.solve(&right).as_slice().to_vec())
}

/// J'WJ and J'Wy of the whole regression for given joint standard deviations.
pub fn weighted_normal_equations(
    joints: &[JointRegression],
    grams: &[(DMatrix<f64>, DVector<f64>)],
    sigma: &[f64],
    parameters: usize,
) -> (DMatrix<f64>, DVector<f64>) {
    let mut normal = DMatrix::zeros(parameters, parameters);
    let mut right = DVector::zeros(parameters);
    for ((joint, (gram, moment)), s) in joints.iter().zip(grams).zip(sigma) {
        let weight = 1.0 / (s * s);
        for (r, &row) in joint.parameters.iter().enumerate() {
            right[row] += weight * moment[r];
            for (c, &column) in joint.parameters.iter().enumerate() {
                normal[(row, column)] += weight * gram[(r, c)];
            }
        }
    }
    (normal, right)
}

/// Standard deviation of each joint's residual. A residual without noise would give an infinite weight, so it is kept
/// above rounding.
fn residual_sigma(joints: &[JointRegression], beta: &[f64]) -> Vec<f64> {
    joints
        .iter()
        .map(|joint| {
            let largest = joint.torque.iter().fold(0.0f64, |m, v| m.max(v.abs()));
            let freedom = joint.rows() as f64 / (joint.rows() - joint.parameters.len()) as f64;
            (joint.residual_rms(beta) * freedom.sqrt()).max(1e-12 * largest).max(f64::MIN_POSITIVE)
        })
        .collect()
}

/// Covariance H^-1 X'W Cov(noise) W X H^-1, the noise of each joint modelled as autoregressive from its residual: white
/// noise gives H^-1, coloured noise what it costs.
fn sandwich(joints: &[JointRegression], beta: &[f64], sigma: &[f64], normal: &ScaledNormal) -> DMatrix<f64> {
    let parameters = beta.len();
    let mut meat = DMatrix::zeros(parameters, parameters);
    for (joint, s) in joints.iter().zip(sigma) {
        let residual = joint.residual(beta);
        let noise = AutoregressiveNoise::fit(&residual, &joint.valid, NOISE_ORDER, joint.parameters.len() as f64);
        let colored = joint.columns.map(|_, column| {
            let mut signal = joint.masked(column);
            noise.color_backward(&mut signal);
            signal
        });
        let matrix = DMatrix::from_row_slice(joint.parameters.len(), joint.columns.samples(), colored.as_slice());
        let gram = &matrix * matrix.transpose() / s.powi(4);
        for (r, &row) in joint.parameters.iter().enumerate() {
            for (c, &column) in joint.parameters.iter().enumerate() {
                meat[(row, column)] += gram[(r, c)];
            }
        }
    }
    let bread = normal.inverse();
    &bread * meat * &bread
}

/// Normal matrix with unit diagonal, factored; the square root of its condition number is the regressor's.
struct ScaledNormal {
    scale: DVector<f64>,
    factor: Cholesky<f64, Dyn>,
    condition_number: f64,
}

impl ScaledNormal {
    fn new(normal: &DMatrix<f64>, names: &[String]) -> Result<Self> {
        let scale = normal.diagonal().map(|d| if d > 0.0 { 1.0 / d.sqrt() } else { 0.0 });
        let still: Vec<&str> =
            scale.iter().zip(names).filter(|(s, _)| **s == 0.0).map(|(_, name)| name.as_str()).collect();
        if !still.is_empty() {
            return Err(Error::request(still.join("; "), "the motion does not excite this at all; move that joint"));
        }
        let mut unit = DMatrix::from_fn(normal.nrows(), normal.ncols(), |r, c| normal[(r, c)] * scale[r] * scale[c]);
        unit.fill_upper_triangle_with_lower_triangle();
        let eigen = SymmetricEigen::new(unit.clone());
        let (low, high) = (eigen.eigenvalues.min(), eigen.eigenvalues.max());
        if low < SINGULAR * high {
            let weakest = eigen.eigenvectors.column(eigen.eigenvalues.imin());
            let mut order: Vec<usize> = (0..names.len()).collect();
            order.sort_by(|&a, &b| weakest[b].abs().total_cmp(&weakest[a].abs()));
            let tied: Vec<&str> = order
                .iter()
                .take_while(|&&i| weakest[i].abs() > 0.1 * weakest[order[0]].abs())
                .map(|&i| names[i].as_str())
                .collect();
            return Err(Error::request(
                tied.join("; "),
                "the motion cannot tell these parameters apart; use a richer motion (each joint with durations of its own)",
            ));
        }
        let factor = Cholesky::new(unit)
            .ok_or_else(|| Error::request("normal equations", "not positive definite; use a richer motion"))?;
        Ok(ScaledNormal { scale, factor, condition_number: (high / low).sqrt() })
    }

    fn solve(&self, right: &DVector<f64>) -> DVector<f64> {
        self.factor.solve(&right.component_mul(&self.scale)).component_mul(&self.scale)
    }

    fn inverse(&self) -> DMatrix<f64> {
        let unit = self.factor.inverse();
        DMatrix::from_fn(unit.nrows(), unit.ncols(), |r, c| unit[(r, c)] * self.scale[r] * self.scale[c])
    }
}
