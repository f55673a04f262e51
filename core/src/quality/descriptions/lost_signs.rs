//! Whether a torque lost its sign: with its sign restored, a model explains it clearly better, be it where the torque turns back at zero,
//! or where the model's torque changes its sign. Without that it looks like a torque with the wrong sign where it is negative for the
//! most part.

use super::change::{Change, Description};
use super::compare::{EXPLAINED, EXPLAINED_ALONE, compare};
use super::fitting::{Fit, Physics, Rows};
use super::tried::Tried;
use crate::error::Result;
use crate::linear::root_mean_square;
use crate::quality::channels::extremes;
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

/// The signs follow the model, and the model the signs, so many times: they settle in two or three.
const PASSES: usize = 6;

/// A torque is beyond zero where it is this many times the residual: one that is right and stays at zero is on either side by chance.
const BEYOND: f64 = 3.0;

/// So many rows, which are a twentieth of a second apart, on the side that the torque does not have: one short peak of a model is none.
const LEAST_ROWS: usize = 5;

/// Joints whose torque lost its sign although a description takes it for a wrong one, of all logs or of each: it is on one side of zero in
/// all logs, the model's torque is on both, and explains it clearly better so than with either sign. `found` are the descriptions of the
/// logs. Those that are `known` from a log to have none have none in the others either.
pub(crate) fn without_sign(
    views: &[&View],
    robot: &Robot,
    found: &[Option<&Description>],
    known: &[usize],
) -> Vec<usize> {
    let is_turned = |joint: usize, own: &Option<&Description>| {
        own.is_some_and(|description| description.changes.contains(&Change::TorqueSign(joint)))
    };
    let is_doubtful = |&joint: &usize| {
        (known.contains(&joint) || found.iter().any(|own| is_turned(joint, own))) && is_one_sided(views, joint)
    };
    let mut joints: Vec<usize> = (0..robot.dof()).filter(is_doubtful).collect();
    if joints.iter().all(|joint| known.contains(joint)) {
        return joints;
    }
    let Some(rows) = Rows::new(views, Some(robot)) else { return Vec::new() };
    let physics = Physics::free(robot);
    joints.retain(|&joint| {
        let signs: Vec<f64> = found.iter().map(|own| if is_turned(joint, own) { -1.0 } else { 1.0 }).collect();
        known.contains(&joint) || is_lost(&physics, &rows, robot, joint, &signs).unwrap_or(false)
    });
    joints
}

/// Whether a torque is never negative, or never positive, in all logs that have it.
fn is_one_sided(views: &[&View], joint: usize) -> bool {
    let torques = views.iter().map(|view| view.log.tau.channel(joint));
    let measured = torques.filter(|tau| tau.iter().any(|v| *v != 0.0 && v.is_finite()));
    let ends: Vec<(f64, f64)> = measured.map(extremes).collect();
    !ends.is_empty() && (ends.iter().all(|(low, _)| *low >= 0.0) || ends.iter().all(|(_, high)| *high <= 0.0))
}

/// Whether the torque of a joint is explained clearly better with the signs that a model gives it, row by row, than with either sign
/// throughout; `signs` are those that the logs seem to have.
fn is_lost(physics: &Physics, rows: &Rows, robot: &Robot, joint: usize, signs: &[f64]) -> Option<bool> {
    let given = Description::as_given(robot.dof(), robot.gravity);
    let with = |sign: &dyn Fn(usize) -> f64| {
        let mut own = rows.clone();
        own.tau.channel_mut(joint).iter_mut().enumerate().for_each(|(row, torque)| *torque = sign(row) * torque.abs());
        own
    };
    let model = |rows: &Rows| {
        let parameters = Fit::new(&physics.tables(rows, &given), rows, &given).parameters()?;
        Some(physics.predicted(rows, &given, joint, &parameters))
    };
    let side = if rows.tau.channel(joint).iter().sum::<f64>() < 0.0 { -1.0 } else { 1.0 };
    let mut restored = with(&|row| side * signs[rows.log[rows.block[row]]]);
    let mut torque = model(&restored)?;
    for _ in 0..PASSES {
        restored = with(&|row| torque[row].signum());
        torque = model(&restored)?;
    }
    let own = restored.tau.channel(joint);
    let valid: Vec<usize> = (0..torque.len()).filter(|&row| rows.moves[joint][row]).collect();
    let residual: Vec<f64> = valid.iter().map(|&row| own[row] - torque[row]).collect();
    let clear = BEYOND * root_mean_square(&residual);
    let beyond = |side: f64| valid.iter().filter(|&&row| side * own[row] > clear && side * torque[row] > clear).count();
    if beyond(1.0).min(beyond(-1.0)) < LEAST_ROWS {
        return Some(false);
    }
    let tried = |rows: &Rows| Tried::new(physics, rows, given.clone());
    let lost = tried(&restored)?;
    let is_better = |sign: f64| {
        let gain = compare(&tried(&with(&|_| sign))?.evaluation, &lost.evaluation, &rows.log)?;
        Some(gain.is_distinct() || gain.falls(joint))
    };
    let explained = lost.evaluation.unexplained[joint].is_some_and(|share| share < EXPLAINED);
    Some(explained && is_better(1.0)? && is_better(-1.0)?)
}
