//! Units of logs that are not those of their description, put right where they are beyond doubt.

use super::examination::examine_together;
use super::finding::Kind;
use super::report::{Report, Together, UnitChanges};
use super::velocity::in_true_time;
use crate::error::Result;
use crate::recording::Recording;
use crate::recording::lenient::Sieved;
use crate::robot::{JointKind, Robot};
use std::f64::consts::PI;

impl UnitChanges {
    /// Those that all logs of one recorder show.
    pub fn shared(reports: &[Report]) -> Self {
        let Some(units) = reports.first().map(|report| report.units) else { return Self::default() };
        let alike = |report: &Report| {
            let without_clock = |units: UnitChanges| UnitChanges { time_factor: None, ..units };
            without_clock(report.units) == without_clock(units)
                && report.units.time_factor.is_some() == units.time_factor.is_some()
        };
        if reports.iter().all(alike) { units } else { Self::default() }
    }

    /// Whether there is nothing to change.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }

    /// Converts a log of `robot`: positions, with their derivatives, to rad and m, and times to seconds.
    pub fn apply(&self, log: &mut Recording, robot: &Robot) {
        let Recording { time, q, qd, qdd, .. } = log;
        let derivatives = [qd.as_mut(), qdd.as_mut()].into_iter().filter(|_| !self.velocities_are_si).flatten();
        for signal in std::iter::once(q).chain(derivatives) {
            for (joint, spec) in robot.joints.iter().enumerate() {
                let factor = self.factor(spec.kind);
                signal.channel_mut(joint).iter_mut().for_each(|value| *value *= factor);
            }
        }
        if let Some(factor) = self.time_factor {
            in_true_time(time, factor);
        }
    }

    /// From the unit of a joint's positions to rad or m.
    fn factor(&self, kind: JointKind) -> f64 {
        match kind {
            JointKind::Revolute if self.degrees => PI / 180.0,
            JointKind::Prismatic if self.millimetres => 1e-3,
            _ => 1.0,
        }
    }

    /// One line on each change: what it is about, and what was done.
    pub fn lines(&self) -> Vec<(Kind, &'static str, String)> {
        let what = if self.velocities_are_si { "positions" } else { "positions and velocities" };
        let units = [(self.degrees, "", "degrees"), (self.millimetres, " of joints that slide", "mm")];
        let positions = units.into_iter().filter(|(other, ..)| *other).map(|(_, joints, unit)| {
            (Kind::PositionUnit, "q", format!("{what}{joints} are in {unit}: they are taken as that"))
        });
        let clock = self.time_factor.map(|factor| {
            let text = format!("true seconds per second of the clock: {factor:.3}; times are taken as that");
            (Kind::ClockFactor, "t", text)
        });
        positions.chain(clock).collect()
    }
}

/// Examines logs of one arm in the units that they all show. Where these are not those of the description and the examination of
/// the converted logs has no doubt about units left, the logs are converted.
///
/// # Errors
/// Those of [`examine_together`].
pub fn examine_in_own_units(logs: &mut [&mut Sieved], robot: &Robot) -> Result<(Together, UnitChanges)> {
    let as_given: Vec<&Sieved> = logs.iter().map(|log| &**log).collect();
    let first = examine_together(&as_given, Some(robot))?;
    let units = UnitChanges::shared(&first.reports);
    if units.is_none() {
        return Ok((first, units));
    }
    let convert = |log: &&mut Sieved| {
        let mut converted = (**log).clone();
        units.apply(&mut converted.recording, robot);
        converted
    };
    let converted: Vec<Sieved> = logs.iter().map(convert).collect();
    let again = examine_together(&converted.iter().collect::<Vec<_>>(), Some(robot))?;
    let doubts = |report: &Report| {
        !report.units.is_none() || report.findings.iter().any(|finding| finding.kind == Kind::PositionUnit)
    };
    if again.reports.iter().any(doubts) {
        return Ok((first, UnitChanges::default()));
    }
    logs.iter_mut().zip(converted).for_each(|(log, converted)| **log = converted);
    Ok((again, units))
}
