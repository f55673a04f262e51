//! Whether positions are those of motors behind gears of one ratio, from the torques of gravity: such positions look like degrees or mrad.

use super::super::change::Description;
use super::super::compare::{EXPLAINED, compare};
use super::super::fitting::{Fit, Physics, Rows};
use super::super::sizes::golden::golden;
use super::super::tried::Tried;
use super::scaled::{scaled, scaled_motion};
use crate::error::Result;
use crate::quality::motion::OtherUnit;
use crate::quality::view::View;
use crate::recording::Recording;
use crate::robot::{JointKind, Robot};

/// Positions exceed the limits by no more than this factor.
const WITHIN: f64 = 1.05;

/// No gear of an arm is higher.
const HIGHEST: f64 = 500.0;

/// Ratios that are tried first are so many times each other. A motion of one radian that is wrong by half of that is wrong by four degrees,
/// which the torque of gravity still nearly follows.
const STEP: f64 = 1.15;

/// Golden sections behind that: to within a thousandth.
const SECTIONS: usize = 12;

/// A ratio this near to a unit's is that of the unit.
const OF_UNIT: f64 = 0.05;

/// Rows that are looked at for the ratio.
const ROWS: usize = 500;

/// The ratio of gears that all joints which turn share, where positions behind it explain the torques clearly better than those in any unit
/// do, and than the `units` that the positions of each joint seem to be in.
///
/// # Errors
/// Those of the filters.
pub(crate) fn ratio(log: &Recording, robot: &Robot, units: &[Option<OtherUnit>]) -> Result<Option<f64>> {
    let turns: Vec<usize> = (0..robot.dof()).filter(|&joint| robot.joints[joint].kind == JointKind::Revolute).collect();
    let lowest = turns.iter().map(|&joint| {
        let limits = robot.joints[joint].limits;
        let largest = log.q.channel(joint).iter().fold(0.0f64, |most, q| most.max(q.abs()));
        largest / (WITHIN * limits.lower.abs().max(limits.upper.abs()))
    });
    let lowest = lowest.fold(1.0, f64::max);
    // One joint alone may be in any unit.
    if turns.len() < 2 || lowest > HIGHEST {
        return Ok(None);
    }
    // The same rows serve all ratios: those of joints that are as fast as behind the lowest.
    let all_by = |ratio: f64| -> Vec<f64> {
        let mut factors = vec![1.0; robot.dof()];
        turns.iter().for_each(|&joint| factors[joint] = 1.0 / ratio);
        factors
    };
    let behind = Recording { q: scaled(&log.q, &all_by(lowest)), ..log.clone() };
    let Some(rows) = Rows::new(&[&View::new(&behind, Some(robot))?], Some(robot)) else { return Ok(None) };
    let physics = Physics::free(robot);
    let start = Description::as_given(robot.dof(), robot.gravity);
    let under = |rows: &Rows, factors: &[f64]| Rows { motion: scaled_motion(&rows.motion, factors), ..rows.clone() };
    let few = rows.thinned(ROWS);
    let merit = |logarithm: f64| {
        let rows = under(&few, &all_by(logarithm.exp() / lowest));
        Fit::new(&physics.tables(&rows, &start), &rows, &start).merit().unwrap_or(f64::INFINITY)
    };
    let (low, high): (f64, f64) = (lowest.ln(), HIGHEST.ln());
    let steps = ((high - low) / STEP.ln()).ceil().max(1.0);
    let each = (0..=steps as usize).map(|step| low + (high - low) * step as f64 / steps);
    let Some((best, _)) = each.map(|at| (at, merit(at))).min_by(|a, b| a.1.total_cmp(&b.1)) else { return Ok(None) };
    let ratio = golden((best - STEP.ln()).max(low), best + STEP.ln(), SECTIONS, merit).exp();
    let in_unit = OtherUnit::of(JointKind::Revolute).iter().any(|unit| (ratio / unit.in_si()).ln().abs() < OF_UNIT);
    if in_unit {
        return Ok(None);
    }
    let tried = |factors: &[f64]| Tried::new(&physics, &under(&rows, factors), start.clone());
    let Some(with) = tried(&all_by(ratio / lowest)) else { return Ok(None) };
    let seeming: Vec<f64> = (0..robot.dof())
        .map(|joint| match units[joint].filter(|_| turns.contains(&joint)) {
            Some(unit) => lowest / unit.in_si(),
            None => 1.0,
        })
        .collect();
    let of_units = OtherUnit::of(JointKind::Revolute).iter().map(|unit| all_by(unit.in_si() / lowest));
    let is_better = |factors: Vec<f64>| {
        let gain = tried(&factors).and_then(|other| compare(&other.evaluation, &with.evaluation, &rows.log));
        gain.is_some_and(|gain| gain.is_better(steps as usize, EXPLAINED) && gain.is_large(1))
    };
    Ok((with.explains_half() && of_units.chain([seeming]).all(is_better)).then_some(ratio))
}
