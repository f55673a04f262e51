//! What is reported of a log, and of several logs of one arm.

use super::descriptions::Verdict;
use super::finding::{Finding, Severity};
use super::motion::JointSummary;
use super::unit_changes::UnitChanges;
use crate::recording::lenient::Rejected;
use crate::recording::resample::Clock;

/// Everything found in a log.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::quality;
/// use tauscope::robot::{self, InertiaCheck};
///
/// let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Required)?;
/// let report = quality::inspect("../tests/reference/pendulum/train.csv".as_ref(), Some(&robot))?;
/// assert!(report.usable && report.fatal().is_none());
/// assert_eq!((report.rows, report.rejected.len(), report.joints.len()), (1000, 0, 1));
/// assert!((report.clock.rate_hz - 50.0).abs() < 1e-6);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Report {
    /// Rows that can be used.
    pub rows: usize,
    /// Rows that were left out.
    pub rejected: Vec<Rejected>,
    /// Time from the first to the last sample, s.
    pub duration_s: f64,
    /// Rate and jitter.
    pub clock: Clock,
    /// Gaps in which rows were lost, and those that are too long to be bridged.
    pub gaps: usize,
    /// Range, speed and torque of every joint.
    pub joints: Vec<JointSummary>,
    /// Condition number of the base parameters' regressor with columns of equal length; with a URDF only.
    pub condition_number: Option<f64>,
    /// What is wrong with the description of the log.
    #[serde(skip)]
    pub description: Option<Verdict>,
    /// Units that are not those of the description.
    #[serde(skip)]
    pub units: UnitChanges,
    /// Joints whose torque lost its sign, so that their equation has no information.
    #[serde(skip)]
    pub unsigned: Vec<usize>,
    /// What is wrong, the worst first.
    pub findings: Vec<Finding>,
    /// Whether the log can be used at all.
    pub usable: bool,
}

impl Report {
    /// Whether the log may be that of another robot: no changed description is one of it then.
    pub fn is_of_another_robot(&self) -> bool {
        self.findings.iter().any(|finding| finding.kind.is_another_robot() && finding.severity > Severity::Note)
    }

    /// The first reason why the log cannot be used.
    pub fn fatal(&self) -> Option<&Finding> {
        self.findings.iter().find(|finding| finding.severity == Severity::Fatal)
    }
}

/// What was found in several logs of one arm.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// # use tauscope::robot::{self, InertiaCheck};
/// # use tauscope::{dataset, quality};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Required)?;
/// # let mut read = dataset::read("../tests/reference/pendulum/train.csv".as_ref(), &robot)?;
/// // Two logs of one recorder. What is wrong with their description is looked for in both together: nothing.
/// let other = dataset::read("../tests/reference/pendulum/test.csv".as_ref(), &robot)?;
/// let together = quality::examine_together(&[&read, &other], Some(&robot))?;
/// assert_eq!((together.reports.len(), together.verdict), (2, None));
/// # let _ = &mut read;
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Together {
    /// One report per log.
    pub reports: Vec<Report>,
    /// What is wrong with the description of all of them.
    pub verdict: Option<Verdict>,
}
