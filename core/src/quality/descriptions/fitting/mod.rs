//! Models of the torques under a description, and their residuals.
//!
//! | question | module |
//! |---|---|
//! | which rows are compared | `rows` |
//! | what is known of the arm | `physics` |
//! | a load that a log may have | `load` |
//! | bodies of other masses | `masses` |
//! | residuals under a description | `fit` |

mod fit;
mod load;
pub(crate) mod masses;
mod physics;
mod rows;

pub(crate) use fit::{Evaluation, Fit, Friction};
pub(crate) use physics::{JointTable, Physics, Tables};
pub(crate) use rows::Rows;
