//! How to search, and what a search found.

use super::damping::{Damping, Scaling};
use super::problem::Bounds;
use nalgebra::DMatrix;

/// How to search and when to stop. The default is Gavin's method 1 with tolerances near the rounding error.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::identification::levenberg_marquardt::{Options, StopReason};
/// # use nalgebra::{DMatrix, DVector};
/// # use tauscope::identification::levenberg_marquardt::{DenseProblem, minimize};
/// # let times = DVector::from_fn(20, |k, _| 0.1 * k as f64);
/// # let measured = times.map(|t| 2.0 * (-1.5 * t).exp());
/// # let of = times.clone();
/// # let decay = move |p: &[f64]| of.map(|t| p[0] * (-p[1] * t).exp());
/// # let slopes = move |p: &[f64]| DMatrix::from_fn(20, 2, |k, c| {
/// #     let fall = (-p[1] * times[k]).exp();
/// #     [fall, -p[0] * times[k] * fall][c]
/// # });
/// # let mut problem = DenseProblem::new(measured, DVector::repeat(20, 1.0), 2, decay, slopes)?;
///
/// // Two steps are not enough to find the decay.
/// let fit = minimize(&mut problem, &[1.0, 1.0], &Options { max_iterations: 2, ..Options::default() })?;
/// assert_eq!((fit.iterations, fit.stop), (2, StopReason::Iterations));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Options {
    /// How lambda changes from step to step.
    pub damping: Damping,
    /// What lambda multiplies.
    pub scaling: Scaling,
    /// lambda at the start; with [`Scaling::Identity`] in units of the largest entry of diag(J'WJ).
    pub initial_lambda: f64,
    /// A step is taken when chi2 falls by more than this share of what the linear model promises (Gavin's epsilon 4).
    pub acceptance: f64,
    /// Stop when the gradient, relative to the residual, is below this (Gavin's epsilon 1).
    pub gradient_tolerance: f64,
    /// Stop when the relative change of every parameter is below this (Gavin's epsilon 2).
    pub step_tolerance: f64,
    /// Stop when chi2 / (measurements - parameters) is below this (Gavin's epsilon 3). Zero leaves it out.
    pub chi2_tolerance: f64,
    /// Most linearisations and trial steps.
    pub max_iterations: usize,
    /// Box that the parameters may not leave.
    pub bounds: Option<Bounds>,
}

impl Default for Options {
    fn default() -> Self {
        Options {
            damping: Damping::default(),
            scaling: Scaling::Diagonal,
            initial_lambda: 1e-2,
            acceptance: 0.1,
            gradient_tolerance: 1e-15,
            step_tolerance: 1e-11,
            chi2_tolerance: 0.0,
            max_iterations: 1000,
            bounds: None,
        }
    }
}

/// Why the search ended.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::identification::levenberg_marquardt::{Options, StopReason};
/// # use nalgebra::{DMatrix, DVector};
/// # use tauscope::identification::levenberg_marquardt::{DenseProblem, minimize};
/// # let times = DVector::from_fn(20, |k, _| 0.1 * k as f64);
/// # let measured = times.map(|t| 2.0 * (-1.5 * t).exp());
/// # let of = times.clone();
/// # let decay = move |p: &[f64]| of.map(|t| p[0] * (-p[1] * t).exp());
/// # let slopes = move |p: &[f64]| DMatrix::from_fn(20, 2, |k, c| {
/// #     let fall = (-p[1] * times[k]).exp();
/// #     [fall, -p[0] * times[k] * fall][c]
/// # });
/// # let mut problem = DenseProblem::new(measured, DVector::repeat(20, 1.0), 2, decay, slopes)?;
///
/// let fit = minimize(&mut problem, &[1.0, 1.0], &Options::default())?;
/// assert!(fit.stop.converged());
///
/// // Running out of iterations, or of steps that help, is no minimum.
/// assert!(!StopReason::Iterations.converged() && !StopReason::Damping.converged());
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StopReason {
    /// The residual is orthogonal to what the parameters can change.
    Gradient,
    /// The parameters no longer change.
    Step,
    /// The reduced chi2 is as small as asked for.
    ChiSquare,
    /// Rounding hides any further gain.
    Precision,
    /// No step of any length lowers chi2 although the gradient is not zero: the Jacobian does not fit the model, or
    /// the model is not smooth here.
    Damping,
    /// The allowed number of iterations is used up.
    Iterations,
}

impl StopReason {
    /// Whether the parameters are a minimum within the tolerances.
    pub fn converged(self) -> bool {
        !matches!(self, StopReason::Damping | StopReason::Iterations)
    }
}

/// The end point of a fit and the way to it.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::identification::levenberg_marquardt::Options;
/// # use nalgebra::{DMatrix, DVector};
/// # use tauscope::identification::levenberg_marquardt::{DenseProblem, minimize};
/// # let times = DVector::from_fn(20, |k, _| 0.1 * k as f64);
/// # let measured = times.map(|t| 2.0 * (-1.5 * t).exp());
/// # let of = times.clone();
/// # let decay = move |p: &[f64]| of.map(|t| p[0] * (-p[1] * t).exp());
/// # let slopes = move |p: &[f64]| DMatrix::from_fn(20, 2, |k, c| {
/// #     let fall = (-p[1] * times[k]).exp();
/// #     [fall, -p[0] * times[k] * fall][c]
/// # });
/// # let mut problem = DenseProblem::new(measured, DVector::repeat(20, 1.0), 2, decay, slopes)?;
///
/// // 2 exp(-1.5 t), from exact values.
/// let fit = minimize(&mut problem, &[1.0, 1.0], &Options::default())?;
/// assert!((fit.parameters[0] - 2.0).abs() < 1e-8 && fit.chi2() < 1e-16);
/// assert!(fit.chi2_history[0] > 1.0 && fit.chi2_history.last() == Some(&fit.chi2()));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Fit {
    /// The parameters found.
    pub parameters: Vec<f64>,
    /// chi2 at the start and after every iteration.
    pub chi2_history: Vec<f64>,
    /// lambda at the start and after every iteration.
    pub lambda_history: Vec<f64>,
    /// Number of trial steps, taken or not.
    pub iterations: usize,
    /// (J'WJ)^-1 chi2 / (measurements - parameters): covariance of the parameters when the weights are known up to a
    /// common factor; divide by [`Fit::reduced_chi2`] where W is the inverse of the measurement covariance. Bounds
    /// are not considered. None where J'WJ is singular (the data do not determine every parameter) or where there
    /// are no more measurements than parameters.
    pub covariance: Option<DMatrix<f64>>,
    /// chi2 / (measurements - parameters); None without degrees of freedom.
    pub reduced_chi2: Option<f64>,
    /// Why the search ended.
    pub stop: StopReason,
}

impl Fit {
    /// The weighted sum of squares at the end.
    pub fn chi2(&self) -> f64 {
        *self.chi2_history.last().expect("the history starts with the initial value")
    }
}
