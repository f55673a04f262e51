//! Linear regression on stacked joint equations.
//!
//! In: columns of the regressor `[joint][row]` and whitened rows. Out: least-squares solutions with covariance, projections onto
//! the complement of a column space, and score (Lagrange multiplier) tests with their chi-square and F p-values.
//! It knows nothing of arms, effects or logs.

mod basis;
mod column;
mod factors;
mod prior;
mod score;
mod solution;

pub use column::{Column, rms};
pub(crate) use column::{combined, joints_of, parts_on};
pub(crate) use column::{deviation, is_constant};
pub(crate) use factors::{Factored, JointFactors, OfJoint};
pub(crate) use prior::Described;
pub use score::Projection;
pub(crate) use score::Test;
pub(crate) use score::{fisher, log_survival};
pub(crate) use solution::Solved;
pub(crate) use solution::{JointEquations, gram, solve, solve_normal};
