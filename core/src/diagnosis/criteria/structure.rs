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
    /// Share of alpha at which training and held-out logs together show structure, and at which the map of all logs does: generic functions
    /// are many, and what they find cannot be checked against a law.
    pub together: f64,
    /// Share of alpha at which the training logs by themselves show structure with certainty, and at which a map shows spectral lines: noise that is
    /// not stationary makes their p-values too small.
    pub certain: f64,
    /// Least share of the residual of a joint that structure must have to be reported: a quarter of its root mean square, as of the noise. With many
    /// rows that of any simplification of a simulator or a sensor is significant.
    pub share_of_residual: f64,
    /// Share of the cut-off of a joint's positions up to which a spectral line counts: nearer to it, what the differences make of encoder
    /// noise is a peak, too.
    pub below_cutoff: f64,
    /// Difference of two spectral lines up to which they are one, Hz: half the width of the peak in a Hann window of 20 s.
    pub same_line_hz: f64,
    /// Factor by which the held-out residual of other logs must exceed that of the training logs and the standard deviation of the
    /// prediction, averages over half a second.
    pub foreign: f64,
    /// Share of the baseline's held-out residual up to which what was found explains the held-out logs too.
    pub carried_on: f64,
    /// Factor on the noise from which the held-out residual counts where no test says what it is: of other logs, of a search that was
    /// ended, of logs too short to separate what it follows. Noise that is estimated without the structure is up to 1.7 times too small on
    /// quiet logs.
    pub above_noise: f64,
    /// Factor on the noise of the map from which a residual is unexplained though no part of it is significant: slow noise and slow structure are
    /// not separated then. Quiet logs with noise that is correlated over half a second have up to 2.1.
    pub not_separated: f64,
    /// Share of the noise of a joint from which a part of its residual is reported.
    pub clear: f64,
    /// Ratio to the background from which the model's own torque has a spectral line at the same frequency: then it is the motion's.
    pub of_the_motion: f64,
    /// Least share of a law's square that must remain in the means over rows in which it is compared with generic functions, for these to
    /// judge it.
    pub resolved: f64,
}

impl Default for StructureCriteria {
    fn default() -> Self {
        StructureCriteria {
            together: 0.2,
            certain: 0.02,
            share_of_residual: 0.0625,
            below_cutoff: 0.5,
            same_line_hz: 0.1,
            foreign: 3.0,
            carried_on: 0.5,
            above_noise: 2.0,
            not_separated: 3.0,
            clear: 0.25,
            of_the_motion: 6.0,
            resolved: 0.5,
        }
    }
}
