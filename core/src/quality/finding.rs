//! A finding: what kind of fault, where, how bad, and what to do.

/// How bad a finding is.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// # use tauscope::robot::{self, InertiaCheck};
/// # use tauscope::{dataset, quality};
/// # let robot = robot::load("../tests/reference/payload/arm.urdf", InertiaCheck::Required)?;
/// # let mut read = dataset::read("../tests/reference/payload/before.csv".as_ref(), &robot)?;
/// use tauscope::quality::Severity;
///
/// // One joint without torque is a warning, since the others can be used; none with torque is fatal.
/// let worst = |read: &_| quality::examine(read, None).map(|report| report.findings[0].severity);
/// read.recording.tau.channel_mut(4).fill(0.0);
/// assert_eq!(worst(&read)?, Severity::Warning);
/// read.recording.tau.as_mut_slice().fill(0.0);
/// assert_eq!(worst(&read)?, Severity::Fatal);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Severity {
    /// Worth knowing.
    Note,
    /// Results will be wrong or poor unless something is done.
    Warning,
    /// The log cannot be used.
    Fatal,
}

/// What kind of fault it is.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// # use tauscope::robot::{self, InertiaCheck};
/// # use tauscope::{dataset, quality};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Required)?;
/// # let mut read = dataset::read("../tests/reference/pendulum/train.csv".as_ref(), &robot)?;
/// use tauscope::quality::Kind;
///
/// // The clock stands still for a second.
/// read.recording.time[300..].iter_mut().for_each(|time| *time += 1.0);
/// let findings = quality::examine(&read, Some(&robot))?.findings;
/// assert!(findings.iter().any(|finding| finding.kind == Kind::Gap));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
#[allow(missing_docs, reason = "the names say it; the text of a finding explains")]
pub enum Kind {
    TooShort,
    CutOff,
    BadRows,
    DuplicateTime,
    BackwardTime,
    Jitter,
    Gap,
    NoMotion,
    NoTorque,
    Frozen,
    HeldSamples,
    Clipped,
    Spike,
    Wrapped,
    UnsignedTorque,
    TorqueSign,
    TorqueUnit,
    VelocitySign,
    VelocityUnit,
    VelocityMismatch,
    VelocityDelay,
    PositionUnit,
    OutsideLimits,
    Swapped,
    DeadTime,
    HardlyMoves,
    PoorExcitation,
    TwoSources,
    Corrected,
    UnusedColumns,
    PositionSign,
    Mounting,
    GravityCompensated,
    ClockFactor,
    MotorOff,
    ModelTorque,
    PositionZero,
    TorqueSpike,
    HeldPosition,
    OtherRobot,
    PositionJump,
    LostRows,
    JointName,
}

/// One finding.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// # use tauscope::robot::{self, InertiaCheck};
/// # use tauscope::{dataset, quality};
/// # let robot = robot::load("../tests/reference/payload/arm.urdf", InertiaCheck::Required)?;
/// # let mut read = dataset::read("../tests/reference/payload/before.csv".as_ref(), &robot)?;
/// use tauscope::quality::{Kind, Severity};
///
/// // A log in which the torque of the last joint was not recorded.
/// read.recording.tau.channel_mut(4).fill(0.0);
/// let report = quality::examine(&read, None)?;
/// let finding = report.findings.iter().find(|finding| finding.kind == Kind::NoTorque).expect("it is noticed");
/// assert!(finding.place.contains("j5") && finding.severity == Severity::Warning);
/// assert!(finding.text.contains("it was not logged"));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Finding {
    /// What kind of fault.
    pub kind: Kind,
    /// The column, joint, line or time.
    #[serde(rename = "where")]
    pub place: String,
    /// How bad.
    pub severity: Severity,
    /// What is wrong and what to do.
    pub text: String,
}

impl Finding {
    pub(super) fn new(kind: Kind, severity: Severity, place: impl Into<String>, text: impl Into<String>) -> Self {
        Finding { kind, place: place.into(), severity, text: text.into() }
    }
}

/// What was found in logs, each item once, with the logs that have it.
pub fn with_logs<L: PartialEq, T: PartialEq>(found: impl IntoIterator<Item = (L, T)>) -> Vec<(Vec<L>, T)> {
    let mut out: Vec<(Vec<L>, T)> = Vec::new();
    for (log, item) in found {
        match out.iter_mut().find(|(_, known)| *known == item) {
            Some((logs, _)) if logs.contains(&log) => {}
            Some((logs, _)) => logs.push(log),
            None => out.push((vec![log], item)),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_several_logs_have_is_there_once() {
        let found = [("a", 1), ("a", 2), ("b", 1), ("a", 1), ("b", 3)];
        assert_eq!(with_logs(found), [(vec!["a", "b"], 1), (vec!["a"], 2), (vec!["b"], 3)]);
    }
}
