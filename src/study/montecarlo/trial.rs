//! One trial: draws, measures, identifies, scores.

use super::plan::smoothings;
use super::study::Study;
use crate::error::Result;
use crate::excitation::Motion;
use crate::excitation::random_sequence::random_sequence;
use crate::identification::least_squares::Estimate;
use crate::identification::model::Model;
use crate::identification::prepare::{Prepared, Smoothing, measured};
use crate::internal::identification::{Data, Estimator};
use crate::random;
use crate::recording::Recording;
use crate::scenario::{NoiseLevel, Setup, drawable, misjudged, sensed, simulate_with};
use crate::simulation::Truth;
use crate::study::closed_loop::{Alongside, ClosedLoop};
use crate::study::score::parameter_distance;
use crate::study::testbed::{Variant, smoothing};
use chacha20::ChaCha8Rng;
use rand::Rng;
use serde::Serialize;
use std::borrow::Cow;
use std::time::Instant;

/// What one estimator made of one trial at one noise level with one smoothing.
///
/// ```
/// use tauscope::study::testbed::Variant;
/// # use tauscope::scenario::Setup;
/// # use tauscope::study::montecarlo::{Overrides, Plan, Study};
/// # let setup = Setup::load("tests/scenarios/pendulum.toml", None)?;
/// # let (estimators, windows) = (Some(vec!["wls".to_owned()]), Some(vec![0, 61]));
/// # let overrides = Overrides { trials: Some(4), estimators, windows, ..Overrides::default() };
/// # let study = Study::new(setup.clone(), Plan::new(&setup, overrides)?)?;
///
/// // Weighted least squares on a trial as measured, and through Savitzky-Golay over 61 samples.
/// let rows = study.trial(0);
/// assert_eq!((rows[0].signals, rows[0].window), (Variant::Raw, 0));
/// assert_eq!((rows[1].signals, rows[1].window, &rows[1].estimator[..]), (Variant::SavitzkyGolay, 61, "wls"));
/// assert!(rows[1].outcome.is_ok());
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Serialize)]
pub struct Row {
    /// Index of the trial.
    pub trial: u32,
    /// Index of the noise level.
    pub level: u32,
    /// How the signals were smoothed: raw, Savitzky-Golay or Butterworth.
    pub signals: Variant,
    /// Savitzky-Golay window in samples, 0 where there is none.
    pub window: u32,
    /// Name of the estimator.
    pub estimator: String,
    /// True base parameters.
    pub truth: Vec<f64>,
    /// What was found, or why nothing was.
    #[serde(flatten, serialize_with = "outcome")]
    pub outcome: std::result::Result<Found, String>,
    /// Time of the estimator with its share of preparing the rows, s.
    pub seconds: f64,
}

/// Parameters found and how good they are.
///
/// ```
/// # use tauscope::scenario::Setup;
/// # use tauscope::study::montecarlo::{Overrides, Plan, Study};
/// # let setup = Setup::load("tests/scenarios/pendulum.toml", None)?;
/// # let (estimators, windows) = (Some(vec!["wls".to_owned()]), Some(vec![0, 61]));
/// # let overrides = Overrides { trials: Some(4), estimators, windows, ..Overrides::default() };
/// # let study = Study::new(setup.clone(), Plan::new(&setup, overrides)?)?;
///
/// // Smoothing brings the parameters nearer to the truth.
/// let rows = study.trial(0);
/// let found = |row: usize| rows[row].outcome.as_ref().expect("the motion separates all parameters");
/// assert!(found(1).d_beta < found(0).d_beta);
/// assert_eq!(found(1).beta.len(), found(1).std.len());
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Found {
    /// Base parameters.
    pub beta: Vec<f64>,
    /// Their standard deviations as the estimator sees them.
    pub std: Vec<f64>,
    /// Distance from the truth, 0 to 2.
    pub d_beta: f64,
    /// Share of the base parameters whose 95 % interval holds the truth.
    pub coverage: f64,
    /// Standard deviation of the torque error on the held-out motion, per joint, N m.
    pub torque_std: Vec<f64>,
}

fn outcome<S: serde::Serializer>(
    outcome: &std::result::Result<Found, String>,
    serializer: S,
) -> std::result::Result<S::Ok, S::Error> {
    #[derive(Serialize)]
    struct Outcome<'a> {
        found: Option<&'a Found>,
        failure: Option<&'a String>,
    }
    Outcome { found: outcome.as_ref().ok(), failure: outcome.as_ref().err() }.serialize(serializer)
}

/// What a trial has drawn.
struct Drawn<'a> {
    setup: Setup,
    run: Cow<'a, Truth>,
    /// Base parameters that iterating estimators start from.
    start: Vec<f64>,
}

/// Where rows belong, and the truth they are scored against.
struct Place<'a> {
    trial: u32,
    level: usize,
    truth: &'a [f64],
}

impl Study {
    /// Makes one trial: its rows by noise level, smoothing and estimator. A failure of an estimator is in its row.
    pub fn trial(&self, trial: u32) -> Vec<Row> {
        let setup = self.drawn_setup(trial);
        let setup = match setup {
            Ok(setup) => setup,
            Err(problem) => return self.failed(trial, &[], &problem.to_string()),
        };
        let truth = self.model.base().values(&Model::standard_values(&setup.plant));
        match self.draw(trial, setup) {
            Ok(drawn) => self.identified(trial, &drawn, &truth),
            Err(problem) => self.failed(trial, &truth, &problem.to_string()),
        }
    }

    fn stream(&self, what: &str, trial: u32) -> ChaCha8Rng {
        random::stream(self.setup.scenario.seed, &format!("montecarlo {what}"), u64::from(trial))
    }

    /// The setup with the trial's plant, motion and seed of its sensors.
    fn drawn_setup(&self, trial: u32) -> Result<Setup> {
        let (setup, spec) = (&self.setup, &self.plan.spec);
        let mut drawn = if spec.plant_error > 0.0 {
            setup.with_plant(misjudged(&setup.known, spec.plant_error, &mut self.stream("plant", trial)))
        } else {
            setup.clone()
        };
        if let Some(random) = &spec.random_motion {
            let limits = drawable(&setup.limits, &setup.known, random);
            let (seed, index) = (setup.scenario.seed, u64::from(trial));
            let motion = random_sequence(seed, "montecarlo motion", index, random.moves, random.duration_s, &limits)?;
            drawn.motion = Motion::Freudenstein(motion);
        }
        drawn.scenario.seed = self.stream("noise", trial).next_u64();
        Ok(drawn)
    }

    fn draw(&self, trial: u32, setup: Setup) -> Result<Drawn<'_>> {
        let spec = &self.plan.spec;
        let run = match &self.shared {
            Some(run) => Cow::Borrowed(run),
            None => Cow::Owned(simulate_with(spec.engine, &setup, &setup.motion, &mut |_| ())?),
        };
        let start = if spec.start_error > 0.0 {
            misjudged(&setup.known, spec.start_error, &mut self.stream("start", trial))
        } else {
            setup.nominal.clone()
        };
        let start = self.model.base().values(&Model::standard_values(&start));
        Ok(Drawn { setup, run, start })
    }

    fn identified(&self, trial: u32, drawn: &Drawn, truth: &[f64]) -> Vec<Row> {
        let arm = ClosedLoop::new(&drawn.setup, &self.model, &drawn.setup.motion);
        let mut rows = Vec::with_capacity(self.plan.cells());
        let mut setup = drawn.setup.clone();
        for (level, noise) in self.plan.spec.noise.iter().enumerate() {
            setup.sensors.clone_from(&drawn.setup.sensors);
            set_noise(&mut setup, noise);
            let place = Place { trial, level, truth };
            match sensed(&setup, &drawn.run, 0) {
                Ok(log) => rows.extend(self.at_level(&place, &log, &arm, &drawn.start)),
                Err(problem) => rows.extend(self.failed_at(&place, &problem.to_string())),
            }
        }
        rows
    }

    /// Rows of one noise level.
    fn at_level(&self, place: &Place, log: &Recording, arm: &ClosedLoop, start: &[f64]) -> Vec<Row> {
        let names = self.parameters();
        let mut rows = Vec::new();
        for smoothed in smoothings(&self.plan.spec) {
            let started = Instant::now();
            let made = self.prepared(log, smoothed).and_then(|prepared| {
                let regression = prepared.regression(&self.model)?;
                Ok((prepared, regression))
            });
            let shared = started.elapsed().as_secs_f64() / self.plan.estimators.len() as f64;
            for &estimator in &self.plan.estimators {
                let started = Instant::now();
                let outcome = match &made {
                    Ok((prepared, regression)) => {
                        let simulated = Alongside { arm, prepared };
                        let data = Data { rows: regression, names: &names, start, simulated: Some(&simulated) };
                        estimator.estimate(&data).map_err(|problem| problem.to_string())
                    }
                    Err(problem) => Err(problem.to_string()),
                };
                let seconds = shared + started.elapsed().as_secs_f64();
                let outcome = outcome.and_then(|estimate| self.judged(&estimate, place.truth));
                rows.push(row(place, smoothed, estimator, outcome, seconds));
            }
        }
        rows
    }

    fn prepared<'b>(&self, log: &'b Recording, (signals, window): (Variant, u32)) -> Result<Prepared<'b>> {
        let spec = &self.setup.scenario.identification;
        let band = spec.reversal_band_rad_s;
        match signals {
            Variant::SavitzkyGolay => {
                let (window, order, decimation) = (window as usize, spec.smoothing_order, spec.decimation);
                measured(log, &Smoothing::SavitzkyGolay { window, order, decimation }, band)
            }
            Variant::Butterworth => measured(log, &smoothing(&self.setup, log, signals)?, band),
            Variant::Raw | Variant::Exact => {
                Ok(measured(log, &Smoothing::None, band)?.every(self.plan.spec.raw_decimation))
            }
        }
    }

    fn judged(&self, estimate: &Estimate, truth: &[f64]) -> std::result::Result<Found, String> {
        if estimate.beta.iter().any(|value| !value.is_finite()) {
            return Err("a parameter is not finite".to_owned());
        }
        let inside = estimate.intervals().iter().zip(truth).filter(|([low, high], t)| (low..=high).contains(t)).count();
        let drawn = (self.plan.spec.plant_error > 0.0).then_some(truth);
        Ok(Found {
            std: estimate.std(),
            d_beta: parameter_distance(truth, &estimate.beta),
            coverage: inside as f64 / truth.len().max(1) as f64,
            torque_std: self.held_out.torque_std(&estimate.beta, drawn),
            beta: estimate.beta.clone(),
        })
    }

    /// Rows of a trial that failed as a whole.
    fn failed(&self, trial: u32, truth: &[f64], problem: &str) -> Vec<Row> {
        (0..self.plan.spec.noise.len())
            .flat_map(|level| self.failed_at(&Place { trial, level, truth }, problem))
            .collect()
    }

    fn failed_at(&self, place: &Place, problem: &str) -> Vec<Row> {
        let smoothings = smoothings(&self.plan.spec).into_iter();
        let cells =
            smoothings.flat_map(|smoothed| self.plan.estimators.iter().map(move |&estimator| (smoothed, estimator)));
        cells.map(|(smoothed, estimator)| row(place, smoothed, estimator, Err(problem.to_owned()), 0.0)).collect()
    }
}

fn row(
    place: &Place,
    (signals, window): (Variant, u32),
    estimator: &dyn Estimator,
    outcome: std::result::Result<Found, String>,
    seconds: f64,
) -> Row {
    Row {
        trial: place.trial,
        level: place.level as u32,
        signals,
        window,
        estimator: estimator.name().to_owned(),
        truth: place.truth.to_vec(),
        outcome,
        seconds,
    }
}

fn set_noise(setup: &mut Setup, level: &NoiseLevel) {
    for sensor in &mut setup.sensors {
        sensor.encoder_noise = level.encoder_rad.unwrap_or(sensor.encoder_noise);
        sensor.torque_noise = level.torque_nm.unwrap_or(sensor.torque_noise);
    }
}
