//! The low-pass that torque may have gone through before it was logged.

use crate::error::Result;
use crate::signal::ZeroPhaseLowPass;

/// A zero-phase Butterworth low-pass.
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
