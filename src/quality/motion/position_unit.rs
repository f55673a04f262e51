//! Whether positions are in rad and m, or in degrees and mm.

use super::summary::JointSummary;
use crate::robot::{JointKind, Limits, Robot};
use std::f64::consts::{PI, TAU};

/// No joint of an arm turns faster, rad/s: taken for the speed limit of one that turns without end, where there is no lower one.
const FASTEST_ENDLESS: f64 = 5.0;

/// Positions of a joint are in another unit beyond this many times its limits; those of another joint may lie between.
const BEYOND: f64 = 4.0;

/// A joint beyond its limits is too fast for its unit from this many times its limit of speed.
const TOO_FAST: f64 = 5.0;

/// In the other unit, position and speed exceed the limits by no more than these factors.
const WITHIN: f64 = 1.05;
const NOT_FASTER: f64 = 1.5;

/// Whole turns by which angles may be away; those that are farther count something else.
const TURNS_AWAY: f64 = 2.0;

/// Units of one kind of joint.
struct Units {
    si: &'static str,
    other: &'static str,
    /// Of the other unit in one of SI.
    ratio: f64,
    /// Limits nearer than this count as this: a joint may leave those of a small range by much.
    least: f64,
    /// Range and largest position of a joint without limits.
    range: f64,
    largest: f64,
    /// What else a large position may be.
    else_: &'static str,
}

/// Wrists that turn twice stay below two turns and a half.
const TURNS: Units = Units {
    si: "rad",
    other: "degrees",
    ratio: 180.0 / PI,
    least: 1.0,
    range: TAU,
    largest: 2.5 * TAU,
    else_: "neither rad nor deg: encoder counts, or turns of the motor?",
};

/// Rails are up to 30 m long.
const SLIDES: Units = Units {
    si: "m",
    other: "mm",
    ratio: 1e3,
    least: 0.1,
    range: 30.0,
    largest: 30.0,
    else_: "neither m nor mm: encoder counts?",
};

/// Why the positions of a joint do not look like those of SI units, and whether they look like degrees or mm. `turns` is whether it
/// turns, and not slides; an `endless` one turns without end.
pub(super) fn other_unit(
    summary: &JointSummary,
    limits: Option<Limits>,
    turns: bool,
    endless: bool,
) -> Option<(String, bool)> {
    let units = if turns { TURNS } else { SLIDES };
    let largest = summary.range[0].abs().max(summary.range[1].abs());
    // Angles that were kept within a whole turn may be turns away from where the joint says it is.
    let turn = if turns { TAU * units.ratio } else { f64::INFINITY };
    let away = (0.5 * (summary.range[0] + summary.range[1]) / turn).round();
    let away = if (1.0..=TURNS_AWAY).contains(&away.abs()) { away * turn } else { 0.0 };
    let nearest = (summary.range[0] - away).abs().max((summary.range[1] - away).abs());
    let (bound, fastest) =
        limits.map_or((f64::INFINITY, f64::INFINITY), |l| (l.lower.abs().max(l.upper.abs()), l.velocity));
    let fastest = if endless { fastest.min(FASTEST_ENDLESS) } else { fastest };
    // A joint within its limits that is too fast jumps; nothing is said about its unit.
    let leaves = if bound.is_finite() { largest > bound } else { summary.range[1] - summary.range[0] > units.range };
    let too_fast = summary.speed > TOO_FAST * fastest && leaves;
    let speed_fits = summary.speed / units.ratio < NOT_FASTER * fastest;
    // A joint that turns without end may be anywhere: its speed alone shows the unit.
    let (beyond, fits) = match endless {
        true => (too_fast, speed_fits),
        false => (
            largest > if bound.is_finite() { BEYOND * bound.max(units.least) } else { units.largest },
            nearest / units.ratio < bound.min(units.largest) * WITHIN,
        ),
    };
    let Units { si, other, else_, .. } = units;
    match (beyond, fits, too_fast && speed_fits) {
        (true, true, _) | (_, true, true) => {
            let text = format!(
                "positions up to {largest:.1} and speeds up to {:.1} per second are far too large in {si}; are they in {other}? \
                 Convert them to {si}",
                summary.speed
            );
            Some((text, true))
        }
        (true, false, _) => {
            let text = format!("positions up to {largest:.3e} are {else_} Convert them to {si} at the joint");
            Some((text, false))
        }
        _ => None,
    }
}

/// Whether positions are in degrees, or in mm, on half of the joints of this `kind` or more: one recorder gives all of them one unit,
/// and small motions do not show it.
pub(crate) fn are_in_other(
    kind: JointKind,
    summaries: &[JointSummary],
    robot: Option<&Robot>,
    endless: &[bool],
) -> bool {
    let of_kind = |joint: &usize| robot.map_or(JointKind::Revolute, |robot| robot.joints[*joint].kind) == kind;
    let joints: Vec<usize> = (0..summaries.len()).filter(of_kind).collect();
    let shows = |joint: &&usize| {
        let limits = robot.map(|robot| robot.joints[**joint].limits);
        let turns = kind == JointKind::Revolute;
        other_unit(&summaries[**joint], limits, turns, endless[**joint]).is_some_and(|(_, other)| other)
    };
    !joints.is_empty() && 2 * joints.iter().filter(shows).count() >= joints.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn summary(range: [f64; 2], speed: f64) -> JointSummary {
        JointSummary {
            name: String::new(),
            range,
            range_share: None,
            speed,
            speed_share: None,
            reversals: 0,
            torque_rms: 1.0,
            unexplained: None,
            dead_time_s: None,
        }
    }

    /// Degrees kept between 0 and 360 and then unwrapped: a joint at -20 deg is at 340.
    #[test]
    fn degrees_may_be_whole_turns_away() {
        let in_degrees = |range: [f64; 2]| {
            other_unit(&summary(range, 60.0), Some(limits(3.0, 3.0)), true, false).map(|(_, other)| other)
        };
        assert_eq!([in_degrees([340.0, 417.0]), in_degrees([-20.0, 57.0])], [Some(true); 2]);
        assert_eq!(in_degrees([80_000.0, 80_020.0]), Some(false));
        // Not even a whole turn brings it within the limits.
        assert_eq!(in_degrees([180.0 - 2.0, 180.0 + 2.0]), Some(false));
    }

    fn limits(bound: f64, velocity: f64) -> Limits {
        Limits { lower: -bound, upper: bound, velocity, effort: f64::INFINITY }
    }

    /// Whether a joint between `range` at `speed`, with limits of 3 rad and 3 rad/s, is taken to be in degrees.
    fn degrees(range: [f64; 2], speed: f64, endless: bool) -> Option<bool> {
        let bound = if endless { f64::INFINITY } else { 3.0 };
        other_unit(&summary(range, speed), Some(limits(bound, 3.0)), true, endless).map(|(_, degrees)| degrees)
    }

    /// Whether a joint that slides is taken to be in mm.
    fn millimetres(largest: f64, speed: f64, limits: Option<Limits>) -> Option<bool> {
        other_unit(&summary([-largest, largest], speed), limits, false, false).map(|(_, mm)| mm)
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

    #[test]
    fn a_joint_that_slides_is_in_mm_far_beyond_its_limits_and_within_them_as_mm() {
        let rail = Some(limits(0.5, 1.0));
        assert_eq!(
            [1.9, 2.1, 524.0, 526.0].map(|q| millimetres(q, 1.0, rail)),
            [None, Some(true), Some(true), Some(false)]
        );
        // A joint that leaves its limits a little is too fast for m/s from five times its speed.
        assert_eq!([4.9, 5.1, 1600.0].map(|v| millimetres(0.6, v, rail)), [None, Some(true), None]);
        // Fingers: a limit of 40 mm counts as 100.
        assert_eq!(
            [0.39, 0.41, 30.0].map(|q| millimetres(q, 0.1, Some(limits(0.04, 1.0)))),
            [None, Some(true), Some(true)]
        );
        // Without limits.
        assert_eq!([29.0, 31.0, 3.2e4].map(|q| millimetres(q, 1.0, None)), [None, Some(true), Some(false)]);
    }
}
