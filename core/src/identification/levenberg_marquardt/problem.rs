//! A least-squares problem as the solver sees it.

use crate::error::Result;
use nalgebra::{DMatrix, DVector};

/// What one linearisation of a least-squares problem at p amounts to.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use nalgebra::{DMatrix, DVector};
/// use tauscope::identification::levenberg_marquardt::{DenseProblem, LeastSquaresProblem};
///
/// // The mean m of 1, 2 and 6, at m = 0: J is a column of ones.
/// let (measured, weights) = (DVector::from_column_slice(&[1.0, 2.0, 6.0]), DVector::repeat(3, 1.0));
/// let (predict, slope) = (|m: &[f64]| DVector::repeat(3, m[0]), |_: &[f64]| DMatrix::repeat(3, 1, 1.0));
/// let at_zero = DenseProblem::new(measured, weights, 1, predict, slope)?.normal_equations(&[0.0])?;
/// assert_eq!((at_zero.jtwj[0], at_zero.jtwr[0], at_zero.chi2), (3.0, 9.0, 41.0));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
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
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use nalgebra::{DMatrix, DVector};
/// use tauscope::error::Result;
/// use tauscope::identification::levenberg_marquardt::{LeastSquaresProblem, NormalEquations, Options, minimize};
///
/// /// The root of 2, as the p for which p^2 is 2.
/// struct Root;
///
/// impl LeastSquaresProblem for Root {
///     fn parameters(&self) -> usize { 1 }
///     fn measurements(&self) -> usize { 1 }
///     fn normal_equations(&mut self, p: &[f64]) -> Result<NormalEquations> {
///         let (slope, rest) = (2.0 * p[0], 2.0 - p[0] * p[0]);
///         let (jtwj, jtwr) = (DMatrix::repeat(1, 1, slope * slope), DVector::repeat(1, slope * rest));
///         Ok(NormalEquations { jtwj, jtwr, chi2: rest * rest })
///     }
///     fn chi2(&mut self, p: &[f64]) -> Result<f64> { Ok((2.0 - p[0] * p[0]).powi(2)) }
/// }
/// let fit = minimize(&mut Root, &[1.0], &Options::default())?;
/// assert!((fit.parameters[0] - 2f64.sqrt()).abs() < 1e-9);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
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
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::identification::levenberg_marquardt::{Bounds, Options};
/// # use nalgebra::{DMatrix, DVector};
/// # use tauscope::identification::levenberg_marquardt::{DenseProblem, minimize};
/// # let times = DVector::from_fn(20, |k, _| 0.1 * k as f64);
/// # let measured = times.map(|t| 2.0 * (-1.5 * t).exp());
/// # let of = times.clone();
/// # let decay = move |p: &[f64]| of.map(|t| p[0] * (-p[1] * t).exp());
/// # let slopes = move |p: &[f64]| DMatrix::from_fn(20, 2, |k, c| {
/// #     let fall = (-p[1] * times[k]).exp();
/// #     [fall, -p[0] * times[k] * fall][c]
/// # });
/// # let mut problem = DenseProblem::new(measured, DVector::repeat(20, 1.0), 2, decay, slopes)?;
///
/// // The decay 2 exp(-1.5 t), of which the rate may not exceed 1.2: it ends there.
/// let bounds = Some(Bounds { lower: vec![0.0, 0.0], upper: vec![f64::INFINITY, 1.2] });
/// let fit = minimize(&mut problem, &[1.0, 1.0], &Options { bounds, ..Options::default() })?;
/// assert!((fit.parameters[1] - 1.2).abs() < 1e-9);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Bounds {
    /// Smallest allowed values.
    pub lower: Vec<f64>,
    /// Largest allowed values.
    pub upper: Vec<f64>,
}
