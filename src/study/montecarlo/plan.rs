//! What a study draws and compares, from the scenario's `[montecarlo]` table and the command line.

use crate::error::{Error, Result};
use crate::internal::identification::{Estimator, estimator};
use crate::internal::random::fnv1a;
use crate::scenario::{MonteCarloSpec, NoiseLevel, Setup};
use crate::signal::{Edge, SavitzkyGolay};
use crate::study::testbed::Variant;
use serde::Serialize;

/// Most chunks a study is cut into, and most trials in a chunk.
const CHUNKS: usize = 64;
const LARGEST_CHUNK: usize = 64;

/// What replaces the scenario's `[montecarlo]` table.
///
/// ```
/// use tauscope::scenario::Setup;
/// use tauscope::study::montecarlo::{Overrides, Plan};
///
/// // What is given here replaces the entries of the scenario's table.
/// let setup = Setup::load("tests/scenarios/montecarlo.toml", None)?;
/// let plan = Plan::new(&setup, Overrides { trials: Some(5), ..Overrides::default() })?;
/// assert_eq!((plan.spec.trials, &plan.spec.sg_windows[..]), (5, &[31][..]));
/// assert!(Plan::new(&setup, Overrides { trials: Some(0), ..Overrides::default() }).is_err());
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct Overrides {
    /// Number of trials.
    pub trials: Option<usize>,
    /// Estimators by name.
    pub estimators: Option<Vec<String>>,
    /// Savitzky-Golay windows, 0 for none.
    pub windows: Option<Vec<usize>>,
    /// Smooth by common practice too, whether or not the scenario asks for it.
    pub butterworth: bool,
    /// Noise levels.
    pub noise: Option<Vec<NoiseLevel>>,
}

/// What a study draws and compares.
///
/// ```
/// use tauscope::scenario::Setup;
/// use tauscope::study::montecarlo::{Overrides, Plan};
///
/// // Two estimators with two windows: four rows a trial.
/// let setup = Setup::load("tests/scenarios/pendulum.toml", None)?;
/// let (estimators, windows) = (Some(["wls", "iv"].map(str::to_owned).to_vec()), Some(vec![0, 61]));
/// let overrides = Overrides { trials: Some(100), estimators, windows, ..Overrides::default() };
/// let plan = Plan::new(&setup, overrides)?;
/// assert_eq!((plan.cells(), plan.draws_runs()), (4, false));
/// assert_eq!((0..plan.chunks()).map(|chunk| plan.trials_of(chunk).len()).sum::<usize>(), 100);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
pub struct Plan {
    /// The table, with everything that was left out filled in.
    pub spec: MonteCarloSpec,
    /// The estimators named there.
    pub estimators: Vec<&'static dyn Estimator>,
}

impl Plan {
    /// The plan of a scenario with `overrides`.
    ///
    /// # Errors
    /// For an unknown estimator, an impossible window or noise level, an empty list, or no trials.
    pub fn new(setup: &Setup, overrides: Overrides) -> Result<Self> {
        let scenario = &setup.scenario;
        let mut spec = scenario.montecarlo.clone().unwrap_or_default();
        spec.trials = overrides.trials.unwrap_or(spec.trials);
        spec.estimators = overrides.estimators.unwrap_or(spec.estimators);
        spec.sg_windows = overrides.windows.unwrap_or(spec.sg_windows);
        spec.butterworth |= overrides.butterworth;
        spec.noise = overrides.noise.unwrap_or(spec.noise);
        if spec.sg_windows.is_empty() {
            spec.sg_windows = vec![0, scenario.identification.fixed_window(scenario.sensors.rate_hz)];
        }
        if spec.noise.is_empty() {
            spec.noise = vec![NoiseLevel::default()];
        }
        if spec.trials == 0 || u32::try_from(spec.trials).is_err() {
            return Err(Error::request("trials", format!("{} make no study; take 1 to {}", spec.trials, u32::MAX)));
        }
        if let Some(level) = spec.noise.iter().find(|level| !level.is_possible()) {
            return Err(Error::request(
                "noise level",
                format!("{level:?}: standard deviations are numbers from zero up"),
            ));
        }
        let period = 1.0 / scenario.sensors.rate_hz;
        for &window in spec.sg_windows.iter().filter(|&&window| window != 0) {
            SavitzkyGolay::new(window, scenario.identification.smoothing_order, 2, period, Edge::Nearest)?;
        }
        require_distinct("estimators", &spec.estimators)?;
        require_distinct("Savitzky-Golay windows", &spec.sg_windows)?;
        let found: Result<Vec<&'static dyn Estimator>> = spec.estimators.iter().map(|name| estimator(name)).collect();
        Ok(Plan { estimators: found?, spec })
    }

    /// Whether trials differ in more than noise, so that each is simulated anew.
    pub fn draws_runs(&self) -> bool {
        self.spec.plant_error > 0.0 || self.spec.random_motion.is_some()
    }

    /// Rows of one trial: noise levels x smoothings x estimators.
    pub fn cells(&self) -> usize {
        cells(&self.spec)
    }

    /// Trials in a chunk, the last one excepted: it depends on the number of trials alone, never on threads or shards.
    pub fn chunk_trials(&self) -> usize {
        (self.spec.trials / CHUNKS).clamp(1, LARGEST_CHUNK)
    }

    /// Number of chunks.
    pub fn chunks(&self) -> usize {
        self.spec.trials.div_ceil(self.chunk_trials())
    }

    /// The trials of a chunk.
    pub fn trials_of(&self, chunk: usize) -> std::ops::Range<u32> {
        let size = self.chunk_trials();
        let end = ((chunk + 1) * size).min(self.spec.trials);
        (chunk * size) as u32..end as u32
    }

    /// Identity of this study: two folders whose identities agree hold trials of one study.
    ///
    /// # Errors
    /// If a file the scenario refers to cannot be read any more.
    pub fn identity(&self, setup: &Setup, parameters: &[String]) -> Result<Identity> {
        let mut text = setup.merged()?;
        for (_, path) in setup.inputs() {
            text +=
                &std::fs::read_to_string(path).map_err(|e| Error::io(path, "read what the scenario refers to", e))?;
        }
        Ok(Identity {
            scenario: setup.scenario.name.clone(),
            seed: setup.scenario.seed,
            inputs: format!("{:016x}", fnv1a(&text, 0xcbf2_9ce4_8422_2325)),
            chunk_trials: self.chunk_trials(),
            montecarlo: self.spec.clone(),
            joints: setup.known.joint_names(),
            parameters: parameters.to_vec(),
        })
    }
}

/// Identity of a study, kept with its trials as `study.json`.
///
/// ```
/// use tauscope::scenario::Setup;
/// use tauscope::study::montecarlo::{Overrides, Plan};
///
/// // Two machines do parts of one study where this agrees; another seed is another study.
/// let identity = |seed| {
///     let setup = Setup::load("tests/scenarios/pendulum.toml", Some(seed))?;
///     Plan::new(&setup, Overrides::default())?.identity(&setup, &[])
/// };
/// assert_eq!(identity(1)?, identity(1)?);
/// assert_ne!(identity(1)?, identity(2)?);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, serde::Deserialize)]
pub struct Identity {
    /// Name of the scenario.
    pub scenario: String,
    /// Seed of all streams.
    pub seed: u64,
    /// Checksum of the scenario, its arm and its motions.
    pub inputs: String,
    /// Trials in a chunk.
    pub chunk_trials: usize,
    /// What is drawn and compared.
    pub montecarlo: MonteCarloSpec,
    /// Joints of the arm.
    pub joints: Vec<String>,
    /// Names of the base parameters.
    pub parameters: Vec<String>,
}

impl Identity {
    /// Number of chunks.
    pub fn chunks(&self) -> usize {
        self.montecarlo.trials.div_ceil(self.chunk_trials)
    }

    /// Rows of one trial.
    pub fn cells(&self) -> usize {
        cells(&self.montecarlo)
    }
}

/// How a study smooths, in the order of its rows: signals and Savitzky-Golay window, 0 where there is none.
pub(super) fn smoothings(spec: &MonteCarloSpec) -> Vec<(Variant, u32)> {
    let of_window = |&window: &usize| match window {
        0 => (Variant::Raw, 0),
        _ => (Variant::SavitzkyGolay, window as u32),
    };
    let usual = spec.butterworth.then_some((Variant::Butterworth, 0));
    spec.sg_windows.iter().map(of_window).chain(usual).collect()
}

fn cells(spec: &MonteCarloSpec) -> usize {
    spec.noise.len() * smoothings(spec).len() * spec.estimators.len()
}

fn require_distinct<T: PartialEq + std::fmt::Display>(what: &str, values: &[T]) -> Result<()> {
    if values.is_empty() {
        return Err(Error::request(what, "none are given; name at least one"));
    }
    match values.iter().enumerate().find(|(index, value)| values[..*index].contains(value)) {
        Some((_, value)) => Err(Error::request(what, format!("{value} is given twice"))),
        None => Ok(()),
    }
}
