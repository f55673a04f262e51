//! Weights for which constants of the drives make up.
//!
//! The weight on a joint that slides is constant, and so is a part of its drive's torque: no residual shows that an arm hangs from a
//! ceiling, or that a slide is upright. The drive then needs a constant force that no drive has. Only a part of the weight may be
//! one, which a balancer takes off.

use super::change::{Change, Description, along_axes};
use super::compare::compare;
use super::fitting::{Fit, Physics, Rows};
use super::shares::ALIKE;
use super::tried::Tried;
use super::verdict::Shown;
use crate::dynamics::{Chain, Motion, inverse_dynamics};
use crate::linear::root_mean_square;
use crate::robot::Robot;

/// Under any direction of gravity a weight varies over the log by less than this share of its size: one on a joint that others turn varies
/// by more, and residuals decide about it.
const VARIES: f64 = 0.05;

/// A weight counts from this share of the root mean square torque of its joint: offsets of drives come to a few hundredths of that.
const HEAVY: f64 = 0.3;

/// Share of the weight above which a constant, less what a balancer may take off, is none of a drive, and below which it is: described
/// masses may be wrong by half.
pub(super) const OF_WEIGHT: f64 = 0.5;

/// A changed description may leave the limits of a joint by so much more than the given one, m.
const LEAVES: f64 = 0.01;

/// Descriptions under which no drive needs a constant beyond its weight.
pub(super) struct Weighed {
    /// The logs as they are.
    pub before: Tried,
    /// The changed descriptions, of which the logs allow each; at least one.
    pub after: Vec<Tried>,
    /// What the drive would need as described.
    pub shown: Shown,
}

/// The weights on the joints that slide, where nothing but a constant of their drives holds them.
struct Slides<'a> {
    bodies: &'a Physics,
    robot: &'a Robot,
    rows: &'a Rows,
    /// What hangs on every joint at most, over the directions of gravity along the axes of the base; none where it does not count.
    heaviest: Vec<Option<f64>>,
}

impl<'a> Slides<'a> {
    fn new(bodies: &'a Physics, rows: &'a Rows, start: &Description) -> Option<Slides<'a>> {
        let Physics::Bodies(robot) = bodies else { return None };
        let each: Vec<Vec<Weight>> =
            directions(start).map(|gravity| weights(robot, rows, &start.with(gravity))).collect();
        let heaviest = |joint: usize| {
            let size = each.iter().map(|of| of[joint].size.abs()).fold(0.0, f64::max);
            let varies = each.iter().map(|of| of[joint].varies).fold(0.0, f64::max);
            let torque = rows.size[start.torque_of[joint]];
            let slides = !rows.turns[joint] && rows.measured[start.torque_of[joint]];
            (slides && varies < VARIES * size && size > HEAVY * torque).then_some(size)
        };
        Some(Slides { bodies, robot, rows, heaviest: (0..start.dof()).map(heaviest).collect() })
    }

    /// The joints whose weights count, each with the constant of its drive in a fit and the heaviest weight on it.
    fn constants(&self, description: &Description) -> Option<Vec<(usize, f64, f64)>> {
        let whole = self.rows.whole();
        let tables = self.bodies.tables(&whole, description);
        let constants = Fit::new(&tables, &whole, description).constants()?;
        let of = |(joint, constant): (usize, f64)| Some((joint, constant, self.heaviest[joint]?));
        Some(constants.into_iter().filter_map(of).collect())
    }

    /// The constant that is most beyond what a balancer makes, with its joint, and its share of the heaviest weight beyond that.
    fn worst(&self, description: &Description) -> Option<(usize, f64, f64)> {
        let given = weights(self.robot, self.rows, description);
        let excess = |(joint, constant, heaviest): (usize, f64, f64)| {
            (joint, constant, beyond_balance(constant, given[joint].size) / heaviest)
        };
        self.constants(description)?.into_iter().map(excess).max_by(|a, b| a.2.total_cmp(&b.2))
    }
}

/// Gravity along each axis of the base.
fn directions(start: &Description) -> impl Iterator<Item = Change> {
    let size = start.gravity.norm();
    along_axes([size, -size]).map(Change::Gravity)
}

/// The part of a weight by which the drive of a joint that slides pushes beyond what a balancer could; zero where no such joint is. None
/// where nothing can be fitted.
pub(super) fn beyond_weight(bodies: &Physics, rows: &Rows, description: &Description) -> Option<f64> {
    let slides = Slides::new(bodies, rows, description)?;
    match slides.heaviest.iter().flatten().next() {
        Some(_) => slides.worst(description).map(|(.., excess)| excess),
        None => Some(0.0),
    }
}

/// Other directions of gravity, or of an axis, under which the logs are explained as well and drives need no constants; none where those of
/// the given description may be a drive's.
pub(super) fn weighed(bodies: &Physics, rows: &Rows, start: &Description) -> Option<Weighed> {
    let slides = Slides::new(bodies, rows, start)?;
    let worst = slides.worst(start).filter(|(.., excess)| *excess >= OF_WEIGHT)?;
    let before = Tried::new(bodies, rows, start.clone())?;
    let beyond = |description: &Description| -> f64 {
        let positions = description.positions(&rows.motion.q);
        let of = |joint: usize| rows.beyond_limits(joint, positions.channel(joint)).max(0.0);
        (0..description.dof()).map(of).fold(0.0, f64::max)
    };
    let changes = directions(start).chain([Change::AxisSign(worst.0)]);
    let after: Vec<Tried> = changes
        .map(|change| start.with(change))
        .filter(|changed| !changed.same_as(start) && beyond(changed) < beyond(start) + LEAVES)
        .filter(|changed| {
            let small = |(_, constant, heaviest): &(usize, f64, f64)| constant.abs() < OF_WEIGHT * heaviest;
            slides.constants(changed).is_some_and(|constants| constants.iter().all(small))
        })
        .filter_map(|changed| Tried::new(bodies, rows, changed))
        .filter(|tried| {
            let worse = compare(&tried.evaluation, &before.evaluation, &rows.log).is_none_or(|loss| loss.is_distinct());
            tried.share() < ALIKE && !worse
        })
        .collect();
    let (joint, constant, _) = worst;
    let shown = Shown::Constant { joint, constant, weight: slides.heaviest[joint]? };
    (!after.is_empty()).then_some(Weighed { before, after, shown })
}

/// By how much a constant is beyond what a balancer makes, which takes off the weight or a part of it.
fn beyond_balance(constant: f64, weight: f64) -> f64 {
    (constant - constant.clamp((-weight).min(0.0), (-weight).max(0.0))).abs()
}

/// The torque of gravity on a joint over a log.
#[derive(Debug, Clone, Copy)]
struct Weight {
    /// Its mean.
    size: f64,
    /// Root mean square of what varies.
    varies: f64,
}

/// The torque of gravity on every joint under a description.
fn weights(robot: &Robot, rows: &Rows, description: &Description) -> Vec<Weight> {
    let motion = Motion::at_rest(description.positions(&rows.motion.q));
    let chain = Chain::new(robot).with_gravity(description.gravity.into());
    let of = |torque: &[f64]| {
        let size = torque.iter().sum::<f64>() / torque.len().max(1) as f64;
        let varies: Vec<f64> = torque.iter().map(|own| own - size).collect();
        Weight { size, varies: root_mean_square(&varies) }
    };
    inverse_dynamics(&chain, &robot.inertial_parameters(), &motion).iter().map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_balancer_takes_off_the_weight_and_no_more() {
        let of = |constant: f64| beyond_balance(constant, 14.0);
        assert_eq!([of(-14.0), of(-7.0), of(0.0)], [0.0; 3]);
        assert_eq!([of(-28.0), of(3.0)], [14.0, 3.0]);
        assert_eq!([beyond_balance(5.0, 0.0), beyond_balance(14.0, -14.0)], [5.0, 0.0]);
    }
}
