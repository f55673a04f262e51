//! What all trajectories are made of. Knots, coefficients and times come in; position, velocity and acceleration at many times go
//! out, and their extremes.

mod batch;
mod peaks;
mod piecewise;
mod polynomial;
mod reference;
pub(super) mod timing;

pub(crate) use batch::{Law, fill_along};
pub(crate) use peaks::Extreme;
pub use peaks::Peaks;
pub(crate) use piecewise::PiecewisePolynomial;
pub use reference::Reference;
pub(crate) use reference::fill;
