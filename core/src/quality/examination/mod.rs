//! The examination of logs: all checks of each, and the judgement of their description together.

mod alone;
mod clocks;

use super::descriptions::{self, Verdict};
use super::finding::{Finding, Kind, Severity};
use super::lost_signs;
use super::motion;
use super::report::{Report, Together};
use super::view::View;
use crate::error::Result;
use crate::recording::Recording;
use crate::recording::lenient::{self, ColumnMap, Sieved};
use crate::robot::Robot;
use alone::Read;
use nalgebra::Vector3;
use rayon::prelude::*;
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
    let read: Vec<Read> = logs.par_iter().map(|log| Read::new(log, robot)).collect::<Result<_>>()?;
    // Bodies whose weight a simulator carries in part, those described or free ones, are not those of the torques.
    let (limits_of, robot) = (robot, robot.filter(|robot| robot.lifted.is_empty()));
    let clocks = clocks::shown(&read, robot)?;
    let examined = read.into_par_iter().zip(clocks).map(|(read, clock)| read.examined(clock));
    let (mut reports, mut torques): (Vec<Report>, Vec<_>) = examined.collect::<Result<Vec<_>>>()?.into_iter().unzip();
    let with_torque: Vec<usize> = (0..logs.len()).filter(|&log| torques[log].is_some()).collect();
    let mut views = views_of(logs, &torques, robot)?;
    let mut judged = Descriptions::of(&views, robot);
    let lost = judged.without_sign(&views, robot, &reports);
    if !lost.is_empty() {
        drop(views);
        for &log in &with_torque {
            leave_out(&mut reports[log], torques[log].as_mut(), &lost);
        }
        views = views_of(logs, &torques, robot)?;
        judged = Descriptions::of(&views, robot);
    }
    let all: Vec<&View> = views.iter().collect();
    let Descriptions { verdict, tilt, gravity_alone, mut by_themselves } = judged;
    if let Some(shares) = gravity_alone {
        for &log in &with_torque {
            reports[log].findings.push(descriptions::of_gravity_alone(shares));
        }
        return Ok(Together { reports, verdict });
    }
    for (place, (&log, view)) in with_torque.iter().zip(&views).enumerate() {
        let own = match by_themselves.get_mut(place) {
            Some(own) => own.take(),
            None => verdict.clone(),
        };
        if let Some(own) = own {
            // Positions that leave the limits for that are no fault of their own.
            let right = own.description.positions(&view.log.q);
            let explained = |finding: &Finding| {
                let of = |&joint: &usize| finding.place == view.place("q", joint);
                (0..view.dof()).find(of).is_some_and(|joint| {
                    own.description.changes_position_of(joint)
                        && !motion::leaves_limits(limits_of, joint, right.channel(joint))
                })
            };
            reports[log].findings.retain(|finding| finding.kind != Kind::OutsideLimits || !explained(finding));
            // Nor is a time by which torques seem to come late, worked out with the torques of others or another motion.
            if !own.description.changes.iter().all(|change| change.keeps_each_torque()) {
                reports[log].findings.retain(|finding| finding.kind != Kind::DeadTime);
            }
            reports[log].findings.extend(descriptions::findings(&own, &view.log.joints, robot));
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
        // Logs of one recorder of which some are in another unit by themselves are not compared with bodies together.
        let in_one_unit = reports.windows(2).all(|pair| pair[0].units.positions == pair[1].units.positions);
        // Nor are shares of rated torques, each joint's in a unit of its own that nothing gives.
        let of_rated = logs.iter().any(|log| log.of_rated);
        let is_asked = !has_scale && in_one_unit && !of_rated;
        let finding = is_asked.then(|| descriptions::of_another_robot(&all, robot, description)).flatten();
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

/// The logs whose torques can be compared with motion.
fn views_of<'a>(
    logs: &[&Sieved],
    torques: &'a [Option<(Recording, isize)>],
    robot: Option<&'a Robot>,
) -> Result<Vec<View<'a>>> {
    let of = |(log, torques): (&&Sieved, &'a Option<(Recording, isize)>)| {
        let (recording, late) = torques.as_ref()?;
        let view = View::new(recording, robot);
        Some(view.map(|view| View { late: *late, is_current: log.currents || log.of_rated, ..view }))
    };
    logs.iter().zip(torques).filter_map(of).collect()
}

/// What is wrong with the description of some logs.
struct Descriptions {
    /// Of all logs together.
    verdict: Option<Verdict>,
    tilt: Option<Vector3<f64>>,
    /// Shares of torques that are those of gravity alone, of all logs together.
    gravity_alone: Option<[f64; 2]>,
    /// Of each log, where all together show nothing and contradict each other; else empty.
    by_themselves: Vec<Option<Verdict>>,
}

impl Descriptions {
    fn of(views: &[View], robot: Option<&Robot>) -> Descriptions {
        let all: Vec<&View> = views.iter().collect();
        let descriptions::Judged { verdict, tilt, gravity_alone } = descriptions::judge(&all, robot);
        let is_unknown = verdict.is_none() && gravity_alone.is_none();
        let contradict =
            is_unknown && views.len() > 1 && robot.is_none_or(|robot| descriptions::contradict(&all, robot));
        let of_each = all.iter().filter(|_| contradict).map(|view| descriptions::judge(&[view], robot).verdict);
        Descriptions { by_themselves: of_each.collect(), verdict, tilt, gravity_alone }
    }

    /// Joints whose torque lost its sign, where that looks like another fault.
    fn without_sign(&self, views: &[View], robot: Option<&Robot>, reports: &[Report]) -> Vec<usize> {
        let Some(robot) = robot else { return Vec::new() };
        let of = |place: usize| match self.by_themselves.get(place) {
            Some(own) => own.as_ref(),
            None => self.verdict.as_ref(),
        };
        let found: Vec<_> = (0..views.len()).map(|place| of(place).map(|verdict| &verdict.description)).collect();
        let known: Vec<usize> = reports.iter().flat_map(|report| report.unsigned.iter().copied()).collect();
        let mut lost = descriptions::without_sign(&views.iter().collect::<Vec<_>>(), robot, &found, &known);
        // Where every log shows it by itself, it is left out already.
        lost.retain(|joint| known.iter().filter(|other| *other == joint).count() < views.len());
        lost
    }
}

/// Leaves torques without their sign out of a log, and says so where that is not known yet.
fn leave_out(report: &mut Report, torques: Option<&mut (Recording, isize)>, lost: &[usize]) {
    let Some((log, _)) = torques else { return };
    let known = report.unsigned.clone();
    for &joint in lost.iter().filter(|joint| !known.contains(joint)) {
        let tau = log.tau.channel_mut(joint);
        report.findings.push(lost_signs::by_model(joint, &log.joints[joint], tau));
        report.unsigned.push(joint);
        tau.fill(0.0);
    }
    report.unsigned.sort_unstable();
    report.findings.sort_by_key(|finding| std::cmp::Reverse(finding.severity));
}
