//! Information that a torque log along a motion holds on the base parameters: their information matrix.
//!
//! A log has one row per joint and sample, tau = y beta + noise, with white noise of a known standard deviation sigma per
//! joint. The information matrix is G = sum y' y / sigma^2 over all rows; its inverse is the covariance of the
//! weighted least-squares estimate (Swevers et al. 1997; Gautier and Khalil 1992). The base columns are those of
//! [`Model`]: proximal first. kappa depends on that choice and on the weights, differences of D do not.
//!
//! A search evaluates thousands of motions, so the rows are never stored: blocks of samples go straight into one Gram
//! matrix per joint, of the columns that can act on that joint. A grid coarser than the log stands for it, with G scaled
//! up by the ratio of the rates.

use crate::channels::Channels;
use crate::dynamics::{Chain, Motion};
use crate::error::{Error, Result};
use crate::excitation::Reference;
use crate::identification::gram::{BLOCK, Gram};
use crate::identification::model::Model;
use crate::identification::sequences::combine_into;
use crate::identification::spectrum::Spectrum;
use crate::lane::{Aligned, Lanes};
use crate::robot::Robot;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// Eigenvalues of the normalised information matrix below this share of the largest are rounding.
pub(super) const SINGULAR: f64 = 1e-12;

/// Information about the base parameters from some rows; adding two of them joins the logs.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::design::{Experiment, Information};
/// use tauscope::excitation::{JointLimits, random_sequence::random_sequence};
/// use tauscope::robot::{self, InertiaCheck};
/// # let pendulum = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Required)?;
/// # let limits = [JointLimits { lower: -2.0, upper: 2.0, velocity: 3.0, acceleration: 20.0 }];
/// # let motion = random_sequence(1, "motion", 0, 4, 6.0, &limits)?;
///
/// // Two logs of a motion halve the variances of the base parameters, all of which it separates.
/// let once = Experiment::new(&pendulum, &[0.5], 100.0)?.information(&motion, 100.0);
/// assert_eq!(once.rank(), once.parameters());
/// let twice = once.clone().joined(&once);
/// let ratio = once.standard_deviations()[0] / twice.standard_deviations()[0];
/// assert!((ratio - 2f64.sqrt()).abs() < 1e-6);
/// assert_eq!(Information::none(5).rank(), 0);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Information {
    /// G, symmetric, one row per base parameter.
    matrix: DMatrix<f64>,
    /// Rows it comes from, over all joints.
    rows: f64,
}

impl Information {
    /// From a matrix G that is known.
    #[cfg(test)]
    pub(super) fn of(matrix: DMatrix<f64>, rows: f64) -> Self {
        Information { matrix, rows }
    }

    /// No rows at all, for `parameters` base parameters.
    pub fn none(parameters: usize) -> Self {
        Information { matrix: DMatrix::zeros(parameters, parameters), rows: 0.0 }
    }

    /// The information matrix G.
    pub fn matrix(&self) -> &DMatrix<f64> {
        &self.matrix
    }

    /// Number of base parameters.
    pub fn parameters(&self) -> usize {
        self.matrix.nrows()
    }

    /// Information of both logs together.
    pub fn joined(mut self, other: &Information) -> Information {
        self.matrix += &other.matrix;
        self.rows += other.rows;
        self
    }

    /// Sum of ln G_ii: the logarithm of the squared product of the column lengths.
    pub(crate) fn log_diagonal(&self) -> f64 {
        self.matrix.diagonal().iter().map(|d| d.ln()).sum()
    }

    /// Spectrum of G scaled to a unit diagonal: the squared singular values of the weighted regressor with columns of unit
    /// length. A column of zeros counts as an eigenvalue of zero.
    pub(crate) fn normalised_spectrum(&self) -> Spectrum {
        let scale = self.matrix.diagonal().map(|d| if d > 0.0 { 1.0 / d.sqrt() } else { 0.0 });
        let unit =
            DMatrix::from_fn(self.parameters(), self.parameters(), |r, c| self.matrix[(r, c)] * scale[r] * scale[c]);
        Spectrum::of(&unit)
    }

    /// Number of base parameters, or combinations of them, that the rows separate.
    pub fn rank(&self) -> usize {
        let spectrum = self.normalised_spectrum();
        let [_, largest] = spectrum.ends();
        if largest.is_nan() { 0 } else { self.parameters() - spectrum.below(SINGULAR * largest) }
    }

    /// ln det G; minus infinity when a parameter is not excited.
    pub fn log_determinant(&self) -> f64 {
        self.factor()
            .map_or(f64::NEG_INFINITY, |factor| 2.0 * factor.l_dirty().diagonal().iter().map(|d| d.ln()).sum::<f64>())
    }

    /// Standard deviation of every base parameter; infinite when one is not excited.
    pub fn standard_deviations(&self) -> Vec<f64> {
        match self.factor() {
            Some(factor) => factor.inverse().diagonal().iter().map(|v| v.sqrt()).collect(),
            None => vec![f64::INFINITY; self.parameters()],
        }
    }

    /// Root mean square over the rows of `other` of the standard deviation of predicted torque, in sigma, when the
    /// parameters come from these rows: sqrt(trace(G^-1 G_other) / rows).
    pub(crate) fn prediction_error(&self, other: &Information) -> f64 {
        self.factor().map_or(f64::INFINITY, |factor| (factor.solve(&other.matrix).trace() / other.rows).sqrt())
    }

    /// Cholesky factor of G; none when a pivot shows that G is singular to rounding.
    fn factor(&self) -> Option<Cholesky<f64, Dyn>> {
        let factor = Cholesky::new(self.matrix.clone())?;
        let pivots = factor.l_dirty().diagonal();
        let regular = pivots.iter().zip(&self.matrix.diagonal()).all(|(pivot, d)| pivot * pivot > SINGULAR * d);
        regular.then_some(factor)
    }
}

/// Samples of a motion with the torque it takes, as [`Experiment::scan`] hands them out.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::design::Experiment;
/// use tauscope::excitation::{JointLimits, Reference, random_sequence::random_sequence};
/// use tauscope::robot::{self, InertiaCheck};
/// # let pendulum = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Required)?;
/// # let limits = [JointLimits { lower: -2.0, upper: 2.0, velocity: 3.0, acceleration: 20.0 }];
/// # let motion = random_sequence(1, "motion", 0, 4, 6.0, &limits)?;
///
/// // The largest torque of the motor along a motion, on the way to its information.
/// let (mut largest, mut seen) = (0f64, 0);
/// Experiment::new(&pendulum, &[0.5], 100.0)?.scan(&motion, 100.0, &mut |samples| {
///     seen += samples.time.len();
///     largest = samples.torque.channel(0).iter().fold(largest, |largest, torque| largest.max(torque.abs()));
/// });
/// assert_eq!(seen, 601);
/// assert!(largest > 5.0 && largest < pendulum.joints[0].limits.effort);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug)]
pub struct Samples {
    /// Times, s.
    pub time: Vec<f64>,
    /// Positions, velocities and accelerations.
    pub motion: Motion,
    /// Torque of the motors, `[joint][time]`.
    pub torque: Channels,
}

/// An arm with its torque sensors: what turns a motion into information.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::design::Experiment;
/// use tauscope::excitation::{JointLimits, random_sequence::random_sequence};
/// use tauscope::robot::{self, InertiaCheck};
///
/// let pendulum = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Required)?;
/// let limits = [JointLimits { lower: -2.0, upper: 2.0, velocity: 3.0, acceleration: 20.0 }];
/// let motion = random_sequence(1, "motion", 0, 4, 6.0, &limits)?;
///
/// // Half the torque noise, half the standard deviation of every base parameter.
/// let deviations = |noise| Ok::<_, tauscope::error::Error>(
///     Experiment::new(&pendulum, &[noise], 100.0)?.information(&motion, 100.0).standard_deviations());
/// let (loud, quiet) = (deviations(0.5)?, deviations(0.25)?);
/// assert!(loud.iter().zip(&quiet).all(|(loud, quiet)| (loud / quiet - 2.0).abs() < 1e-6));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Experiment {
    chain: Chain,
    model: Model,
    /// Values of the base parameters, for torque and relative deviations.
    beta: DVector<f64>,
    /// Standard deviation of the torque noise of each joint, N m.
    sigma: Vec<f64>,
    rate_hz: f64,
}

impl Experiment {
    /// Torque of `robot` logged at `rate_hz` under white noise of `torque_noise` (N m, one entry per joint).
    ///
    /// # Errors
    /// Names the joint whose torque noise is not above zero, or the wrong number of them.
    pub fn new(robot: &Robot, torque_noise: &[f64], rate_hz: f64) -> Result<Self> {
        if torque_noise.len() != robot.dof() {
            let problem = format!("{} values for {} joints; give one per joint", torque_noise.len(), robot.dof());
            return Err(Error::request("torque noise", problem));
        }
        for (joint, sigma) in robot.joints.iter().zip(torque_noise) {
            if !(sigma.is_finite() && *sigma > 0.0) {
                let problem = format!("its torque noise weighs its rows and must be above zero, found {sigma} N m");
                return Err(Error::request(&joint.name, problem));
            }
        }
        let model = Model::new(robot);
        let beta = DVector::from_vec(model.base().values(&Model::standard_values(robot)));
        Ok(Experiment { chain: Chain::new(robot), model, beta, sigma: torque_noise.to_vec(), rate_hz })
    }

    /// The torque model with its base parameters.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// Values of the base parameters of the arm.
    pub fn beta(&self) -> &[f64] {
        self.beta.as_slice()
    }

    /// Rate of the log, Hz.
    pub fn rate_hz(&self) -> f64 {
        self.rate_hz
    }

    /// Information of the log along `motion`, from samples at `grid_hz`.
    pub fn information(&self, motion: &dyn Reference, grid_hz: f64) -> Information {
        self.run(motion, grid_hz, None)
    }

    /// [`Experiment::information`], and shows `visit` the samples with their torque.
    pub fn scan(&self, motion: &dyn Reference, grid_hz: f64, visit: &mut dyn FnMut(&Samples)) -> Information {
        self.run(motion, grid_hz, Some(visit))
    }

    fn run(&self, motion: &dyn Reference, grid_hz: f64, mut visit: Option<&mut dyn FnMut(&Samples)>) -> Information {
        let total = (motion.duration_s() * grid_hz + 1e-9).floor() as usize + 1;
        let (columns, dof) = (self.model.base_columns(), self.sigma.len());
        let mut grams: Vec<Gram> = (0..dof).map(|joint| Gram::new(columns.parameters(joint).len())).collect();
        let beta = |joint| columns.parameters(joint).iter().map(|&parameter| self.beta[parameter]).collect();
        let weights: Vec<Vec<f64>> = (0..dof).map(beta).collect();
        let mut table = Aligned::zeros(columns.places() * BLOCK);
        for first in (0..total).step_by(BLOCK) {
            let mut samples = self.sample(motion, first..total.min(first + BLOCK), grid_hz);
            let rows = samples.time.len();
            let table = &mut table[..columns.places() * rows];
            columns.write(Lanes::best(), &self.chain, [&samples.motion; 2], 0.0, 0..rows, table);
            for (joint, gram) in grams.iter_mut().enumerate() {
                let share = columns.of(joint);
                let own = &table[share.start * rows..share.end * rows];
                gram.add(own, rows);
                if visit.is_none() {
                    continue;
                }
                combine_into(own, &weights[joint], samples.torque.channel_mut(joint));
            }
            if let Some(visit) = &mut visit {
                visit(&samples);
            }
        }
        self.weighted(&grams, total as f64, self.rate_hz / grid_hz)
    }

    fn sample(&self, motion: &dyn Reference, range: std::ops::Range<usize>, grid_hz: f64) -> Samples {
        let dof = self.sigma.len();
        let mut block = Motion::zeros(dof, range.len());
        let time: Vec<f64> = range.map(|k| k as f64 / grid_hz).collect();
        motion.along(&time, [&mut block.q, &mut block.qd, &mut block.qdd]);
        let torque = Channels::zeros(dof, time.len());
        Samples { time, motion: block, torque }
    }

    /// The joints' Gram matrices, weighted and put together; `scale` log rows stand behind every row.
    fn weighted(&self, grams: &[Gram], samples: f64, scale: f64) -> Information {
        let mut information = Information::none(self.beta.len());
        information.rows = samples * scale * self.sigma.len() as f64;
        for ((joint, gram), sigma) in grams.iter().enumerate().zip(&self.sigma) {
            let weight = scale / (sigma * sigma);
            let parameters = self.model.base_columns().parameters(joint);
            gram.each_entry(|row, column, sum| {
                information.matrix[(parameters[row], parameters[column])] += weight * sum;
            });
        }
        information.matrix.fill_upper_triangle_with_lower_triangle();
        information
    }
}
