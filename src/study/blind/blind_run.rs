//! A blind run: the arm is simulated with what is hidden in it, and the logs are screened and diagnosed like anybody's.

use super::arm::random_setup;
use super::case::{ArmKind, Case, Class};
use super::motion::{TRAIN, kept, motions};
use super::outcome::{Judgement, judge};
use super::power::{power, power_as_measured};
use super::sizing::{noise_at_size, sized};
use crate::diagnosis::{Consequence, DataFault, Diagnosis};
use crate::effects::{Placed, Site};
use crate::error::{Error, Result};
use crate::quality;
use crate::recording::Recording;
use crate::recording::lenient::Sieved;
use crate::robot::Robot;
use crate::scenario::{Setup, measure, simulate};
use crate::simulation::integrator::Integrator;
use std::time::Instant;

/// A blind run that was made.
///
/// ```
/// use tauscope::scenario::Setup;
/// use tauscope::study::blind::{self, Case, Outcome};
///
/// // A run that hides nothing: the diagnosis is right if it names nothing.
/// let setup = Setup::load("tests/scenarios/pendulum.toml", None)?;
/// let run = blind::run(&setup, &Case::plain(7))?;
/// assert!(run.hidden.is_empty() && run.logs.len() >= 2);
/// assert_eq!(run.judgement.outcome, Outcome::Quiet);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug)]
pub struct BlindRun {
    /// The arm's description.
    pub robot: Robot,
    /// The logs: those to identify from, and the one to judge by.
    pub logs: Vec<Recording>,
    /// What was hidden, at the size used.
    pub hidden: Vec<Placed>,
    /// Faults of the data that were found.
    pub faults: Vec<DataFault>,
    /// The answer; None where faults of the data forbid one.
    pub diagnosis: Option<Diagnosis>,
    /// Share of what is hidden that the extended model adds to the held-out torque too; None where there is no answer, or
    /// nothing is hidden.
    pub accounted_for: Option<f64>,
    /// For each hidden effect, how often the best of all tests would name it.
    pub power: Vec<f64>,
    /// The same with the positions as the encoders measure them.
    pub power_as_measured: Vec<f64>,
    /// How it came out.
    pub judgement: Judgement,
    /// Time that screening and diagnosis took, s.
    pub seconds: f64,
}

/// Times that a run which cannot be simulated is drawn again.
const REDRAWS: u64 = 20;

/// Makes a blind run on the arm of `setup`, or on one drawn in its place. What cannot be simulated is drawn again, unless it was
/// asked for.
///
/// # Errors
/// If the hidden effect does not show on the arm, the simulation runs away under it, or those of the diagnosis.
pub fn run(setup: &Setup, case: &Case) -> Result<BlindRun> {
    let mut attempt = 0;
    let (case, made) = loop {
        let drawn = case.again(attempt, setup.known.dof());
        match simulated(setup, &drawn) {
            Ok(made) => break (drawn, made),
            Err(problem) if case.class == Class::Asked || attempt == REDRAWS => return Err(problem),
            Err(problem) => tracing::debug!(run = case.index, attempt, %problem, "drawn again"),
        }
        attempt += 1;
    };
    let Simulated { setup, hidden, power, power_as_measured, logs } = made;
    let started = Instant::now();
    let answer = Diagnosis::of(&setup.known)
        .train(&logs[..TRAIN])
        .test(&logs[TRAIN..])
        .truth(hidden.iter().cloned())
        .trust(case.trust)
        .seed(case.seed)
        // A wrong description counts as found where the diagnosis stops at it.
        .correct(false)
        .run();
    let seconds = started.elapsed().as_secs_f64();
    let (faults, conclusion) = match answer {
        Ok(answer) => (answer.faults.clone(), answer.into_conclusion().ok()),
        Err(problem) => match unusable(&setup.known, &logs)? {
            faults if faults.is_empty() => return Err(problem),
            faults => (faults, None),
        },
    };
    let accounted_for = conclusion.as_ref().and_then(|conclusion| conclusion.accounted_for);
    let diagnosis = conclusion.map(|conclusion| conclusion.diagnosis);
    let judgement = judge(&case, &hidden, &faults, diagnosis.as_ref());
    let robot = setup.known;
    Ok(BlindRun { robot, logs, hidden, faults, diagnosis, accounted_for, power, power_as_measured, judgement, seconds })
}

/// An arm with what is hidden in it, and its logs.
struct Simulated {
    setup: Setup,
    hidden: Vec<Placed>,
    power: Vec<f64>,
    power_as_measured: Vec<f64>,
    logs: Vec<Recording>,
}

fn simulated(setup: &Setup, case: &Case) -> Result<Simulated> {
    let mut setup = match case.arm {
        ArmKind::Scenario => setup.clone(),
        ArmKind::Random(dof) => random_setup(setup, dof, case.seed),
    };
    if let Some(placed) = case.hidden.iter().find(|placed| !placed.effect.can_be_on(placed.joint, &setup.known)) {
        let name = &setup.known.joints[placed.joint].name;
        return Err(Error::request(placed.effect.about().name, format!("cannot be on `{name}` of this arm")));
    }
    let motions = motions(case, &setup)?;
    for placed in &case.hidden {
        let factor = noise_at_size(&setup, placed, case, &motions)?;
        setup.sensors.iter_mut().for_each(|sensor| sensor.torque_noise *= factor);
    }
    let hidden: Vec<Placed> =
        case.hidden.iter().map(|placed| sized(&setup, placed, case, &motions)).collect::<Result<_>>()?;
    setup.scenario.seed = case.seed;
    for sensor in &mut setup.sensors {
        sensor.torque_correlation_s = case.correlation_s;
    }
    let power = hidden.iter().map(|placed| power(&setup, placed, case, &motions)).collect::<Result<_>>()?;
    for placed in &hidden {
        placed.effect.alter(&placed.parameters, placed.joint, &mut setup.plant);
        if placed.effect.about().site == Site::Integrator {
            setup.scenario.plant.integrator = Integrator::RapierNative;
            setup.scenario.plant.step_s = placed.parameters[0];
        }
        setup.effects.push(placed.clone());
    }
    let mut logs: Vec<Recording> = motions
        .iter()
        .zip(0..)
        .map(|(motion, index)| {
            let log = measure(&setup, &simulate(&setup, motion, &mut |_| ())?, index)?;
            // The truth and what a log of a controller would not have must not be seen.
            Ok(kept(case, &Recording { truth: None, qdd: None, ..log }))
        })
        .collect::<Result<_>>()?;
    let power_as_measured = match hidden.is_empty() {
        true => Vec::new(),
        false => power_as_measured(&setup, &hidden, case, &logs)?,
    };
    if let Some(fault) = case.fault {
        fault.put_into(&mut logs, case.seed);
    }
    Ok(Simulated { setup, hidden, power, power_as_measured, logs })
}

/// The faults for which logs cannot be used at all.
fn unusable(robot: &Robot, logs: &[Recording]) -> Result<Vec<DataFault>> {
    let sieved =
        |log: &Recording| Sieved { recording: log.clone(), lines: (1..=log.samples()).collect(), ..Sieved::default() };
    let sieved: Vec<Sieved> = logs.iter().map(sieved).collect();
    let reports = quality::examine_together(&sieved.iter().collect::<Vec<_>>(), Some(robot))?.reports;
    let fault = |(index, report): (usize, &quality::Report)| {
        let quality::Finding { kind, place, text, .. } = report.fatal()?.clone();
        Some(DataFault { kind, log: format!("log {}", index + 1), place, text, consequence: Consequence::Stops })
    };
    Ok(reports.iter().enumerate().filter_map(fault).collect())
}
