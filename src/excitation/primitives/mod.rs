//! What all trajectories are made of. Knots, coefficients and times come in; position, velocity and acceleration at many times go
//! out, and their extremes.

mod batch;
mod peaks;
mod piecewise;
mod polynomial;
mod reference;
pub(super) mod timing;

pub use batch::{Law, fill_along};
pub use peaks::{Extreme, Peaks};
pub use piecewise::PiecewisePolynomial;
pub use reference::{Reference, fill};
