//! A torque from which a controller takes the gravity of the described bodies, whose masses are not quite the arm's: a part of gravity is left in it,
//! which is that of no direction and of no bodies.

use super::super::change::{Change, Description};
use super::super::compare::{EXPLAINED, compare};
use super::super::fitting::{Physics, Rows};
use super::super::shares::{ALIKE, FEWEST, MORE_THAN_ALL, WRONG_MASSES};
use super::super::tried::Tried;
use crate::robot::Robot;

/// The logs as they are and without the gravity of the described `bodies`, where bodies of any masses explain the torques clearly better by that, and
/// those described do not explain them as they are.
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
    (after.share() < WRONG_MASSES && gain.is_better(1, EXPLAINED) && gain.is_large(1)).then_some([before, after])
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
