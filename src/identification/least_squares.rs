//! Weighted least squares on base parameters, with weights per joint and standard deviations that allow for coloured noise.

use super::gram::{BLOCK, Gram, products, valid_block};
use super::joint_sums::{JointSums, Sums};
use super::linear_problem::LinearProblem;
use super::noise::{AutoregressiveNoise, autocovariance, simulate_together};
use super::sequences::combined;
use super::spectrum::Spectrum;
use super::tsqr::Triangle;
use crate::channels::Channels;
use crate::error::{Error, Result};
use crate::random;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::inverse::{inverse as llt_inverse, inverse_scratch};
use faer::{MatMut, MatRef, Par};
use nalgebra::{Cholesky, DMatrix, DVector, Dyn, SymmetricEigen};

/// Order of the noise model behind the standard deviations.
pub(super) const NOISE_ORDER: usize = 12;

/// Rounds of, and draws in each round of, correcting the noise model for what the fit swallows.
const BIAS_ROUNDS: u64 = 2;
const BIAS_DRAWS: u64 = 10;

/// Times the weights are taken anew from the residual.
pub const REWEIGHTINGS: usize = 3;

/// Smallest eigenvalue of the scaled normal matrix, over its largest, that still counts as identifiable.
const SINGULAR: f64 = 1e-13;

/// The same for the singular values of a triangle, which are the eigenvalues' roots.
const SINGULAR_OF_TRIANGLE: f64 = 1e-8;

/// The 97.5 % point of the normal distribution.
pub const NORMAL_95: f64 = 1.959_963_984_540_054;

/// One joint's share of a linear regression: torque = columns * parameters.
#[derive(Debug, Clone)]
pub struct JointRegression {
    /// Name of the joint.
    pub joint: String,
    /// Which parameters the columns belong to.
    pub parameters: Vec<usize>,
    /// Columns, `[active parameter][row]`.
    pub columns: Channels,
    /// Measured torque of each row.
    pub torque: Vec<f64>,
    /// Rows that count; the others are kept in place so that noise can be followed over time.
    pub valid: Vec<bool>,
}

impl JointRegression {
    /// Several logs of one joint one after the other, with `separation` rows without weight between them.
    pub fn joined(mut parts: Vec<JointRegression>, separation: usize) -> Self {
        // A single log, which may be long, stays where it is.
        if parts.len() == 1 && parts[0].parameters.is_sorted_by(|a, b| a < b) {
            return parts.swap_remove(0);
        }
        let mut parameters: Vec<usize> = parts.iter().flat_map(|part| part.parameters.clone()).collect();
        parameters.sort_unstable();
        parameters.dedup();
        let rows: usize = parts.iter().map(|part| part.columns.samples()).sum();
        let samples = rows + separation * parts.len().saturating_sub(1);
        let mut joined = JointRegression {
            joint: parts.first().map_or(String::new(), |part| part.joint.clone()),
            columns: Channels::zeros(parameters.len(), samples),
            torque: vec![0.0; samples],
            valid: vec![false; samples],
            parameters,
        };
        let mut start = 0;
        for part in parts {
            let rows = start..start + part.columns.samples();
            joined.torque[rows.clone()].copy_from_slice(&part.torque);
            joined.valid[rows.clone()].copy_from_slice(&part.valid);
            for (parameter, column) in part.parameters.iter().zip(part.columns.iter()) {
                let place = joined.parameters.iter().position(|p| p == parameter);
                // A parameter can have several columns of one joint only by summing them.
                if let Some(place) = place {
                    let target = &mut joined.columns.channel_mut(place)[rows.clone()];
                    target.iter_mut().zip(column).for_each(|(t, c)| *t += c);
                }
            }
            start = rows.end + separation;
        }
        joined
    }

    /// Adds the column of one more parameter, whose present `value` is already part of the prediction.
    pub(super) fn append(&mut self, parameter: usize, column: &[f64], value: f64) {
        let mut columns: Vec<Vec<f64>> = self.columns.iter().map(<[f64]>::to_vec).collect();
        columns.push(column.to_vec());
        self.columns = Channels::from_vectors(&columns);
        self.parameters.push(parameter);
        self.torque.iter_mut().zip(column).for_each(|(torque, x)| *torque += value * x);
    }

    /// The same without the parameters that are held, whose torque is taken off; the others, `kept` in order, are counted
    /// anew.
    pub(super) fn without(&self, held: &[(usize, f64)], kept: &[usize]) -> Self {
        let (mut parameters, mut columns) = (Vec::new(), Vec::new());
        let mut torque = self.torque.clone();
        for (parameter, column) in self.parameters.iter().zip(self.columns.iter()) {
            if let Some((_, value)) = held.iter().find(|(own, _)| own == parameter) {
                torque.iter_mut().zip(column).for_each(|(torque, x)| *torque -= value * x);
            } else if let Ok(place) = kept.binary_search(parameter) {
                parameters.push(place);
                columns.push(column.to_vec());
            }
        }
        let columns = Channels::from_vectors(&columns);
        JointRegression { joint: self.joint.clone(), parameters, columns, torque, valid: self.valid.clone() }
    }

    /// Number of rows that count.
    pub fn rows(&self) -> usize {
        self.valid.iter().filter(|&&ok| ok).count()
    }

    /// Torque that `beta` predicts, for every row.
    pub fn predict(&self, beta: &[f64]) -> Vec<f64> {
        let weights: Vec<f64> = self.parameters.iter().map(|&parameter| beta[parameter]).collect();
        combined(&self.columns, &weights)
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

    /// Inner product of two signals over the rows that count.
    pub(super) fn dot(&self, a: &[f64], b: &[f64]) -> f64 {
        a.iter().zip(b).zip(&self.valid).map(|((x, y), &ok)| if ok { x * y } else { 0.0 }).sum()
    }

    /// X'X over the rows that count.
    pub(super) fn gram(&self) -> DMatrix<f64> {
        let mut gram = Gram::new(self.parameters.len());
        gram.add_valid(self.columns.iter(), &self.valid);
        gram.matrix()
    }

    /// The Gram matrix of columns and torque over the rows that count.
    fn sums(&self) -> JointSums {
        let mut gram = Gram::new(self.parameters.len() + 1);
        gram.add_valid(self.columns.iter().chain([self.torque.as_slice()]), &self.valid);
        JointSums { parameters: self.parameters.clone(), rows: self.rows(), gram: gram.matrix() }
    }

    /// The triangle of columns and torque over the rows that count.
    fn triangle(&self) -> DMatrix<f64> {
        let mut triangle = Triangle::new(self.parameters.len() + 1);
        let mut block = vec![0.0; (self.parameters.len() + 1) * BLOCK];
        for (number, valid) in self.valid.chunks(BLOCK).enumerate() {
            let block = &mut block[..(self.parameters.len() + 1) * valid.len()];
            let table = self.columns.iter().chain([self.torque.as_slice()]);
            valid_block(table, number * BLOCK, valid, block);
            triangle.add(block, valid.len());
        }
        triangle.factor()
    }

    /// X'y over the rows that count, for one value y per row.
    pub(super) fn products(&self, signal: &[f64]) -> Vec<f64> {
        let fast = products(&self.columns, &self.masked(signal));
        // Rows that do not count may hold what is not a number.
        let sum = |(value, column): (f64, &[f64])| if value.is_finite() { value } else { self.dot(column, signal) };
        fast.into_iter().zip(self.columns.iter()).map(sum).collect()
    }

    /// Adds `weight` times X'X over the rows that count to `sum`, at the places of this joint's parameters.
    pub(super) fn add_gram(&self, weight: f64, sum: &mut DMatrix<f64>) {
        self.scatter(weight, &self.gram(), sum);
    }

    /// Adds `weight` times the Gram matrix of `table`, `[active parameter][row]`, to `sum`.
    pub(super) fn scatter_gram(&self, weight: f64, table: &Channels, sum: &mut DMatrix<f64>) {
        let mut gram = Gram::new(self.parameters.len());
        gram.add(table.as_slice(), table.samples());
        self.scatter(weight, &gram.matrix(), sum);
    }

    /// Adds `weight` times a matrix over this joint's columns to `sum`, at the places of the parameters.
    pub(super) fn scatter(&self, weight: f64, gram: &DMatrix<f64>, sum: &mut DMatrix<f64>) {
        for (r, &row) in self.parameters.iter().enumerate() {
            for (c, &column) in self.parameters.iter().enumerate() {
                sum[(row, column)] += weight * gram[(r, c)];
            }
        }
    }

    /// The columns, zero where rows do not count.
    pub(super) fn masked_columns(&self) -> Channels {
        let mut columns = self.columns.clone();
        for column in 0..columns.channels() {
            columns.channel_mut(column).iter_mut().zip(&self.valid).filter(|(_, ok)| !**ok).for_each(|(x, _)| *x = 0.0);
        }
        columns
    }

    pub(super) fn masked(&self, signal: &[f64]) -> Vec<f64> {
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

    /// The same with parameters that are held put back in their places, without uncertainty.
    pub(super) fn with_held(mut self, held: &[(usize, f64)], count: usize) -> Self {
        let value = |k: usize| held.iter().find(|(own, _)| *own == k).map(|(_, value)| *value);
        let free: Vec<usize> = (0..count).filter(|&k| value(k).is_none()).collect();
        let mut covariance = DMatrix::zeros(count, count);
        for (r, &row) in free.iter().enumerate() {
            for (c, &column) in free.iter().enumerate() {
                covariance[(row, column)] = self.covariance[(r, c)];
            }
        }
        let mut found = self.beta.iter().copied();
        self.beta = (0..count).map(|k| value(k).or_else(|| found.next()).unwrap_or_default()).collect();
        Estimate { covariance, ..self }
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
    require_rows(joints)?;
    let sums = sums(joints);
    let mut sigma = vec![1.0; joints.len()];
    for _ in 0..REWEIGHTINGS {
        let beta = sums.solution(&sigma, names)?;
        sigma = joints.iter().zip(sums.joints()).map(|(joint, own)| sigma_of(joint, own, beta.as_slice())).collect();
    }
    let (beta, scaled) = sums.solve(&sigma, names)?;
    let beta = beta.as_slice().to_vec();
    Ok(Estimate {
        covariance: sandwich(joints, &sums, &beta, &sigma, &scaled),
        condition_number: scaled.condition_number,
        rows: joints.iter().map(JointRegression::rows).collect(),
        beta,
        sigma,
    })
}

/// Refuses a joint with fewer than twice as many rows as parameters.
pub(super) fn require_rows(joints: &[JointRegression]) -> Result<()> {
    for joint in joints {
        if joint.rows() < 2 * joint.parameters.len() {
            let problem = format!(
                "{} usable samples for {} parameters; the log is too short or the joint hardly moves",
                joint.rows(),
                joint.parameters.len()
            );
            return Err(Error::request(joint.joint.as_str(), problem));
        }
    }
    Ok(())
}

/// The solution for given joint standard deviations.
///
/// # Errors
/// Names the parameters that the motion cannot tell apart.
pub(super) fn weighted_solution(joints: &[JointRegression], sigma: &[f64], names: &[String]) -> Result<Vec<f64>> {
    Ok(sums(joints).solution(sigma, names)?.as_slice().to_vec())
}

/// What the solutions for all weights need, from one pass over the rows.
fn sums(joints: &[JointRegression]) -> Sums<'_> {
    let triangles = move || joints.iter().map(JointRegression::triangle).collect();
    Sums::new(joints.iter().map(JointRegression::sums).collect(), triangles)
}

/// Standard deviation of each joint's residual. A residual without noise would give an infinite weight, so it is kept
/// above rounding. Every joint needs more rows that count than parameters.
pub fn residual_sigma(joints: &[JointRegression], beta: &[f64]) -> Vec<f64> {
    joints.iter().map(|joint| residual_sigma_of(joint, beta)).collect()
}

fn residual_sigma_of(joint: &JointRegression, beta: &[f64]) -> f64 {
    let largest = joint.torque.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    let freedom = joint.rows() as f64 / (joint.rows() - joint.parameters.len()) as f64;
    (joint.residual_rms(beta) * freedom.sqrt()).max(1e-12 * largest).max(f64::MIN_POSITIVE)
}

/// The same from the joint's sums, or from the rows where those do not resolve the residual.
fn sigma_of(joint: &JointRegression, sums: &JointSums, beta: &[f64]) -> f64 {
    match sums.residual(beta) {
        Some(sum) => (sum / (sums.rows - sums.parameters.len()) as f64).sqrt(),
        None => residual_sigma_of(joint, beta),
    }
}

/// Covariance H^-1 X'W Cov(noise) W X H^-1, the noise of each joint modelled as autoregressive from its residual: white
/// noise gives H^-1, coloured noise what it costs.
fn sandwich(
    joints: &[JointRegression],
    sums: &Sums,
    beta: &[f64],
    sigma: &[f64],
    normal: &ScaledNormal,
) -> DMatrix<f64> {
    let parameters = beta.len();
    let mut meat = DMatrix::zeros(parameters, parameters);
    let noises = residual_noise(joints, sums, beta, sigma, normal);
    for ((joint, s), noise) in joints.iter().zip(sigma).zip(noises) {
        let mut colored = joint.masked_columns();
        noise.color_backward(&mut colored);
        joint.scatter_gram(s.powi(-4), &colored, &mut meat);
    }
    let bread = normal.inverse();
    &bread * meat * &bread
}

/// The noise behind the residual of each joint. The fit swallows part of the noise, slow noise most of all, so the
/// residual's autocovariances are too small; noise of the model found so far is sent through the same fit, and what it
/// loses there is added back.
fn residual_noise(
    joints: &[JointRegression],
    sums: &Sums,
    beta: &[f64],
    sigma: &[f64],
    normal: &ScaledNormal,
) -> Vec<AutoregressiveNoise> {
    let problem = LinearProblem::with_normal(joints, sigma, sums.normal(sigma, beta.len()));
    let lags = |signals: &[Vec<f64>]| -> Vec<Vec<f64>> {
        joints.iter().zip(signals).map(|(joint, signal)| autocovariance(signal, &joint.valid, NOISE_ORDER)).collect()
    };
    let residuals: Vec<Vec<f64>> = joints.iter().map(|joint| joint.residual(beta)).collect();
    let observed = lags(&residuals);
    let rows = joints.iter().map(|joint| joint.torque.len()).max().unwrap_or(0);
    let mut noises: Vec<AutoregressiveNoise> =
        observed.iter().map(|covariance| AutoregressiveNoise::from_autocovariance(covariance)).collect();
    for round in 0..BIAS_ROUNDS {
        let mut corrected = observed.clone();
        for draw in 0..BIAS_DRAWS {
            let mut source = random::stream(0, "noise bias", round * BIAS_DRAWS + draw);
            let drawn = simulate_together(&noises, rows, &mut source);
            let swallowed = normal.solve(&problem.right(&drawn));
            let left: Vec<Vec<f64>> = joints
                .iter()
                .zip(&drawn)
                .map(|(joint, noise)| {
                    noise.iter().zip(joint.predict(swallowed.as_slice())).map(|(e, fitted)| e - fitted).collect()
                })
                .collect();
            for ((target, before), after) in corrected.iter_mut().zip(lags(&drawn)).zip(lags(&left)) {
                for (lag, value) in target.iter_mut().enumerate() {
                    *value += (before[lag] - after[lag]) / BIAS_DRAWS as f64;
                }
            }
        }
        noises = corrected.iter().map(|covariance| AutoregressiveNoise::from_autocovariance(covariance)).collect();
    }
    noises
}

/// The first few of many names.
fn listed(names: &[&str]) -> String {
    const MOST: usize = 4;
    match names.len().checked_sub(MOST) {
        None | Some(0) => names.join("; "),
        Some(more) => format!("{}; and {more} more", names[..MOST].join("; ")),
    }
}

/// Normal matrix with unit diagonal, factored; the square root of its condition number is the regressor's.
pub(super) struct ScaledNormal {
    scale: DVector<f64>,
    factor: Cholesky<f64, Dyn>,
    pub(super) condition_number: f64,
}

impl ScaledNormal {
    pub(super) fn new(normal: &DMatrix<f64>, names: &[String]) -> Result<Self> {
        let scale = unit_scale(normal.diagonal(), names)?;
        let mut unit = DMatrix::from_fn(normal.nrows(), normal.ncols(), |r, c| normal[(r, c)] * scale[r] * scale[c]);
        unit.fill_upper_triangle_with_lower_triangle();
        let [low, high] = Spectrum::of(&unit).ends();
        if low < SINGULAR * high {
            let eigen = SymmetricEigen::new(unit);
            return Err(tied(eigen.eigenvectors.column(eigen.eigenvalues.imin()).as_slice(), names));
        }
        let factor = Cholesky::new(unit)
            .ok_or_else(|| Error::request("normal equations", "not positive definite; use a richer motion"))?;
        Ok(ScaledNormal { scale, factor, condition_number: (high / low).sqrt() })
    }

    /// From the triangle R of the weighted rows, R'R = X'WX, which knows small singular values to more digits.
    ///
    /// # Errors
    /// Names the parameters that the motion cannot tell apart.
    pub(super) fn from_triangle(triangle: &DMatrix<f64>, names: &[String]) -> Result<Self> {
        let squares = DVector::from_iterator(names.len(), triangle.column_iter().map(|column| column.norm_squared()));
        let scale = unit_scale(squares, names)?;
        let unit = DMatrix::from_fn(names.len(), names.len(), |r, c| triangle[(r, c)] * scale[c]);
        let svd = unit.clone().svd(false, true);
        let (low, high) = (svd.singular_values.min(), svd.singular_values.max());
        if low < SINGULAR_OF_TRIANGLE * high {
            let weakest = svd.v_t.map(|v| v.row(svd.singular_values.imin()).transpose()).unwrap_or_default();
            return Err(tied(weakest.as_slice(), names));
        }
        Ok(ScaledNormal { scale, factor: Cholesky::pack_dirty(unit.transpose()), condition_number: high / low })
    }

    pub(super) fn solve(&self, right: &DVector<f64>) -> DVector<f64> {
        self.factor.solve(&right.component_mul(&self.scale)).component_mul(&self.scale)
    }

    /// Inverse of the matrix with unit diagonal; faer takes a sixth of the time that unit vectors solved one by one take.
    fn inverse_of_unit(&self) -> DMatrix<f64> {
        let size = self.scale.len();
        let mut inverse = DMatrix::zeros(size, size);
        let factor = MatRef::from_column_major_slice(self.factor.l_dirty().as_slice(), size, size);
        let target = MatMut::from_column_major_slice_mut(inverse.as_mut_slice(), size, size);
        let mut memory = MemBuffer::new(inverse_scratch::<f64>(size, Par::Seq));
        llt_inverse(target, factor, Par::Seq, MemStack::new(&mut memory));
        inverse.fill_upper_triangle_with_lower_triangle();
        inverse
    }

    pub(super) fn inverse(&self) -> DMatrix<f64> {
        let unit = self.inverse_of_unit();
        DMatrix::from_fn(unit.nrows(), unit.ncols(), |r, c| unit[(r, c)] * self.scale[r] * self.scale[c])
    }
}

/// What brings columns of the given squared lengths to unit length.
fn unit_scale(squares: DVector<f64>, names: &[String]) -> Result<DVector<f64>> {
    let scale = squares.map(|d| if d > 0.0 { 1.0 / d.sqrt() } else { 0.0 });
    let still: Vec<&str> = scale.iter().zip(names).filter(|(s, _)| **s == 0.0).map(|(_, name)| name.as_str()).collect();
    if still.is_empty() {
        return Ok(scale);
    }
    Err(Error::request(listed(&still), "the motion does not excite this at all; move that joint"))
}

/// The error that the parameters of a `weakest` direction cannot be told apart.
fn tied(weakest: &[f64], names: &[String]) -> Error {
    let mut order: Vec<usize> = (0..names.len()).collect();
    order.sort_by(|&a, &b| weakest[b].abs().total_cmp(&weakest[a].abs()));
    let tied: Vec<&str> = order
        .iter()
        .take_while(|&&i| weakest[i].abs() > 0.1 * weakest[order[0]].abs())
        .map(|&i| names[i].as_str())
        .collect();
    Error::request(
        listed(&tied),
        "the motion cannot tell these parameters apart; use a richer motion (each joint with durations of its own)",
    )
}
