//! `tauscope excite`: search for an excitation motion, or compare the parametrisations.

use crate::cli::shared::{DONE, Global, interrupt, print, progress, time};
use crate::design::criterion::KAPPA_WEIGHT;
use crate::design::{Criterion, Envelope, Experiment, Problem};
use crate::error::{Error, Result};
use crate::excitation::{Motion, MotionFile};
use crate::internal::design::{Family, Judge, Outcome, Request, compare, excite};
use crate::internal::excitation::random_point;
use crate::report::excitation;
use crate::scenario::Arm;
use clap::builder::PossibleValuesParser;
use rayon::prelude::*;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

/// Least time between two writings of the best motion so far.
const WRITE_EVERY: Duration = Duration::from_secs(1);

/// Share of the time that checking and writing may take during the search: one part in this many.
const WRITING_SHARE: u32 = 20;

/// Motions evaluated to learn how fast this machine is, where only the time is limited.
const SPEED_PROBES: u64 = 200;

/// Arguments of `tauscope excite`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example:\n  tauscope excite scenarios/irb1600.toml --duration 20 --budget 60s --out motion.toml"
)]
pub(crate) struct Arguments {
    /// Scenario file: arm, limits, torque noise, rate of the log.
    #[arg(default_value = "scenarios/irb1600.toml")]
    scenario: PathBuf,
    /// Parametrisation of the motion.
    #[arg(long, help_heading = "Motion", default_value = "freudenstein", value_parser = PossibleValuesParser::new(Motion::KINDS))]
    kind: String,
    /// Length, s; above 10 s the motion is joined from blocks of about 10 s where the parametrisation allows.
    #[arg(long, help_heading = "Motion", value_name = "S", default_value_t = 10.0)]
    duration: f64,
    /// Moves (segments, harmonics, control points) of each joint. Default: the usual number for the length.
    #[arg(long, help_heading = "Motion", value_name = "N")]
    moves: Option<usize>,
    /// Criterion to minimise.
    #[arg(long, help_heading = "Search", default_value = "compromise", value_parser = PossibleValuesParser::new(Criterion::NAMES))]
    criterion: String,
    /// Weight of ln kappa in the compromise D + W ln kappa.
    #[arg(long, help_heading = "Search", value_name = "W", default_value_t = KAPPA_WEIGHT)]
    kappa_weight: f64,
    /// Total number of evaluations; makes the search reproducible to the byte. Default: 30000, or what fits into --budget.
    #[arg(long, help_heading = "Search", value_name = "N")]
    evaluations: Option<usize>,
    /// Time for the search, as 60s or 2min; the best motion by then is kept. Ctrl-C does the same.
    #[arg(long, alias = "budget-s", value_name = "TIME", value_parser = time, help_heading = "Search")]
    budget: Option<Duration>,
    /// Independent starts that share the evaluations.
    #[arg(long, help_heading = "Search", value_name = "N", default_value_t = 1)]
    starts: usize,
    /// Rate of the grid on which the search evaluates, Hz.
    #[arg(long, help_heading = "Search", value_name = "HZ", default_value_t = 50.0)]
    grid_hz: f64,
    /// Compare all parametrisations at this length instead of writing a motion.
    #[arg(long, help_heading = "Output")]
    compare: bool,
}

/// Searches and writes the motion to `--out` (a file that ends in .toml, or a folder for `motion.toml`).
pub(crate) fn run(arguments: &Arguments, global: &Global) -> Result<u8> {
    let arm = Arm::load(&arguments.scenario, global.seed)?;
    let problem = problem(arguments, &arm)?;
    let mut request = Request {
        family: Family::named(&arguments.kind)?,
        duration_s: arguments.duration,
        size: arguments.moves,
        still_band: arm.scenario.identification.reversal_band_rad_s,
        seed: arm.scenario.seed,
        starts: arguments.starts,
        evaluations: arguments.evaluations.unwrap_or(30_000),
    };
    // A time too long for the clock is no limit.
    let deadline = arguments.budget.and_then(|budget| Instant::now().checked_add(budget));
    if let (None, Some(budget)) = (arguments.evaluations, arguments.budget) {
        request.evaluations = affordable(&problem, &request, budget)?;
    }
    let stop = interrupt::flag(global)?;
    let go_on = || !stop.load(Ordering::Relaxed) && deadline.is_none_or(|deadline| Instant::now() < deadline);
    if arguments.compare {
        return run_comparison(&problem, &request, global, &go_on);
    }
    let mut writer = Writer::new(path(global, &arm.scenario.name), &problem);
    let bar = progress::bar(global, "searching", request.evaluations);
    let mut failed = None;
    let outcome = excite(&problem, &request, &mut |progress, better| {
        bar.set_position(progress.evaluations as u64);
        if let Some(best) = progress.best {
            bar.set_message(format!("searching, best {} {best:.4}", problem.criterion.name()));
        }
        failed = better.and_then(|motion| writer.offer(motion).err());
        failed.is_none() && go_on()
    });
    bar.finish_and_clear();
    if let Some(error) = failed {
        return Err(error);
    }
    let outcome = outcome?;
    writer.write(&outcome.motion)?;
    report(&problem, &request, &outcome, &writer.path, global)
}

/// The problem that the scenario and the options pose.
fn problem(arguments: &Arguments, arm: &Arm) -> Result<Problem> {
    if !(arguments.grid_hz.is_finite() && arguments.grid_hz > 0.0) {
        return Err(Error::request("--grid-hz", format!("must be a number above zero, found {}", arguments.grid_hz)));
    }
    if !(arguments.kappa_weight.is_finite() && arguments.kappa_weight >= 0.0) {
        let problem = format!("must be a number of zero or more, found {}", arguments.kappa_weight);
        return Err(Error::request("--kappa-weight", problem));
    }
    let noise: Vec<f64> = arm.sensors.iter().map(|sensor| sensor.torque_noise).collect();
    let experiment = Experiment::new(&arm.known, &noise, arm.scenario.sensors.rate_hz)?;
    let envelope = Envelope::new(&arm.known, &arm.limits, arm.scenario.limits.workspace)?;
    let criterion = Criterion::named(&arguments.criterion, arguments.kappa_weight)?;
    Problem::new(experiment, envelope, criterion, arguments.grid_hz, arm.scenario.identification.reversal_band_rad_s)
}

/// Evaluations that fit into `budget`, from the speed of some random ones.
fn affordable(problem: &Problem, request: &Request, budget: Duration) -> Result<usize> {
    let size = request.size.unwrap_or_else(|| request.family.usual_size(request.duration_s));
    let encoding = request.family.encoding(problem.envelope.joints(), request.duration_s, size)?;
    let started = Instant::now();
    (0..SPEED_PROBES).into_par_iter().for_each(|index| {
        let motion = encoding.decode(&random_point(&*encoding, request.seed, "speed", index));
        let (information, violation) = problem.observe(&motion);
        std::hint::black_box(problem.worth(&information, violation));
    });
    let each = started.elapsed().as_secs_f64() / SPEED_PROBES as f64;
    Ok(((budget.as_secs_f64() / each) as usize).max(1))
}

/// Where the motion goes.
fn path(global: &Global, scenario: &str) -> PathBuf {
    match &global.out {
        Some(file) if file.extension().is_some_and(|extension| extension == "toml") => file.clone(),
        _ => global.folder(&format!("{scenario}_excitation")).join("motion.toml"),
    }
}

/// Keeps the best motion so far on disk.
struct Writer<'a> {
    path: PathBuf,
    problem: &'a Problem,
    /// When the next writing is due.
    due: Instant,
}

impl<'a> Writer<'a> {
    fn new(path: PathBuf, problem: &'a Problem) -> Self {
        Writer { path, problem, due: Instant::now() }
    }

    /// Writes a better motion if it is time to and it passes the check at 10 kHz.
    fn offer(&mut self, motion: &Motion) -> Result<()> {
        let started = Instant::now();
        if started < self.due {
            return Ok(());
        }
        if self.problem.envelope.check(motion).is_ok() {
            self.write(motion)?;
        }
        self.due = Instant::now() + WRITE_EVERY.max(started.elapsed() * WRITING_SHARE);
        Ok(())
    }

    /// Writes to another file and renames it, so that the motion is whole at any time.
    fn write(&self, motion: &Motion) -> Result<()> {
        let robot = self.problem.envelope.robot();
        let file = MotionFile { robot: robot.name.clone(), joints: robot.joint_names(), motion: motion.clone() };
        if let Some(folder) = self.path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
            std::fs::create_dir_all(folder).map_err(|source| Error::io(folder, "create the folder", source))?;
        }
        let partial = self.path.with_extension("toml.partial");
        file.write(&partial)?;
        std::fs::rename(&partial, &self.path).map_err(|source| Error::io(&self.path, "write the motion", source))
    }
}

fn report(problem: &Problem, request: &Request, outcome: &Outcome, path: &Path, global: &Global) -> Result<u8> {
    let judge = Judge::new(problem, request)?;
    let row = judge.row(request.family.name(), &outcome.motion);
    let found = excitation::found(problem, request, outcome, path, &row, judge.random_median());
    let text = || {
        let rows: Vec<_> = std::iter::once(&row).chain(judge.random_median()).cloned().collect();
        let table = excitation::table(problem.experiment.beta().len(), &rows);
        format!("{table}\n\n{}\n\nMotion in {}", excitation::summary(problem, request, outcome), path.display())
    };
    print::result(global, excitation::SCHEMA, &found, text)?;
    Ok(DONE)
}

fn run_comparison(problem: &Problem, request: &Request, global: &Global, go_on: &dyn Fn() -> bool) -> Result<u8> {
    let bar = progress::bar(global, "comparing", request.evaluations * Family::ALL.len());
    let (mut done, mut last) = (0, 0);
    let comparison = compare(problem, request, &mut |progress, _| {
        if progress.evaluations < last {
            done += last;
        }
        last = progress.evaluations;
        bar.set_position((done + last) as u64);
        go_on()
    })?;
    bar.finish_and_clear();
    let text = || excitation::comparison(problem, &comparison);
    print::result(global, excitation::COMPARISON_SCHEMA, &comparison, text)?;
    Ok(DONE)
}
