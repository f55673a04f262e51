//! Motor currents, or percent of rated torques, in the place of torques: the torque constants with which the described bodies explain them.
//!
//! Each motor has its own constant, so the bodies of every joint are fitted in a unit of their own. What else is wrong with the description
//! is searched for in the same way.

use super::super::change::Description;
use super::super::fitting::{Fit, Physics, Rows};
use super::super::known::Known;
use super::super::search::search;
use super::super::shares::ALIKE;
use super::super::tried::Tried;
use crate::robot::Robot;

/// Standard error over value up to which the constant of a joint is known: friction alone makes the current of some joints.
const KNOWN: f64 = 0.15;

/// Currents with the torque constants that were found.
pub(crate) struct Currents {
    /// The currents taken as torques of the described bodies.
    pub before: Tried,
    /// With the constants, and what is wrong besides.
    pub after: Tried,
    /// Amperes per torque of every joint, where the logs determine it.
    pub factors: Vec<Option<f64>>,
}

/// The torque constants of `robot`; none where the described bodies do not explain the currents with any.
pub(crate) fn constants(robot: &Robot, rows: &Rows, with_motion: &[bool], start: &Description) -> Option<Currents> {
    let (bodies, multiples) = (Physics::bodies(robot)?, Physics::multiples(robot)?);
    let found = search(Known::alone(&multiples), rows, with_motion, start.clone())?.found;
    let others = found.map_or_else(|| start.clone(), |found| found.best.description.without_scales());
    let mut after = Tried::new(&multiples, rows, others.clone())?;
    if after.share() >= ALIKE {
        return None;
    }
    let tables = multiples.tables(rows, &others);
    let places: Vec<usize> = (0..robot.dof()).collect();
    let estimates = Fit::new(&tables, rows, &others).with_errors(&places)?;
    let factors: Vec<Option<f64>> = estimates.into_iter().map(known).collect();
    let mut sizes: Vec<f64> = factors.iter().flatten().copied().collect();
    sizes.sort_by(f64::total_cmp);
    let usual = *sizes.get(sizes.len() / 2)?;
    let all: Vec<f64> = factors.iter().map(|factor| factor.unwrap_or(usual)).collect();
    after.description = others.with_scales(usual, &all);
    after.description.scale_is_partial = sizes.len() < factors.len();
    Some(Currents { before: Tried::new(&bodies, rows, start.clone())?, after, factors })
}

/// An estimate whose standard error is small.
fn known((value, error): (f64, f64)) -> Option<f64> {
    (value > 0.0 && error < KNOWN * value).then_some(value)
}

#[cfg(test)]
mod tests {
    use super::known;

    #[test]
    fn a_constant_is_known_where_its_error_is_small() {
        assert_eq!([(2.0, 0.29), (2.0, 0.31), (0.0, 0.0)].map(known), [Some(2.0), None, None]);
    }
}
