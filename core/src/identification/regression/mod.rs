//! Linear regression over all joints. Each joint's rows and torque come in; parameters with standard deviations that allow for
//! coloured noise go out, and the parameters that the rows do not determine.

pub(crate) mod joint_regression;
pub(crate) mod joint_sums;
pub mod least_squares;
pub mod linear_problem;
pub(crate) mod noise;
pub(super) mod undetermined;
