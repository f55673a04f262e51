//! A torque from which a controller takes the gravity of the described bodies, whose masses are not quite the arm's: a part of gravity is
//! left in it, which is that of no direction and of no bodies.

use super::super::change::{Change, Description};
use super::super::compare::{EXPLAINED, compare};
use super::super::fitting::{Fit, Physics, Rows, masses};
use super::super::shares::{ALIKE, FEWEST, MORE_THAN_ALL, WRONG_MASSES};
use super::super::tried::Tried;
use crate::dynamics::Motion;
use crate::linear::root_mean_square;
use crate::robot::Robot;

/// What a controller leaves of gravity is less than this share of what it takes off: masses that are wrong by half leave as much. A log
/// with all of its gravity has another arm's then, or one with other masses.
const LEFT: f64 = 0.5;

/// The logs as they are and without the gravity of the described `bodies`, where bodies of any masses explain the torques clearly better by
/// that, and those described do not explain them as they are.
pub(crate) fn judged(robot: &Robot, bodies: &Physics, rows: &Rows, start: &Description) -> Option<[Tried; 2]> {
    let under = |physics: &Physics, description: &Description| Tried::new(physics, rows, description.clone());
    if start.gravity.norm() == 0.0 {
        return None;
    }
    let before = under(bodies, start)?;
    // Where joints move in turns, those that gravity does not move keep the mean small.
    let exceeds = |share: &&f64| **share > MORE_THAN_ALL;
    if before.share() < ALIKE && before.evaluation.unexplained.iter().flatten().filter(exceeds).count() < FEWEST {
        return None;
    }
    let masses = Physics::masses(robot)?;
    let after = under(&masses, &start.with(Change::WithoutGravity))?;
    let gain = compare(&under(&masses, start)?.evaluation, &after.evaluation, &rows.log)?;
    tracing::debug!(before = before.share(), after = after.share(), gain = gain.gain, p = gain.p, "compensation");
    let left = || gravity_left(robot, &masses, rows, &after.description).is_some_and(|left| left < LEFT);
    let is_clear = after.share() < WRONG_MASSES && gain.is_better(1, EXPLAINED) && gain.is_large(1);
    (is_clear && left()).then_some([before, after])
}

/// Gravity that stays in the torques with the masses that fit them, over that which a controller with those described takes off, root mean
/// squares over all joints.
fn gravity_left(robot: &Robot, masses: &Physics, rows: &Rows, description: &Description) -> Option<f64> {
    let whole = rows.whole();
    let fitted = Fit::new(&masses.tables(&whole, description), &whole, description).parameters()?;
    let at_rest = Motion::at_rest(description.positions(&rows.motion.q));
    let each = masses::torques(robot, robot.gravity.into(), &at_rest);
    let with = |factor: &dyn Fn(usize) -> f64| {
        let mut sum = vec![0.0; each.first().map_or(0, |torque| torque.as_slice().len())];
        for (body, torque) in each.iter().enumerate() {
            let factor = factor(body);
            sum.iter_mut().zip(torque.as_slice()).for_each(|(sum, own)| *sum += factor * own);
        }
        root_mean_square(&sum)
    };
    Some(with(&|body| fitted[body] - 1.0) / with(&|_| 1.0).max(f64::MIN_POSITIVE))
}

/// The logs without the gravity of the described bodies, whatever these weigh.
pub(crate) fn of_masses(robot: &Robot, rows: &Rows, start: &Description) -> Option<Tried> {
    Tried::new(&Physics::masses(robot)?, rows, start.with(Change::WithoutGravity))
}

/// Whether bodies of any masses explain what a controller leaves of a torque.
pub(super) fn is_explained(robot: &Robot, rows: &Rows, description: &Description) -> bool {
    let masses = || Tried::new(&Physics::masses(robot)?, rows, description.clone());
    description.changes == [Change::WithoutGravity] && masses().is_some_and(|tried| tried.share() < WRONG_MASSES)
}
