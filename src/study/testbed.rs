//! The testbed: simulate a training and a held-out motion, measure them, identify, and score against the truth.

use super::score::{parameter_distance, relative_errors, torque_std};
use crate::error::{Error, Result};
use crate::excitation::Reference;
use crate::identification::least_squares::{Estimate, weighted_least_squares};
use crate::identification::model::Model;
use crate::identification::prepare::{self, Prepared, Smoothing};
use crate::identification::smoothing_choice::{self, Described};
use crate::internal::identification::JointRegression;
use crate::recording::Recording;
use crate::scenario::{Setup, measure, simulate};
use crate::simulation::Truth;
use std::time::Instant;

/// Which signals an identification sees.
///
/// ```
/// use tauscope::identification::model::Model;
/// use tauscope::scenario::Setup;
/// use tauscope::study::testbed::{self, Variant};
///
/// // Perfect sensors give the parameters but for integration error; real ones add their noise.
/// let setup = Setup::load("tests/scenarios/pendulum.toml", None)?;
/// let (runs, model) = (testbed::record(&setup, &mut |_| ())?, Model::new(&setup.known));
/// let identify = |variant| testbed::identify(&setup, &model, &runs, variant);
/// let error = |variant| identify(variant).map(|scored| scored.score.torque_std_held_out_nm[0]);
/// assert!(error(Variant::Exact)? < 0.01 * error(Variant::SavitzkyGolay)?);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Variant {
    /// The exact signals: what perfect sensors would give.
    Exact,
    /// Measured signals as they are.
    Raw,
    /// Measured signals through Savitzky-Golay.
    SavitzkyGolay,
    /// Measured signals by common practice: positions through a zero-phase Butterworth low-pass, central differences, parallel filter
    /// and decimation.
    Butterworth,
}

impl Variant {
    /// All variants, in the order of the reports.
    pub const ALL: [Variant; 4] = [Variant::Exact, Variant::Raw, Variant::SavitzkyGolay, Variant::Butterworth];

    /// Name in results.
    pub fn name(self) -> &'static str {
        match self {
            Variant::Exact => "exact",
            Variant::Raw => "raw",
            Variant::SavitzkyGolay => "savitzky_golay",
            Variant::Butterworth => "butterworth",
        }
    }
}

/// A motion as it was simulated and as it was measured.
///
/// ```
/// use tauscope::scenario::Setup;
/// use tauscope::study::testbed;
///
/// // What happened, and what the sensors made of it: torque with a noise of 0.05 N m.
/// let run = testbed::record(&Setup::load("tests/scenarios/pendulum.toml", None)?, &mut |_| ())?.training;
/// let pairs = run.recording.tau.channel(0).iter().zip(run.truth.signals.tau.channel(0));
/// let power = pairs.map(|(measured, true_)| (measured - true_).powi(2)).sum::<f64>() / run.recording.samples() as f64;
/// assert!((power.sqrt() - 0.05).abs() < 0.005);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Run {
    /// What happened.
    pub truth: Truth,
    /// Sensor signals.
    pub recording: Recording,
}

/// The two runs of a scenario.
///
/// ```
/// use tauscope::scenario::Setup;
/// use tauscope::study::testbed;
///
/// // Both motions of a scenario: 6 s to identify from, 4 s to judge by.
/// let setup = Setup::load("tests/scenarios/pendulum.toml", None)?;
/// let runs = testbed::record(&setup, &mut |_| ())?;
/// let samples = [runs.training.recording.samples(), runs.held_out.recording.samples()];
/// assert_eq!((samples, testbed::samples(&setup)), ([3001, 2001], 5002));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Runs {
    /// The motion that is identified from.
    pub training: Run,
    /// The motion on which the result is judged.
    pub held_out: Run,
}

/// An identification and how close it came.
///
/// ```
/// use tauscope::study::testbed::{self, Variant};
/// # use tauscope::identification::model::Model;
/// # use tauscope::scenario::Setup;
/// # let setup = Setup::load("tests/scenarios/pendulum.toml", None)?;
/// # let (runs, model) = (testbed::record(&setup, &mut |_| ())?, Model::new(&setup.known));
///
/// // An identification of a simulated pendulum from measured signals.
/// let scored = testbed::identify(&setup, &model, &runs, Variant::SavitzkyGolay)?;
/// assert_eq!(scored.estimate.beta.len(), 5);
///
/// // The residual is the sensor's noise, of which smoothing takes off a part.
/// assert!(scored.residual_rms[0] < 0.05);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Scored {
    /// Which signals it saw.
    pub variant: Variant,
    /// How they were smoothed.
    pub smoothing: Smoothing,
    /// The same in numbers; None where they were not.
    pub described: Option<Described>,
    /// What it found.
    pub estimate: Estimate,
    /// Root mean square of the regression residual per joint, N m.
    pub residual_rms: Vec<f64>,
    /// Error of the base parameters.
    pub score: Score,
    /// Time for preparing and solving, s.
    pub seconds: f64,
}

/// Distance from the truth.
///
/// ```
/// use tauscope::study::testbed::{self, Variant};
/// # use tauscope::identification::model::Model;
/// # use tauscope::scenario::Setup;
/// # let setup = Setup::load("tests/scenarios/pendulum.toml", None)?;
/// # let (runs, model) = (testbed::record(&setup, &mut |_| ())?, Model::new(&setup.known));
///
/// // The identified model predicts the torque of the other motion far better than the sensor measures it (0.05 N m).
/// let score = testbed::identify(&setup, &model, &runs, Variant::SavitzkyGolay)?.score;
/// assert!(score.torque_std_held_out_nm[0] < 0.02);
///
/// // The first moment along x is zero; all other parameters are exact to one percent.
/// assert!(score.relative_errors[1..].iter().all(|error| error.abs() < 0.01));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Score {
    /// (2 / p) sum |beta - est| / (|beta| + |est|) over the base parameters.
    pub d_beta: f64,
    /// Relative error of every base parameter.
    pub relative_errors: Vec<f64>,
    /// Standard deviation of predicted minus noise-free torque on the training motion, per joint, N m.
    pub torque_std_training_nm: Vec<f64>,
    /// The same on the held-out motion.
    pub torque_std_held_out_nm: Vec<f64>,
}

/// Simulates and measures both motions of a scenario. `tick` receives the samples done of all samples of both motions.
///
/// # Errors
/// Those of [`simulate`] and [`measure`].
pub fn record(setup: &Setup, tick: &mut dyn FnMut(usize)) -> Result<Runs> {
    let mut done = 0;
    let mut one = |motion: &dyn Reference, run: u64| -> Result<Run> {
        let mut last = 0;
        let truth = simulate(setup, motion, &mut |samples| {
            last = samples;
            tick(done + samples);
        })?;
        done += last;
        let recording = measure(setup, &truth, run)?;
        Ok(Run { truth, recording })
    };
    Ok(Runs { training: one(&setup.motion, 0)?, held_out: one(&setup.held_out, 1)? })
}

/// Samples that both motions of a scenario have in the log.
pub fn samples(setup: &Setup) -> usize {
    [&setup.motion, &setup.held_out].map(|motion| setup.scenario.samples(motion.duration_s())).iter().sum()
}

/// Share of the samples of a run at which the drive of each joint gave all it can: the arm did not follow its controller
/// there.
pub fn at_effort_limit(setup: &Setup, run: &Run) -> Vec<f64> {
    let torque = &run.truth.signals.tau;
    let joints = setup.known.joints.iter().zip(torque.iter());
    joints
        .map(|(joint, tau)| {
            let cut = tau.iter().filter(|value| value.abs() >= joint.limits.effort).count();
            cut as f64 / tau.len().max(1) as f64
        })
        .collect()
}

impl Scored {
    /// The signals of a run as this identification sees them.
    ///
    /// # Errors
    /// If the log is too short for the filter.
    pub fn seen<'a>(&self, setup: &Setup, run: &'a Run) -> Result<Prepared<'a>> {
        smoothed(setup, run, self.variant, self.smoothing.clone())
    }
}

/// How a variant smooths measured signals: by the scenario, and where that is open, by the noise and the motion of the log.
///
/// # Errors
/// If the choice is open and the log shows no motion or is too short.
pub fn smoothing(setup: &Setup, log: &Recording, variant: Variant) -> Result<Smoothing> {
    let spec = &setup.scenario.identification;
    let (order, decimation) = (spec.smoothing_order, spec.decimation);
    match variant {
        Variant::Exact | Variant::Raw => Ok(Smoothing::None),
        Variant::SavitzkyGolay => {
            let window = spec.smoothing_window.map_or_else(|| smoothing_choice::window(&[log], order), Ok)?;
            Ok(Smoothing::SavitzkyGolay { window, order, decimation })
        }
        Variant::Butterworth => match spec.low_pass_hz {
            Some(cutoff_hz) => Ok(Smoothing::LowPass { cutoff_hz, decimation }),
            None => smoothing_choice::usual_low_pass(&[log]),
        },
    }
}

fn smoothed<'a>(setup: &Setup, run: &'a Run, variant: Variant, smoothing: Smoothing) -> Result<Prepared<'a>> {
    let band = setup.scenario.identification.reversal_band_rad_s;
    match variant {
        Variant::Exact => Ok(prepare::exact(&run.truth.time, &run.truth.signals, band)),
        _ => prepare::measured(&run.recording, &smoothing, band),
    }
}

/// The signals of a run as a variant sees them, with the smoothing chosen for that run.
///
/// # Errors
/// Those of [`smoothing`], and if the log is too short for the filter.
pub fn prepared<'a>(setup: &Setup, run: &'a Run, variant: Variant) -> Result<Prepared<'a>> {
    smoothed(setup, run, variant, smoothing(setup, &run.recording, variant)?)
}

/// Identifies from the training run as `variant` sees it, and scores the result on both runs.
///
/// # Errors
/// Those of preparing and of the regression; named for the joint or parameters at fault.
pub fn identify(setup: &Setup, model: &Model, runs: &Runs, variant: Variant) -> Result<Scored> {
    let started = Instant::now();
    let smoothing = smoothing(setup, &runs.training.recording, variant)?;
    let training = smoothed(setup, &runs.training, variant, smoothing.clone())?;
    let regression = training.regression(model)?;
    let names: Vec<String> = model.base().groupings().iter().map(|g| g.name.clone()).collect();
    let estimate = weighted_least_squares(&regression, &names).map_err(|problem| {
        Error::request(format!("identification from {} signals", variant.name()), problem.to_string())
    })?;
    let seconds = started.elapsed().as_secs_f64();

    let truth = model.base().values(&Model::standard_values(&setup.plant));
    let torque_error = |run: &Run, seen: &Prepared| {
        torque_std(&seen.predict(model, &estimate.beta), &run.truth.signals.tau, |joint| seen.moving(joint))
    };
    let score = Score {
        d_beta: parameter_distance(&truth, &estimate.beta),
        relative_errors: relative_errors(&truth, &estimate.beta),
        torque_std_training_nm: torque_error(&runs.training, &training),
        torque_std_held_out_nm: torque_error(
            &runs.held_out,
            &smoothed(setup, &runs.held_out, variant, smoothing.clone())?,
        ),
    };
    let residual_rms = regression.iter().map(|joint: &JointRegression| joint.residual_rms(&estimate.beta)).collect();
    let described = smoothing_choice::described(&smoothing, runs.training.recording.rate_hz())?;
    Ok(Scored { variant, smoothing, described, residual_rms, score, seconds, estimate })
}
