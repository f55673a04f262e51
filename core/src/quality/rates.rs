//! Units of positions and velocities together: the unit of each joint's velocity, and that of positions which velocities show.

use super::descriptions;
use super::finding::{Finding, Kind, Severity};
use super::motion::{NoAngles, OtherUnit, PositionUnits};
use super::places::{grouped, places};
use super::unit_changes::{OtherRate, UnitChanges};
use super::velocity;
use super::view::View;
use crate::error::Result;
use crate::recording::Recording;
use crate::robot::{Joint, JointKind, Robot};
use std::f64::consts::TAU;

/// Relative deviation of a velocity from its unit where it is converted: the ratios of gears lie between units.
const OF_UNIT: f64 = 0.03;

/// Relative deviation of a velocity from the change of position per second which is no other unit.
const SAME: f64 = 0.1;

/// Positions in another unit leave the limits by more than this factor, and are within it in their own.
const WITHIN: f64 = 1.05;

/// Units of the positions and velocities of a log at even steps. Positions that are far beyond their limits show their unit by themselves,
/// turns, and degrees of a small motion, show it in the torques.
///
/// # Errors
/// Those of the filters.
pub(super) fn found(log: &Recording, positions: &PositionUnits, robot: Option<&Robot>) -> Result<UnitChanges> {
    let mut units = of_motion(log, units_of_positions(log, positions, robot)?, robot)?;
    // To positions in an unknown unit no velocity is in a proportion that shows its own.
    units
        .velocities
        .iter_mut()
        .enumerate()
        .filter(|(j, _)| positions.is_unknown(*j))
        .for_each(|(_, unit)| *unit = None);
    units = units.or_none();
    if let Some(robot) = robot.filter(|_| units.is_none() && !positions.any())
        && let Some(of_turning) = by_torques(log, robot)?
    {
        let unit = |joint: &Joint| (joint.kind == JointKind::Revolute).then_some(of_turning);
        units.positions = robot.joints.iter().map(unit).collect();
        if log.qd.is_some() {
            units.velocities = units.positions.iter().map(|unit| unit.map(OtherRate::PerSecond)).collect();
            if let Some(converted) = units.positions_in_si(log) {
                of_velocities(&View::new(&converted, Some(robot))?, &mut units, Some(robot));
            }
        }
    }
    Ok(units.or_none())
}

/// The unit of the positions of joints that turn, where the torques show that they are not in rad though they may be.
fn by_torques(log: &Recording, robot: &Robot) -> Result<Option<OtherUnit>> {
    if descriptions::are_turns(log, robot)? {
        return Ok(Some(OtherUnit::Turn));
    }
    Ok(descriptions::are_degrees(log, robot)?.then_some(OtherUnit::Degree))
}

/// The positions, where none of the joints that turn is in rad and all are shares of ranges, or those before gears.
///
/// # Errors
/// Those of the filters.
pub(super) fn not_of_joints(log: &Recording, positions: PositionUnits, robot: Option<&Robot>) -> Result<PositionUnits> {
    // Shares of a range are within the limits in rad where a joint hardly moves.
    let [in_doubt, turned] = positions.turned_in_doubt();
    let Some(robot) = robot.filter(|_| 2 * in_doubt > turned) else { return Ok(positions) };
    let gears = match in_doubt == turned {
        true => descriptions::gear_ratio(log, robot, &positions.units())?,
        false => None,
    };
    if let Some(ranges) = descriptions::ranges(log, robot, gears)? {
        return Ok(positions.of_no_angles(NoAngles::OfRanges(ranges)));
    }
    Ok(match gears {
        Some(gears) => positions.of_no_angles(NoAngles::BeforeGears(gears)),
        None => positions,
    })
}

/// The unit of each joint's positions, where it is none of SI. What half of the joints show is assumed of the others, unless their
/// velocities or the torques show SI units.
fn units_of_positions(
    log: &Recording,
    positions: &PositionUnits,
    robot: Option<&Robot>,
) -> Result<Vec<Option<OtherUnit>>> {
    let mut units = positions.units();
    let mut assumed: Vec<usize> = (0..units.len()).filter(|&j| units[j].is_some() && !positions.doubts(j)).collect();
    if assumed.is_empty() {
        return Ok(units);
    }
    let view = View::new(log, robot)?;
    let of_unit = |joint: usize, ratio: f64| {
        let unit = units[joint].map_or(1.0, OtherUnit::in_si);
        (ratio / unit - 1.0).abs() < SAME
    };
    let ratios: Vec<Option<f64>> = (0..units.len()).map(|joint| velocity::ratio(&view, joint)).collect();
    // Velocities in rad/s are so many times smaller than positions in another unit have them.
    let are_in_si = (0..units.len())
        .filter(|&joint| positions.doubts(joint))
        .all(|joint| ratios[joint].is_some_and(|ratio| of_unit(joint, ratio)));
    if are_in_si {
        for &joint in &assumed {
            if ratios[joint].is_some_and(|ratio| (ratio - 1.0).abs() < SAME) {
                units[joint] = None;
            }
        }
        assumed.retain(|&joint| ratios[joint].is_none());
    }
    let Some(robot) = robot.filter(|_| !assumed.is_empty()) else { return Ok(units) };
    let factors: Vec<f64> = units.iter().map(|unit| unit.map_or(1.0, OtherUnit::in_si)).collect();
    for joint in descriptions::in_si_units(log, robot, &factors, &assumed)? {
        units[joint] = None;
    }
    Ok(units)
}

/// What positions, in units that they show by themselves, and velocities show.
fn of_motion(log: &Recording, of_positions: Vec<Option<OtherUnit>>, robot: Option<&Robot>) -> Result<UnitChanges> {
    let mut units = UnitChanges { positions: of_positions, ..UnitChanges::default() };
    if log.qd.is_none() {
        return Ok(units.or_none());
    }
    let raw = View::new(log, robot)?;
    let of_positions = units.positions.clone();
    if !velocity::is_si(&raw, |joint| of_positions[joint].map(OtherUnit::in_si)) {
        units.velocities = of_positions.iter().map(|unit| unit.map(OtherRate::PerSecond)).collect();
    }
    units.velocities.resize(raw.dof(), None);
    let converted = units.clone().or_none().positions_in_si(log);
    let converted = converted.as_ref().map(|log| View::new(log, robot)).transpose()?;
    let view = converted.as_ref().unwrap_or(&raw);
    if velocity::clock_factor(view, robot).is_none() || all_show_units(view, &units, robot) {
        of_velocities(view, &mut units, robot);
    }
    Ok(units.or_none())
}

/// Whether positions are in another unit, and the velocities of all joints are then in a known one: no clock runs wrong by such a factor.
fn all_show_units(view: &View, units: &UnitChanges, robot: Option<&Robot>) -> bool {
    let is_known = |joint: usize| {
        let kind = robot.map_or(JointKind::Revolute, |robot| robot.joints[joint].kind);
        let Some(ratio) = velocity::ratio(view, joint) else { return true };
        let converted = units.velocities[joint].map_or(1.0, OtherRate::in_si);
        let shown = shown(kind, units.positions[joint], units.velocities[joint], ratio, converted);
        matches!(shown, Some(Shown::Velocity(_)))
    };
    units.positions.iter().any(Option::is_some) && (0..view.dof()).all(is_known)
}

/// What the velocities show of units, in a log that was converted by those that were found before.
fn of_velocities(view: &View, units: &mut UnitChanges, robot: Option<&Robot>) {
    let kinds: Vec<JointKind> =
        (0..view.dof()).map(|joint| robot.map_or(JointKind::Revolute, |robot| robot.joints[joint].kind)).collect();
    for kind in [JointKind::Revolute, JointKind::Prismatic] {
        let joints: Vec<usize> = (0..view.dof()).filter(|&joint| kinds[joint] == kind).collect();
        let shown: Vec<(usize, Shown)> = joints
            .iter()
            .filter_map(|&joint| {
                let ratio = velocity::ratio(view, joint)?;
                let converted = units.velocities[joint].map_or(1.0, OtherRate::in_si);
                Some((joint, shown(kind, units.positions[joint], units.velocities[joint], ratio, converted)?))
            })
            .collect();
        let shared = |which: Shown| shown.iter().all(|(_, own)| *own == which);
        for &(joint, own) in &shown {
            let alike: Vec<usize> = shown.iter().filter(|(_, other)| *other == own).map(|(joint, _)| *joint).collect();
            let all: Vec<usize> = if shared(own) { joints.clone() } else { vec![joint] };
            match own {
                Shown::Velocity(unit) => all.into_iter().for_each(|joint| units.velocities[joint] = unit),
                Shown::Position(unit) if is_of_positions(view, robot, unit, &alike, shared(own)) => {
                    all.into_iter().for_each(|joint| units.positions[joint] = Some(unit));
                }
                Shown::Position(_) => {}
            }
        }
    }
}

/// What the velocity of a joint shows.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Shown {
    /// It is in this unit, or in SI units.
    Velocity(Option<OtherRate>),
    /// The position is in another unit, and the velocity in SI units.
    Position(OtherUnit),
}

/// What the change of position per second over the velocity shows, of a velocity that was `converted` to SI units by this factor.
fn shown(
    kind: JointKind,
    position: Option<OtherUnit>,
    velocity: Option<OtherRate>,
    ratio: f64,
    converted: f64,
) -> Option<Shown> {
    let near = |factor: f64| (factor - 1.0).abs() < OF_UNIT;
    if (ratio - 1.0).abs() < SAME {
        return Some(Shown::Velocity(velocity));
    }
    // So many of the log's unit make one of SI.
    let own = converted / ratio;
    if near(own) {
        return Some(Shown::Velocity(None));
    }
    if let Some(unit) = OtherRate::of(kind).find(|unit| near(own / unit.in_si())) {
        return Some(Shown::Velocity(Some(unit)));
    }
    let of_position = || OtherUnit::of(kind).iter().copied().find(|unit| near(ratio / unit.in_si()));
    position.is_none().then(of_position).flatten().map(Shown::Position)
}

/// Whether positions that differ from SI units as a unit does are in this unit. A velocity may be in the wrong unit too: positions in small
/// units leave the limits of some joint, and turns are those of all joints and within the limits.
fn is_of_positions(view: &View, robot: Option<&Robot>, unit: OtherUnit, joints: &[usize], shared: bool) -> bool {
    let limit = |joint: usize| {
        let bound = robot.map(|robot| &robot.joints[joint].limits).map(|l| l.lower.abs().max(l.upper.abs()));
        bound.filter(|bound| bound.is_finite()).unwrap_or(TAU)
    };
    let largest = |joint: usize| view.log.q.channel(joint).iter().fold(0.0f64, |most, q| most.max(q.abs()));
    match unit {
        OtherUnit::Turn => shared && joints.iter().all(|&joint| largest(joint) / unit.in_si() < WITHIN * limit(joint)),
        _ => joints.iter().any(|&joint| largest(joint) > WITHIN * limit(joint)),
    }
}

/// Findings about units that the velocities show; those of positions that show theirs by themselves are found with them.
pub(super) fn findings(units: &UnitChanges, positions: &PositionUnits, view: &View) -> Vec<Finding> {
    let mut out = Vec::new();
    let by_velocity = |joint: usize| units.position(joint).filter(|_| !positions.doubts(joint));
    for (unit, joints) in grouped(view.dof(), by_velocity) {
        let place = places(view, "q", &joints);
        let of_velocity = joints.iter().any(|&joint| view.log.has_velocity(joint) && units.velocity(joint).is_none());
        let shown = match of_velocity {
            true => "where the velocities are in SI units",
            false if positions.any() => "as those of the other joints are, since nothing shows another unit",
            false => "as the torques of gravity show",
        };
        let text = format!(
            "the positions are in {} {shown}; convert them, or set [units] position = \"{}\" in a dataset",
            unit.words(),
            unit.symbol()
        );
        out.push(Finding::new(Kind::PositionUnit, Severity::Warning, place, text));
    }
    let of_its_own = |joint: usize| {
        let unit = units.velocity(joint)?;
        (units.position(joint).map(OtherRate::PerSecond) != Some(unit) && view.log.has_velocity(joint)).then_some(unit)
    };
    for (unit, joints) in grouped(view.dof(), of_its_own) {
        let of_positions = units.position(joints[0]).map_or("rad or m", OtherUnit::words);
        let symbol = unit.symbol();
        let text = format!(
            "the velocities are in {symbol} where the positions are in {of_positions}; convert them, or set [units] velocity = \
             \"{symbol}\" in a dataset"
        );
        out.push(Finding::new(Kind::VelocityUnit, Severity::Warning, places(view, "qd", &joints), text));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    const DEGREE: OtherUnit = OtherUnit::Degree;

    /// What a velocity shows that is in SI units as far as is known.
    fn plain(ratio: f64) -> Option<Shown> {
        shown(JointKind::Revolute, None, None, ratio, 1.0)
    }

    #[test]
    fn a_velocity_shows_units_and_not_gears() {
        let velocity = |unit: OtherRate| Some(Shown::Velocity(Some(unit)));
        assert_eq!([plain(1.09), plain(0.91)], [Some(Shown::Velocity(None)); 2]);
        // Three percent around rpm, of which there are 9.549 in one rad/s: a gear has ten.
        assert_eq!([plain(1.0 / 9.80), plain(1.0 / 9.86), plain(0.1)], [velocity(OtherRate::Rpm), None, None]);
        assert_eq!(plain(1.0 / DEGREE.in_si()), velocity(OtherRate::PerSecond(DEGREE)));
        assert_eq!(plain(TAU), velocity(OtherRate::PerSecond(OtherUnit::Turn)));
        assert_eq!([plain(57.3), plain(1e3)], [DEGREE, OtherUnit::Milliradian].map(|unit| Some(Shown::Position(unit))));
        assert_eq!(plain(1.0 / TAU), Some(Shown::Position(OtherUnit::Turn)));
        assert_eq!([plain(1.0 / 101.0), plain(1.0 / 60.0)], [None; 2]);
        // A joint that slides has no degrees.
        assert_eq!(shown(JointKind::Prismatic, None, None, 1.0 / 57.3, 1.0), None);
    }

    #[test]
    fn velocities_of_positions_in_degrees() {
        let per_second = Some(OtherRate::PerSecond(DEGREE));
        let of = |ratio: f64| shown(JointKind::Revolute, Some(DEGREE), per_second, ratio, DEGREE.in_si());
        assert_eq!(of(1.0), Some(Shown::Velocity(per_second)));
        assert_eq!(of(57.3), Some(Shown::Velocity(None)));
        assert_eq!(of(6.0), Some(Shown::Velocity(Some(OtherRate::Rpm))));
        assert_eq!(of(20.0), None);
    }
}
