//! Screening for faults of the data, before any model is fitted: faults that stop a diagnosis, samples that are excluded, and warnings.
//!
//! The checks are those of [`quality`]. Samples at a clipping level become torques that are not a number, which the rows of
//! the tests leave out; logs are cut at long gaps; columns in the wrong order, unit or sign stop the diagnosis, since any
//! cause named from them would be wrong.

use crate::error::{Error, Result};
use crate::quality::descriptions::{self, Verdict};
use crate::quality::{self, Kind, Severity, UnitChanges};
use crate::recording::Recording;
use crate::recording::lenient::Sieved;
use crate::robot::Robot;

/// What a fault does to the diagnosis.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::dataset;
/// use tauscope::diagnosis::{Consequence, screen};
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Ignored)?;
/// # let mut read = dataset::read("../tests/reference/pendulum/train.csv".as_ref(), &robot)?;
///
/// // A gap is left out or bridged. A position that stands out from both neighbours stops a diagnosis.
/// let mut gap = read.clone();
/// gap.recording.time[300..].iter_mut().for_each(|time| *time += 0.5);
/// let faults = screen("monday.csv", gap, &robot)?.faults;
/// assert!(faults.iter().all(|fault| fault.consequence != Consequence::Stops));
///
/// read.recording.q.channel_mut(0)[300] += 2.0;
/// let faults = screen("monday.csv", read, &robot)?.faults;
/// assert!(faults.iter().any(|fault| fault.consequence == Consequence::Stops));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Consequence {
    /// No cause of physics can be named.
    Stops,
    /// The samples at fault are left out or bridged.
    LeftOut,
    /// What is named holds only if the logs are of this robot, and by a right clock, which is not sure.
    Doubts,
    /// A note; it does not change what the diagnosis uses.
    #[serde(rename = "told")]
    Noted,
    /// The description of the logs was wrong beyond doubt; the diagnosis goes on with the right one.
    Corrected,
}

/// A fault of one log.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::dataset;
/// use tauscope::diagnosis::screen;
/// use tauscope::quality::Kind;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Ignored)?;
/// # let mut read = dataset::read("../tests/reference/pendulum/train.csv".as_ref(), &robot)?;
///
/// // The clock stands still for half a second.
/// read.recording.time[300..].iter_mut().for_each(|time| *time += 0.5);
/// let faults = screen("monday.csv", read, &robot)?.faults;
/// let gap = faults.iter().find(|fault| fault.kind == Kind::Gap).expect("it is noticed");
/// assert_eq!(gap.log, "monday.csv");
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct DataFault {
    /// What kind of fault.
    pub kind: Kind,
    /// The log.
    pub log: String,
    /// The column, joint, line or time.
    pub place: String,
    /// What is wrong and what to do.
    pub text: String,
    /// What it does to the diagnosis.
    pub consequence: Consequence,
}

/// A log made ready, with its faults.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::dataset;
/// use tauscope::diagnosis::screen;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Ignored)?;
/// # let mut read = dataset::read("../tests/reference/pendulum/train.csv".as_ref(), &robot)?;
///
/// // Five seconds are missing in the middle: the log is made ready in two pieces.
/// read.recording.time[400..].iter_mut().for_each(|time| *time += 5.0);
/// let screened = screen("monday.csv", read, &robot)?;
/// assert_eq!((&screened.name[..], screened.pieces.len()), ("monday.csv", 2));
/// assert!(screened.verdict.is_none());
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Screened {
    /// What it is called: its file.
    pub name: String,
    /// The pieces between long gaps, at even steps; torque that must not be used is not a number there.
    pub pieces: Vec<Recording>,
    /// What is wrong with it.
    pub faults: Vec<DataFault>,
    /// What is wrong with its description.
    pub verdict: Option<Verdict>,
}

/// Examines a log called `name` and makes it ready.
///
/// # Errors
/// If nothing can be learnt from the log: too few samples, no motion, no torque, most rows unusable.
pub fn screen(name: &str, sieved: Sieved, robot: &Robot) -> Result<Screened> {
    screen_all(vec![(name.to_owned(), sieved)], robot)?.remove(0)
}

/// Examines logs of one arm together, each with its name, and makes them ready.
///
/// # Errors
/// Those of the filters; each log has those of [`screen`] for itself.
pub(crate) fn screen_all(logs: Vec<(String, Sieved)>, robot: &Robot) -> Result<Vec<Result<Screened>>> {
    let sieved: Vec<&Sieved> = logs.iter().map(|(_, sieved)| sieved).collect();
    let reports = quality::examine_together(&sieved, Some(robot))?.reports;
    let ready = |((name, sieved), report): ((String, Sieved), quality::Report)| ready(name, sieved, report);
    Ok(logs.into_iter().zip(reports).map(ready).collect())
}

/// The same in the units that all logs show, where these are beyond doubt.
///
/// # Errors
/// Those of [`screen_all`].
pub(crate) fn screen_in_own_units(
    mut logs: Vec<(String, Sieved)>,
    robot: &Robot,
) -> Result<(Vec<Result<Screened>>, UnitChanges)> {
    let mut sieved: Vec<&mut Sieved> = logs.iter_mut().map(|(_, sieved)| sieved).collect();
    let (together, units) = quality::examine_in_own_units(&mut sieved, robot)?;
    let corrected = |screened: &mut Screened| {
        screened.faults.extend(units.lines(robot).into_iter().map(|(kind, place, text)| DataFault {
            kind,
            log: screened.name.clone(),
            place: place.to_owned(),
            text,
            consequence: Consequence::Corrected,
        }));
    };
    let screened = logs.into_iter().zip(together.reports).map(|((name, sieved), report)| {
        let mut screened = ready(name, sieved, report)?;
        corrected(&mut screened);
        Ok(screened)
    });
    Ok((screened.collect(), units))
}

fn ready(name: String, sieved: Sieved, report: quality::Report) -> Result<Screened> {
    if let Some(finding) = report.fatal() {
        let problem = format!("{}: the log cannot be used: {}", finding.place, finding.text);
        return Err(Error::request(name, problem));
    }
    // Currents of motors with unlike constants are torques of no bodies.
    let in_unlike_units = report.description.as_ref().is_some_and(Verdict::has_unlike_factors);
    let faults = quality::alike_together(&report.findings)
        .into_iter()
        .filter_map(|finding| {
            let consequence = match finding.kind {
                Kind::TorqueUnit if in_unlike_units => Consequence::Stops,
                kind => consequence(kind, finding.severity)?,
            };
            let quality::Finding { kind, place, text, .. } = finding;
            Some(DataFault { kind, log: name.clone(), place, text, consequence })
        })
        .collect();
    let quality::Usable { pieces, .. } = quality::usable(sieved.recording)?;
    if pieces.is_empty() {
        return Err(Error::request(name, quality::NO_PIECE));
    }
    Ok(Screened { name, pieces, faults, verdict: report.description })
}

/// What is wrong with the description of all logs alike; none where one log denies it.
pub(crate) fn shared_verdict(logs: &[&mut Screened]) -> Option<Verdict> {
    let verdict = logs.first()?.verdict.clone()?;
    let agrees = |other: &Verdict| other.description.same_as(&verdict.description);
    logs.iter().all(|log| log.verdict.as_ref().is_some_and(agrees)).then_some(verdict)
}

/// Puts right what is wrong beyond doubt with the description of all `logs`, in the logs and in the gravity of `robot`.
/// Nothing is changed where there is nothing to correct, or a doubt.
pub(crate) fn correct(logs: &mut [&mut Screened], robot: &mut Robot) {
    let beyond_doubt = logs.iter().all(|log| log.verdict.as_ref().is_some_and(|verdict| verdict.beyond_doubt));
    let Some(verdict) = shared_verdict(logs).filter(|_| beyond_doubt) else { return };
    for log in logs.iter_mut() {
        log.pieces.iter_mut().for_each(|piece| verdict.description.apply(piece));
        for fault in log.faults.iter_mut().filter(|fault| descriptions::is_description(fault.kind)) {
            fault.consequence = Consequence::Corrected;
        }
    }
    robot.gravity = verdict.description.gravity;
}

/// All faults, those that stop first. A joint that moves in the logs that judge and in none to identify from stops the
/// diagnosis too.
pub(crate) fn all_faults(
    train: &[Screened],
    test: &[Screened],
    reference: &[Screened],
    robot: &Robot,
) -> Vec<DataFault> {
    let others = [test, reference].concat();
    let moves_elsewhere = |joint: usize| others.iter().any(|log| hardly_moves(log, joint).is_none());
    let still = still_joints(train, robot).into_iter().filter(|(joint, _)| moves_elsewhere(*joint));
    let stills = still.map(|(_, fault)| DataFault { consequence: Consequence::Stops, ..fault });
    let logs = train.iter().chain(test).chain(reference);
    let mut all: Vec<DataFault> = stills.collect();
    let faults = logs.flat_map(|log| log.faults.iter().cloned());
    let others: Vec<DataFault> =
        faults.filter(|fault| !all.iter().any(|stop| stop.place == fault.place && stop.log == fault.log)).collect();
    all.extend(others);
    confirm(&mut all, train.len() + test.len() + reference.len());
    all.sort_by_key(|fault| (fault.consequence != Consequence::Stops, fault.consequence != Consequence::Doubts));
    all
}

/// Takes back what one of several logs seems to show of the sign of a torque or a position and most others do not: one recorder made all.
fn confirm(faults: &mut [DataFault], logs: usize) {
    let signs = [Kind::TorqueSign, Kind::UnsignedTorque, Kind::PositionSign];
    let seen: Vec<(Kind, String)> = faults.iter().map(|fault| (fault.kind, fault.place.clone())).collect();
    for fault in faults.iter_mut().filter(|fault| signs.contains(&fault.kind)) {
        let count = seen.iter().filter(|(kind, place)| *kind == fault.kind && *place == fault.place).count();
        if 2 * count < logs {
            fault.consequence = Consequence::Noted;
        }
    }
}

/// The fault of a joint of a log if it hardly moves there.
fn hardly_moves(log: &Screened, joint: usize) -> Option<&DataFault> {
    let column = format!("q{} (", joint + 1);
    log.faults.iter().find(|fault| fault.kind == Kind::HardlyMoves && fault.place.starts_with(&column))
}

/// Joints that hardly move in any of the logs, with their faults.
pub(crate) fn still_joints(logs: &[Screened], robot: &Robot) -> Vec<(usize, DataFault)> {
    (0..robot.dof())
        .filter_map(|joint| {
            let each: Vec<DataFault> = logs.iter().filter_map(|log| hardly_moves(log, joint).cloned()).collect();
            (each.len() == logs.len()).then(|| Some((joint, each.into_iter().next()?))).flatten()
        })
        .collect()
}

/// What a fault means to a diagnosis, which takes positions, torques and the clock; None for what is no fault.
fn consequence(kind: Kind, severity: Severity) -> Option<Consequence> {
    if descriptions::is_description(kind) && severity == Severity::Note {
        return Some(Consequence::Noted);
    }
    match kind {
        // Rows that show by themselves which source they are of are left out.
        Kind::TwoSources if severity == Severity::Warning => Some(Consequence::LeftOut),
        Kind::OtherRobot if severity > Severity::Note => Some(Consequence::Doubts),
        Kind::UnusedColumns if severity > Severity::Note => Some(Consequence::Noted),
        // Motor currents whose constants are alike.
        Kind::TorqueUnit if severity == Severity::Note => Some(Consequence::Noted),
        // A clock that could not be corrected, or an arm of another size.
        Kind::ClockFactor if severity > Severity::Note => Some(Consequence::Doubts),
        Kind::Swapped
        | Kind::NothingExplains
        | Kind::PositionUnit
        | Kind::TorqueUnit
        | Kind::TorqueSign
        | Kind::PositionSign
        | Kind::PositionZero
        | Kind::Mounting
        | Kind::HeldPosition
        | Kind::PositionJump
        | Kind::GravityCompensated
        | Kind::GravityAlone
        | Kind::UnsignedTorque
        | Kind::TwoSources
        | Kind::Wrapped
        | Kind::Spike
        | Kind::TooShort
        | Kind::NoMotion => Some(Consequence::Stops),
        Kind::CutOff
        | Kind::Frozen
        | Kind::TorqueSpike
        | Kind::NoTorque
        | Kind::Clipped
        | Kind::MotorOff
        | Kind::Gap
        | Kind::Jitter
        | Kind::DuplicateTime
        | Kind::BackwardTime
        | Kind::BadRows => Some(Consequence::LeftOut),
        Kind::PoorExcitation | Kind::UnusedColumns => None,
        Kind::Corrected
        | Kind::OtherRobot
        | Kind::LostRows
        | Kind::JointName
        | Kind::HeldSamples
        | Kind::HardlyMoves
        | Kind::OutsideLimits
        | Kind::DeadTime
        | Kind::ClockFactor
        | Kind::ModelTorque => Some(Consequence::Noted),
        Kind::VelocitySign | Kind::VelocityUnit | Kind::VelocityMismatch | Kind::VelocityDelay => {
            (severity > Severity::Note).then_some(Consequence::Noted)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sign_that_one_log_of_three_shows_is_only_noted() {
        let fault = |log: &str, kind: Kind| DataFault {
            kind,
            log: log.into(),
            place: "tau1 (a)".into(),
            text: String::new(),
            consequence: Consequence::Stops,
        };
        let mut faults = vec![fault("a", Kind::TorqueSign), fault("a", Kind::Swapped)];
        confirm(&mut faults, 3);
        assert_eq!(faults.iter().map(|f| f.consequence).collect::<Vec<_>>(), [Consequence::Noted, Consequence::Stops]);
        let mut faults = vec![fault("a", Kind::PositionSign)];
        confirm(&mut faults, 3);
        assert_eq!(faults[0].consequence, Consequence::Noted);
        let mut faults = vec![fault("a", Kind::TorqueSign), fault("b", Kind::TorqueSign)];
        confirm(&mut faults, 3);
        assert!(faults.iter().all(|f| f.consequence == Consequence::Stops));
    }

    #[test]
    fn wrong_columns_stop_and_gaps_do_not() {
        assert_eq!(consequence(Kind::Swapped, Severity::Warning), Some(Consequence::Stops));
        assert_eq!(consequence(Kind::Gap, Severity::Note), Some(Consequence::LeftOut));
        assert_eq!(consequence(Kind::PoorExcitation, Severity::Note), None);
    }

    #[test]
    fn another_robot_stops_or_puts_in_doubt() {
        assert_eq!(consequence(Kind::NothingExplains, Severity::Warning), Some(Consequence::Stops));
        assert_eq!(consequence(Kind::OtherRobot, Severity::Warning), Some(Consequence::Doubts));
        assert_eq!(consequence(Kind::ClockFactor, Severity::Warning), Some(Consequence::Doubts));
        // Masses that are wrong are likelier then.
        assert_eq!(consequence(Kind::OtherRobot, Severity::Note), Some(Consequence::Noted));
    }
}
