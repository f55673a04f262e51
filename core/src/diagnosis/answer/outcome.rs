//! The answer that a diagnosis hands out: it owns all it holds.

use super::diagnosis::Diagnosis;
use super::extended::ExtendedModel;
use super::resimulation::{Replay, Resimulation, Simulator};
use super::words::{Finding, findings};
use crate::diagnosis::logs::{CleanLogs, Consequence, DataFault};
use crate::diagnosis::search::Verdict;
use crate::error::{Error, Result};
use crate::quality::{UnitChanges, descriptions};
use crate::robot::Robot;

/// The answer of a diagnosis. It serialises as `diagnosis.json` has it, without the schema.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// # use tauscope::diagnosis::Diagnosis;
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Ignored)?;
/// # let log = |name: &str| recording::load(format!("../tests/reference/pendulum/{name}.csv"), None);
/// # let (train, test) = (log("train")?, log("test")?);
/// # let answer = Diagnosis::of(&robot).train([&train]).test([&test]).candidates(["torque_ripple"]).run()?;
///
/// // The answer in a word, as findings, and as `diagnosis.json` has it.
/// assert_eq!(answer.findings().len(), 1);
/// let json = serde_json::to_value(&answer).expect("it has a JSON form");
/// assert_eq!((&json["verdict"], &json["robot"]), (&"named".into(), &"pendulum".into()));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug)]
pub struct Answer {
    /// The arm as described, its gravity corrected where the logs show another.
    pub robot: Robot,
    /// Family-wise false-alarm rate that was asked for.
    pub alpha: f64,
    /// The logs as they were used, or would have been.
    pub logs: CleanLogs,
    /// Faults of the data, those that stop first.
    pub faults: Vec<DataFault>,
    /// What is wrong with the description of all logs alike. It was corrected where it is beyond doubt.
    pub description: Option<descriptions::Verdict>,
    /// Units of training and held-out logs that were not those of their description, and were converted.
    pub units: UnitChanges,
    /// What came of it.
    pub outcome: Outcome,
}

/// What came of a diagnosis.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::diagnosis::{Diagnosis, Outcome, Verdict};
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Ignored)?;
/// # let log = |name: &str| recording::load(format!("../tests/reference/pendulum/{name}.csv"), None);
/// # let (train, test) = (log("train")?, log("test")?);
///
/// // Torque and position have opposite signs, and either may be the wrong one: an answer of its own, and no error.
/// let (mut train, mut test) = (train, test);
/// for log in [&mut train, &mut test] {
///     log.tau.as_mut_slice().iter_mut().for_each(|torque| *torque = -*torque);
/// }
/// let answer = Diagnosis::of(&robot).train([&train]).test([&test]).run()?;
/// assert!(matches!(answer.outcome, Outcome::Stopped) && answer.verdict() == Verdict::NotTestable);
/// assert!(!answer.faults.is_empty());
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug)]
pub enum Outcome {
    /// Faults of the data forbid an answer; [`Answer::faults`] has them.
    Stopped,
    /// The arm was diagnosed.
    Concluded(Box<Conclusion>),
}

/// A diagnosis with the model that comes out of it.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// # use tauscope::diagnosis::Diagnosis;
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Ignored)?;
/// # let log = |name: &str| recording::load(format!("../tests/reference/pendulum/{name}.csv"), None);
/// # let (train, test) = (log("train")?, log("test")?);
/// # let answer = Diagnosis::of(&robot).train([&train]).test([&test]).candidates(["torque_ripple"]).run()?;
///
/// // What was found, and the arm with it for a simulator.
/// let conclusion = answer.conclusion().expect("the logs are good");
/// assert_eq!(conclusion.extended()?.effects.len(), conclusion.diagnosis.found.len());
/// assert!(conclusion.accounted_for.is_none() && conclusion.resimulation.is_none());
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug)]
pub struct Conclusion {
    /// What was found.
    pub diagnosis: Diagnosis,
    /// Rate, accelerations and noise of the training logs.
    pub measured: Measured,
    /// Share of the torque of [`DiagnosisBuilder::truth`](super::DiagnosisBuilder::truth) on the held-out logs, beyond what
    /// the baseline takes up, that the extended model adds too; None where no truth was given.
    pub accounted_for: Option<f64>,
    /// The extended model run along the held-out motions, once [`Conclusion::resimulate`] has.
    pub resimulation: Option<Resimulation>,
    pub(super) replay: Replay,
}

/// What was measured of the arm in addition to its model.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// # use tauscope::diagnosis::Diagnosis;
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Ignored)?;
/// # let log = |name: &str| recording::load(format!("../tests/reference/pendulum/{name}.csv"), None);
/// # let (train, test) = (log("train")?, log("test")?);
/// # let answer = Diagnosis::of(&robot).train([&train]).test([&test]).candidates(["torque_ripple"]).run()?;
///
/// // What a simulation of the logs needs in addition to the model: rate, accelerations, noise.
/// let measured = &answer.conclusion().expect("the logs are good").measured;
/// assert!((measured.rate_hz - 50.0).abs() < 1e-6 && (9.0..12.0).contains(&measured.acceleration[0]));
/// assert!(measured.torque_noise[0] < 0.2);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// Rate of the logs, Hz.
    pub rate_hz: f64,
    /// Largest acceleration of each joint, rad/s2.
    pub acceleration: Vec<f64>,
    /// Noise of the positions of each joint, rad.
    pub position_noise: Vec<f64>,
    /// Noise of the torques of each joint, N m.
    pub torque_noise: Vec<f64>,
}

/// The first of the faults that stop a diagnosis, as an error.
pub(super) fn stopped(faults: &[DataFault]) -> Error {
    let fault = faults.iter().find(|fault| fault.consequence == Consequence::Stops);
    let [log, place, text] =
        fault.map(|DataFault { log, place, text, .. }| [log, place, text].map(String::as_str)).unwrap_or_default();
    Error::request(log, format!("{place}: {text}"))
}

impl Answer {
    /// The answer in a word.
    pub fn verdict(&self) -> Verdict {
        self.diagnosis().map_or(Verdict::NotTestable, |diagnosis| diagnosis.verdict)
    }

    /// What was found; None where faults of the data stopped the diagnosis.
    pub fn diagnosis(&self) -> Option<&Diagnosis> {
        self.conclusion().map(|conclusion| &conclusion.diagnosis)
    }

    /// What was found, with the extended model; None where faults of the data stopped the diagnosis.
    pub fn conclusion(&self) -> Option<&Conclusion> {
        match &self.outcome {
            Outcome::Stopped => None,
            Outcome::Concluded(conclusion) => Some(conclusion),
        }
    }

    /// The same by value.
    ///
    /// # Errors
    /// If faults of the data stopped the diagnosis: the first of them.
    pub fn into_conclusion(self) -> Result<Conclusion> {
        match self.outcome {
            Outcome::Concluded(conclusion) => Ok(*conclusion),
            Outcome::Stopped => Err(stopped(&self.faults)),
        }
    }

    /// The effects found, with names and units; none where the diagnosis stopped.
    pub fn findings(&self) -> Vec<Finding> {
        self.diagnosis().map(|diagnosis| findings(&self.robot, diagnosis)).unwrap_or_default()
    }
}

impl Conclusion {
    /// The arm with everything found, as the simulator takes it.
    ///
    /// # Errors
    /// If no bodies can be found that fit the logs.
    pub fn extended(&self) -> Result<&ExtendedModel> {
        self.replay.extended.as_ref().map_err(Error::clone)
    }

    /// Runs the arm as described, the fitted baseline and the extended model along the held-out motions in a `simulator`, and
    /// keeps the result.
    ///
    /// # Errors
    /// If the baseline or the extended model cannot be simulated.
    pub fn resimulate(&mut self, simulator: impl Simulator) -> Result<&Resimulation> {
        let resimulation = self.replay.run(&self.diagnosis, &simulator)?;
        Ok(self.resimulation.insert(resimulation))
    }
}
