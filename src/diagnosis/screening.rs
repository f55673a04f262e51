//! Faults of the data, looked for before any physics: what stops a diagnosis, what is left out, and what is only told.
//!
//! The checks are those of [`quality`]. Samples at a clipping level become torques that are not a number, which the rows of
//! the tests leave out; logs are cut at long gaps; columns in the wrong order, unit or sign stop the diagnosis, since any
//! cause named from them would be wrong.

use crate::error::{Error, Result};
use crate::quality::{self, Kind, Severity};
use crate::recording::lenient::Sieved;
use crate::recording::{Recording, resample};
use crate::robot::Robot;

/// Time on either side of a clipped sample that is left out with it, s: noise hides there how much was cut off.
const BESIDE_CLIPPED_S: f64 = 0.04;

/// Shortest time that logs may last together, s.
const SHORTEST_S: f64 = 5.0;

/// What a fault does to the diagnosis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Consequence {
    /// No cause of physics can be named.
    Stops,
    /// The samples at fault are left out or bridged.
    LeftOut,
    /// Worth knowing; it does not touch what the diagnosis uses.
    Told,
}

/// A fault of one log.
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
#[derive(Debug, Clone)]
pub struct Screened {
    /// What it is called: its file.
    pub name: String,
    /// The pieces between long gaps, at even steps; torque that must not be used is not a number there.
    pub pieces: Vec<Recording>,
    /// What is wrong with it.
    pub faults: Vec<DataFault>,
}

/// Examines a log called `name` and makes it ready.
///
/// # Errors
/// If nothing can be learnt from the log: too few samples, no motion, no torque, most rows unusable.
pub fn screen(name: &str, sieved: Sieved, robot: &Robot) -> Result<Screened> {
    let report = quality::examine(&sieved, Some(robot))?;
    if let Some(finding) = report.fatal() {
        let problem = format!("{}: the log cannot be used: {}", finding.place, finding.text);
        return Err(Error::request(name, problem));
    }
    let faults = report
        .findings
        .into_iter()
        .filter_map(|finding| {
            let consequence = consequence(finding.kind, finding.severity)?;
            let quality::Finding { kind, place, text, .. } = finding;
            Some(DataFault { kind, log: name.to_owned(), place, text, consequence })
        })
        .collect();
    let levels: Vec<Vec<f64>> = sieved.recording.tau.iter().map(clipping_levels).collect();
    let mut pieces = resample::pieces(sieved.recording);
    if pieces.is_empty() {
        return Err(Error::request(name, "the clock is so full of gaps that no piece of the log is left"));
    }
    for piece in &mut pieces {
        let beside = (BESIDE_CLIPPED_S * piece.rate_hz()).round() as usize;
        for (joint, levels) in levels.iter().enumerate() {
            leave_out(piece.tau.channel_mut(joint), levels, beside);
        }
    }
    Ok(Screened { name: name.to_owned(), pieces, faults })
}

/// All faults, those that stop first; a joint that moves in no training log stops the diagnosis too.
pub fn all_faults(train: &[Screened], test: &[Screened], reference: &[Screened], robot: &Robot) -> Vec<DataFault> {
    let still = still_joints(train, robot);
    let stills = still.into_iter().map(|(_, fault)| DataFault { consequence: Consequence::Stops, ..fault });
    let logs = train.iter().chain(test).chain(reference);
    let mut all: Vec<DataFault> = stills.collect();
    let told = logs.flat_map(|log| log.faults.iter().cloned());
    let told: Vec<DataFault> =
        told.filter(|fault| !all.iter().any(|stop| stop.place == fault.place && stop.log == fault.log)).collect();
    all.extend(told);
    confirm(&mut all, train.len() + test.len() + reference.len());
    all.sort_by_key(|fault| fault.consequence != Consequence::Stops);
    all
}

/// Takes back what one of several logs seems to show of the sign of a torque and most others do not: one recorder made all.
fn confirm(faults: &mut [DataFault], logs: usize) {
    let signs = [Kind::TorqueSign, Kind::UnsignedTorque];
    let seen: Vec<(Kind, String)> = faults.iter().map(|fault| (fault.kind, fault.place.clone())).collect();
    for fault in faults.iter_mut().filter(|fault| signs.contains(&fault.kind)) {
        let count = seen.iter().filter(|(kind, place)| *kind == fault.kind && *place == fault.place).count();
        if 2 * count < logs {
            fault.consequence = Consequence::Told;
        }
    }
}

/// Refuses logs that are too short together; `option` names where they were given.
///
/// # Errors
/// If they are shorter than five seconds.
pub fn check_length(option: &str, logs: &[Screened]) -> Result<()> {
    let seconds: f64 = logs.iter().flat_map(|log| &log.pieces).map(Recording::duration).sum();
    if logs.is_empty() || seconds >= SHORTEST_S {
        return Ok(());
    }
    let problem = format!(
        "the logs last {seconds:.1} s together; a diagnosis needs {SHORTEST_S} s at the least, and two motions of 20 s to be \
         worth while"
    );
    Err(Error::request(option, problem))
}

/// Joints that hardly move in any of the logs, with what is said of them.
fn still_joints(logs: &[Screened], robot: &Robot) -> Vec<(usize, DataFault)> {
    let of = |screened: &Screened, joint: usize| {
        let column = format!("q{} (", joint + 1);
        let mut faults = screened.faults.iter();
        faults.find(|fault| fault.kind == Kind::HardlyMoves && fault.place.starts_with(&column)).cloned()
    };
    (0..robot.dof())
        .filter_map(|joint| {
            let each: Vec<DataFault> = logs.iter().filter_map(|log| of(log, joint)).collect();
            (each.len() == logs.len()).then(|| Some((joint, each.into_iter().next()?))).flatten()
        })
        .collect()
}

/// Levels at which a torque is cut off, on both sides where both extremes are the same size.
fn clipping_levels(tau: &[f64]) -> Vec<f64> {
    let mut levels: Vec<f64> = quality::clipping(tau).into_iter().map(|(level, ..)| level).collect();
    if let [level] = levels[..]
        && tau.contains(&-level)
    {
        levels.push(-level);
    }
    levels
}

/// Torques at a level, and what is beside them, become not a number.
fn leave_out(tau: &mut [f64], levels: &[f64], beside: usize) {
    let at: Vec<usize> = (0..tau.len())
        .filter(|&k| levels.iter().any(|level| (tau[k] - level) * level.signum() >= -1e-9 * level.abs()))
        .collect();
    for k in at {
        let end = (k + beside + 1).min(tau.len());
        tau[k.saturating_sub(beside)..end].fill(f64::NAN);
    }
}

/// What a fault means to a diagnosis, which takes positions, torques and the clock; None for what is no fault.
fn consequence(kind: Kind, severity: Severity) -> Option<Consequence> {
    match kind {
        Kind::Swapped
        | Kind::PositionUnit
        | Kind::TorqueUnit
        | Kind::TorqueSign
        | Kind::UnsignedTorque
        | Kind::TwoSources
        | Kind::Frozen
        | Kind::Wrapped
        | Kind::Spike
        | Kind::TooShort
        | Kind::NoMotion => Some(Consequence::Stops),
        Kind::CutOff
        | Kind::NoTorque
        | Kind::Clipped
        | Kind::Gap
        | Kind::Jitter
        | Kind::DuplicateTime
        | Kind::BackwardTime
        | Kind::BadRows => Some(Consequence::LeftOut),
        Kind::PoorExcitation | Kind::UnusedColumns => None,
        Kind::Mended | Kind::HeldSamples | Kind::HardlyMoves | Kind::OutsideLimits | Kind::DeadTime => {
            Some(Consequence::Told)
        }
        Kind::VelocitySign | Kind::VelocityUnit | Kind::VelocityMismatch | Kind::VelocityDelay => {
            (severity > Severity::Note).then_some(Consequence::Told)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clipped_samples_and_their_neighbours_are_left_out() {
        let mut tau: Vec<f64> = (0..400).map(|k| (5.0 * (0.05 * f64::from(k)).sin()).clamp(-3.0, 9.0)).collect();
        let levels = clipping_levels(&tau);
        assert_eq!(levels, [-3.0]);
        leave_out(&mut tau, &levels, 2);
        let first = tau.iter().position(|v| v.is_nan()).unwrap();
        let at = |k: usize| 5.0 * (0.05 * k as f64).sin();
        assert!(at(first + 1) > -3.0 && at(first + 2) <= -3.0);
        assert!(tau.iter().filter(|v| !v.is_nan()).all(|v| *v > -3.0));
    }

    #[test]
    fn a_sign_that_one_log_of_three_shows_is_only_told() {
        let fault = |log: &str, kind: Kind| DataFault {
            kind,
            log: log.into(),
            place: "tau1 (a)".into(),
            text: String::new(),
            consequence: Consequence::Stops,
        };
        let mut faults = vec![fault("a", Kind::TorqueSign), fault("a", Kind::Swapped)];
        confirm(&mut faults, 3);
        assert_eq!(faults.iter().map(|f| f.consequence).collect::<Vec<_>>(), [Consequence::Told, Consequence::Stops]);
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
}
