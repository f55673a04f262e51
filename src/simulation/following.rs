//! An arm in the simulator that follows a motion that was measured: its motor torque is that of forward dynamics, and can
//! be compared with the measured torque.

use super::controller::ComputedTorque;
use super::engine::EngineKind;
use super::integrator::{Integrator, Run};
use super::measured_motion::MeasuredMotion;
use super::plant::{Plant, State};
use crate::channels::Channels;
use crate::diagnosis::{Engine, Followed, Simulator};
use crate::dynamics::Motion;
use crate::effects::{Placed, Site, drive_friction};
use crate::error::{Error, Result};
use crate::robot::Robot;

/// Closed loop that keeps the arm on the motion: stiff enough that it follows, soft enough not to shake elastic gears.
const BANDWIDTH_HZ: f64 = 8.0;
const DAMPING_RATIO: f64 = 1.0;

/// Longest time step, s.
const LONGEST_STEP_S: f64 = 0.002;

/// Speed that no joint reaches unless the simulation runs away.
const RUNAWAY_SPEED: f64 = 1e4;

impl Simulator for EngineKind {
    fn engine(&self, robot: &Robot) -> Engine {
        let kind = self.of(robot);
        let key = match kind {
            EngineKind::Rapier => "rapier",
            EngineKind::Recursive => "recursive",
        };
        Engine { key, name: kind.name() }
    }

    fn follow(&self, robot: &Robot, effects: &[Placed], motion: &Motion, start: f64, period: f64) -> Result<Followed> {
        follow(*self, robot, effects, motion, start, period)
    }
}

/// Lets `robot`, with `effects` in addition to the friction of its drives, follow `motion` (where the joints really were; the first
/// sample at `start`, `period` seconds apart) under computed torque of its own model with feedback. Rapier's own time step, if it is
/// among the effects, takes rapier whatever the `engine`.
///
/// # Errors
/// If rapier does not take the arm, or the simulation runs away.
pub(crate) fn follow(
    engine: EngineKind,
    robot: &Robot,
    effects: &[Placed],
    motion: &Motion,
    start: f64,
    period: f64,
) -> Result<Followed> {
    let mut robot = robot.clone();
    // Whatever limits the description gives the drives: the motion was made.
    robot.joints.iter_mut().for_each(|joint| joint.limits.effort = f64::INFINITY);
    let (robot, dof) = (&robot, robot.dof());
    let reference = MeasuredMotion::new(motion, start, period);
    let controller = ComputedTorque::new(robot, &reference, BANDWIDTH_HZ, DAMPING_RATIO);
    let mut acting = drive_friction(robot);
    acting.extend(effects.iter().cloned());
    let native = effects.iter().find(|placed| placed.effect.about().site == Site::Integrator);
    let steps = match native {
        Some(placed) => (period / placed.parameters[0]).round().max(1.0),
        None => (period / LONGEST_STEP_S - 1e-9).ceil().max(1.0),
    };
    let (integrator, engine) =
        if native.is_some() { (Integrator::RapierNative, EngineKind::Rapier) } else { (Integrator::Rk4, engine) };
    let step = period / steps;
    let mut plant = Plant::with_engine(engine, robot, acting)?;
    let first = |table: &Channels| (0..dof).map(|joint| table.channel(joint)[0]).collect::<Vec<f64>>();
    let mut state: State = plant.resting(first(&motion.q));
    (state.qd, state.link_qd) = (first(&motion.qd), first(&motion.qd));
    let mut run = Run::starting_at(start, &mut plant, &controller, state);
    let samples = motion.samples();
    let mut torque = Channels::zeros(dof, samples);
    let mut q = torque.clone();
    for sample in 0..samples {
        for substep in 0..steps as usize {
            let response = run.response();
            if substep == 0 {
                torque.set(sample, &response.tau);
                q.set(sample, &run.state().q);
                let runs_away = |j: usize| !(response.tau[j].is_finite() && run.state().qd[j].abs() < RUNAWAY_SPEED);
                if let Some(joint) = (0..dof).find(|&j| runs_away(j)) {
                    let at = start + sample as f64 * period;
                    let problem = format!("the simulation along the held-out motion ran away at {at:.3} s");
                    return Err(Error::request(&robot.joints[joint].name, problem));
                }
            }
            let time = start + (sample as f64 * steps + substep as f64 + 1.0) * step;
            run.advance(integrator, &response, time);
        }
    }
    for placed in effects {
        for joint in placed.sensed(dof) {
            placed.effect.distort_torque(&placed.parameters, torque.channel_mut(joint), period);
        }
    }
    Ok(Followed { torque, q })
}
