//! Units of logs that are not those of their description, corrected where they are beyond doubt.

use super::examination::examine_together;
use super::finding::Kind;
use super::motion::OtherUnit;
use super::places::grouped;
use super::report::{Report, Together};
use super::unit_changes::{OtherRate, UnitChanges};
use super::velocity::{self, in_true_time};
use crate::channels::Channels;
use crate::error::Result;
use crate::recording::Recording;
use crate::recording::lenient::Sieved;
use crate::robot::{JointKind, Robot};

impl UnitChanges {
    /// Those that all logs of one recorder show.
    pub fn shared(reports: &[Report]) -> Self {
        let Some(units) = reports.first().map(|report| &report.units) else { return Self::default() };
        let alike = |report: &Report| {
            let other = &report.units;
            (&other.positions, &other.velocities) == (&units.positions, &units.velocities)
                && other.time_factor.is_some() == units.time_factor.is_some()
        };
        if reports.iter().all(alike) { units.clone() } else { Self::default() }
    }

    /// Whether there is nothing to change.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }

    /// The same without lists in which no joint has another unit.
    pub(super) fn or_none(mut self) -> Self {
        if self.positions.iter().all(Option::is_none) {
            self.positions.clear();
        }
        if self.velocities.iter().all(Option::is_none) {
            self.velocities.clear();
        }
        self
    }

    /// Converts a log: positions and their derivatives to SI units, and times to seconds.
    pub fn apply(&self, log: &mut Recording) {
        self.apply_to_motion(log);
        if let Some(factor) = self.time_factor {
            in_true_time(&mut log.time, factor);
        }
    }

    /// A log with its positions, and their derivatives, in SI units, where they are not in these.
    pub(super) fn positions_in_si(&self, log: &Recording) -> Option<Recording> {
        if self.positions.is_empty() && self.velocities.is_empty() {
            return None;
        }
        let mut log = log.clone();
        self.apply_to_motion(&mut log);
        Some(log)
    }

    fn apply_to_motion(&self, log: &mut Recording) {
        let Recording { q, qd, qdd, .. } = log;
        let position = |joint: usize| self.position(joint).map_or(1.0, OtherUnit::in_si);
        let velocity = |joint: usize| self.velocity(joint).map_or(1.0, OtherRate::in_si);
        // No unit of accelerations counts minutes.
        let rates_are_si = qd.is_some() && self.velocities.is_empty();
        let acceleration = |joint: usize| if rates_are_si { 1.0 } else { position(joint) };
        let divide = |table: &mut Channels, unit: &dyn Fn(usize) -> f64| {
            for joint in 0..table.channels() {
                let factor = 1.0 / unit(joint);
                table.channel_mut(joint).iter_mut().for_each(|value| *value *= factor);
            }
        };
        divide(q, &position);
        qd.iter_mut().for_each(|qd| divide(qd, &velocity));
        qdd.iter_mut().for_each(|qdd| divide(qdd, &acceleration));
    }

    /// The unit of the position of a joint, where it is none of SI.
    pub fn position(&self, joint: usize) -> Option<OtherUnit> {
        self.positions.get(joint).copied().flatten()
    }

    /// The unit of the velocity of a joint, where it is none of SI.
    pub fn velocity(&self, joint: usize) -> Option<OtherRate> {
        self.velocities.get(joint).copied().flatten()
    }

    /// One line on each change: what it is about, and what was done.
    pub fn lines(&self, robot: &Robot) -> Vec<(Kind, &'static str, String)> {
        let of = |joints: &[usize]| {
            let all_of = |kind: JointKind| {
                joints.iter().copied().eq((0..robot.dof()).filter(|&joint| robot.joints[joint].kind == kind))
            };
            if all_of(JointKind::Prismatic) {
                return " of joints that slide".to_owned();
            }
            if joints.len() == robot.dof() || all_of(JointKind::Revolute) {
                return String::new();
            }
            let names: Vec<&str> = joints.iter().map(|&joint| robot.joints[joint].name.as_str()).collect();
            format!(" of {}", names.join(", "))
        };
        let per_second = |joint: usize| self.velocity(joint) == self.position(joint).map(OtherRate::PerSecond);
        let positions = grouped(robot.dof(), |joint| self.position(joint)).into_iter().map(|(unit, joints)| {
            let both = joints.iter().all(|&joint| per_second(joint));
            let what = if both { "positions and velocities" } else { "positions" };
            let text = format!("{what}{} are in {}: they are taken as that", of(&joints), unit.words());
            (Kind::PositionUnit, "q", text)
        });
        let of_their_own = |joint: usize| self.velocity(joint).filter(|_| !per_second(joint));
        let velocities = grouped(robot.dof(), of_their_own).into_iter().map(|(unit, joints)| {
            let text = format!("velocities{} are in {}: they are taken as that", of(&joints), unit.symbol());
            (Kind::VelocityUnit, "qd", text)
        });
        let clock = self.time_factor.map(|factor| {
            let factor = velocity::digits(factor);
            let text = format!("true seconds per second of the clock: {factor}; times are taken as that");
            (Kind::ClockFactor, "t", text)
        });
        positions.chain(velocities).chain(clock).collect()
    }
}

/// Examines logs of one arm in the units that they all show. Where these are not those of the description and the examination of
/// the converted logs has no doubt about units left, the logs are converted.
///
/// # Errors
/// Those of [`examine_together`].
pub(crate) fn examine_in_own_units(logs: &mut [&mut Sieved], robot: &Robot) -> Result<(Together, UnitChanges)> {
    let as_given: Vec<&Sieved> = logs.iter().map(|log| &**log).collect();
    let first = examine_together(&as_given, Some(robot))?;
    let units = UnitChanges::shared(&first.reports);
    if units.is_none() {
        return Ok((first, units));
    }
    let convert = |log: &&mut Sieved| {
        let mut converted = (**log).clone();
        units.apply(&mut converted.recording);
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
