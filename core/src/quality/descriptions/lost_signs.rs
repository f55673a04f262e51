//! Whether a torque that turns back at zero lost its sign there: with its sign restored, a model explains it clearly better.

use super::change::Description;
use super::compare::{EXPLAINED, EXPLAINED_ALONE, compare};
use super::fitting::{Physics, Rows};
use super::tried::Tried;
use crate::error::Result;
use crate::quality::view::View;
use crate::recording::Recording;
use crate::robot::Robot;
use nalgebra::Vector3;

/// The sign that is lost is that of the parts between visits, or that of the others.
const SIGNS: [f64; 2] = [1.0, -1.0];

/// Whether the torque of a joint, whose sign changes at the samples of one of `turns`, is explained clearly better with that than as it is
/// logged: by free bodies where the arm is known, else by a joint of its own.
///
/// # Errors
/// Those of the filters.
pub(crate) fn is_explained_with_signs(
    log: &Recording,
    robot: Option<&Robot>,
    joint: usize,
    turns: &[Vec<usize>],
) -> Result<bool> {
    let physics = robot.map_or(Physics::Alone, Physics::free);
    let limit = if robot.is_some() { EXPLAINED } else { EXPLAINED_ALONE };
    let gravity = robot.map_or(Vector3::zeros(), |robot| robot.gravity);
    let tried = |log: &Recording| -> Result<Option<(Tried, Vec<usize>)>> {
        let Some(rows) = Rows::new(&[&View::new(log, robot)?], robot) else { return Ok(None) };
        let tried = Tried::new(&physics, &rows, Description::as_given(log.joints(), gravity));
        Ok(tried.map(|tried| (tried, rows.log)))
    };
    let Some((as_logged, blocks)) = tried(log)? else { return Ok(false) };
    for (turns, sign) in turns.iter().flat_map(|turns| SIGNS.map(|sign| (turns, sign))) {
        let mut restored = log.clone();
        let changed = |sample: usize| turns.iter().filter(|&&turn| turn <= sample).count() % 2 == 1;
        for (sample, torque) in restored.tau.channel_mut(joint).iter_mut().enumerate() {
            *torque *= if changed(sample) { -sign } else { sign };
        }
        let gains = |(own, _): (Tried, Vec<usize>)| {
            let gain = compare(&as_logged.evaluation, &own.evaluation, &blocks);
            let explained = own.evaluation.unexplained[joint].is_some_and(|share| share < limit);
            explained && gain.is_some_and(|gain| gain.is_better(SIGNS.len(), limit) && gain.is_distinct())
        };
        if tried(&restored)?.is_some_and(gains) {
            return Ok(true);
        }
    }
    Ok(false)
}
