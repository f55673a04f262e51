//! Torques of gravity alone, as controllers compute them: those of the arm at rest at every position that it passes.
//!
//! They are commanded while a hand guides the arm, or logged by a controller in the place of measured ones. Inertia and friction are not in
//! them, so that no description of the motion explains them, and a search would name the one that comes nearest.

use super::super::change::Description;
use super::super::compare::{EXPLAINED, compare};
use super::super::fitting::{Physics, Rows};
use super::super::shares::WRONG_MASSES;
use super::super::tried::Tried;
use crate::quality::finding::{Finding, Kind, Severity};
use crate::quality::view::View;
use crate::robot::Robot;

/// Shares of the torques that free bodies leave unexplained along the motion and at rest, where the torques of some logs are those of gravity
/// alone. Slow logs, in which both explain them, are not.
pub(in super::super) fn judged(views: &[&View], robot: &Robot) -> Option<[f64; 2]> {
    let rows = Rows::new(views, Some(robot)).filter(|_| robot.gravity.norm() > 0.0)?;
    let start = Description::as_given(robot.dof(), robot.gravity);
    let free = Physics::free(robot);
    let moving = Tried::new(&free, &rows, start.clone())?;
    if moving.share() < WRONG_MASSES {
        return None;
    }
    let rows = Rows { at_rest: true, ..rows };
    let still = Tried::new(&free, &rows, start)?;
    let gain = compare(&moving.evaluation, &still.evaluation, &rows.log)?;
    tracing::debug!(moving = moving.share(), still = still.share(), gain = gain.gain, p = gain.p, "at rest");
    let explains = still.explains_half() && still.share() < WRONG_MASSES;
    (explains && gain.is_better(1, EXPLAINED) && gain.is_large(1)).then(|| [moving.share(), still.share()])
}

/// What is said of torques that are those of gravity alone.
pub(crate) fn finding([moving, still]: [f64; 2]) -> Finding {
    let [still, moving] = super::super::findings::apart(still, moving);
    let text = format!(
        "the torques are those of gravity alone: without the inertia of this motion {still} of them stays unexplained on parts held out, and with \
         it {moving}. They are computed by a controller, as while a hand guides the arm, and are not those that make this motion; log measured torques or \
         currents of a motion that the drives make"
    );
    Finding::new(Kind::GravityAlone, Severity::Warning, "tau", text)
}
