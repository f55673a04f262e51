//! The low-pass that torque may have gone through before it was logged.

use crate::error::Result;
use crate::signal::ZeroPhaseLowPass;

/// A zero-phase Butterworth low-pass.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::diagnosis::{Diagnosis, LowPass};
///
/// // The band that the torque of the logs has.
/// fn band_hz(diagnosis: &Diagnosis) -> Option<f64> {
///     diagnosis.logs.passband.map(|LowPass { hz, .. }| hz)
/// }
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LowPass {
    /// Order of one of the two runs.
    pub order: usize,
    /// Frequency that passes with half its amplitude, Hz.
    pub hz: f64,
}

impl LowPass {
    /// The filter for signals of a rate.
    ///
    /// # Errors
    /// If the cut-off is not below half the rate.
    pub(crate) fn at_rate(&self, rate_hz: f64) -> Result<ZeroPhaseLowPass> {
        ZeroPhaseLowPass::new(self.order, self.hz, rate_hz)
    }
}
