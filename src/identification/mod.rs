//! Identification: from a recording to base parameters with standard deviations.

pub(crate) mod base_columns;
mod bounded;
pub mod consistent;
mod consistent_body;
pub mod effect_model;
pub mod equations;
pub(crate) mod estimators;
pub mod fit;
pub mod fused;
pub(crate) mod gram;
pub(crate) mod joint_regression;
pub(crate) mod joint_sums;
pub mod least_squares;
pub mod levenberg_marquardt;
pub(crate) mod linear_model;
pub mod linear_problem;
pub mod model;
pub(crate) mod noise;
mod plausible;
pub mod prepare;
mod pseudo_inertia;
pub mod reversals;
mod scaled_normal;
pub(crate) mod separable;
pub(crate) mod sequences;
pub mod smoothing_choice;
pub(crate) mod spectrum;
pub(crate) mod standard;
mod streamed;
pub mod tsqr;
mod undetermined;

pub(crate) use consistent_body::nearest_body;
