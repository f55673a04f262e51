//! `tauscope blind`: hide effects in simulated arms and count how often the diagnosis names them.

use crate::cli::shared::{DONE, FAILED, Global, interrupt, print, progress, trust};
use crate::effects::{self, Placed, Scope, find};
use crate::error::{Error, Result};
use crate::identification::effect_model::Trust;
use crate::output::ResultFolder;
use crate::recording::csv;
use crate::report::blind::{self as report, BlindResult, SCHEMA};
use crate::robot::to_urdf;
use crate::scenario::Setup;
use crate::study::blind::journal::{Identity, Journal};
use crate::study::blind::motion::TRAIN;
use crate::study::blind::row::Row;
use crate::study::blind::summary::Summary;
use crate::study::blind::{BlindRun, Case, Class, Plan, draw, run as blind_run};
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Arguments of `tauscope blind`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  tauscope blind --effect stribeck_friction:joint_2 --runs 5 --severity 2")]
pub(crate) struct Arguments {
    /// Scenario whose arm, limits and sensors are used, in addition to arms drawn at random.
    #[arg(long, help_heading = "Study", value_name = "SCENARIO", default_value = "scenarios/irb1600.toml")]
    scenario: PathBuf,
    /// Make the whole study (hours) in place of a short one (minutes).
    #[arg(long, help_heading = "Study")]
    full: bool,
    /// Make runs of these classes only. Default: all.
    #[arg(long, help_heading = "Study", value_enum, value_delimiter = ',')]
    class: Vec<Class>,
    /// Repeat one run of the study, by its number, and show it; with --out, its logs and the arm are written too.
    #[arg(long, help_heading = "Study", value_name = "N", conflicts_with_all = ["class", "resume"])]
    run: Option<usize>,
    /// Continue a study that was stopped.
    #[arg(long, help_heading = "Study")]
    resume: bool,
    /// Parallel runs. Default: the number of processors.
    #[arg(long, help_heading = "Study", value_name = "N")]
    jobs: Option<std::num::NonZeroUsize>,
    /// In place of the study: hide this effect, `NAME` or `NAME:JOINT` or `none` or `any`, in the scenario's own arm.
    #[arg(long, help_heading = "One effect", value_name = "EFFECT", conflicts_with_all = ["full", "class"])]
    effect: Option<String>,
    /// Number of runs with --effect.
    #[arg(long, help_heading = "One effect", default_value_t = 10, requires = "effect")]
    runs: u64,
    /// Size of --effect: root mean square of the torque that it adds beyond the baseline, over that of the torque noise.
    #[arg(long, help_heading = "One effect", default_value_t = 1.0, requires = "effect")]
    severity: f64,
    /// Correlation times of the torque noise with --effect, s, comma-separated, taken in turn.
    #[arg(
        long,
        help_heading = "One effect",
        value_name = "S",
        value_delimiter = ',',
        default_value = "0,0.13,0.5",
        requires = "effect"
    )]
    correlation: Vec<f64>,
    /// With --effect: estimate inertias (structure), or take them from the URDF (nominal).
    #[arg(long, help_heading = "One effect", value_parser = trust::parser(), default_value = "nominal", requires = "effect")]
    trust: Trust,
}

/// Makes the runs and writes the tables.
pub(crate) fn run(arguments: &Arguments, global: &Global) -> Result<u8> {
    let setup = Setup::load(&arguments.scenario, global.seed)?;
    let seed = setup.scenario.seed;
    let (plan, mut cases) = plan(arguments, &setup)?;
    if let Some(index) = arguments.run {
        let count = cases.len();
        let Some(case) = cases.get(index) else {
            return Err(Error::request("--run", format!("the study has runs 0 to {}", count - 1)));
        };
        let made = blind_run(&setup, case);
        let row = Row::new(case, &made);
        if let (Ok(made), Some(out)) = (&made, &global.out) {
            write_run(made, &row, out)?;
        }
        print::result(global, SCHEMA, &row, || report::line(&row))?;
        return Ok(DONE);
    }
    if !arguments.class.is_empty() {
        cases.retain(|case| arguments.class.contains(&case.class));
    }
    let out = global.folder("blind");
    drop(ResultFolder::create(&out)?);
    let identity = Identity { seed, scenario: setup.scenario.name.clone(), plan };
    let (journal, mut rows) = Journal::open(&out, &identity, arguments.resume)?;
    let planned: Vec<usize> = cases.iter().map(|case| case.index).collect();
    rows.retain(|row| planned.contains(&row.run));
    cases.retain(|case| rows.iter().all(|row| row.run != case.index));
    let (journal, rows) = make(&setup, &cases, journal, rows, arguments.jobs, global)?;

    let result = BlindResult { seed, summary: Summary::new(&rows), runs: rows };
    let left = planned.len() - result.runs.len();
    if left > 0 {
        if !global.quiet {
            eprintln!(
                "Stopped with {left} runs to go; --resume continues. Up to here:\n{}",
                report::counts(&result.summary)
            );
        }
        return Ok(FAILED);
    }
    let folder = ResultFolder::create(&out)?;
    folder.write_json("blind.json", SCHEMA, &result)?;
    folder.write_text("confusion.csv", &report::confusion_csv(&result.summary))?;
    folder.write_text("blind.md", &report::page(&result))?;
    let path = folder.finish()?;
    journal.remove()?;
    print::result(global, SCHEMA, &result, || {
        format!("{}\n\nResults in {}", report::counts(&result.summary), path.display())
    })?;
    Ok(DONE)
}

/// Writes what a run showed to the diagnosis, and what came of it, so that it can be looked into with the other commands.
fn write_run(made: &BlindRun, row: &Row, out: &Path) -> Result<()> {
    let folder = ResultFolder::create(out)?;
    folder.write_text("robot.urdf", &to_urdf(&made.robot))?;
    for (index, log) in made.logs.iter().enumerate() {
        let name = if index < TRAIN { format!("train_{}.csv", index + 1) } else { "test.csv".to_owned() };
        folder.write_with(&name, |path| csv::write(path, log))?;
    }
    folder.write_json("blind_run.json", SCHEMA, row)?;
    folder.finish().map(|_| ())
}

/// Makes the cases on all processors, a run on each, until all are made or ctrl-C; adds to `rows`, in the plan's order.
fn make(
    setup: &Setup,
    cases: &[Case],
    journal: Journal,
    mut rows: Vec<Row>,
    jobs: Option<std::num::NonZeroUsize>,
    global: &Global,
) -> Result<(Journal, Vec<Row>)> {
    let stop = interrupt::flag(global)?;
    let bar = progress::bar(global, "blind runs", cases.len());
    let processors = std::thread::available_parallelism().map_or(1, usize::from);
    let jobs = jobs.map_or(processors, usize::from).min(cases.len().max(1));
    let next = AtomicUsize::new(0);
    let shared = Mutex::new((journal, Vec::new()));
    let work = || -> Result<()> {
        // One run on a thread each wastes less of them than one run on all.
        let pool = rayon::ThreadPoolBuilder::new().num_threads((processors / jobs).max(1)).build();
        let pool = pool.map_err(|problem| Error::request("--jobs", format!("no threads: {problem}")))?;
        while !stop.load(Ordering::Relaxed) {
            let Some(case) = cases.get(next.fetch_add(1, Ordering::Relaxed)) else { break };
            let row = pool.install(|| Row::new(case, &blind_run(setup, case)));
            bar.inc(1);
            if !global.quiet && !global.json {
                match std::io::stderr().is_terminal() {
                    true => bar.println(report::line(&row)),
                    false => eprintln!("{} of {}: {}", bar.position(), cases.len(), report::line(&row)),
                }
            }
            let mut shared = shared.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
            shared.0.add(&row)?;
            shared.1.push(row);
        }
        Ok(())
    };
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..jobs).map(|_| scope.spawn(work)).collect();
        workers.into_iter().try_for_each(|worker| match worker.join() {
            Ok(result) => result,
            Err(panic) => std::panic::resume_unwind(panic),
        })
    })?;
    bar.finish_and_clear();
    let (journal, made) = shared.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
    rows.extend(made);
    rows.sort_by_key(|row| row.run);
    Ok((journal, rows))
}

/// The cases asked for, and the plan in words.
fn plan(arguments: &Arguments, setup: &Setup) -> Result<(String, Vec<Case>)> {
    let Some(wanted) = &arguments.effect else {
        let plan = if arguments.full { Plan::FULL } else { Plan::SMALL };
        return Ok((format!("{plan:?}"), plan.cases(setup.scenario.seed, setup.known.dof())));
    };
    let Arguments { runs, severity, correlation, trust, .. } = arguments;
    if correlation.is_empty() || !(*severity > 0.0 && severity.is_finite()) {
        return Err(Error::request("--severity", "must be a positive number, with at least one --correlation"));
    }
    let case = |index: u64| {
        let seed = setup.scenario.seed.wrapping_add(index);
        let correlation_s = correlation[index as usize % correlation.len()];
        let mut case = draw(setup, seed, *severity, correlation_s, *trust);
        case.index = index as usize;
        if wanted != "any" {
            case.hidden = hidden(wanted, setup, index)?.into_iter().collect();
        }
        Ok(case)
    };
    let cases = (0..*runs).map(case).collect::<Result<Vec<Case>>>()?;
    Ok((format!("{runs} x {wanted} at {severity}, noise {correlation:?}, {trust:?}"), cases))
}

/// The effect asked for; without a joint it takes all joints in turn.
fn hidden(wanted: &str, setup: &Setup, index: u64) -> Result<Option<Placed>> {
    if wanted == "none" {
        return Ok(None);
    }
    let (name, joint) = wanted.split_once(':').map_or((wanted, None), |(name, joint)| (name, Some(joint)));
    let effect = find(name)?;
    let dof = setup.known.dof();
    let joint = match (effect.about().scope, joint) {
        (Scope::Joint, None) => index as usize % dof,
        (Scope::Pair, None) => index as usize % (dof - 1).max(1),
        _ => effects::joint(effect, joint, &setup.known).map_err(|problem| Error::request(wanted, problem))?,
    };
    Ok(Some(Placed::typical(effect, joint)))
}
