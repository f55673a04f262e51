//! A problem small enough to hold its Jacobian.

use super::problem::{LeastSquaresProblem, NormalEquations};
use crate::error::{Error, Result};
use nalgebra::{DMatrix, DVector};

/// A least-squares problem given by two closures and a diagonal weight matrix.
///
/// `predict` maps p to yhat(p), one value per measurement; `jacobian` maps p to d yhat / d p, measurements x
/// parameters.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use nalgebra::{DMatrix, DVector};
/// use tauscope::identification::levenberg_marquardt::{DenseProblem, Options, minimize};
///
/// // A straight line through (0, 1), (1, 3), (2, 5) and (3, 9).
/// let columns = DMatrix::from_row_slice(4, 2, &[1.0, 0.0, 1.0, 1.0, 1.0, 2.0, 1.0, 3.0]);
/// let (measured, weights) = (DVector::from_column_slice(&[1.0, 3.0, 5.0, 9.0]), DVector::repeat(4, 1.0));
/// let predict = |p: &[f64]| &columns * DVector::from_column_slice(p);
/// let mut line = DenseProblem::new(measured, weights, 2, predict, |_: &[f64]| columns.clone())?;
///
/// let fit = minimize(&mut line, &[0.0, 0.0], &Options::default())?;
/// assert!((fit.parameters[0] - 0.6).abs() < 1e-9 && (fit.parameters[1] - 2.6).abs() < 1e-9);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
pub struct DenseProblem<F, G> {
    measured: DVector<f64>,
    weights: DVector<f64>,
    parameters: usize,
    predict: F,
    jacobian: G,
}

impl<F, G> DenseProblem<F, G>
where
    F: FnMut(&[f64]) -> DVector<f64>,
    G: FnMut(&[f64]) -> DMatrix<f64>,
{
    /// The problem of fitting `parameters` parameters to the values `measured` with `weights` (the diagonal of W,
    /// 1 / sigma^2 each).
    ///
    /// # Errors
    /// Different numbers of values and weights; a value that is not finite; a weight that is negative or not finite.
    pub fn new(
        measured: DVector<f64>,
        weights: DVector<f64>,
        parameters: usize,
        predict: F,
        jacobian: G,
    ) -> Result<Self> {
        let subject = "least-squares problem";
        if measured.len() != weights.len() {
            let problem = format!("{} values but {} weights; give one weight each", measured.len(), weights.len());
            return Err(Error::request(subject, problem));
        }
        if let Some(i) = measured.iter().position(|y| !y.is_finite()) {
            return Err(Error::request(subject, format!("value {i} is {}; leave it out", measured[i])));
        }
        if let Some(i) = weights.iter().position(|w| !(w.is_finite() && *w >= 0.0)) {
            return Err(Error::request(subject, format!("weight {i} is {}; use 0 or a positive number", weights[i])));
        }
        Ok(DenseProblem { measured, weights, parameters, predict, jacobian })
    }

    /// y - yhat(p).
    fn residual(&mut self, p: &[f64]) -> Result<DVector<f64>> {
        let predicted = (self.predict)(p);
        self.check("values", predicted.len(), self.measured.len())?;
        Ok(&self.measured - predicted)
    }

    fn check(&self, what: &str, got: usize, expected: usize) -> Result<()> {
        if got == expected {
            return Ok(());
        }
        Err(Error::request("least-squares problem", format!("the model returns {got} {what}; it must be {expected}")))
    }
}

impl<F, G> LeastSquaresProblem for DenseProblem<F, G>
where
    F: FnMut(&[f64]) -> DVector<f64>,
    G: FnMut(&[f64]) -> DMatrix<f64>,
{
    fn parameters(&self) -> usize {
        self.parameters
    }

    fn measurements(&self) -> usize {
        self.measured.len()
    }

    fn normal_equations(&mut self, p: &[f64]) -> Result<NormalEquations> {
        let residual = self.residual(p)?;
        let jacobian = (self.jacobian)(p);
        self.check("Jacobian rows", jacobian.nrows(), self.measured.len())?;
        self.check("Jacobian columns", jacobian.ncols(), self.parameters)?;
        let mut weighted = jacobian.clone();
        for mut column in weighted.column_iter_mut() {
            column.component_mul_assign(&self.weights);
        }
        let jtwr = weighted.tr_mul(&residual);
        let chi2 = residual.component_mul(&self.weights).dot(&residual);
        Ok(NormalEquations { jtwj: weighted.tr_mul(&jacobian), jtwr, chi2 })
    }

    fn chi2(&mut self, p: &[f64]) -> Result<f64> {
        let residual = self.residual(p)?;
        Ok(residual.component_mul(&self.weights).dot(&residual))
    }
}
