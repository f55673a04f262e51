//! Estimators of base parameters on one interface, to be compared on the same rows (as BIRDy does: Leboutet et al.,
//! "Inertial parameter identification in robotics: a survey", Applied Sciences 11, 2021).

mod closed_loop_output_error;
mod covariance;
mod estimator;
mod instrumental_variables;
mod iteratively_reweighted;
mod levenberg_marquardt;
mod ordinary;
mod total_least_squares;
mod weighted;

pub(crate) use closed_loop_output_error::Didim;
pub use estimator::{Data, Estimator, SimulatedRows};
pub(crate) use instrumental_variables::InstrumentalVariables;
pub(crate) use iteratively_reweighted::IterativelyReweighted;
pub(crate) use levenberg_marquardt::LevenbergMarquardt;
pub(crate) use ordinary::OrdinaryLeastSquares;
pub(crate) use total_least_squares::TotalLeastSquares;
pub(crate) use weighted::WeightedLeastSquares;

use crate::error::{Error, Result};

/// All estimators, in the order of tables.
pub(crate) static ALL: [&dyn Estimator; 7] = [
    &OrdinaryLeastSquares,
    &WeightedLeastSquares,
    &IterativelyReweighted,
    &LevenbergMarquardt,
    &TotalLeastSquares,
    &InstrumentalVariables,
    &Didim,
];

/// The estimator called `name`.
///
/// # Errors
/// Lists the names there are.
pub fn find(name: &str) -> Result<&'static dyn Estimator> {
    ALL.into_iter().find(|estimator| estimator.name() == name).ok_or_else(|| {
        let names: Vec<&str> = ALL.iter().map(|estimator| estimator.name()).collect();
        Error::request(
            format!("estimator `{name}`"),
            format!("there is none of this name; there are {}", names.join(", ")),
        )
    })
}

#[cfg(test)]
mod tests;
