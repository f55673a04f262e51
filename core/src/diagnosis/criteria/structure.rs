//! Thresholds of the tests for structure that no effect explains.

use serde::Serialize;

/// Thresholds that decide which structure of the residual is reported as unexplained, and which findings it replaces.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::diagnosis::{Criteria, StructureCriteria};
///
/// // Report a part of a joint's residual from half of its noise on, not from a quarter.
/// let structure = StructureCriteria { clear: 0.5, ..StructureCriteria::default() };
/// let criteria = Criteria { structure, ..Criteria::default() };
/// assert_eq!((criteria.structure.clear, Criteria::default().structure.clear), (0.5, 0.25));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct StructureCriteria {
    /// Share of alpha at which training and held-out logs together show structure, and another such at which the map of all logs does: generic
    /// functions are many, and what they find cannot be checked against a law.
    pub together: f64,
    /// Difference of two spectral lines up to which they are one, Hz: half the width of the peak in a Hann window of 20 s.
    pub same_line_hz: f64,
    /// Factor on the noise from which the held-out residual counts where no test indicates its cause: of other logs, of a search that
    /// was ended, of logs too short to separate what it follows. Noise that is estimated without the structure is up to 1.7 times too small
    /// on quiet logs.
    pub above_noise: f64,
    /// Share of the noise of a joint, and of its residual, from which a part of the residual is reported, root mean squares. With many rows
    /// that of any simplification of a simulator or a sensor is significant.
    pub clear: f64,
    /// Ratio to the background from which the model's own torque has a spectral line at the same frequency: then it is the motion's.
    pub of_the_motion: f64,
}

impl StructureCriteria {
    /// Least share of the square of a joint's residual that structure must have to be reported.
    pub(crate) fn share_of_residual(&self) -> f64 {
        self.clear * self.clear
    }
}

impl Default for StructureCriteria {
    fn default() -> Self {
        StructureCriteria { together: 0.1, same_line_hz: 0.1, above_noise: 2.0, clear: 0.25, of_the_motion: 6.0 }
    }
}
