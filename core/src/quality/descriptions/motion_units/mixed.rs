//! Joints that keep rad where the others are in another unit, from the torques: a small motion shows no unit by itself.
//!
//! Free bodies are asked, joint by joint, with the others in the units that fit best. The direction of a motion is the same in any unit, so
//! that friction decides nothing.

use super::super::change::Description;
use super::super::compare::{EXPLAINED, compare};
use super::super::fitting::{Physics, Rows};
use super::super::tried::Tried;
use super::scaled::{scaled, scaled_motion};
use crate::error::Result;
use crate::quality::view::View;
use crate::recording::Recording;
use crate::robot::Robot;

/// Passes over the joints, in each of which every joint is tested once: two units converge at once.
const PASSES: usize = 3;

/// Those of the `assumed` joints that are in SI units, as the torques show. The positions of a log are so many times larger than in SI
/// units as `factors` give, which is certain for all joints but those assumed.
///
/// # Errors
/// Those of the filters.
pub(crate) fn in_si_units(log: &Recording, robot: &Robot, factors: &[f64], assumed: &[usize]) -> Result<Vec<usize>> {
    let of_sure = |joint: usize| if assumed.contains(&joint) { 1.0 } else { 1.0 / factors[joint] };
    let sure: Vec<f64> = (0..robot.dof()).map(of_sure).collect();
    let converted = Recording { q: scaled(&log.q, &sure), ..log.clone() };
    // In SI units the assumed joints move most: the same rows serve all units.
    let Some(rows) = Rows::new(&[&View::new(&converted, Some(robot))?], Some(robot)) else { return Ok(Vec::new()) };
    let units = Units { physics: Physics::free(robot), rows, robot, factors, assumed };
    Ok(units.in_si())
}

/// The joints whose unit is to be found, with the data that determine it.
struct Units<'a> {
    physics: Physics,
    /// Rows in which the assumed joints are in SI units.
    rows: Rows,
    robot: &'a Robot,
    factors: &'a [f64],
    assumed: &'a [usize],
}

impl Units<'_> {
    /// The torques where some of the assumed joints are in SI units.
    fn tried(&self, in_si: &[bool]) -> Option<Tried> {
        let mut factors = vec![1.0; self.robot.dof()];
        for (&joint, _) in self.assumed.iter().zip(in_si).filter(|(_, in_si)| !**in_si) {
            factors[joint] = 1.0 / self.factors[joint];
        }
        let rows = Rows { motion: scaled_motion(&self.rows.motion, &factors), ..self.rows.clone() };
        Tried::new(&self.physics, &rows, Description::as_given(self.robot.dof(), self.robot.gravity))
    }

    /// The units that fit best, from given ones on, with the torques.
    fn settled(&self, mut in_si: Vec<bool>) -> Option<(Vec<bool>, Tried)> {
        let mut best = self.tried(&in_si)?;
        for _ in 0..PASSES {
            let before = in_si.clone();
            for joint in 0..in_si.len() {
                in_si[joint] = !in_si[joint];
                match self.tried(&in_si).filter(|other| other.share() < best.share()) {
                    Some(other) => best = other,
                    None => in_si[joint] = !in_si[joint],
                }
            }
            if in_si == before {
                break;
            }
        }
        Some((in_si, best))
    }

    /// Joints that are clearly in SI units. Where one is, the recorder does not give all joints one unit, and the others have the units
    /// that fit best.
    fn in_si(&self) -> Vec<usize> {
        let count = self.assumed.len();
        let ends = [false, true].into_iter().filter_map(|in_si| self.settled(vec![in_si; count]));
        let best = ends.min_by(|a, b| a.1.share().total_cmp(&b.1.share()));
        let Some((in_si, best)) = best else { return Vec::new() };
        let is_shown = |place: usize| {
            let mut other = in_si.clone();
            other[place] = false;
            let gain =
                self.tried(&other).and_then(|other| compare(&other.evaluation, &best.evaluation, &self.rows.log));
            gain.is_some_and(|gain| gain.is_better(2 * count, EXPLAINED) && gain.is_distinct())
        };
        let of_si = || (0..count).filter(|&place| in_si[place]);
        match best.explains_half() && of_si().any(is_shown) {
            true => of_si().map(|place| self.assumed[place]).collect(),
            false => Vec::new(),
        }
    }
}
