//! The direction of gravity by all logs, where the description of the base was corrected.

use crate::diagnosis::Options;
use crate::diagnosis::logs::Input;
use crate::diagnosis::model::{Candidate, Known, all_candidates};
use crate::diagnosis::preparation::prepare;
use crate::diagnosis::regression::Column;
use crate::effects::{LIBRARY, Placed};
use crate::error::Result;
use crate::identification::model::Model;
use crate::recording::Recording;
use crate::robot::Robot;
use nalgebra::Vector3;

/// The gravity of the base as the logs show it, where it differs significantly from that of the arm: the tilt of the base is fitted together
/// with a constant torque of every joint, which amplifiers and hoses add and which gravity would otherwise take up.
///
/// # Errors
/// If a log is too short or a joint hardly moves.
pub(super) fn refined_gravity(model: &Model, input: &Input, options: &Options) -> Result<Option<Vector3<f64>>> {
    let robot = model.robot();
    let known = Known { effects: input.present.clone(), ..Known::nothing(robot, options.trust) };
    let logs: Vec<&Recording> = input.train.iter().chain(&input.test).chain(&input.reference).copied().collect();
    let session = prepare(model, options.trust, known, &logs, &logs, options.criteria)?;
    let is_asked = |placed: &Placed| placed.effect.is_constant() || gravity_under(placed, robot) != robot.gravity;
    let asked = LIBRARY.iter().map(|effect| Placed::typical(*effect, 0)).filter(is_asked);
    let names: Vec<String> = asked.map(|placed| placed.effect.about().name.to_owned()).collect();
    let train = &session.logs.train;
    let candidates = all_candidates(&session.model.arm, &train.rows, session.model.asked(&names))?;
    let (constant, tilts): (Vec<Candidate>, Vec<Candidate>) =
        candidates.into_iter().partition(|candidate| candidate.placed.effect.is_constant());
    let constant = constant.iter().flat_map(|candidate| candidate.columns.iter());
    let present: Vec<Column> = train.baseline.iter().chain(constant).cloned().collect();
    let whitener = session.noise_under(&present);
    let fit = whitener.fit(&present, &train.torque);
    let judged = tilts.iter().filter_map(|candidate| session.judge(candidate, &whitener, &fit));
    let Some(best) = judged.min_by(|a, b| a.test.log_p().total_cmp(&b.test.log_p())) else { return Ok(None) };
    let best = session.refined(best, &whitener, &fit)?;
    let gravity = gravity_under(&best.member().placed, robot);
    tracing::debug!(?gravity, log_p = best.test.log_p(), "direction of gravity by all logs");
    Ok((best.test.log_p() < options.criteria.levels.sure_p.ln()).then_some(gravity))
}

/// The gravity of the arm with an effect.
fn gravity_under(placed: &Placed, robot: &Robot) -> Vector3<f64> {
    let mut altered = robot.clone();
    placed.effect.alter(&placed.parameters, placed.joint, &mut altered);
    altered.gravity
}
