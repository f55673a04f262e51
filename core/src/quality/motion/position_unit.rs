//! Whether positions are in rad and m, or in degrees, mrad, mm or um.

use super::exchange::{self, NOT_FASTER, WITHIN};
use super::no_angles::NoAngles;
use super::summary::JointSummary;
use crate::quality::places::grouped;
use crate::quality::velocity;
use crate::quality::view::View;
use crate::robot::{JointKind, Limits, Robot};
use std::f64::consts::{PI, TAU};

/// No joint of an arm turns faster, rad/s: taken for the speed limit of one that turns without end, where there is no lower one.
const FASTEST_ENDLESS: f64 = 5.0;

/// Positions of a joint are in another unit beyond this many times its limits; those of another joint may lie between.
const BEYOND: f64 = 4.0;

/// A joint beyond its limits is too fast for its unit from this many times its limit of speed.
const TOO_FAST: f64 = 5.0;

/// Whole turns by which angles may be away; those that are farther count something else.
const TURNS_AWAY: f64 = 2.0;

/// Velocities show the unit of positions where their ratio is within this of it.
const RATIO: f64 = 0.1;

/// A unit of positions other than rad and m.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::quality::OtherUnit;
///
/// // As a dataset names it: [units] position = "deg".
/// assert_eq!(OtherUnit::Degree.symbol(), "deg");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs, reason = "a unit says what it is")]
pub enum OtherUnit {
    Degree,
    Milliradian,
    Millimetre,
    Micrometre,
    Turn,
}

impl OtherUnit {
    /// Those in which positions of a kind of joint may be.
    pub(crate) fn of(kind: JointKind) -> &'static [OtherUnit] {
        match kind {
            JointKind::Revolute => &[OtherUnit::Degree, OtherUnit::Milliradian, OtherUnit::Turn],
            JointKind::Prismatic => &[OtherUnit::Millimetre, OtherUnit::Micrometre],
        }
    }

    /// How a dataset names it.
    pub fn symbol(self) -> &'static str {
        match self {
            OtherUnit::Degree => "deg",
            OtherUnit::Milliradian => "mrad",
            OtherUnit::Millimetre => "mm",
            OtherUnit::Micrometre => "um",
            OtherUnit::Turn => "rev",
        }
    }

    /// The unit in a sentence.
    pub(crate) fn words(self) -> &'static str {
        match self {
            OtherUnit::Degree => "degrees",
            OtherUnit::Turn => "turns",
            other => other.symbol(),
        }
    }

    /// How many of it make one of SI.
    pub(crate) fn in_si(self) -> f64 {
        match self {
            OtherUnit::Degree => 180.0 / PI,
            OtherUnit::Milliradian | OtherUnit::Millimetre => 1e3,
            OtherUnit::Micrometre => 1e6,
            OtherUnit::Turn => 1.0 / TAU,
        }
    }
}

/// Units of one kind of joint.
struct Units {
    si: &'static str,
    /// The usual one first. Those behind it must show more: that the joint moves, and numbers that are no counts.
    others: [OtherUnit; 2],
    /// Limits nearer than this count as this: a joint may leave those of a small range by much.
    least: f64,
    /// Range and largest position of a joint without limits.
    range: f64,
    largest: f64,
    /// Range from which a joint is said to move.
    moves: f64,
    /// What else a large position may be.
    else_: &'static str,
}

impl Units {
    /// Those of a kind of joint.
    fn of(kind: JointKind) -> &'static Units {
        match kind {
            JointKind::Revolute => &TURNS,
            JointKind::Prismatic => &SLIDES,
        }
    }
}

/// Wrists that turn twice stay below two turns and a half.
const TURNS: Units = Units {
    si: "rad",
    others: [OtherUnit::Degree, OtherUnit::Milliradian],
    least: 1.0,
    range: TAU,
    largest: 2.5 * TAU,
    moves: 0.02,
    else_: "neither rad nor deg: encoder counts, mrad in whole numbers, or turns of the motor? A dataset takes counts as turns behind a gear: [units] \
            position = \"rev\", [motors] gear_ratio = counts per turn, position_at = \"motor\", torque_at = \"joint\".",
};

/// Rails are up to 30 m long.
const SLIDES: Units = Units {
    si: "m",
    others: [OtherUnit::Millimetre, OtherUnit::Micrometre],
    least: 0.1,
    range: 30.0,
    largest: 30.0,
    moves: 0.002,
    else_: "neither m nor mm: encoder counts, or um in whole numbers?",
};

/// What a log shows of the unit of a joint's positions besides their size.
#[derive(Debug, Clone, Copy, Default)]
struct Shown {
    /// All positions are whole numbers, as counts of an encoder are.
    whole: bool,
    /// Change of position per second over the logged velocity.
    ratio: Option<f64>,
}

/// The limit that is farther from zero.
fn bound(limits: Limits) -> f64 {
    limits.lower.abs().max(limits.upper.abs())
}

/// Whether positions are too far from zero for SI units.
fn is_far(summary: &JointSummary, bound: f64, units: &Units) -> bool {
    let largest = summary.range[0].abs().max(summary.range[1].abs());
    largest > if bound.is_finite() { BEYOND * bound.max(units.least) } else { units.largest }
}

/// Units in which the positions of a joint fit its limits, where they do not in SI units; there may be none.
fn fitting(
    summary: &JointSummary,
    limits: Option<Limits>,
    units: &Units,
    endless: bool,
    shown: Shown,
) -> Option<Vec<OtherUnit>> {
    let [low, high] = summary.range;
    let largest = low.abs().max(high.abs());
    let (bound, fastest) =
        limits.map_or((f64::INFINITY, f64::INFINITY), |limits| (self::bound(limits), limits.velocity));
    let fastest = if endless { fastest.min(FASTEST_ENDLESS) } else { fastest };
    // A joint within its limits that is too fast jumps; nothing is said about its unit.
    let leaves = if bound.is_finite() { largest > bound } else { high - low > units.range };
    let too_fast = summary.speed > TOO_FAST * fastest && leaves;
    let far = is_far(summary, bound, units);
    // A joint that turns without end may be anywhere: its speed alone shows the unit.
    let beyond = if endless { too_fast } else { far };
    let of_velocity = |unit: OtherUnit| shown.ratio.is_some_and(|ratio| (ratio / unit.in_si() - 1.0).abs() < RATIO);
    let shown_by_velocity = units.others.into_iter().find(|unit| of_velocity(*unit));
    let fits = |(place, unit): (usize, OtherUnit)| {
        let ratio = unit.in_si();
        // Angles that were kept within a whole turn may be whole turns away from the range of the joint.
        let turn = if units.si == TURNS.si { TAU * ratio } else { f64::INFINITY };
        let away = (0.5 * (low + high) / turn).round();
        let away = if (1.0..=TURNS_AWAY).contains(&away.abs()) { away * turn } else { 0.0 };
        let nearest = (low - away).abs().max((high - away).abs());
        let speed_fits = summary.speed / ratio < NOT_FASTER * fastest;
        // A joint that turns without end is as fast in its own unit as one in rad that is not suspected.
        let place_fits = if endless {
            summary.speed / ratio < TOO_FAST * fastest
        } else {
            nearest / ratio < bound.min(units.largest) * WITHIN
        };
        let shows = shown_by_velocity == Some(unit)
            || (shown_by_velocity.is_none() && (place == 0 || (!shown.whole && (high - low) / ratio >= units.moves)));
        (place_fits && shows && (beyond || (too_fast && speed_fits))).then_some(unit)
    };
    let fitting: Vec<OtherUnit> = units.others.into_iter().enumerate().filter_map(fits).collect();
    (beyond || !fitting.is_empty()).then_some(fitting)
}

/// The units of the positions of all joints, as far as they are not those of SI.
pub(crate) struct PositionUnits {
    /// The units of each joint that fit, where SI units do not.
    doubts: Vec<Option<Vec<OtherUnit>>>,
    /// For each joint the one whose positions it may have.
    exchanged: Vec<Option<usize>>,
    kinds: Vec<JointKind>,
    /// What the positions of joints that turn are, where they are no angles of these.
    no_angles: Option<NoAngles>,
}

impl PositionUnits {
    /// Looks at the positions of all joints; `endless` ones turn without end.
    pub(crate) fn of(view: &View, summaries: &[JointSummary], robot: Option<&Robot>, endless: &[bool]) -> Self {
        let kinds: Vec<JointKind> =
            (0..view.dof()).map(|joint| robot.map_or(JointKind::Revolute, |robot| robot.joints[joint].kind)).collect();
        let doubt = |joint: usize| {
            let limits = robot.map(|robot| robot.joints[joint].limits);
            let whole = view.log.q.channel(joint).iter().all(|value| value.fract() == 0.0);
            let shown = Shown { whole, ratio: velocity::ratio(view, joint) };
            let units = Units::of(kinds[joint]);
            fitting(&summaries[joint], limits, units, endless[joint], shown)
        };
        let mut doubts: Vec<Option<Vec<OtherUnit>>> = (0..view.dof()).map(doubt).collect();
        // One recorder gives all joints one unit: speed alone shows another of a few joints no better than a wrong clock does.
        for kind in [JointKind::Revolute, JointKind::Prismatic] {
            let own = |joint: &usize| kinds[*joint] == kind;
            let doubtful: Vec<usize> = (0..kinds.len()).filter(|j| own(j) && doubts[*j].is_some()).collect();
            if 2 * doubtful.len() < (0..kinds.len()).filter(own).count() {
                for joint in doubtful.into_iter().filter(|&joint| !endless[joint]) {
                    let bound = robot.map_or(f64::INFINITY, |robot| bound(robot.joints[joint].limits));
                    if !is_far(&summaries[joint], bound, Units::of(kind)) {
                        doubts[joint] = None;
                    }
                }
            }
        }
        // The positions of a joint that turns are far too large for one that slides, in which no unit is wrong.
        let partner = |joint: usize| exchange::partner(robot.filter(|_| doubts[joint].is_some())?, summaries, joint);
        let exchanged: Vec<Option<usize>> = (0..view.dof()).map(partner).collect();
        doubts.iter_mut().zip(&exchanged).filter(|(_, other)| other.is_some()).for_each(|(doubt, _)| *doubt = None);
        PositionUnits { doubts, exchanged, kinds, no_angles: None }
    }

    /// The joint whose positions this one may have: in each other's place both are within their limits.
    pub(super) fn exchanged(&self, joint: usize) -> Option<usize> {
        self.exchanged[joint]
    }

    /// Whether the positions of any joint are not in rad or m.
    pub(crate) fn any(&self) -> bool {
        self.doubts.iter().any(Option::is_some)
    }

    /// Whether the positions of a joint are not in rad or m.
    pub(crate) fn doubts(&self, joint: usize) -> bool {
        self.doubts[joint].is_some()
    }

    /// Joints that turn and are not in rad as far as their positions show, and all that turn.
    pub(crate) fn turned_in_doubt(&self) -> [usize; 2] {
        let turned = || (0..self.kinds.len()).filter(|&joint| self.kinds[joint] == JointKind::Revolute);
        [turned().filter(|&joint| self.doubts(joint)).count(), turned().count()]
    }

    /// The same where the positions of joints that turn are none of angles of the joints: in no unit of these.
    pub(crate) fn of_no_angles(mut self, positions: NoAngles) -> Self {
        let turned = self.doubts.iter_mut().zip(&self.kinds).filter(|(_, kind)| **kind == JointKind::Revolute);
        turned.for_each(|(doubt, _)| *doubt = Some(Vec::new()));
        self.no_angles = Some(positions);
        self
    }

    /// Whether the positions of a joint are in none of the known units.
    pub(crate) fn is_unknown(&self, joint: usize) -> bool {
        self.doubts[joint].as_ref().is_some_and(Vec::is_empty)
    }

    /// The unit of each joint, where it is none of SI: that of all joints of a kind where half of them or more show it, as one recorder
    /// gives all of them one unit and small motions do not show it, else that of the joint alone.
    pub(crate) fn units(&self) -> Vec<Option<OtherUnit>> {
        let of = |joint: usize| self.shared(self.kinds[joint]).or_else(|| self.of_joint(joint));
        (0..self.kinds.len()).map(of).collect()
    }

    fn shared(&self, kind: JointKind) -> Option<OtherUnit> {
        let joints = (0..self.kinds.len()).filter(|&joint| self.kinds[joint] == kind);
        let unit = self.likely(kind)?;
        (2 * self.count(kind, unit) >= joints.count()).then_some(unit)
    }

    /// The unit that the positions of a joint show by themselves.
    fn of_joint(&self, joint: usize) -> Option<OtherUnit> {
        let fitting = self.doubts[joint].as_ref()?;
        self.likely(self.kinds[joint]).filter(|unit| fitting.contains(unit)).or(fitting.first().copied())
    }

    /// The first unit that half of the joints fit whose positions are not in SI units.
    fn likely(&self, kind: JointKind) -> Option<OtherUnit> {
        let doubtful = self.doubts.iter().zip(&self.kinds).filter(|(doubt, own)| doubt.is_some() && **own == kind);
        let doubtful = doubtful.count();
        Units::of(kind).others.into_iter().find(|unit| doubtful > 0 && 2 * self.count(kind, *unit) >= doubtful)
    }

    fn count(&self, kind: JointKind, unit: OtherUnit) -> usize {
        let shows = |(doubt, own): &(&Option<Vec<OtherUnit>>, &JointKind)| {
            **own == kind && doubt.as_ref().is_some_and(|fitting| fitting.contains(&unit))
        };
        self.doubts.iter().zip(&self.kinds).filter(shows).count()
    }

    /// Why the positions of joints do not look like those of SI units, with the joints: one text for those of one unit.
    pub(super) fn texts(&self, summaries: &[JointSummary]) -> Vec<(Vec<usize>, String)> {
        let dof = self.kinds.len();
        let largest = |joints: &[usize]| {
            let of = |&joint: &usize| summaries[joint].range.iter().fold(0.0f64, |most, end| most.max(end.abs()));
            joints.iter().map(of).fold(0.0, f64::max)
        };
        let doubtful = |joint: usize| {
            self.doubts[joint].as_ref()?;
            // Zeros that are others take a joint in the unit of all out of its limits.
            let unit = self.of_joint(joint).map(|own| self.shared(self.kinds[joint]).unwrap_or(own));
            Some((Units::of(self.kinds[joint]).si, unit))
        };
        let text = |si: &str, unit: Option<OtherUnit>, joints: &[usize]| {
            let fastest = joints.iter().map(|&joint| summaries[joint].speed).fold(0.0, f64::max);
            let largest = largest(joints);
            let turns = self.kinds[joints[0]] == JointKind::Revolute;
            match (unit, self.no_angles.as_ref().filter(|_| turns)) {
                (None, Some(positions)) => positions.text(largest),
                (Some(unit), _) => format!(
                    "the positions are in {}: up to {largest:.1}, at up to {fastest:.1} per second, they are far too large in {si}; convert \
                     them, or set [units] position = \"{}\" in a dataset",
                    unit.words(),
                    unit.symbol()
                ),
                (None, None) => {
                    let else_ = Units::of(self.kinds[joints[0]]).else_;
                    format!("positions up to {largest:.3e} are {else_} Convert them to {si} at the joint")
                }
            }
        };
        let groups = grouped(dof, doubtful).into_iter();
        groups.map(|((si, unit), joints)| (joints.clone(), text(si, unit, &joints))).collect()
    }
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
            constant: None,
            dead_time_s: None,
        }
    }

    /// The first unit of a joint that fits, where it is not in SI units.
    fn unit(
        range: [f64; 2],
        speed: f64,
        limits: Option<Limits>,
        turns: bool,
        endless: bool,
    ) -> Option<Option<OtherUnit>> {
        let units = if turns { &TURNS } else { &SLIDES };
        let fitting = fitting(&summary(range, speed), limits, units, endless, Shown::default())?;
        Some(fitting.first().copied())
    }

    fn is(of: Option<Option<OtherUnit>>, unit: OtherUnit) -> Option<bool> {
        of.map(|found| found == Some(unit))
    }

    /// Degrees kept between 0 and 360 and then unwrapped: a joint at -20 deg is at 340.
    #[test]
    fn degrees_may_be_whole_turns_away() {
        let in_degrees =
            |range: [f64; 2]| is(unit(range, 60.0, Some(limits(3.0, 3.0)), true, false), OtherUnit::Degree);
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
        is(unit(range, speed, Some(limits(bound, 3.0)), true, endless), OtherUnit::Degree)
    }

    /// Whether a joint that slides is taken to be in mm.
    fn millimetres(largest: f64, speed: f64, limits: Option<Limits>) -> Option<bool> {
        is(unit([-largest, largest], speed, limits, false, false), OtherUnit::Millimetre)
    }

    #[test]
    fn a_joint_that_turns_without_end_is_judged_by_its_speed() {
        assert_eq!(degrees([-2.0, 51.2], 5.0, true), None);
        assert_eq!(degrees([-2.0, 51.2], 5.0, false), Some(true));
        // Beyond five times its speed, and what fits it in degrees.
        assert_eq!(degrees([-90.0, 90.0], 14.9, true), None);
        assert_eq!(degrees([-90.0, 90.0], 15.1, true), Some(true));
        assert_eq!(degrees([-9e4, 9e4], 1e5, true), Some(false));
        // As fast as one in rad that is not suspected: fifteen rad/s.
        assert_eq!([859.0, 860.0].map(|speed| degrees([-9e4, 9e4], speed, true)), [Some(true), Some(false)]);
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

    #[test]
    fn milliradians_are_beyond_degrees_and_within_the_limits() {
        let of = |largest: f64| unit([-largest, largest], 900.0, Some(limits(3.0, 3.0)), true, false);
        // 3 rad are 172 degrees or 3000 mrad, and 5 % more are allowed.
        assert_eq!(unit([-11.9, 11.9], 2.0, Some(limits(3.0, 3.0)), true, false), None);
        assert_eq!(of(180.0), Some(Some(OtherUnit::Degree)));
        assert_eq!(
            [of(181.0), of(3149.0), of(3151.0)],
            [Some(Some(OtherUnit::Milliradian)), Some(Some(OtherUnit::Milliradian)), Some(None)]
        );
        let rail = |largest: f64| unit([-largest, largest], 900.0, Some(limits(0.5, 1.0)), false, false);
        assert_eq!(
            [rail(524.0), rail(0.9e3), rail(1.1e3), rail(5.2e5), rail(5.3e5)],
            [
                Some(Some(OtherUnit::Millimetre)),
                Some(None),
                Some(Some(OtherUnit::Micrometre)),
                Some(Some(OtherUnit::Micrometre)),
                Some(None)
            ]
        );
    }

    #[test]
    fn whole_numbers_are_counts_unless_velocities_show_their_unit() {
        let found =
            |shown: Shown| fitting(&summary([-900.0, 900.0], 900.0), Some(limits(3.0, 3.0)), &TURNS, false, shown);
        let shown = |whole: bool, ratio: Option<f64>| found(Shown { whole, ratio });
        assert_eq!(shown(false, None), Some(vec![OtherUnit::Milliradian]));
        assert_eq!(shown(true, None), Some(vec![]));
        assert_eq!(
            [shown(true, Some(910.0)), shown(true, Some(890.0))],
            [Some(vec![OtherUnit::Milliradian]), Some(vec![])]
        );
        // A small motion is one in degrees or in mrad: the velocities decide.
        let small = |ratio: Option<f64>| {
            let shown = Shown { whole: false, ratio };
            fitting(&summary([-90.0, 90.0], 90.0), Some(limits(3.0, 3.0)), &TURNS, false, shown)
        };
        assert_eq!(small(None), Some(vec![OtherUnit::Degree, OtherUnit::Milliradian]));
        assert_eq!(small(Some(1e3)), Some(vec![OtherUnit::Milliradian]));
        assert_eq!(small(Some(57.3)), Some(vec![OtherUnit::Degree]));
    }
}
