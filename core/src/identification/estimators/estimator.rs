//! What estimators share: what they see, what they give, and when their iterations end.

use crate::error::{Error, Result};
use crate::identification::regression::joint_regression::JointRegression;
use crate::identification::regression::least_squares::Estimate;

/// What an estimator sees.
#[derive(Clone, Copy)]
pub struct Data<'a> {
    /// Regression rows of every joint along the measured motion.
    pub rows: &'a [JointRegression],
    /// Names of the parameters, for errors.
    pub names: &'a [String],
    /// Parameters to start from, for estimators that iterate.
    pub start: &'a [f64],
    /// The arm simulated under its controller, for estimators that need it.
    pub simulated: Option<&'a dyn SimulatedRows>,
}

impl<'a> Data<'a> {
    pub(super) fn require_simulation(&self, estimator: &str) -> Result<&'a dyn SimulatedRows> {
        self.simulated.ok_or_else(|| {
            let problem =
                "needs the arm's controller and reference motion to simulate it; measured logs do not have them";
            Error::request(estimator, problem)
        })
    }
}

/// An arm with given parameters, simulated under the controller and along the reference of the measured one.
pub trait SimulatedRows {
    /// The measured torque with the columns along the simulated motion, row by row with the measured rows. Rows count
    /// where they do along the simulated motion.
    ///
    /// # Errors
    /// If the parameters make no arm that can be simulated.
    fn rows(&self, beta: &[f64]) -> Result<Vec<JointRegression>>;
}

/// A way from regression rows to parameters.
pub trait Estimator: Sync {
    /// Name on the command line and in results.
    fn name(&self) -> &'static str;
    /// What it is, in a few words.
    fn title(&self) -> &'static str;
    /// Whether it needs [`Data::simulated`].
    fn simulates(&self) -> bool {
        false
    }
    /// Estimates the parameters.
    ///
    /// # Errors
    /// Names the joint without rows, or the parameters that the motion does not separate; if an iteration does not converge.
    fn estimate(&self, data: &Data) -> Result<Estimate>;
}

/// Rounds after which an iteration through simulations has not converged.
pub(super) const MOST_ROUNDS: usize = 15;

/// Change of the predicted torque, root mean square over that of the residual, at which such an iteration has converged.
const SETTLED: f64 = 1e-2;

/// Whether the torque that `rows` predict changes too little between two sets of parameters for the noise `sigma` to show.
pub(super) fn settled(rows: &[JointRegression], before: &[f64], after: &[f64], sigma: &[f64]) -> bool {
    let change: Vec<f64> = before.iter().zip(after).map(|(b, a)| a - b).collect();
    let moved = rows.iter().zip(sigma).map(|(joint, s)| {
        let torque = joint.predict(&change);
        (joint.dot(&torque, &torque) / joint.rows().max(1) as f64).sqrt() / s
    });
    moved.fold(0.0, f64::max) <= SETTLED
}

/// The error of an iteration through simulations that does not converge.
pub(super) fn unsettled(estimator: &dyn Estimator) -> Error {
    let problem = format!("has not settled after {MOST_ROUNDS} rounds; start nearer to the truth or smooth more");
    Error::request(estimator.name(), problem)
}
