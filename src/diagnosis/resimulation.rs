//! The extended model back in the simulator: rapier is driven along the measured held-out motion, and its motor torque
//! compared with the measured one.
//!
//! The arm follows the filtered measured positions under computed torque of its own model with feedback, so that its torque
//! is that of the simulator's forward dynamics and not of the regression that found the model.

use super::column::Column;
use super::extended::ExtendedModel;
use super::rows::{Log, Rows};
use crate::channels::Channels;
use crate::dynamics::Motion;
use crate::effects::{Placed, Scope, Site};
use crate::error::{Error, Result};
use crate::simulation::controller::ComputedTorque;
use crate::simulation::integrator::{Integrator, Run};
use crate::simulation::measured_motion::MeasuredMotion;
use crate::simulation::plant::{Plant, State};
use rayon::prelude::*;

/// Closed loop that keeps the arm on the motion: stiff enough that it follows, soft enough not to shake elastic gears.
const BANDWIDTH_HZ: f64 = 8.0;
const DAMPING_RATIO: f64 = 1.0;

/// Longest time step, s.
const LONGEST_STEP_S: f64 = 0.002;

/// Time after the start until the loop has settled, s.
const SETTLING_S: f64 = 0.5;

/// Speed that no joint reaches unless the simulation runs away.
const RUNAWAY_SPEED: f64 = 1e4;

/// What a model leaves of the measured torque over the rows; rows in which the loop still settles are not in `valid`.
#[derive(Debug, Clone)]
pub struct Resimulated {
    /// Measured less simulated torque.
    pub residual: Column,
    /// Rows that count, `[joint][row]`.
    pub valid: Vec<Vec<bool>>,
    /// Positions of the simulated arm along every log, `[joint][time]`, rad.
    pub positions: Vec<Channels>,
}

/// Runs `models` along the motions of all logs of `rows`.
///
/// # Errors
/// If rapier does not take a model, or a simulation runs away; `models` are named by their place.
pub fn resimulate(models: &[&ExtendedModel], rows: &Rows) -> Result<Vec<Resimulated>> {
    let jobs: Vec<(usize, &Log)> =
        (0..models.len()).flat_map(|model| rows.logs.iter().map(move |log| (model, log))).collect();
    let runs: Vec<(Channels, Channels)> =
        jobs.into_par_iter().map(|(k, log)| along(models[k], log)).collect::<Result<_>>()?;
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
                each.flat_map(|(log, (torque, _))| log.blocks(torque.channel(joint))).collect()
            }));
            residual.add(-1.0, &simulated);
            let positions = logs.iter().map(|(_, q)| q.clone()).collect();
            Resimulated { residual, valid: valid.clone(), positions }
        })
        .collect())
}

/// Motor torque as the sensors would log it, when the arm follows the motion of a log, and its positions, `[joint][time]`.
fn along(model: &ExtendedModel, log: &Log) -> Result<(Channels, Channels)> {
    let mut robot = model.robot.clone();
    // Whatever the description says of the drives: the motion was made.
    robot.joints.iter_mut().for_each(|joint| joint.limits.effort = f64::INFINITY);
    let (robot, dof) = (&robot, robot.dof());
    let motion = true_motion(&model.effects, log)?;
    let reference = MeasuredMotion::new(&motion, log.time[0], log.period);
    let controller = ComputedTorque::new(robot, &reference, BANDWIDTH_HZ, DAMPING_RATIO);
    let mut effects = crate::scenario::drive_friction(robot);
    effects.extend(model.effects.iter().cloned());
    let native = model.effects.iter().find(|placed| placed.effect.about().site == Site::Integrator);
    let steps = match native {
        Some(placed) => (log.period / placed.parameters[0]).round().max(1.0),
        None => (log.period / LONGEST_STEP_S - 1e-9).ceil().max(1.0),
    };
    let integrator = if native.is_some() { Integrator::RapierNative } else { Integrator::Rk4 };
    let step = log.period / steps;
    let mut plant = Plant::new(robot, effects)?;
    let first = |table: &Channels| (0..dof).map(|joint| table.channel(joint)[0]).collect::<Vec<f64>>();
    let mut state: State = plant.resting(first(&motion.q));
    (state.qd, state.link_qd) = (first(&motion.qd), first(&motion.qd));
    let mut run = Run::starting_at(log.time[0], &mut plant, &controller, state);
    let mut torque = Channels::zeros(dof, log.time.len());
    let mut q = torque.clone();
    for sample in 0..log.time.len() {
        for substep in 0..steps as usize {
            let response = run.response();
            if substep == 0 {
                torque.set(sample, &response.tau);
                q.set(sample, &run.state().q);
                let runs_away = |j: usize| !(response.tau[j].is_finite() && run.state().qd[j].abs() < RUNAWAY_SPEED);
                if let Some(joint) = (0..dof).find(|&j| runs_away(j)) {
                    let problem =
                        format!("the simulation along the held-out motion ran away at {:.3} s", log.time[sample]);
                    return Err(Error::request(&robot.joints[joint].name, problem));
                }
            }
            let time = log.time[0] + (sample as f64 * steps + substep as f64 + 1.0) * step;
            run.advance(integrator, &response, time);
        }
    }
    for placed in &model.effects {
        for joint in sensed(placed, dof) {
            placed.effect.distort_torque(&placed.parameters, torque.channel_mut(joint), log.period);
        }
    }
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

/// Joints whose sensors an effect may distort.
fn sensed(placed: &Placed, dof: usize) -> Vec<usize> {
    if placed.effect.about().scope == Scope::Arm { (0..dof).collect() } else { placed.joints() }
}
