//! The examination of logs: all checks of each, and the judgement of their description together.

use super::channels::Jumps;
use super::descriptions;
use super::finding::{Finding, Kind, Severity};
use super::motion::PositionUnits;
use super::reading::{clock, cycles, joint_names};
use super::report::{Report, Together};
use super::unit_changes::UnitChanges;
use super::velocity::in_true_time;
use super::view::View;
use super::{channels, lost_signs, motion, rates, torque, velocity};
use crate::error::Result;
use crate::recording::Recording;
use crate::recording::lenient::{self, ColumnMap, Sieved};
use crate::recording::resample::{self, Clock};
use crate::robot::Robot;
use std::borrow::Cow;
use std::path::Path;

/// Faults of the signals after which torques and motion do not belong together, whatever robot they are of.
const SPOIL: [Kind; 11] = [
    Kind::Jitter,
    Kind::BackwardTime,
    Kind::ClockFactor,
    Kind::LostRows,
    Kind::PositionJump,
    Kind::VelocityMismatch,
    Kind::Wrapped,
    Kind::Spike,
    Kind::Frozen,
    Kind::UnsignedTorque,
    Kind::TwoSources,
];

/// Reads a log leniently and examines it; with the arm's joints in order and their limits where `robot` is known.
///
/// # Errors
/// Those of [`lenient::load`]: the file cannot be read as a log at all.
pub fn inspect(path: &Path, robot: Option<&Robot>) -> Result<Report> {
    let names = robot.map(Robot::joint_names);
    examine(&lenient::load(path, names.as_deref(), &ColumnMap::default())?, robot)
}

/// Examines a log. `robot` gives limits and geometry; its inertias are used where they are possible.
///
/// # Errors
/// None on a log of any content; those of the filters are passed on.
pub fn examine(sieved: &Sieved, robot: Option<&Robot>) -> Result<Report> {
    let mut together = examine_together(&[sieved], robot)?;
    Ok(together.reports.remove(0))
}

/// Examines several logs of one arm, whose description is judged on all of them together. Where they contradict each other,
/// each is judged by itself.
///
/// # Errors
/// Those of [`examine`].
pub fn examine_together(logs: &[&Sieved], robot: Option<&Robot>) -> Result<Together> {
    let (mut reports, mut torques) = (Vec::new(), Vec::new());
    for sieved in logs {
        let (report, usable) = examine_alone(sieved, robot)?;
        reports.push(report);
        torques.push(usable);
    }
    let with_torque: Vec<usize> = (0..logs.len()).filter(|&log| torques[log].is_some()).collect();
    let views = torques.iter().flatten().map(|(log, late)| Ok(View { late: *late, ..View::new(log, robot)? }));
    let views: Vec<View> = views.collect::<Result<_>>()?;
    let all: Vec<&View> = views.iter().collect();
    let descriptions::Judged { verdict, tilt } = descriptions::judge(&all, robot);
    let by_themselves =
        verdict.is_none() && views.len() > 1 && robot.is_none_or(|robot| descriptions::contradict(&all, robot));
    for (&log, view) in with_torque.iter().zip(&views) {
        let own = match verdict {
            None if by_themselves => descriptions::judge(&[view], robot).verdict,
            _ => verdict.clone(),
        };
        if let Some(own) = own {
            // Positions that leave the limits for that are no fault of their own.
            let right = own.description.positions(&view.log.q);
            let explained = |finding: &Finding| {
                let of = |&joint: &usize| finding.place == view.place("q", joint);
                (0..view.dof()).find(of).is_some_and(|joint| {
                    own.description.changes_position_of(joint)
                        && !motion::leaves_limits(robot, joint, right.channel(joint))
                })
            };
            reports[log].findings.retain(|finding| finding.kind != Kind::OutsideLimits || !explained(finding));
            // Nor is a time by which torques seem to come late, worked out with the torques of others or another motion.
            if !own.description.changes.iter().all(|change| change.keeps_each_torque()) {
                reports[log].findings.retain(|finding| finding.kind != Kind::DeadTime);
            }
            reports[log].findings.extend(descriptions::findings(&own, &view.log.joints));
            reports[log].description = Some(own);
            reports[log].findings.sort_by_key(|finding| std::cmp::Reverse(finding.severity));
        }
    }
    let tilted = robot.zip(tilt).and_then(|(robot, tilt)| descriptions::of_tilt(tilt, robot.gravity));
    for &log in with_torque.iter().filter(|_| verdict.is_none()) {
        reports[log].findings.extend(tilted.clone());
    }
    let measured = |log: &&usize| logs[**log].of_controller.is_none();
    if descriptions::is_modelled(&all, robot, verdict.as_ref().map(|verdict| &verdict.description)) {
        let text = "no friction in any joint's torque, and a rigid-body model explains it: probably the controller's model (a desired or \
                    target torque) or a simulation, not a measurement, so that identification gives that model back; or sensors behind \
                    the gears, which do not see friction";
        for &log in with_torque.iter().filter(measured) {
            reports[log].findings.push(Finding::new(Kind::ModelTorque, Severity::Note, "tau", text));
        }
    }
    // Logs that contradict each other are judged one by one.
    if let Some(robot) =
        robot.filter(|_| verdict.is_some() || reports.iter().all(|report| report.description.is_none()))
    {
        let has_scale = verdict.as_ref().is_some_and(|verdict| !verdict.factors.is_empty());
        let description = verdict.as_ref().map(|verdict| &verdict.description);
        let finding = (!has_scale).then(|| descriptions::of_another_robot(&all, robot, description)).flatten();
        // What spoils motion or torque is a cause by itself.
        let spoils = |finding: &Finding| finding.severity > Severity::Note && SPOIL.contains(&finding.kind);
        for &log in with_torque.iter() {
            if reports[log].findings.iter().any(spoils) {
                continue;
            }
            // Other zeros make the motion of this arm out of that of another: what the bodies deny is no more than a possibility then.
            let is_another = finding.as_ref().is_some_and(|finding| finding.severity > Severity::Note);
            let denied = is_another && verdict.as_ref().is_some_and(|verdict| verdict.unlike_bodies);
            let mut known = std::mem::take(&mut reports[log].findings);
            known
                .iter_mut()
                .filter(|finding| denied && descriptions::is_description(finding.kind))
                .for_each(|finding| finding.severity = Severity::Note);
            reports[log].findings = finding.clone().into_iter().chain(known).collect();
            reports[log].findings.sort_by_key(|finding| std::cmp::Reverse(finding.severity));
        }
    }
    Ok(Together { reports, verdict })
}

/// Examines all of a log but its description, and returns it at even steps without long gaps where torques can be compared
/// with motion, with the samples by which they come behind it.
fn examine_alone(sieved: &Sieved, robot: Option<&Robot>) -> Result<(Report, Option<(Recording, isize)>)> {
    let recording = &sieved.recording;
    let clock = Clock::new(recording);
    let known = with_all_torques(recording);
    let in_steps = |log: &Recording| if clock.is_irregular() { resample::evenly(log) } else { log.clone() };
    let mut units = UnitChanges::default();
    if clock::seems_short(recording) {
        units.time_factor = velocity::clock_factor(&View::new(&in_steps(&known), robot)?, robot);
    }
    let mut findings = clock::findings(sieved, &clock, units.time_factor.unwrap_or(1.0));
    findings.extend(robot.map_or(Vec::new(), |robot| joint_names::findings(sieved, robot)));
    let mut summaries = Vec::new();
    let mut condition_number = None;
    let (mut comparable, mut unsigned) = (None, Vec::new());
    if findings.iter().all(|finding| finding.severity != Severity::Fatal) {
        let recording: &Recording = &known;
        let even = in_steps(recording);
        let view = View::new(&even, robot)?;
        summaries = motion::summaries(&view, robot);
        let endless = motion::endless(&sieved.unwrapped, robot, view.dof());
        let position_units = PositionUnits::of(&view, &summaries, robot, &endless);
        // Derivatives across a long gap are those of no motion.
        let longest = resample::longest_stretch(recording).map(|rows| resample::evenly(&recording.slice(rows)));
        let of_units = longest.as_ref().unwrap_or(&even);
        let position_units = match rates::gear_ratio(of_units, &position_units, robot)? {
            Some(gears) => position_units.before_gears(gears),
            None => position_units,
        };
        units = rates::found(of_units, &position_units, robot)?;
        findings.extend(rates::findings(&units, &position_units, &view));
        // All else is asked of positions in rad and m, and of motion in true time: what comes of a wrong unit is no fault of its own.
        let in_si = units.positions_in_si(&even);
        let view = in_si.as_ref().map_or(Ok(view), |log| View::new(log, robot))?;
        findings.extend(channels::findings(&view, &sieved.recording));
        findings.extend(lost_signs::findings(&view, &sieved.recording, robot)?);
        let longest = longest.map(|log| units.positions_in_si(&log).unwrap_or(log));
        let whole = view;
        let jumps = Jumps::of(&whole);
        findings.extend(jumps.findings(&whole));
        // Nor are those across a jump. On a part of the log its own jumps are asked.
        let longest = match &longest {
            Some(log) => Jumps::of(&View::new(log, robot)?).longest_without(log).or(longest),
            None => jumps.longest_without(whole.log),
        };
        let of_longest = longest.as_ref().map(|log| View::new(log, robot)).transpose()?;
        let view = of_longest.as_ref().unwrap_or(&whole);
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
        // Nor are torques compared with positions in an unknown unit.
        let units_doubtful = match &in_si {
            Some(_) => PositionUnits::of(&whole, &motion::summaries(&whole, robot), robot, &endless).any(),
            None => position_units.any(),
        };
        if let Some(robot) = robot.filter(|_| view.log.qd.is_none() && !units_doubtful) {
            let shown = descriptions::clock_factor(view.log, robot)?;
            units.time_factor = if sieved.may_count { shown.map(cycles::length_ms) } else { shown };
            let text = if sieved.may_count { cycles::text } else { descriptions::clock_text };
            let finding = |factor| Finding::new(Kind::ClockFactor, Severity::Warning, "t", text(factor));
            findings.extend(units.time_factor.map(finding));
            if sieved.may_count && shown.is_none() {
                let moving = motion::summaries(&whole, Some(robot));
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
        let shown = in_si.as_ref().map(|_| motion::summaries(&whole, robot));
        let in_true_time = |log: &Recording| {
            let factor = units.time_factor?;
            let mut log = log.clone();
            in_true_time(&mut log.time, factor);
            Some(log)
        };
        let whole_in_true_time = in_true_time(whole.log);
        let whole_in_true_time = whole_in_true_time.as_ref().map(|log| View::new(log, robot)).transpose()?;
        let moving = whole_in_true_time.as_ref().unwrap_or(&whole);
        let mut about_motion = motion::findings(moving, &summaries, &position_units, robot);
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
        let positions_doubtful = units_doubtful || view.log.q.iter().any(|q| channels::half_turn(q).is_some());
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
            comparable = Some((log, torques.late)).filter(|_| unsigned.len() < recording.joints());
        }
    }
    findings.sort_by_key(|finding| std::cmp::Reverse(finding.severity));
    let report = Report {
        rows: recording.samples(),
        rejected: sieved.rejected.clone(),
        duration_s: recording.duration(),
        gaps: clock::lost(sieved, &clock).len(),
        clock,
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
