//! How lambda follows the success of the steps: the three rules of Gavin (2019), section 4.1.

use nalgebra::{DMatrix, DVector};

/// What lambda multiplies in \[J'WJ + lambda D\] h = J'W (y - yhat).
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::identification::levenberg_marquardt::{Options, Scaling};
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
/// // Of y = a exp(-b t): with diag(J'WJ) the path is the same in whatever units a and b are.
/// assert_eq!(Options::default().scaling, Scaling::Diagonal);
/// let fit = minimize(&mut problem, &[1.0, 1.0], &Options { scaling: Scaling::Identity, ..Options::default() })?;
/// assert!((fit.parameters[0] - 2.0).abs() < 1e-8 && (fit.parameters[1] - 1.5).abs() < 1e-8);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scaling {
    /// D = I (Levenberg). Sensible where all parameters are of one scale.
    Identity,
    /// D = diag(J'WJ) (Marquardt). The path does not depend on the units of the parameters.
    Diagonal,
}

/// The rule by which lambda changes.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::identification::levenberg_marquardt::{Damping, Options};
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
/// // Every rule finds the decay 2 exp(-1.5 t).
/// for damping in [Damping::default(), Damping::Nielsen] {
///     let fit = minimize(&mut problem, &[1.0, 1.0], &Options { damping, ..Options::default() })?;
///     assert!((fit.parameters[0] - 2.0).abs() < 1e-8 && (fit.parameters[1] - 1.5).abs() < 1e-8);
/// }
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Damping {
    /// Divide by `down` after a step that is taken, multiply by `up` after one that is not (Gavin's method 1, with
    /// 9 and 11).
    Marquardt {
        /// Divisor after a step that is taken.
        down: f64,
        /// Factor after a step that is not.
        up: f64,
    },
    /// Go to the minimum of the parabola along the step; divide by 1 + alpha, or add |relative change of chi2| /
    /// (2 alpha) (Gavin's method 2). Costs two evaluations a step and creeps along curved valleys.
    Quadratic,
    /// Multiply by max(1/3, 1 - (2 rho - 1)^3), or by 2, 4, 8 and so on after steps in a row that are not taken
    /// (Nielsen 1999; Gavin's method 3).
    Nielsen,
}

impl Default for Damping {
    fn default() -> Self {
        Damping::Marquardt { down: 9.0, up: 11.0 }
    }
}

/// Range of lambda in its own unit. Gavin's lower limit is 1e-7.
const LIMITS: [f64; 2] = [1e-12, 1e7];

/// The damping of the current iteration.
#[derive(Debug)]
pub(super) struct Lambda {
    /// Multiplies D.
    pub value: f64,
    scaling: Scaling,
    rule: Damping,
    /// Largest entry of diag(J'WJ) at the start for [`Scaling::Identity`], else 1: makes the limits free of units.
    unit: f64,
    /// Nielsen's factor for the next step that is not taken.
    nu: f64,
}

impl Lambda {
    /// The damping at the start, where J'WJ is `jtwj`.
    pub(super) fn new(rule: Damping, scaling: Scaling, initial: f64, jtwj: &DMatrix<f64>) -> Self {
        let unit = match scaling {
            Scaling::Identity => jtwj.diagonal().max().max(f64::MIN_POSITIVE),
            Scaling::Diagonal => 1.0,
        };
        Lambda { value: initial * unit, scaling, rule, unit, nu: 2.0 }
    }

    /// lambda D for the diagonal `diagonal` of J'WJ. A parameter without influence gets the pivot 1: its gradient is
    /// zero, so it stays where it is.
    pub(super) fn diagonal(&self, diagonal: &DVector<f64>) -> DVector<f64> {
        diagonal.map(|d| match self.scaling {
            _ if d <= 0.0 => 1.0,
            Scaling::Identity => self.value,
            Scaling::Diagonal => self.value * d,
        })
    }

    /// lambda free of units.
    pub(super) fn relative(&self) -> f64 {
        self.value / self.unit
    }

    /// After a step that is taken, whose gain was `rho` times the expected one and whose line search gave `alpha`.
    pub(super) fn decrease(&mut self, rho: f64, alpha: f64) {
        let floor = LIMITS[0] * self.unit;
        self.value = match self.rule {
            Damping::Marquardt { down, .. } => (self.value / down).max(floor),
            Damping::Quadratic => (self.value / (1.0 + alpha)).max(floor),
            Damping::Nielsen => self.value * (1.0 - (2.0 * rho.min(1.0) - 1.0).powi(3)).max(1.0 / 3.0),
        };
        self.nu = 2.0;
    }

    /// After a step that is not taken, which would have lowered chi2 by the share `gain`. False when lambda was at its upper
    /// limit already.
    pub(super) fn increase(&mut self, gain: f64, alpha: f64) -> bool {
        let ceiling = LIMITS[1] * self.unit;
        let before = self.value;
        let grown = match self.rule {
            Damping::Marquardt { up, .. } => before * up,
            Damping::Quadratic => (before + self.unit * gain.abs() / (2.0 * alpha)).max(2.0 * before),
            Damping::Nielsen => before * self.nu,
        };
        self.nu *= 2.0;
        self.value = if grown.is_finite() { grown.min(ceiling) } else { (before * 11.0).min(ceiling) };
        before < ceiling
    }
}

/// The factor alpha at which chi2 is least along a step h with g'h = `slope` and chi2(p + h) - chi2(p) = `rise`; 1
/// where the parabola through them has no minimum ahead.
pub(super) fn line_minimiser(slope: f64, rise: f64) -> f64 {
    let curvature = rise + 2.0 * slope;
    let alpha = slope / curvature;
    if curvature > 0.0 && alpha.is_finite() && alpha > 0.0 { alpha.min(10.0) } else { 1.0 }
}
