//! Linear regression on stacked joint equations.
//!
//! In: columns of the regressor `[joint][row]` and whitened rows. Out: least-squares solutions with covariance, projections onto
//! the complement of a column space, and score (Lagrange multiplier) tests with their chi-square and F p-values.
//! It knows nothing of arms, effects or logs.

mod basis;
mod column;
mod score;
mod solution;

pub use column::{Column, combined, joints_of, rms};
pub use score::{Projection, Test, fisher, log_survival};
pub use solution::{JointEquations, Solved, gram, solve, solve_normal};
