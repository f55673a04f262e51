//! Logs made ready for identification.

use super::read::read_all;
use crate::error::{Error, Result};
use crate::quality;
use crate::quality::UnitChanges;
use crate::quality::descriptions::Description;
use crate::recording::lenient::Sieved;
use crate::recording::{Once, Recording};
use crate::robot::Robot;
use std::path::{Path, PathBuf};

/// Logs made ready, in SI units at the joints and at even steps, with what had to be done to them.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use std::path::PathBuf;
/// use tauscope::dataset;
/// use tauscope::robot::{self, InertiaCheck};
///
/// let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Required)?;
/// let file = |log: &str| [PathBuf::from(format!("../tests/reference/pendulum/{log}.csv"))];
/// let (train, test) = (file("train"), file("test"));
/// let logs = dataset::ready([dataset::read_all(&train, &robot)?, dataset::read_all(&test, &robot)?], &robot)?;
///
/// // Nothing is wrong with these two.
/// assert_eq!((logs.train.len(), logs.test.len()), (1, 1));
/// assert!(logs.correction.is_none() && logs.units.is_none() && !logs.torque_is_scaled);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Logs {
    /// Training logs.
    pub train: Vec<Recording>,
    /// Held-out logs.
    pub test: Vec<Recording>,
    /// Rows left out, clocks made even, and warnings of [`quality::examine`]; each begins with the file.
    pub notes: Vec<String>,
    /// The description that the logs were taken by, where the given one is wrong beyond doubt; the arm's gravity is then the
    /// one in it.
    pub correction: Option<Description>,
    /// Whether torques are too large or too small by a factor, so that their unit is none that is known.
    pub torque_is_scaled: bool,
    /// Units of the logs that were not those of their description, and were converted.
    pub units: UnitChanges,
}

/// A log without a description made ready: rows that cannot be used left out, clock made even, faults noted.
///
/// # Errors
/// Those of [`lenient::load`](crate::recording::lenient::load), and a log that cannot be used, with the reason.
pub fn plain(path: &Path, robot: &Robot, notes: &mut Vec<String>) -> Result<Vec<Recording>> {
    let logs = ready([read_all(&[path.to_owned()], robot)?, Vec::new()], robot)?;
    notes.extend(logs.notes);
    Ok(logs.train)
}

/// Examines training and held-out logs, refuses those that cannot be used, corrects what is wrong with their description beyond
/// doubt, and cuts them into pieces at even steps.
///
/// # Errors
/// A log that cannot be used, with the reason: also one whose positions are in an unknown unit; and one that is given twice.
pub fn ready([train, test]: [Vec<(PathBuf, Sieved)>; 2], robot: &Robot) -> Result<Logs> {
    let mut logs = Logs::default();
    let trained = train.len();
    let mut all: Vec<(PathBuf, Sieved)> = train.into_iter().chain(test).collect();
    let mut sieved: Vec<&mut Sieved> = all.iter_mut().map(|(_, sieved)| sieved).collect();
    let (quality::Together { reports, verdict }, units) = quality::examine_in_own_units(&mut sieved, robot)?;
    logs.notes.extend(units.lines(robot).into_iter().map(|(_, place, text)| format!("{place}: {text}")));
    logs.units = units;
    let is_another = reports.iter().any(quality::Report::is_of_another_robot);
    let are_currents = verdict.as_ref().is_some_and(|verdict| verdict.currents);
    let is_unequal = verdict.as_ref().is_some_and(|verdict| match verdict.currents {
        true => verdict.has_unlike_factors(),
        false => verdict.factors.len() > 1,
    });
    logs.torque_is_scaled = verdict.as_ref().is_some_and(|verdict| verdict.description.scaled().next().is_some());
    logs.correction = verdict.filter(|verdict| verdict.beyond_doubt && !is_another).map(|verdict| verdict.description);
    let mut findings = Vec::new();
    let unsigned = unsigned(&reports, robot.dof());
    // Some logs in another unit, and some not, are files to convert: a dataset has one unit for all.
    let is_unit = |finding: &quality::Finding| finding.kind == quality::Kind::PositionUnit;
    let in_one_unit = reports.iter().all(|report| report.findings.iter().any(is_unit));
    let mut once = Once::default();
    for (place, ((path, mut sieved), report)) in all.into_iter().zip(reports).enumerate() {
        if let Some(finding) = report.fatal() {
            let problem = format!("the log cannot be used: {}", finding.text);
            return Err(Error::input(path, None, finding.place.as_str(), problem));
        }
        if let Some(finding) = unusable(&report) {
            let others = if in_one_unit || !is_unit(finding) { "" } else { OTHERS_DIFFER };
            let problem = format!("the log cannot be used: {}{others}", finding.text);
            return Err(Error::input(path, None, finding.place.as_str(), problem));
        }
        let rows = sieved.rejected.iter().take(1).map(|row| {
            let all = sieved.rejected.len();
            format!("{}:{}: {}: {} ({all} rows left out)", path.display(), row.line, row.column, row.problem)
        });
        logs.notes.extend(rows);
        logs.notes.extend(sieved.corrections.iter().map(|note| format!("{}: {note}", path.display())));
        let told = quality::standing_together(&report.findings);
        let noted = told.iter().filter(|finding| {
            let changes_the_fit = matches!(
                finding.kind,
                quality::Kind::ModelTorque | quality::Kind::MotorOff | quality::Kind::TorqueUnit
            );
            // What is cut off is counted below.
            let is_counted = finding.kind == quality::Kind::Clipped;
            (finding.severity == quality::Severity::Warning && !is_counted) || changes_the_fit
        });
        findings
            .extend(noted.map(|finding| (path.display().to_string(), format!("{}: {}", finding.place, finding.text))));
        unsigned.iter().for_each(|&joint| sieved.recording.tau.channel_mut(joint).fill(f64::NAN));
        let quality::Usable { mut pieces, clipped } = quality::usable(sieved.recording)?;
        if pieces.is_empty() {
            return Err(Error::input(path, None, "t", quality::NO_PIECE));
        }
        let all: usize = pieces.iter().map(Recording::samples).sum();
        let cut_off = clipped.iter().enumerate().filter(|(_, count)| **count > 0).map(|(joint, count)| {
            let place = format!("tau{} ({})", joint + 1, robot.joints[joint].name);
            let text = match quality::is_saturated(*count, all) {
                true => format!(
                    "{count} of {all} samples stand at a limit: the drive is saturated in nearly all of the log, or the torque was not \
                     measured; it is left out"
                ),
                false => format!("{count} samples that are cut off at a limit, and those next to them, are left out"),
            };
            format!("{}: {place}: {text}", path.display())
        });
        logs.notes.extend(cut_off);
        once.take(path.display().to_string(), &pieces)?;
        if let Some(description) = &logs.correction {
            pieces.iter_mut().for_each(|piece| description.apply(piece));
        }
        if place < trained { &mut logs.train } else { &mut logs.test }.extend(pieces);
    }
    let findings = quality::with_logs(findings);
    logs.notes.extend(findings.into_iter().map(|(paths, finding)| format!("{}: {finding}", paths.join(", "))));
    if logs.torque_is_scaled {
        let coupled = if robot.dof() > 1 { ", or motors drive several joints (coupling)" } else { "" };
        let units = match is_unequal {
            true => {
                "Each joint has a unit of its own: residuals and friction are in these, and no bodies fit all of them, so that the inertias are \
                 none"
            }
            false => "Residuals, friction and inertias are in the unit of the log",
        };
        logs.notes.push(match are_currents {
            true => format!(
                "the torques are motor currents, or percent of rated torques. {units}: give [motors] torque_constant_nm_a in a dataset"
            ),
            false => format!(
                "the torques are not as large as those of the joints: they may be in another unit, or those of motors behind gears{coupled}. \
                 {units}: give [units] torque or [motors] in a dataset"
            ),
        });
    }
    if !unsigned.is_empty() {
        let names: Vec<&str> = unsigned.iter().map(|&joint| robot.joints[joint].name.as_str()).collect();
        logs.notes
            .push(format!("a torque without its sign is left out, as if it had not been logged: {}", names.join(", ")));
    }
    let is_turned = logs.correction.as_ref().is_some_and(|description| description.gravity != robot.gravity);
    let gravity = if is_turned { "; the arm's gravity is the one given there" } else { "" };
    if logs.correction.is_some() || !logs.units.is_none() {
        logs.notes.push(format!("the logs are taken as corrected.toml describes them{gravity}"));
    }
    Ok(logs)
}

/// What to do about one log whose positions are in another unit than those of the others.
const OTHERS_DIFFER: &str =
    ". Other logs show no such unit, and [units] of a dataset hold for all logs: convert this file";

/// Positions whose unit is not that of the description and could not be resolved, or torques that are not those of the motion: no parameter of
/// the arm can be right with them.
fn unusable(report: &quality::Report) -> Option<&quality::Finding> {
    let spoils = |kind: quality::Kind| matches!(kind, quality::Kind::PositionUnit | quality::Kind::GravityAlone);
    report.findings.iter().find(|finding| spoils(finding.kind))
}

/// Joints whose torque lost its sign in half of the logs or more: one recorder made them all, so that what a single one seems to show is
/// chance.
fn unsigned(reports: &[quality::Report], joints: usize) -> Vec<usize> {
    let count = |joint: usize| reports.iter().filter(|report| report.unsigned.contains(&joint)).count();
    (0..joints).filter(|&joint| count(joint) > 0 && 2 * count(joint) >= reports.len()).collect()
}
