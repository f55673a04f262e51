//! A finding: what kind of fault, where, how bad, and what to do.

use crate::robot::shortened;

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
    GravityAlone,
    ClockFactor,
    MotorOff,
    ModelTorque,
    PositionZero,
    TorqueSpike,
    HeldPosition,
    OtherRobot,
    NothingExplains,
    PositionJump,
    LostRows,
    JointName,
}

impl Kind {
    /// Whether it is that the log may be of another robot.
    pub fn is_another_robot(self) -> bool {
        matches!(self, Kind::OtherRobot | Kind::NothingExplains)
    }
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

/// The findings of a log, with one on all joints that hardly move, and on all joints whose signals stop together, in place of one for each.
pub fn standing_together(findings: &[Finding]) -> Vec<Finding> {
    let mut out = alike_together(findings);
    for what in [NOT_FOUND, UNCERTAIN] {
        let is_own = |finding: &Finding| finding.kind == Kind::HardlyMoves && finding.text.ends_with(what);
        let own: Vec<&Finding> = findings.iter().filter(|finding| is_own(finding)).collect();
        let [first, _, ..] = own[..] else { continue };
        let places: Vec<String> = own.iter().map(|finding| finding.place.clone()).collect();
        let text = format!("these joints hardly move: their friction and inertia {what}");
        let all = Finding::new(Kind::HardlyMoves, first.severity, shortened(&places), text);
        let place = out.iter().position(is_own).unwrap_or(0);
        out.retain(|finding| !is_own(finding));
        out.insert(place, all);
    }
    out
}

/// Kinds that one cause gives several joints: a switch of all motors, a message that did not come.
const OF_ALL_JOINTS: [Kind; 3] = [Kind::MotorOff, Kind::Frozen, Kind::HeldSamples];

/// The findings, with one in the place of those that say the same of several joints from the same time on.
pub(crate) fn alike_together(findings: &[Finding]) -> Vec<Finding> {
    let time = |finding: &Finding| finding.place.find(" from ").map(|at| finding.place[at..].to_owned());
    let key = |finding: &Finding| (finding.kind, finding.severity, finding.text.clone(), time(finding));
    let mut out: Vec<Finding> = Vec::new();
    for finding in findings {
        let own: Vec<&Finding> = findings.iter().filter(|other| key(other) == key(finding)).collect();
        if !OF_ALL_JOINTS.contains(&finding.kind) || own.len() < 2 {
            out.push(finding.clone());
        } else if std::ptr::eq(own[0], finding) {
            let since = time(finding).unwrap_or_default();
            let places: Vec<String> =
                own.iter().map(|other| other.place.trim_end_matches(since.as_str()).to_owned()).collect();
            out.push(Finding { place: format!("{}{since}", shortened(&places)), ..finding.clone() });
        }
    }
    out
}

/// What becomes of the friction and inertia of a joint that hardly moves: it stands ..
pub(super) const NOT_FOUND: &str = "cannot be found from this log";

/// .. or it moves above its noise, so that an identification has numbers for them.
pub(super) const UNCERTAIN: &str = "are uncertain";

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
    fn joints_that_hardly_move_are_named_together() {
        let of = |kind: Kind, place: &str| Finding::new(kind, Severity::Warning, place, NOT_FOUND);
        let still: Vec<Finding> = ["a", "b", "c", "d", "e"].map(|place| of(Kind::HardlyMoves, place)).to_vec();
        let others = [of(Kind::Gap, "t"), of(Kind::Spike, "x")];
        let all = [&others[..1], &still, &others[1..]].concat();
        let told = standing_together(&all);
        assert_eq!((told.len(), &*told[1].place), (3, "a, b, c and 2 more"));
        assert_eq!([&told[0], &told[2]], [&others[0], &others[1]]);
        // One keeps its range and speed, also besides others of which something else becomes.
        assert_eq!(standing_together(&all[..2]), all[..2]);
        let creeps = Finding::new(Kind::HardlyMoves, Severity::Warning, "f", UNCERTAIN);
        let told = standing_together(&[&all[..], &[creeps.clone(), creeps.clone()]].concat());
        assert_eq!(
            (told.len(), &*told[3].text),
            (4, "these joints hardly move: their friction and inertia are uncertain")
        );
        assert_eq!(standing_together(&[all[1].clone(), creeps.clone()]), [all[1].clone(), creeps]);
    }

    #[test]
    fn motors_that_are_off_together_are_named_together() {
        let off = |place: &str, text: &str| Finding::new(Kind::MotorOff, Severity::Note, place, text);
        let joints = ["tau1 (a)", "tau2 (b)", "tau3 (c)", "tau4 (d)", "tau5 (e)"]
            .map(|joint| off(&format!("{joint} from 5 s"), "off"));
        let told = standing_together(&joints);
        assert_eq!(told, [off("tau1 (a), tau2 (b), tau3 (c) and 2 more from 5 s", "off")]);
        // At another time, for another time, and a single one.
        let other =
            [off("tau1 (a) from 5 s", "off"), off("tau2 (b) from 6 s", "off"), off("tau3 (c) from 5 s", "long")];
        assert_eq!(standing_together(&other), other);
        let spikes = ["q1 (a)", "q2 (b)"].map(|place| Finding::new(Kind::Spike, Severity::Warning, place, "remove it"));
        assert_eq!(standing_together(&spikes), spikes);
    }

    #[test]
    fn what_several_logs_have_is_there_once() {
        let found = [("a", 1), ("a", 2), ("b", 1), ("a", 1), ("b", 3)];
        assert_eq!(with_logs(found), [(vec!["a", "b"], 1), (vec!["a"], 2), (vec!["b"], 3)]);
    }
}
