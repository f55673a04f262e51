//! The extended model back in the simulator: the arm is driven along the measured held-out motion, in rapier or by the project's own
//! forward dynamics, and its motor torque compared with the measured one.
//!
//! The arm follows the filtered measured positions under computed torque of its own model with feedback, so that its torque
//! is that of the simulator's forward dynamics and not of the regression that found the model.

use super::extended::ExtendedModel;
use crate::channels::Channels;
use crate::diagnosis::logs::{Log, Rows};
use crate::diagnosis::regression::Column;
use crate::dynamics::Motion;
use crate::effects::Placed;
use crate::error::Result;
use crate::simulation::engine::EngineKind;
use crate::simulation::following::{Followed, follow, sensed};
use rayon::prelude::*;

/// Time after the start until the loop has settled, s.
const SETTLING_S: f64 = 0.5;

/// What a model leaves of the measured torque over the rows; rows in which the loop still settles are not in `valid`.
#[derive(Debug, Clone)]
pub(super) struct Resimulated {
    /// Measured less simulated torque.
    pub residual: Column,
    /// Rows that count, `[joint][row]`.
    pub valid: Vec<Vec<bool>>,
    /// Positions of the simulated arm along every log, `[joint][time]`, rad.
    pub positions: Vec<Channels>,
}

/// Runs `models` along the motions of all logs of `rows` under the forward dynamics of `engine`.
///
/// # Errors
/// If rapier does not take a model, or a simulation runs away; `models` are named by their place.
pub(super) fn resimulate(engine: EngineKind, models: &[&ExtendedModel], rows: &Rows) -> Result<Vec<Resimulated>> {
    let jobs: Vec<(usize, &Log)> =
        (0..models.len()).flat_map(|model| rows.logs.iter().map(move |log| (model, log))).collect();
    let runs: Vec<(Channels, Channels)> =
        jobs.into_par_iter().map(|(k, log)| along(engine, models[k], log)).collect::<Result<_>>()?;
    let mut valid = rows.valid.clone();
    for (log, &start) in rows.logs.iter().zip(&rows.starts) {
        let settling = log.blocks(&log.time).iter().filter(|&&t| t < log.time[0] + SETTLING_S).count();
        valid.iter_mut().for_each(|valid| valid[start..start + settling].fill(false));
    }
    let logs = runs.chunks_exact(rows.logs.len());
    Ok(logs
        .map(|logs| {
            let mut residual = Column::new(rows.torque.iter().cloned());
            let simulated = Column::new((0..rows.dof()).map(|joint| {
                let each = rows.logs.iter().zip(logs);
                each.flat_map(|(log, (torque, _))| log.as_logged(torque.channel(joint))).collect()
            }));
            residual.add(-1.0, &simulated);
            let positions = logs.iter().map(|(_, q)| q.clone()).collect();
            Resimulated { residual, valid: valid.clone(), positions }
        })
        .collect())
}

/// Motor torque as the sensors would log it, when the arm follows the motion of a log, and its positions, `[joint][time]`.
fn along(engine: EngineKind, model: &ExtendedModel, log: &Log) -> Result<(Channels, Channels)> {
    let motion = true_motion(&model.effects, log)?;
    let Followed { torque, q } = follow(engine, &model.robot, &model.effects, &motion, log.time[0], log.period)?;
    Ok((torque, q))
}

/// Where the joints really were when the encoders read the motion of a log.
fn true_motion(effects: &[Placed], log: &Log) -> Result<Motion> {
    let mut q = log.motion.q.clone();
    for placed in effects {
        for joint in sensed(placed, q.channels()) {
            let before = q.channel(joint).to_vec();
            placed.effect.distort_position(&placed.parameters, q.channel_mut(joint));
            q.channel_mut(joint).iter_mut().zip(before).for_each(|(x, q)| *x = 2.0 * q - *x);
        }
    }
    if q == log.motion.q { Ok(log.motion.clone()) } else { Log::motion_of(q, log.period) }
}
