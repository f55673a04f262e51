//! Identification: from a recording to base parameters with standard deviations.

pub mod base_columns;
mod bounded;
pub mod consistent;
pub mod effect_model;
pub mod estimators;
pub mod fit;
pub mod fused;
pub mod gram;
pub mod joint_regression;
pub mod joint_sums;
pub mod least_squares;
pub mod levenberg_marquardt;
pub mod linear_model;
pub mod linear_problem;
pub mod model;
pub mod noise;
pub mod paper78;
pub mod prepare;
mod scaled_normal;
pub mod separable;
pub(crate) mod sequences;
pub mod spectrum;
pub mod standard;
mod streamed;
pub mod tsqr;
