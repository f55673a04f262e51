//! The low-pass that torque may have gone through before it was logged.

use crate::error::Result;
use crate::signal::ZeroPhaseLowPass;

/// A zero-phase Butterworth low-pass.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::diagnosis::LowPass;
/// # use tauscope::diagnosis::Diagnosis;
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Ignored)?;
/// # let log = |name: &str| recording::load(format!("../tests/reference/pendulum/{name}.csv"), None);
/// # let (train, test) = (log("train")?, log("test")?);
/// # let answer = Diagnosis::of(&robot).train([&train]).test([&test]).candidates(["torque_ripple"]).run()?;
/// # let diagnosis = answer.diagnosis().expect("the logs are good");
///
/// // Torque of these logs was not filtered before it was logged.
/// let passband: Option<LowPass> = diagnosis.logs.passband;
/// assert_eq!(passband, None);
/// # Ok::<(), tauscope::error::Error>(())
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
