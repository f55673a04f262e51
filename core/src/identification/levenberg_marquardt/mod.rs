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
mod options;
mod problem;
mod solver;
mod step;
#[cfg(test)]
mod tests;

pub use damping::{Damping, Scaling};
pub use dense::DenseProblem;
pub use options::{Fit, Options, StopReason};
pub use problem::{Bounds, LeastSquaresProblem, NormalEquations};
pub use solver::minimize;
