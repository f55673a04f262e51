//! A scenario in motion: its plant driven along a reference, and what its sensors make of that.

use super::Setup;
use crate::channels::Channels;
use crate::effects::Scope;
use crate::error::{Error, Result};
use crate::excitation::Reference;
use crate::random;
use crate::recording::{Recording, Signals};
use crate::signal;
use crate::simulation::Truth;
use crate::simulation::controller::ComputedTorque;
use crate::simulation::engine::EngineKind;
use crate::simulation::integrator::Run;
use crate::simulation::plant::Plant;
use crate::simulation::sensors;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Speed (rad/s or m/s) that no joint reaches unless the simulation runs away.
const RUNAWAY_SPEED: f64 = 1e4;

/// Drives the plant of `setup` along `reference` and logs what happens. `tick` receives the number of samples done.
///
/// # Errors
/// If the plant cannot be built, or the motion runs away (speeds beyond any joint's, numbers no longer finite).
pub fn simulate(setup: &Setup, reference: &dyn Reference, tick: &mut dyn FnMut(usize)) -> Result<Truth> {
    simulate_with(EngineKind::Rapier, setup, reference, tick)
}

/// [`simulate`] with another engine than rapier.
///
/// # Errors
/// As [`simulate`].
pub fn simulate_with(
    engine: EngineKind,
    setup: &Setup,
    reference: &dyn Reference,
    tick: &mut dyn FnMut(usize),
) -> Result<Truth> {
    let scenario = &setup.scenario;
    let dof = setup.plant.dof();
    let per_sample = scenario.steps_per_sample();
    let samples = scenario.samples(reference.duration_s());
    let controller = ComputedTorque::new(
        &setup.nominal,
        reference,
        scenario.controller.bandwidth_hz,
        scenario.controller.damping_ratio,
    );
    let mut plant = Plant::with_engine(engine, &setup.plant, setup.effects.clone())?;
    let start = plant.resting(start_position(reference));
    let mut run = Run::new(&mut plant, &controller, start);
    let zeros = || Channels::zeros(dof, samples);
    let mut time = Vec::with_capacity(samples);
    let mut signals = Signals { q: zeros(), qd: zeros(), qdd: zeros(), tau: zeros() };
    let mut friction = zeros();
    for sample in 0..samples {
        let first_step = sample * per_sample;
        let mut response = run.response();
        time.push(first_step as f64 * scenario.plant.step_s);
        signals.q.set(sample, &run.state().q);
        signals.qd.set(sample, &run.state().qd);
        signals.qdd.set(sample, &response.qdd);
        signals.tau.set(sample, &response.tau);
        friction.set(sample, &response.friction);
        let sane = |j: usize| {
            let numbers = [run.state().q[j], response.qdd[j], response.tau[j]];
            numbers.iter().all(|v| v.is_finite()) && run.state().qd[j].abs() < RUNAWAY_SPEED
        };
        if let Some(joint) = (0..dof).find(|&j| !sane(j)) {
            let problem = format!(
                "the simulation ran away at t = {:.3} s; lower controller.bandwidth_hz or plant.step_s",
                time[sample]
            );
            return Err(Error::request(&setup.plant.joints[joint].name, problem));
        }
        tick(sample + 1);
        if sample + 1 == samples {
            break;
        }
        for step in first_step..first_step + per_sample {
            if step > first_step {
                response = run.response();
            }
            run.advance(scenario.plant.integrator, &response, (step + 1) as f64 * scenario.plant.step_s);
        }
    }
    Ok(Truth { time, signals: Arc::new(signals), friction })
}

/// Where a motion starts, from rest.
fn start_position(reference: &dyn Reference) -> Vec<f64> {
    let zeros = || vec![0.0; reference.joints()];
    let (mut q, mut qd, mut qdd) = (zeros(), zeros(), zeros());
    reference.at(0.0, &mut q, &mut qd, &mut qdd);
    q
}

/// Positions and torques as the effects in the sensors leave them, before noise.
fn distorted<'a>(setup: &Setup, truth: &'a Truth, period: f64) -> (Cow<'a, Channels>, Cow<'a, Channels>) {
    let (mut q, mut tau) = (Cow::Borrowed(&truth.signals.q), Cow::Borrowed(&truth.signals.tau));
    for placed in &setup.effects {
        let joints =
            if placed.effect.about().scope == Scope::Arm { (0..q.channels()).collect() } else { placed.joints() };
        for joint in joints {
            placed.effect.distort_position(&placed.parameters, q.to_mut().channel_mut(joint));
            placed.effect.distort_torque(&placed.parameters, tau.to_mut().channel_mut(joint), period);
        }
    }
    (q, tau)
}

/// What the sensors of `setup` make of a run, with velocity and acceleration as differences of the positions where nothing measures
/// them; `run` numbers the noise, so that two motions never share it.
///
/// # Errors
/// If the run is too short to differentiate.
pub fn measure(setup: &Setup, truth: &Truth, run: u64) -> Result<Recording> {
    let mut log = sensed(setup, truth, run)?;
    let period = 1.0 / setup.scenario.sensors.rate_hz;
    let mut qdd = Channels::zeros(log.q.channels(), log.q.samples());
    for (joint, position) in log.q.iter().enumerate() {
        signal::second_derivative(position, period, qdd.channel_mut(joint))?;
    }
    if log.qd.is_none() {
        log.qd = Some(velocities(setup, truth, &log.q, run)?);
    }
    log.qdd = Some(qdd);
    let tachometers = setup.sensors.iter().all(|sensor| sensor.tachometer_noise.is_some());
    log.provenance.extend([
        ("qd".to_owned(), if tachometers { "tachometer" } else { "central differences of q" }.to_owned()),
        ("qdd".to_owned(), "second central differences of q".to_owned()),
    ]);
    Ok(log)
}

/// What the sensors of `setup` make of a run, and no more: no accelerations, and no velocities where no joint has a tachometer. The
/// noise is that of [`measure`].
///
/// # Errors
/// If the run is too short to differentiate, where some joints have tachometers and others have not.
pub fn sensed(setup: &Setup, truth: &Truth, run: u64) -> Result<Recording> {
    let seed = setup.scenario.seed;
    let period = 1.0 / setup.scenario.sensors.rate_hz;
    let (q, tau) = distorted(setup, truth, period);
    let q = sensors::encoders(&q, &setup.sensors, seed, run);
    let tachometers = setup.sensors.iter().take(q.channels()).any(|sensor| sensor.tachometer_noise.is_some());
    let qd = if tachometers { Some(velocities(setup, truth, &q, run)?) } else { None };
    let provenance = BTreeMap::from([
        ("generator".to_owned(), random::GENERATOR.to_owned()),
        ("seed".to_owned(), seed.to_string()),
        ("run".to_owned(), run.to_string()),
        ("scenario".to_owned(), setup.scenario.name.clone()),
        ("tauscope".to_owned(), env!("CARGO_PKG_VERSION").to_owned()),
    ]);
    Ok(Recording {
        robot: setup.plant.name.clone(),
        joints: setup.plant.joint_names(),
        time: truth.time.clone(),
        tau: sensors::torque(&tau, &setup.sensors, period, seed, run),
        q,
        qd,
        qdd: None,
        truth: Some(truth.signals.clone()),
        provenance,
    })
}

/// Velocities as the tachometers read them; central differences of the measured positions where there is none.
fn velocities(setup: &Setup, truth: &Truth, q: &Channels, run: u64) -> Result<Channels> {
    let period = 1.0 / setup.scenario.sensors.rate_hz;
    let mut qd = Channels::zeros(q.channels(), q.samples());
    for (joint, position) in q.iter().enumerate() {
        let own = qd.channel_mut(joint);
        match setup.sensors[joint].tachometer_noise {
            Some(noise) => {
                let velocity = truth.signals.qd.channel(joint);
                own.copy_from_slice(&sensors::tachometer(velocity, noise, setup.scenario.seed, run, joint));
            }
            None => signal::first_derivative(position, period, own)?,
        }
    }
    Ok(qd)
}
