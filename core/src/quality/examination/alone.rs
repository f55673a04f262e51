//! The examination of one log: all of it but its description, which is judged on all logs together.
//!
//! The clock of a log without velocities shows in its torques. It is that of all logs of one recorder, so that a log is read first and
//! judged when its clock is known.

use crate::error::Result;
use crate::quality::channels::Jumps;
use crate::quality::descriptions::{self, ClockFactor};
use crate::quality::finding::{Finding, Kind, Severity};
use crate::quality::motion::{JointSummary, PositionUnits};
use crate::quality::reading::{clock, cycles, joint_names, unused_columns};
use crate::quality::report::Report;
use crate::quality::unit_changes::UnitChanges;
use crate::quality::velocity::in_true_time;
use crate::quality::view::View;
use crate::quality::{channels, lost_signs, motion, rates, torque, velocity};
use crate::recording::Recording;
use crate::recording::lenient::Sieved;
use crate::recording::resample::{self, Clock};
use crate::robot::Robot;
use std::borrow::Cow;

/// A log that was read as far as that goes without its clock.
pub(super) struct Read<'a> {
    sieved: &'a Sieved,
    robot: Option<&'a Robot>,
    clock: Clock,
    findings: Vec<Finding>,
    summaries: Vec<JointSummary>,
    units: UnitChanges,
    /// The signals, where the log can be used.
    signals: Option<Signals>,
}

/// The signals of a log at even steps, with positions in rad and m as far as their unit is known.
struct Signals {
    whole: Recording,
    /// The longest part without gaps and jumps, where that is not all.
    part: Option<Recording>,
    position_units: PositionUnits,
    /// Whether positions were converted.
    are_converted: bool,
    /// Whether positions may still be in another unit.
    are_doubtful: bool,
}

/// What the examination of one log gives: its report, and the log at even steps without long gaps where torques can be compared with
/// motion, with the samples by which they come behind it.
pub(super) type Examined = (Report, Option<(Recording, isize)>);

impl<'a> Read<'a> {
    /// Reads a log.
    ///
    /// # Errors
    /// Those of the filters.
    pub(super) fn new(sieved: &'a Sieved, robot: Option<&'a Robot>) -> Result<Read<'a>> {
        let recording = &sieved.recording;
        let clock = Clock::new(recording);
        let known = with_all_torques(recording);
        let is_irregular = clock.is_irregular();
        let in_steps = |log: &Recording| if is_irregular { resample::evenly(log) } else { log.clone() };
        let mut units = UnitChanges::default();
        if clock::seems_short(recording) {
            units.time_factor = velocity::clock_factor(&View::new(&in_steps(&known), robot)?, robot);
        }
        let mut findings = clock::findings(sieved, &clock, units.time_factor.unwrap_or(1.0));
        findings.extend(unused_columns::finding(sieved, robot));
        findings.extend(unused_columns::ambiguous(sieved));
        findings.extend(robot.map_or(Vec::new(), |robot| joint_names::findings(sieved, robot)));
        let mut read = Read { sieved, robot, clock, findings, summaries: Vec::new(), units, signals: None };
        if read.is_usable() {
            let even = in_steps(&known);
            read.with_signals(&known, even)?;
        }
        Ok(read)
    }

    fn is_usable(&self) -> bool {
        self.findings.iter().all(|finding| finding.severity != Severity::Fatal)
    }

    /// Examines the signals of the log, `even` at even steps.
    fn with_signals(&mut self, recording: &Recording, even: Recording) -> Result<()> {
        let robot = self.robot;
        let view = View::new(&even, robot)?;
        self.summaries = motion::summaries(&view, robot);
        let endless = motion::endless(&self.sieved.unwrapped, robot, view.dof());
        let position_units = PositionUnits::of(&view, &self.summaries, robot, &endless);
        // Derivatives across a long gap are those of no motion.
        let longest = resample::longest_stretch(recording).map(|rows| resample::evenly(&recording.slice(rows)));
        let of_units = longest.as_ref().unwrap_or(&even);
        let position_units = rates::not_of_joints(of_units, position_units, robot)?;
        self.units = rates::found(of_units, &position_units, robot)?;
        self.findings.extend(rates::findings(&self.units, &position_units, &view));
        // All else is asked of positions in rad and m, and of motion in true time: what comes of a wrong unit is no fault of its own.
        let in_si = self.units.positions_in_si(&even);
        let whole = in_si.as_ref().map_or(Ok(view), |log| View::new(log, robot))?;
        self.findings.extend(channels::findings(&whole, &self.sieved.recording));
        self.findings.extend(lost_signs::findings(&whole, &self.sieved.recording, robot)?);
        let longest = longest.map(|log| self.units.positions_in_si(&log).unwrap_or(log));
        let jumps = Jumps::of(&whole);
        self.findings.extend(jumps.findings(&whole));
        // Nor are those across a jump. On a part of the log its own jumps are asked.
        let part = match &longest {
            Some(log) => Jumps::of(&View::new(log, robot)?).longest_without(log).or(longest),
            None => jumps.longest_without(whole.log),
        };
        // Nor are torques compared with positions in an unknown unit.
        let are_doubtful = match &in_si {
            Some(_) => PositionUnits::of(&whole, &motion::summaries(&whole, robot), robot, &endless).any(),
            None => position_units.any(),
        };
        let are_converted = in_si.is_some();
        let whole = in_si.unwrap_or(even);
        self.signals = Some(Signals { whole, part, position_units, are_converted, are_doubtful });
        Ok(())
    }

    /// The log that asks the torques for its clock: one without velocities, of an arm that is known.
    pub(super) fn asks_for_clock(&self) -> Option<&Recording> {
        let signals = self.signals.as_ref().filter(|signals| self.robot.is_some() && !signals.are_doubtful)?;
        Some(signals.part.as_ref().unwrap_or(&signals.whole)).filter(|log| log.qd.is_none())
    }

    /// Whether its column of time may count cycles.
    pub(super) fn may_count(&self) -> bool {
        self.sieved.may_count
    }

    /// Examines the rest of the log, whose torques show its `clock`, where that is wrong.
    ///
    /// # Errors
    /// Those of the filters.
    pub(super) fn examined(mut self, clock: Option<ClockFactor>) -> Result<Examined> {
        let asks = self.asks_for_clock().is_some();
        let signals = self.signals.take();
        let (mut condition_number, mut unsigned, mut comparable) = (None, Vec::new(), None);
        let Read { sieved, robot, mut findings, mut summaries, mut units, .. } = self;
        if let Some(signals) = &signals {
            let whole = View::new(&signals.whole, robot)?;
            let of_part = signals.part.as_ref().map(|log| View::new(log, robot)).transpose()?;
            let view = of_part.as_ref().unwrap_or(&whole);
            let position_units = &signals.position_units;
            // Positions in an unknown unit are in no known proportion to velocities, whatever the clock.
            let counts = (0..view.dof()).any(|joint| position_units.is_unknown(joint));
            let mut shown_clock = if counts { velocity::Clock::Right } else { velocity::Clock::of(view, robot) };
            if let (velocity::Clock::Wrong(factor), Some(robot)) = (shown_clock, robot)
                && descriptions::torques_deny_clock(view.log, robot, factor)?
            {
                shown_clock = velocity::Clock::RightByTorques;
            }
            units.time_factor = shown_clock.factor();
            let mut time_unknown = false;
            if asks {
                let is_sure = clock.is_none_or(|clock| clock.is_sure);
                let shown = clock.filter(|_| is_sure).map(|clock| clock.factor);
                units.time_factor = if sieved.may_count { shown.map(cycles::length_ms) } else { shown };
                let text = if sieved.may_count { cycles::text } else { descriptions::clock_text };
                let finding = |text: String| Finding::new(Kind::ClockFactor, Severity::Warning, "t", text);
                let fall = clock.map_or_else(String::new, |clock| format!("; {}", clock.fall()));
                findings.extend(units.time_factor.map(|factor| finding(text(factor) + &fall)));
                let unsure = clock.filter(|_| !is_sure).map(descriptions::unsure_clock_text);
                findings.extend(unsure.map(|text| finding(text + &fall)));
                if sieved.may_count && shown.is_none() {
                    let moving = motion::summaries(&whole, robot);
                    let too_fast = cycles::too_fast(moving.iter().filter_map(|summary| summary.speed_share));
                    time_unknown = too_fast.is_some();
                    findings.extend(too_fast);
                }
            }
            // Velocities are not compared with positions that stand or count something else.
            let mut incomparable = channels::with_frozen_position(view, &findings);
            incomparable.extend((0..view.dof()).filter(|&joint| position_units.is_unknown(joint)));
            findings.extend(velocity::findings(view, shown_clock, &incomparable));
            // The table has positions and speeds as they are compared with the limits.
            let shown = signals.are_converted.then(|| motion::summaries(&whole, robot));
            let in_true_time = |log: &Recording| {
                let factor = units.time_factor?;
                let mut log = log.clone();
                in_true_time(&mut log.time, factor);
                Some(log)
            };
            let whole_in_true_time = in_true_time(whole.log);
            let whole_in_true_time = whole_in_true_time.as_ref().map(|log| View::new(log, robot)).transpose()?;
            let moving = whole_in_true_time.as_ref().unwrap_or(&whole);
            let mut about_motion = motion::findings(moving, &summaries, position_units, robot);
            // A joint that stands and has no torque either is one matter.
            let stands = |place: String| about_motion.iter().any(|f| f.kind == Kind::HardlyMoves && f.place == place);
            let standing: Vec<String> = (0..view.dof())
                .filter(|&joint| stands(view.place("q", joint)))
                .map(|joint| view.place("tau", joint))
                .collect();
            findings.retain(|finding| finding.kind != Kind::NoTorque || !standing.contains(&finding.place));
            // A joint that went on turning may be whole turns outside its limits.
            let turned =
                |finding: &Finding| sieved.unwrapped.iter().any(|(joint, _)| finding.place == view.place("q", *joint));
            about_motion.retain(|finding| finding.kind != Kind::OutsideLimits || !turned(finding));
            // Torques are not compared with positions half a turn from where the joint is.
            let positions_doubtful =
                signals.are_doubtful || view.log.q.iter().any(|q| channels::half_turn(q).is_some());
            findings.extend(about_motion);
            summaries = shown.unwrap_or(summaries);
            // Torques are compared with motion in true time.
            let corrected = in_true_time(view.log);
            let corrected_view = corrected.as_ref().map(|log| View::new(log, robot)).transpose()?;
            let view = corrected_view.as_ref().unwrap_or(view);
            let moves = findings.iter().all(|finding| finding.severity != Severity::Fatal);
            if moves && !positions_doubtful && !time_unknown {
                let torques = torque::examined(view, &mut summaries, robot);
                findings.extend(torques.findings);
                condition_number = torques.condition_number;
                unsigned = lost_signs::without_sign(view, &findings);
                let mut log = view.log.clone();
                unsigned.iter().for_each(|&joint| log.tau.channel_mut(joint).fill(0.0));
                let joints = sieved.recording.joints();
                comparable = Some((log, torques.late)).filter(|_| unsigned.len() < joints);
            }
        }
        findings.sort_by_key(|finding| std::cmp::Reverse(finding.severity));
        let recording = &sieved.recording;
        let report = Report {
            rows: recording.samples(),
            rejected: sieved.rejected.clone(),
            duration_s: recording.duration(),
            gaps: clock::lost(sieved, &self.clock).len(),
            clock: self.clock,
            joints: summaries,
            condition_number,
            description: None,
            units,
            unsigned,
            usable: findings.iter().all(|finding| finding.severity != Severity::Fatal),
            findings,
        };
        Ok((report, comparable))
    }
}

/// The log with zeros where a joint has no torque, which the checks of motion do not look at.
fn with_all_torques(recording: &Recording) -> Cow<'_, Recording> {
    let without: Vec<usize> = (0..recording.joints()).filter(|joint| !recording.has_torque(*joint)).collect();
    if without.is_empty() {
        return Cow::Borrowed(recording);
    }
    let mut log = recording.clone();
    without.into_iter().for_each(|joint| log.tau.channel_mut(joint).fill(0.0));
    Cow::Owned(log)
}
