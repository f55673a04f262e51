//! Weighted least squares on base parameters, with weights per joint and standard deviations that allow for coloured noise.

use super::joint_regression::JointRegression;
use super::joint_sums::{JointSums, Sums};
use super::linear_problem::LinearProblem;
use super::noise::{AutoregressiveNoise, autocovariance, simulate_together};
use crate::error::{Error, Result};
use crate::identification::numerics::scaled_normal::ScaledNormal;
use crate::random;
use nalgebra::DMatrix;
use serde::{Serialize, Serializer};

/// Order of the noise model behind the standard deviations.
pub(in crate::identification) const NOISE_ORDER: usize = 12;

/// Rounds of, and draws in each round of, correcting the noise model for what the fit swallows.
const BIAS_ROUNDS: u64 = 2;
const BIAS_DRAWS: u64 = 10;

/// Times the weights are taken anew from the residual.
pub const REWEIGHTINGS: usize = 3;

/// The 97.5 % point of the normal distribution.
pub const NORMAL_95: f64 = 1.959_963_984_540_054;

/// What identification found.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::identification::least_squares::weighted_least_squares;
/// use tauscope::identification::model::Model;
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/payload/arm.urdf", InertiaCheck::Ignored)?;
/// # let log = recording::load("../tests/reference/payload/before.csv", None)?;
/// # use tauscope::identification::prepare::{self, Smoothing};
/// # use tauscope::identification::reversals::Band;
/// # let smoothing = Smoothing::SavitzkyGolay { window: 11, order: 4, decimation: 2 };
///
/// let model = Model::new(&robot);
/// let rows = prepare::measured(&log, smoothing, Band::OfNoise)?.regression(&model)?;
/// let names: Vec<String> = model.base().groupings().iter().map(|grouping| grouping.name.clone()).collect();
/// let estimate = weighted_least_squares(&rows, &names)?;
///
/// // Coulomb friction of joint 1, of which the log was made with 2 N m.
/// let friction = names.iter().position(|name| name == "Fc1").expect("friction is a base parameter");
/// assert!((estimate.beta[friction] - 2.0).abs() < 0.3);
/// let [low, high] = estimate.intervals()[friction];
/// assert!((high - low - 2.0 * 1.96 * estimate.std()[friction]).abs() < 1e-3);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Serialize)]
pub struct Estimate {
    /// Base parameters.
    pub beta: Vec<f64>,
    /// Covariance of the base parameters, with the colour of the residual taken into account; where a fit takes the scatter between
    /// blocks too, with the larger of both standard deviations. Serialised row by row.
    #[serde(serialize_with = "by_row")]
    pub covariance: DMatrix<f64>,
    /// Standard deviation of the residual of each joint, the inverse root of its weight, N m.
    pub sigma: Vec<f64>,
    /// Condition number of the regressor with rows divided by sigma and columns of unit length.
    pub condition_number: f64,
    /// Rows used of each joint.
    pub rows: Vec<usize>,
}

/// A matrix as a list of its rows.
fn by_row<S: Serializer>(matrix: &DMatrix<f64>, serializer: S) -> std::result::Result<S::Ok, S::Error> {
    serializer.collect_seq(matrix.row_iter().map(|row| row.iter().copied().collect::<Vec<f64>>()))
}

impl Estimate {
    /// Standard deviation of each base parameter.
    pub fn std(&self) -> Vec<f64> {
        self.covariance.diagonal().iter().map(|v| v.max(0.0).sqrt()).collect()
    }

    /// The same with no standard deviation below that of `least`, in the order of the parameters: the covariance keeps its correlations.
    pub(in crate::identification) fn at_least(mut self, least: &[f64]) -> Self {
        let own = self.std();
        let factor = |k: usize| match least.get(k) {
            Some(least) if own[k] > 0.0 => (least / own[k]).max(1.0),
            _ => 1.0,
        };
        let factors: Vec<f64> = (0..own.len()).map(factor).collect();
        self.covariance =
            DMatrix::from_fn(own.len(), own.len(), |i, j| factors[i] * self.covariance[(i, j)] * factors[j]);
        self
    }

    /// The same with parameters that are held put back in their places, without uncertainty.
    pub(in crate::identification) fn with_held(mut self, held: &[(usize, f64)], count: usize) -> Self {
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
pub(in crate::identification) fn require_rows(joints: &[JointRegression]) -> Result<()> {
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
/// Names the parameters that the motion does not separate.
pub(in crate::identification) fn weighted_solution(
    joints: &[JointRegression],
    sigma: &[f64],
    names: &[String],
) -> Result<Vec<f64>> {
    Ok(sums(joints).solution(sigma, names)?.as_slice().to_vec())
}

/// What the solutions for all weights need, from one pass over the rows.
pub(in crate::identification) fn sums(joints: &[JointRegression]) -> Sums<'_> {
    let triangles = move || joints.iter().map(JointRegression::triangle).collect();
    Sums::new(joints.iter().map(JointRegression::sums).collect(), triangles)
}

/// Standard deviation of each joint's residual. A residual without noise would give an infinite weight, so it is kept
/// above rounding. Every joint needs more valid rows than parameters.
pub fn residual_sigma(joints: &[JointRegression], beta: &[f64]) -> Vec<f64> {
    joints.iter().map(|joint| residual_sigma_of(joint, beta)).collect()
}

fn residual_sigma_of(joint: &JointRegression, beta: &[f64]) -> f64 {
    // Without rows any weight is right, as long as it is a number.
    if joint.rows() == 0 {
        return 1.0;
    }
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
