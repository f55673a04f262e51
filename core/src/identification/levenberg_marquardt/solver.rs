//! The search itself.

use super::damping::{self, Damping, Lambda};
use super::options::{Fit, Options, StopReason};
use super::problem::{LeastSquaresProblem, NormalEquations};
use super::step;
use crate::error::{Error, Result};
use nalgebra::{Cholesky, DMatrix};

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
