//! Units of logs that are not those of their description, put right where they are beyond doubt.

use super::examination::examine_together;
use super::finding::Kind;
use super::motion::OtherUnit;
use super::report::{Report, Together, UnitChanges};
use super::velocity::{self, in_true_time};
use crate::error::Result;
use crate::recording::Recording;
use crate::recording::lenient::Sieved;
use crate::robot::{JointKind, Robot};

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

    /// Converts a log: positions, with their derivatives, to rad and m, and times to seconds. Without a `robot` all joints turn.
    pub fn apply(&self, log: &mut Recording, robot: Option<&Robot>) {
        self.apply_to_positions(log, robot);
        if let Some(factor) = self.time_factor {
            in_true_time(&mut log.time, factor);
        }
    }

    /// A log with its positions, and their derivatives, in rad and m, where they are not in these.
    pub(super) fn positions_in_si(&self, log: &Recording, robot: Option<&Robot>) -> Option<Recording> {
        self.turning.or(self.sliding)?;
        let mut log = log.clone();
        self.apply_to_positions(&mut log, robot);
        Some(log)
    }

    fn apply_to_positions(&self, log: &mut Recording, robot: Option<&Robot>) {
        let Recording { q, qd, qdd, .. } = log;
        let derivatives = [qd.as_mut(), qdd.as_mut()].into_iter().filter(|_| !self.velocities_are_si).flatten();
        for signal in std::iter::once(q).chain(derivatives) {
            for joint in 0..signal.channels() {
                let kind = robot.map_or(JointKind::Revolute, |robot| robot.joints[joint].kind);
                let factor = self.unit(kind).map_or(1.0, |unit| 1.0 / unit.in_si());
                signal.channel_mut(joint).iter_mut().for_each(|value| *value *= factor);
            }
        }
    }

    /// The unit of positions of joints of a kind, where it is none of SI.
    pub fn unit(&self, kind: JointKind) -> Option<OtherUnit> {
        match kind {
            JointKind::Revolute => self.turning,
            JointKind::Prismatic => self.sliding,
        }
    }

    /// One line on each change: what it is about, and what was done.
    pub fn lines(&self) -> Vec<(Kind, &'static str, String)> {
        let what = if self.velocities_are_si { "positions" } else { "positions and velocities" };
        let units = [(self.turning, ""), (self.sliding, " of joints that slide")];
        let positions = units.into_iter().filter_map(|(unit, joints)| {
            let unit = unit?.words();
            Some((Kind::PositionUnit, "q", format!("{what}{joints} are in {unit}: they are taken as that")))
        });
        let clock = self.time_factor.map(|factor| {
            let factor = velocity::digits(factor);
            let text = format!("true seconds per second of the clock: {factor}; times are taken as that");
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
        units.apply(&mut converted.recording, Some(robot));
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
