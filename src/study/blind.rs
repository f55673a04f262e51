//! Blind runs: an effect is hidden in a simulated arm, and the diagnosis, which sees the arm's description and the logs
//! alone, has to name it.

use crate::diagnosis::score::Projection;
use crate::diagnosis::selection::rms;
use crate::diagnosis::session::Session;
use crate::diagnosis::{Diagnosis, Options, Verdict, candidates, diagnose};
use crate::effects::{Effect, LIBRARY, Placed, Role, Site};
use crate::error::{Error, Result};
use crate::excitation::random_sequence::random_sequence;
use crate::excitation::{FreudensteinSequence, Reference};
use crate::identification::effect_model::Trust;
use crate::identification::model::Model;
use crate::random;
use crate::recording::Recording;
use crate::scenario::Setup;
use crate::simulation::integrator::Integrator;
use crate::simulation::{measure, simulate};
use rand::RngExt;
use std::time::Instant;

/// Motions of a run: two to identify from, one held out.
const TRAIN: u64 = 2;
const MOTIONS: u64 = 3;

/// Length of each motion, s, and moves of every joint in it.
const DURATION_S: f64 = 20.0;
const MOVES: usize = 12;

/// Corrections of an effect's size towards the wanted severity.
const SIZINGS: usize = 4;

/// A blind run to be made.
#[derive(Debug, Clone)]
pub struct Case {
    /// Seed of motions, noise and what is drawn.
    pub seed: u64,
    /// The effect that is hidden, if any, at its typical size.
    pub hidden: Option<Placed>,
    /// Root mean square of what the effect adds beyond the baseline on its worst joint, over that of the torque noise.
    pub severity: f64,
    /// Correlation time of the torque noise, s.
    pub correlation_s: f64,
    /// What is believed of the arm.
    pub trust: Trust,
}

/// How a blind run came out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// The hidden effect was named, on its joint.
    Named,
    /// It is one of a set.
    OneOf,
    /// Nothing was named.
    Missed,
    /// Something else was named.
    Wrong,
    /// Nothing was hidden and nothing named.
    Quiet,
    /// Nothing was hidden and something named.
    FalseAlarm,
}

/// A blind run that was made.
#[derive(Debug)]
pub struct BlindRun {
    /// What was hidden, at the size used.
    pub hidden: Option<Placed>,
    /// How it came out.
    pub outcome: Outcome,
    /// Effects named beside the hidden one.
    pub extra: usize,
    /// The answer.
    pub diagnosis: Diagnosis,
    /// Time that the diagnosis took, s.
    pub seconds: f64,
}

/// Draws a case: any effect of the library that `trust` lets one see, on any of its places.
pub fn draw(setup: &Setup, seed: u64, severity: f64, correlation_s: f64, trust: Trust) -> Case {
    let mut source = random::stream(seed, "blind case", 0);
    let effects: Vec<&'static dyn Effect> =
        LIBRARY.iter().copied().filter(|effect| candidates::is_candidate(*effect, trust, &[])).collect();
    let effect = effects[source.random_range(0..effects.len())];
    let joint = source.random_range(candidates::places(effect, setup.known.dof()));
    Case { seed, hidden: Some(Placed::typical(effect, joint)), severity, correlation_s, trust }
}

/// Makes a blind run on the arm of `setup`.
///
/// # Errors
/// If the simulation runs away under the effect, or those of the diagnosis.
pub fn run(setup: &Setup, case: &Case) -> Result<BlindRun> {
    let motions: Vec<FreudensteinSequence> = (0..MOTIONS)
        .map(|index| random_sequence(case.seed, "blind motion", index, MOVES, DURATION_S, &setup.limits))
        .collect::<Result<_>>()?;
    let hidden = case.hidden.as_ref().map(|placed| sized(setup, placed, case, &motions)).transpose()?;
    let mut setup = setup.clone();
    setup.scenario.seed = case.seed;
    for sensor in &mut setup.sensors {
        sensor.torque_correlation_s = case.correlation_s;
    }
    if let Some(placed) = &hidden {
        placed.effect.alter(&placed.parameters, placed.joint, &mut setup.plant);
        if placed.effect.about().site == Site::Integrator {
            setup.scenario.plant.integrator = Integrator::RapierNative;
            setup.scenario.plant.step_s = placed.parameters[0];
        }
        setup.effects.push(placed.clone());
    }
    let logs: Vec<Recording> = motions
        .iter()
        .zip(0..)
        .map(|(motion, index)| measure(&setup, &simulate(&setup, motion, &mut |_| ())?, index))
        .collect::<Result<_>>()?;
    let (train, test) = logs.split_at(TRAIN as usize);
    let (train, test): (Vec<&Recording>, Vec<&Recording>) = (train.iter().collect(), test.iter().collect());
    let options = Options { trust: case.trust, seed: case.seed, ..Options::default() };
    let started = Instant::now();
    let diagnosis = diagnose(&setup.known, &train, &test, &options, &mut |_| ())?;
    let (outcome, extra) = outcome(hidden.as_ref(), &diagnosis);
    Ok(BlindRun { hidden, outcome, extra, diagnosis, seconds: started.elapsed().as_secs_f64() })
}

/// Compares the answer with what was hidden; the second number counts other effects that were firmly named beside it.
fn outcome(hidden: Option<&Placed>, diagnosis: &Diagnosis) -> (Outcome, usize) {
    let firm = diagnosis.found.iter().filter(|found| found.verdict == Verdict::Named).count();
    let told = diagnosis.found.iter().filter(|found| found.verdict != Verdict::Unexplained);
    let names = told.clone().count();
    let Some(hidden) = hidden else {
        return (if names == 0 { Outcome::Quiet } else { Outcome::FalseAlarm }, names);
    };
    let family = candidates::Family { effect: hidden.effect.about().name, joint: hidden.joint };
    for found in told {
        let own = found.member.candidate.family() == family;
        if own || found.alternatives.iter().any(|other| other.family == family) {
            return match found.verdict {
                Verdict::Named => (Outcome::Named, firm - 1),
                _ => (Outcome::OneOf, firm),
            };
        }
    }
    (if firm > 0 { Outcome::Wrong } else { Outcome::Missed }, firm)
}

/// The effect at the size that has the wanted severity along the reference motions.
fn sized(setup: &Setup, placed: &Placed, case: &Case, motions: &[FreudensteinSequence]) -> Result<Placed> {
    let logs: Vec<Recording> = motions[..TRAIN as usize].iter().map(|motion| reference_log(setup, motion)).collect();
    let logs: Vec<&Recording> = logs.iter().collect();
    let model = Model::new(&setup.known);
    let mut session = Session::new(&model, case.trust, &logs, &logs)?;
    session.believe(&setup.known);
    let severity = |placed: &Placed| -> Result<f64> {
        let added = session.arm.added(std::slice::from_ref(placed), &session.train.rows)?.swap_remove(0);
        let masked = |column: &crate::diagnosis::column::Column| column.masked(&session.train.rows.valid);
        let baseline: Vec<_> = session.train.baseline.iter().map(masked).collect();
        let left = Projection::new(&baseline, &masked(&added)).residual;
        let each = rms(&session.train.rows.valid, &left);
        Ok(each.iter().zip(&setup.sensors).map(|(rms, sensor)| rms / sensor.torque_noise).fold(0.0, f64::max))
    };
    let mut placed = placed.clone();
    if placed.effect.about().site == Site::Integrator {
        // The step must divide the time between samples, so it cannot be sized.
        return Ok(placed);
    }
    if candidates::is_level(placed.effect) {
        let largest = session.largest_torque(placed.joint);
        let (mut low, mut high) = (0.1 * largest, largest);
        for _ in 0..20 {
            placed.parameters[0] = 0.5 * (low + high);
            if severity(&placed)? > case.severity { low = placed.parameters[0] } else { high = placed.parameters[0] }
        }
        return Ok(placed);
    }
    for _ in 0..SIZINGS {
        let now = severity(&placed)?;
        if !(now > 0.0 && now.is_finite()) {
            let problem = format!("`{}` does not show on this arm beyond the baseline", placed.effect.about().name);
            return Err(Error::request("blind run", problem));
        }
        let factor = case.severity / now;
        for (parameter, value) in placed.effect.parameters().iter().zip(&mut placed.parameters) {
            if matches!(parameter.role, Role::Amplitude | Role::Departure) {
                *value = (*value * factor).clamp(parameter.lower, parameter.upper);
            }
        }
    }
    Ok(placed)
}

/// A log of the reference itself, without torque.
fn reference_log(setup: &Setup, motion: &FreudensteinSequence) -> Recording {
    let dof = setup.known.dof();
    let rate = setup.scenario.sensors.rate_hz;
    let samples = setup.scenario.samples(motion.duration_s());
    let mut q = crate::channels::Channels::zeros(dof, samples);
    let mut state = [vec![0.0; dof], vec![0.0; dof], vec![0.0; dof]];
    let time: Vec<f64> = (0..samples).map(|sample| sample as f64 / rate).collect();
    for (sample, &t) in time.iter().enumerate() {
        let [position, velocity, acceleration] = &mut state;
        motion.at(t, position, velocity, acceleration);
        q.set(sample, position);
    }
    let tau = crate::channels::Channels::zeros(dof, samples);
    Recording { joints: setup.known.joint_names(), time, q, tau, ..Default::default() }
}

/// An effect with its joint, for tables.
pub fn name(setup: &Setup, placed: &Placed) -> String {
    let joints: Vec<&str> = placed.joints().iter().map(|&joint| setup.known.joints[joint].name.as_str()).collect();
    let about = placed.effect.about().name;
    if joints.is_empty() { about.to_owned() } else { format!("{about}:{}", joints.join("+")) }
}
