//! From motion and torque to parameters.

pub mod levenberg_marquardt;
pub mod paper78;
