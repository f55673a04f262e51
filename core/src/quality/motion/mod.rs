//! What the joints do: range and speed against the limits, units of position, joints that hardly move.

mod coupled;
mod exchange;
mod gears;
mod no_angles;
mod position_unit;
mod ranges;
mod summary;

pub(crate) use gears::Gears;
pub(crate) use no_angles::NoAngles;
pub use position_unit::OtherUnit;
pub(crate) use position_unit::PositionUnits;
pub(crate) use ranges::Ranges;
pub(crate) use summary::summaries;
pub use summary::{Constant, JointSummary};

use super::finding::{Finding, Kind, NOT_FOUND, Severity, UNCERTAIN};
use super::places::places;
use super::view::View;
use crate::identification::equations;
use crate::robot::{JointKind, Robot};
use coupled::BEYOND;
use std::f64::consts::TAU;

/// Nobody logs an arm at longer steps than this, s; a millisecond that is taken for a second is as long.
const SLOW_CLOCK: f64 = 0.5;

/// Joints that turn without end, which may be at any number of turns: those without limits, and those of which whole turns in
/// rad were undone.
pub(super) fn endless(unwrapped: &[(usize, f64)], robot: Option<&Robot>, joints: usize) -> Vec<bool> {
    let unlimited = |joint: usize| {
        robot.is_some_and(|robot| {
            let joint = &robot.joints[joint];
            joint.kind == JointKind::Revolute && !joint.limits.lower.is_finite() && !joint.limits.upper.is_finite()
        })
    };
    let turned = |joint: usize| unwrapped.iter().any(|&(own, turn)| own == joint && turn == TAU);
    (0..joints).map(|joint| unlimited(joint) || turned(joint)).collect()
}

/// Whether positions of a joint leave its limits.
pub(super) fn leaves_limits(robot: Option<&Robot>, joint: usize, positions: &[f64]) -> bool {
    robot.is_some_and(|robot| robot.joints[joint].limits.left_by(positions) > BEYOND)
}

/// Findings about the motion; `logged` are the summaries in the units of the log.
pub(super) fn findings(
    view: &View,
    logged: &[JointSummary],
    units: &PositionUnits,
    robot: Option<&Robot>,
) -> Vec<Finding> {
    let mut out = Vec::new();
    let still = |joint: usize| !view.band[joint].is_finite();
    let summaries = summaries(view, robot);
    let nothing_moves = (0..summaries.len()).all(still);
    if nothing_moves && view.period > SLOW_CLOCK {
        let text = format!(
            "samples are {:.3e} s apart, and nothing moves: is the time in ms, us or ns? Convert it to s, or give the unit in a dataset \
             ([units] time)",
            view.period
        );
        return vec![Finding::new(Kind::NoMotion, Severity::Fatal, "t", text)];
    }
    if nothing_moves {
        let text = "no joint moves by more than 0.02 rad at 0.06 rad/s, or by 0.05 rad at any speed (2 mm at 6 mm/s, or 5 mm, where it slides): nothing can be \
                    identified from it";
        return vec![Finding::new(Kind::NoMotion, Severity::Fatal, "q", text)];
    }
    for (joints, text) in units.texts(logged) {
        out.push(Finding::new(Kind::PositionUnit, Severity::Warning, places(view, "q", &joints), text));
    }
    for (joint, summary) in summaries.iter().enumerate().filter(|(joint, _)| !units.doubts(*joint)) {
        let place = view.place("q", joint);
        let revolute = robot.is_none_or(|robot| robot.joints[joint].kind == JointKind::Revolute);
        let limits = robot.map(|robot| robot.joints[joint].limits);
        if let Some(limits) = limits.filter(|_| leaves_limits(robot, joint, &summary.range)) {
            let other = units.exchanged(joint).map_or(String::new(), |other| {
                format!(" (those of {} are within them, and these within its own), or units", view.log.joints[other])
            });
            let coupled = robot.and_then(|robot| coupled::hint(view, robot, joint)).unwrap_or_default();
            let text = format!(
                "the positions {:.3} .. {:.3} leave the URDF's limits {:.3} .. {:.3}; check zero positions, signs and the \
                     order of the joints{other}{coupled}",
                summary.range[0], summary.range[1], limits.lower, limits.upper
            );
            out.push(Finding::new(Kind::OutsideLimits, Severity::Warning, place.clone(), text));
        }
        if still(joint) {
            let unit = if revolute { "rad" } else { "m" };
            // As in an identification: with so few samples a joint has no equation, with more it has one.
            let what = if view.moving[joint] < equations::FEWEST { NOT_FOUND } else { UNCERTAIN };
            let text = format!(
                "the joint hardly moves ({:.4} {unit}, at most {:.3} {unit}/s): its friction and inertia {what}",
                summary.range[1] - summary.range[0],
                summary.speed
            );
            out.push(Finding::new(Kind::HardlyMoves, Severity::Warning, place, text));
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use crate::quality::examine;
    use crate::quality::finding::{Finding, Kind, NOT_FOUND, UNCERTAIN};
    use crate::quality::tests::{irb, log};

    #[test]
    fn a_joint_that_creeps_is_uncertain_and_one_that_stands_is_not_found() {
        let robot = irb();
        let mut sieved = log(&robot, 250.0, 12.0);
        let time = sieved.recording.time.clone();
        sieved.recording.qd = None;
        for (joint, swing) in [(4, 0.02), (5, 0.0)] {
            let own = sieved.recording.q.channel_mut(joint);
            own.iter_mut().zip(&time).enumerate().for_each(|(i, (q, t))| {
                *q = 0.2 + swing * (1.5 * t).sin() + 2e-6 * if i % 3 == 0 { 1.0 } else { -0.5 };
            });
        }
        let report = examine(&sieved, Some(&robot)).unwrap();
        for (place, what) in [("q5", UNCERTAIN), ("q6", NOT_FOUND)] {
            let hardly = |finding: &&Finding| finding.kind == Kind::HardlyMoves && finding.place.starts_with(place);
            let found = report.findings.iter().find(hardly).unwrap();
            assert!(found.text.ends_with(what), "{}", found.text);
        }
    }
}
