//! A least-squares problem as the solver sees it.

use crate::error::Result;
use nalgebra::{DMatrix, DVector};

/// What one linearisation of a least-squares problem at p amounts to.
#[derive(Debug, Clone)]
pub struct NormalEquations {
    /// J'WJ, parameters x parameters, symmetric.
    pub jtwj: DMatrix<f64>,
    /// J'W (y - yhat), one entry per parameter: minus half the gradient of chi2.
    pub jtwr: DVector<f64>,
    /// (y - yhat)' W (y - yhat).
    pub chi2: f64,
}

/// A weighted least-squares problem, as the solver needs it.
pub trait LeastSquaresProblem {
    /// Number of parameters.
    fn parameters(&self) -> usize;
    /// Number of measurements (rows of J).
    fn measurements(&self) -> usize;
    /// The normal equations at `p`.
    ///
    /// # Errors
    /// Whatever keeps the model from being evaluated; the fit ends with it.
    fn normal_equations(&mut self, p: &[f64]) -> Result<NormalEquations>;
    /// The weighted sum of squares at `p`. NaN or infinity means that the model has no value there: the step that led
    /// to it is shortened.
    ///
    /// # Errors
    /// Whatever keeps the model from being evaluated; the fit ends with it.
    fn chi2(&mut self, p: &[f64]) -> Result<f64>;
}

/// Lower and upper limit of every parameter; use infinities where there is none.
#[derive(Debug, Clone)]
pub struct Bounds {
    /// Smallest allowed values.
    pub lower: Vec<f64>,
    /// Largest allowed values.
    pub upper: Vec<f64>,
}
