//! Weighted nonlinear least squares by the Levenberg-Marquardt method.
//!
//! Minimises chi2(p) = (y - yhat(p))' W (y - yhat(p)). With J = d yhat / d p every step h solves
//! \[J'WJ + lambda D\] h = J'W (y - yhat), where D is the identity (Levenberg, equation (12) of Ogbemhe, Mpofu and
//! Mokakabye, "Robot dynamic model: freudenstein-based optimal trajectory and parameter identification") or
//! diag(J'WJ) (Marquardt). lambda grows after a bad step (towards steepest descent) and shrinks after a good one
//! (towards Gauss-Newton), by one of the three rules of Gavin, "The Levenberg-Marquardt algorithm for nonlinear
//! least squares curve-fitting problems", Duke University, 2019.
//!
//! The solver only ever sees J'WJ, J'W(y - yhat) and chi2, so a problem may accumulate them block by block and never
//! hold its Jacobian; [`DenseProblem`] is for those small enough to do so.
//!
//! It departs from Gavin in six places, each because the original depends on the units of the data or stops early:
//! - The gradient criterion is taken relative to the residual: max_i |g_i| / sqrt((J'WJ)_ii chi2), the cosine between
//!   the residual and a column of J.
//! - The step criterion measures |h_i| against max(|p_i|, sqrt(chi2 / (J'WJ)_ii)), so that a parameter whose true
//!   value is zero can converge too. Only accepted steps count.
//! - The quadratic rule uses the exact minimiser alpha = g'h / (chi2(p + h) - chi2(p) + 2 g'h); Gavin halves the
//!   difference, which on a quadratic stops at two thirds of the way.
//! - The quadratic rule raises lambda by the change of chi2 relative to chi2, and at least twofold; the absolute
//!   change that Gavin adds has another unit than lambda.
//! - lambda may fall to 1e-12 instead of 1e-7, which would slow the last steps down where J has a condition number
//!   above some thousands.
//! - A step whose expected decrease is below the rounding of chi2 cannot be judged by chi2 and is taken on trust, as
//!   long as such steps keep shrinking.

mod damping;
mod dense;
#[cfg(test)]
mod nist;
mod step;

pub use damping::{Damping, Scaling};
pub use dense::DenseProblem;

use crate::error::{Error, Result};
use damping::Lambda;
use nalgebra::{Cholesky, DMatrix, DVector};

/// What one linearisation of a least-squares problem at p amounts to.
#[derive(Debug, Clone)]
pub struct NormalEquations {
    /// J'WJ, parameters x parameters, symmetric.
    pub jtwj: DMatrix<f64>,
    /// J'W (y - yhat), one entry per parameter: minus half the gradient of chi2.
    pub jtwr: DVector<f64>,
    /// (y - yhat)' W (y - yhat).
    pub chi2: f64,
}

/// A weighted least-squares problem, as the solver needs it.
pub trait LeastSquaresProblem {
    /// Number of parameters.
    fn parameters(&self) -> usize;
    /// Number of measurements (rows of J).
    fn measurements(&self) -> usize;
    /// The normal equations at `p`.
    ///
    /// # Errors
    /// Whatever keeps the model from being evaluated; the fit ends with it.
    fn normal_equations(&mut self, p: &[f64]) -> Result<NormalEquations>;
    /// The weighted sum of squares at `p`. NaN or infinity says that the model has no value there: the step that led
    /// to it is shortened.
    ///
    /// # Errors
    /// Whatever keeps the model from being evaluated; the fit ends with it.
    fn chi2(&mut self, p: &[f64]) -> Result<f64>;
}

/// Lower and upper limit of every parameter; use infinities where there is none.
#[derive(Debug, Clone)]
pub struct Bounds {
    /// Smallest allowed values.
    pub lower: Vec<f64>,
    /// Largest allowed values.
    pub upper: Vec<f64>,
}

/// How to search and when to stop. The default is Gavin's method 1 with tolerances near the rounding error.
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

/// Minimises chi2 of `problem` from the start `p0`.
///
/// # Errors
/// `p0`, bounds or normal equations of the wrong length; a start outside the bounds; a model that is not finite at
/// the start or whose derivatives are not finite at a point reached; errors of the problem itself.
pub fn minimize(problem: &mut impl LeastSquaresProblem, p0: &[f64], options: &Options) -> Result<Fit> {
    let bounds = step::checked_bounds(problem.parameters(), p0, options.bounds.as_ref())?;
    let mut p = p0.to_vec();
    let mut normal = linearise(problem, &p)?;
    let mut lambda = Lambda::new(options.damping, options.scaling, options.initial_lambda, &normal.jtwj);
    let mut chi2_history = vec![normal.chi2];
    let mut lambda_history = vec![lambda.value];
    let freedom = problem.measurements().checked_sub(p.len()).filter(|&f| f > 0).map(|f| f as f64);
    let mut iterations = 0;
    let mut trust = Trust::default();

    let stop = loop {
        if step::relative_gradient(&normal, &p, &bounds) <= options.gradient_tolerance {
            break StopReason::Gradient;
        }
        if freedom.is_some_and(|f| normal.chi2 / f < options.chi2_tolerance) || normal.chi2 == 0.0 {
            break StopReason::ChiSquare;
        }
        if iterations == options.max_iterations {
            break StopReason::Iterations;
        }
        iterations += 1;

        let mut trial = step::damped(&normal, &lambda, &p, &bounds);
        let mut chi2 = problem.chi2(&trial.p)?;
        let size = step::relative_size(&normal, &p, &trial.h);
        let rounding = 8.0 * f64::EPSILON * normal.chi2;
        let mut alpha = 1.0;
        if options.damping == Damping::Quadratic && trial.predicted > rounding {
            let slope = trial.h.dot(&normal.jtwr);
            alpha = damping::line_minimiser(slope, chi2 - normal.chi2);
            trial = step::along(&normal, &p, &(&trial.h * alpha), &bounds);
            chi2 = problem.chi2(&trial.p)?;
        }
        let gain = normal.chi2 - chi2;
        let hidden = trial.predicted.abs() <= rounding && gain.abs() <= 64.0 * rounding;
        let rho = if hidden { 1.0 } else { gain / trial.predicted };
        if trial.predicted > -rounding && rho > options.acceptance {
            p = trial.p;
            normal = linearise(problem, &p)?;
            lambda.decrease(rho, alpha);
            chi2_history.push(normal.chi2);
            lambda_history.push(lambda.value);
            if size <= options.step_tolerance {
                break StopReason::Step;
            }
            if hidden && trust.exhausted(size) {
                break StopReason::Precision;
            }
        } else {
            let undamped_size = size * (1.0 + lambda.relative());
            let may_grow = lambda.increase(gain / normal.chi2, alpha);
            chi2_history.push(normal.chi2);
            lambda_history.push(lambda.value);
            if undamped_size <= options.step_tolerance {
                break StopReason::Precision;
            }
            if !may_grow {
                break StopReason::Damping;
            }
        }
    };

    let reduced_chi2 = freedom.map(|f| normal.chi2 / f);
    let covariance = reduced_chi2.and_then(|s2| Some(inverse(&normal.jtwj)? * s2));
    Ok(Fit { parameters: p, chi2_history, lambda_history, iterations, covariance, reduced_chi2, stop })
}

/// Watches the steps that chi2 is too coarse to judge: they are at the rounding of the gradient once they no longer
/// shrink.
struct Trust {
    smallest: f64,
    idle: usize,
}

impl Default for Trust {
    fn default() -> Self {
        Trust { smallest: f64::INFINITY, idle: 0 }
    }
}

impl Trust {
    /// Whether a step of `size` is the fifth in a row that is no real improvement on the smallest before it.
    fn exhausted(&mut self, size: f64) -> bool {
        if size < 0.9 * self.smallest {
            *self = Trust { smallest: size, idle: 0 };
        } else {
            self.idle += 1;
        }
        self.idle == 5
    }
}

/// The normal equations at `p`, checked.
fn linearise(problem: &mut impl LeastSquaresProblem, p: &[f64]) -> Result<NormalEquations> {
    let normal = problem.normal_equations(p)?;
    let n = p.len();
    if normal.jtwj.shape() != (n, n) || normal.jtwr.len() != n {
        return Err(numerical(format!(
            "the normal equations are {}x{} with {} right-hand sides for {n} parameters",
            normal.jtwj.nrows(),
            normal.jtwj.ncols(),
            normal.jtwr.len()
        )));
    }
    if !normal.chi2.is_finite() {
        return Err(numerical(format!("the sum of squares is {} at p = {p:?}; start elsewhere", normal.chi2)));
    }
    let bad = (0..n).find(|&k| !normal.jtwr[k].is_finite() || normal.jtwj.column(k).iter().any(|v| !v.is_finite()));
    if let Some(k) = bad {
        return Err(numerical(format!(
            "the derivative by parameter {k} is not finite at p = {p:?}; bound that parameter or start elsewhere"
        )));
    }
    Ok(normal)
}

/// Inverse of a symmetric positive definite matrix by Cholesky factors of its unit-diagonal form; None where it is
/// singular within rounding.
fn inverse(a: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let n = a.nrows();
    let scale: Vec<f64> = (0..n).map(|i| 1.0 / a[(i, i)].sqrt()).collect();
    if scale.iter().any(|s| !s.is_finite()) {
        return None;
    }
    let unit = DMatrix::from_fn(n, n, |i, j| a[(i, j)] * scale[i] * scale[j]);
    let factor = Cholesky::new(unit)?;
    let smallest = factor.l_dirty().diagonal().min();
    if smallest * smallest <= 4.0 * n as f64 * f64::EPSILON {
        return None;
    }
    let inverse = factor.inverse();
    Some(DMatrix::from_fn(n, n, |i, j| inverse[(i, j)] * scale[i] * scale[j]))
}

/// An error of the numbers, not of the caller's files.
fn numerical(problem: String) -> Error {
    Error::request("numerical problem in the Levenberg-Marquardt fit", problem)
}

#[cfg(test)]
mod tests;
