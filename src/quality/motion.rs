//! What the joints do: range and speed against the limits, units of position, joints that hardly move.

use super::finding::{Finding, Kind, Severity};
use super::statistics::size_quantile;
use super::view::View;
use crate::linear::root_mean_square;
use crate::robot::{JointKind, Robot};
use std::f64::consts::{PI, TAU};

/// Nobody logs an arm at longer steps than this, s; a millisecond that is taken for a second is as long.
const SLOW_CLOCK: f64 = 0.5;

/// No joint of an arm turns faster, rad/s: taken for the speed limit of one that turns without end, where there is no lower one.
const FASTEST_ENDLESS: f64 = 5.0;

/// Positions of a joint are in another unit beyond this many times its limits; those of another joint may lie between.
const BEYOND: f64 = 4.0;

/// Range, speed and torque of a joint.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct JointSummary {
    /// Name of the joint.
    pub name: String,
    /// Lowest and highest position, rad or m.
    pub range: [f64; 2],
    /// Share of the URDF's range that is used.
    pub range_share: Option<f64>,
    /// Highest speed, from positions, rad/s or m/s.
    pub speed: f64,
    /// Share of the URDF's speed.
    pub speed_share: Option<f64>,
    /// Reversals of the direction of motion.
    pub reversals: usize,
    /// Root mean square torque, N m or N.
    pub torque_rms: f64,
    /// Part of the torque that the joint's own model leaves unexplained, root mean square over root mean square.
    pub unexplained: Option<f64>,
    /// Time by which the torque lags the motion, s, where it can be estimated.
    pub dead_time_s: Option<f64>,
}

/// Summaries of all joints.
pub fn summaries(view: &View, robot: Option<&Robot>) -> Vec<JointSummary> {
    (0..view.dof())
        .map(|joint| {
            let q = view.log.q.channel(joint);
            let range = q.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], &v| [a.min(v), b.max(v)]);
            let speed = size_quantile(view.qd.channel(joint).iter().copied(), 1.0);
            let limits = robot.map(|robot| robot.joints[joint].limits);
            let span = limits.map(|limits| limits.upper - limits.lower).filter(|span| span.is_finite() && *span > 0.0);
            let fastest = limits.map(|limits| limits.velocity).filter(|v| v.is_finite());
            JointSummary {
                name: view.log.joints[joint].clone(),
                range,
                range_share: span.map(|span| (range[1] - range[0]) / span),
                speed,
                speed_share: fastest.map(|fastest| speed / fastest),
                reversals: reversals(view.qd.channel(joint), view.band[joint]),
                torque_rms: root_mean_square(view.log.tau.channel(joint)),
                unexplained: None,
                dead_time_s: None,
            }
        })
        .collect()
}

fn reversals(velocity: &[f64], band: f64) -> usize {
    let mut direction = 0.0;
    let mut count = 0;
    for &v in velocity.iter().filter(|v| v.abs() > band) {
        if direction * v < 0.0 {
            count += 1;
        }
        direction = v.signum();
    }
    count
}

/// Joints that turn without end, which may be at any number of turns: those without limits, and those of which whole turns in
/// rad were undone.
pub fn endless(unwrapped: &[(usize, f64)], robot: Option<&Robot>, joints: usize) -> Vec<bool> {
    let unlimited = |joint: usize| {
        robot.is_some_and(|robot| {
            let joint = &robot.joints[joint];
            joint.kind == JointKind::Revolute && !joint.limits.lower.is_finite() && !joint.limits.upper.is_finite()
        })
    };
    let turned = |joint: usize| unwrapped.iter().any(|&(own, turn)| own == joint && turn == TAU);
    (0..joints).map(|joint| unlimited(joint) || turned(joint)).collect()
}

/// Findings about the motion; `endless` joints turn without end.
pub fn findings(view: &View, summaries: &[JointSummary], robot: Option<&Robot>, endless: &[bool]) -> Vec<Finding> {
    let mut out = Vec::new();
    let still = |joint: usize| !view.band[joint].is_finite();
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
        let text = "no joint moves by more than 0.02 rad or faster than 0.06 rad/s (2 mm or 6 mm/s where it slides): nothing can be \
                    identified from it";
        return vec![Finding::new(Kind::NoMotion, Severity::Fatal, "q", text)];
    }
    for (joint, summary) in summaries.iter().enumerate() {
        let place = view.place("q", joint);
        let revolute = robot.is_none_or(|robot| robot.joints[joint].kind == JointKind::Revolute);
        let limits = robot.map(|robot| robot.joints[joint].limits);
        let bounds = limits.map(|l| (l.lower, l.upper, l.velocity));
        if let Some((text, _)) = unit(summary, bounds, endless[joint]).filter(|_| revolute) {
            out.push(Finding::new(Kind::PositionUnit, Severity::Warning, place, text));
            continue;
        }
        if let Some(limits) = limits {
            let over = (limits.lower - summary.range[0]).max(summary.range[1] - limits.upper);
            if over > 0.01 {
                let text = format!(
                    "the positions {:.3} .. {:.3} leave the URDF's limits {:.3} .. {:.3}; check zero positions, signs and the \
                     order of the joints",
                    summary.range[0], summary.range[1], limits.lower, limits.upper
                );
                out.push(Finding::new(Kind::OutsideLimits, Severity::Warning, place.clone(), text));
            }
        }
        if still(joint) {
            let unit = if revolute { "rad" } else { "m" };
            let text = format!(
                "the joint hardly moves ({:.4} {unit}, at most {:.3} {unit}/s): its friction and inertia cannot be found from \
                 this log",
                summary.range[1] - summary.range[0],
                summary.speed
            );
            out.push(Finding::new(Kind::HardlyMoves, Severity::Warning, place, text));
        }
    }
    out
}

/// Whether positions are in degrees on half of the joints or more: one recorder gives all joints one unit, and small motions
/// do not show it.
pub fn in_degrees(summaries: &[JointSummary], robot: Option<&Robot>, endless: &[bool]) -> bool {
    let shows = |joint: usize| {
        let limits = robot.map(|robot| robot.joints[joint].limits);
        let revolute = robot.is_none_or(|robot| robot.joints[joint].kind == JointKind::Revolute);
        let limits = limits.map(|l| (l.lower, l.upper, l.velocity));
        revolute && unit(&summaries[joint], limits, endless[joint]).is_some_and(|(_, degrees)| degrees)
    };
    2 * (0..summaries.len()).filter(|&joint| shows(joint)).count() >= summaries.len().max(1)
}

/// Why positions do not look like radians, and whether they look like degrees; `limits` are lower, upper and speed.
fn unit(summary: &JointSummary, limits: Option<(f64, f64, f64)>, endless: bool) -> Option<(String, bool)> {
    let largest = summary.range[0].abs().max(summary.range[1].abs());
    let (bound, fastest) = limits.map_or((f64::INFINITY, f64::INFINITY), |(l, u, v)| (l.abs().max(u.abs()), v));
    let fastest = if endless { fastest.min(FASTEST_ENDLESS) } else { fastest };
    // A joint within its limits that is too fast jumps; nothing is said about its unit.
    let leaves = if bound.is_finite() { largest > bound } else { summary.range[1] - summary.range[0] > TAU };
    let too_fast = summary.speed > 5.0 * fastest && leaves;
    let fits_in_degrees = summary.speed / (180.0 / PI) < 1.5 * fastest;
    // A joint that turns without end may be anywhere: its speed alone shows the unit.
    let (beyond, in_degrees) = match endless {
        true => (too_fast, fits_in_degrees),
        // Wrists that turn twice stay below two turns and a half.
        false => (
            largest > if bound.is_finite() { BEYOND * bound.max(1.0) } else { 2.5 * TAU },
            largest / (180.0 / PI) < bound.min(2.5 * TAU) * 1.05,
        ),
    };
    match (beyond, in_degrees, too_fast && fits_in_degrees) {
        (true, true, _) | (_, true, true) => {
            let text = format!(
                "positions up to {largest:.1} and speeds up to {:.1} per second are far too large in rad; are they in \
                 degrees? Convert them to rad",
                summary.speed
            );
            Some((text, true))
        }
        (true, false, _) => {
            let text = format!(
                "positions up to {largest:.3e} are neither rad nor deg: encoder counts, or turns of the motor? Convert them \
                 to rad at the joint"
            );
            Some((text, false))
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether a joint between `range` at `speed`, with limits of 3 rad and 3 rad/s, is taken to be in degrees.
    fn degrees(range: [f64; 2], speed: f64, endless: bool) -> Option<bool> {
        let (name, range_share, speed_share, unexplained, dead_time_s) = (String::new(), None, None, None, None);
        let rest = (0, 1.0);
        let summary = JointSummary {
            name,
            range,
            range_share,
            speed,
            speed_share,
            reversals: rest.0,
            torque_rms: rest.1,
            unexplained,
            dead_time_s,
        };
        let limits = if endless { (f64::NEG_INFINITY, f64::INFINITY, 3.0) } else { (-3.0, 3.0, 3.0) };
        unit(&summary, Some(limits), endless).map(|(_, degrees)| degrees)
    }

    #[test]
    fn a_joint_that_turns_without_end_is_judged_by_its_speed() {
        assert_eq!(degrees([-2.0, 51.2], 5.0, true), None);
        assert_eq!(degrees([-2.0, 51.2], 5.0, false), Some(true));
        // Beyond five times its speed, and what fits it in degrees.
        assert_eq!(degrees([-90.0, 90.0], 14.9, true), None);
        assert_eq!(degrees([-90.0, 90.0], 15.1, true), Some(true));
        assert_eq!(degrees([-9e4, 9e4], 1e5, true), Some(false));
    }

    #[test]
    fn a_joint_within_its_limits_is_not_in_degrees_however_fast_it_jumps() {
        assert_eq!(degrees([-1.6, 1.3], 103.9, false), None);
        assert_eq!(degrees([-3.1, 1.3], 103.9, false), Some(true));
    }
}
