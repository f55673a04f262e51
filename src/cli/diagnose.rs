//! `tauscope diagnose`: name what the model of an arm misses, from logs.

use super::arm::ArmArguments;
use super::{DONE, Global, corrected, print, progress};
use crate::dataset::arm::LoggedArm;
use crate::dataset::{self, Dataset, Named};
use crate::diagnosis::{
    Consequence, Input, Observed, Options, Screened, all_faults, check_length, conclude, correct, held_out, observed,
    screen_all, shared_verdict, still_joints,
};
use crate::effects::{self, Placed};
use crate::error::{Error, Result};
use crate::identification::effect_model::Trust;
use crate::output::ResultFolder;
use crate::quality::UnitChanges;
use crate::recording::Recording;
use crate::recording::lenient::Sieved;
use crate::report::diagnosis::{self as report, EXTENDED_SCENARIO, EXTENDED_URDF, SCHEMA};
use crate::report::html::{self, Provenance};
use crate::report::viewer;
use crate::robot::{self, Robot};
use crate::scenario::{Arm, Scenario};
use crate::simulation::engine::EngineKind;
use std::collections::HashSet;
use std::hash::{DefaultHasher, Hasher};
use std::path::PathBuf;

/// What the written scenario says of itself.
const EXTENDED_NOTE: &str = "\
# The model of the arm as `tauscope diagnose` found it. Bodies, rotors and friction of the drives are in extended.urdf, what the
# arm does beyond is in the [[effect]] tables.

";

/// Rounds of the search that there are even where nothing is found.
const LEAST_ROUNDS: usize = 2;

/// Held-out logs shorter than this together judge nothing, s.
const SHORTEST_HELD_OUT_S: f64 = 2.0;

/// Arguments of `tauscope diagnose`.
#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    arm: ArmArguments,
    /// Log to find from; repeat for more.
    #[arg(long, value_name = "LOG", required_unless_present = "dataset")]
    train: Vec<PathBuf>,
    /// Log of another motion to judge by; repeat for more. Without any, the last part of every training log.
    #[arg(long, value_name = "LOG")]
    test: Vec<PathBuf>,
    /// Description of logs: columns, units, motors, payload, mounting, which of them are found from and which judge.
    #[arg(long, value_name = "TOML", conflicts_with_all = ["train", "test"])]
    dataset: Option<PathBuf>,
    /// Log from before a change; repeat for more. The question is then what changed since: a payload, wear, a new hose.
    #[arg(long, value_name = "LOG")]
    reference: Vec<PathBuf>,
    /// The simulation as it stands: its arm, friction, gravity and effects are known, and what else is missing is asked.
    #[arg(long, value_name = "SCENARIO")]
    scenario: Option<PathBuf>,
    /// Whether the URDF's inertias are believed, or re-identified.
    #[arg(long, value_enum, default_value = "structure")]
    trust: Trust,
    /// Probability of naming anything where there is nothing.
    #[arg(long, default_value_t = 0.05)]
    alpha: f64,
    /// Most effects that are named.
    #[arg(long, default_value = "12", value_parser = clap::value_parser!(u16).range(1..))]
    max_findings: u16,
    /// Effects to look for, with commas between, or repeated. All of the library where absent.
    #[arg(long, value_name = "EFFECTS", value_delimiter = ',')]
    candidates: Vec<String>,
    /// Leave out the simulation of what was found along the held-out motion.
    #[arg(long)]
    no_resimulation: bool,
    /// Forward dynamics of that simulation: rapier, or the project's own, the same to rounding.
    #[arg(long, value_enum, default_value = "rapier")]
    engine: EngineKind,
}

/// Diagnoses and writes the results folder.
pub(super) fn run(arguments: &Arguments, global: &Global) -> Result<u8> {
    if !(arguments.alpha > 0.0 && arguments.alpha < 1.0) {
        return Err(Error::request("--alpha", format!("is {}; give a probability between 0 and 1", arguments.alpha)));
    }
    for name in &arguments.candidates {
        effects::find(name)?;
    }
    let dataset = arguments.dataset.as_ref().map(Dataset::load).transpose()?;
    let Simulation { arm, mut robot, scenario } = simulation(arguments, dataset.as_ref())?;
    let bar = progress::bar(global, "looking at the logs", LEAST_ROUNDS + 1);
    let [train, test] = match &dataset {
        Some(dataset) => dataset.sieved(&robot)?,
        None => [dataset::read_all(&arguments.train, &robot)?, dataset::read_all(&arguments.test, &robot)?],
    };
    let mut logs = [train, test, dataset::read_all(&arguments.reference, &robot)?];
    if let Some(mut arm) = arm {
        arm.settle(dataset.as_ref(), &mut logs)?;
        robot = arm.robot;
    }
    let effects = present(arguments, scenario.as_ref(), &robot)?;
    let [train, test, reference] = logs;
    let mut reference = screened(reference, &robot)?;
    let trained = train.len();
    let mut train = screened(train.into_iter().chain(test).collect(), &robot)?;
    let mut test = train.split_off(trained);
    let (trained, judged) = match &arguments.dataset {
        Some(path) => (format!("{}: train", path.display()), format!("{}: test", path.display())),
        None => ("--train".to_owned(), "--test".to_owned()),
    };
    check_length(&trained, &train)?;
    check_held_out(&judged, &test)?;
    check_length("--reference", &reference)?;
    refuse_twice([("--train", &train), ("--test", &test), ("--reference", &reference)])?;
    let folder = ResultFolder::create(global.folder(&format!("diagnose_{}", robot.name)))?;
    let mut all: Vec<&mut Screened> = train.iter_mut().chain(&mut test).chain(&mut reference).collect();
    let found = shared_verdict(&all);
    correct(&mut all, &mut robot);
    if let Some(description) = found.map(|verdict| verdict.description) {
        let named =
            Named { robot: arguments.arm.robot.clone(), train: arguments.train.clone(), test: arguments.test.clone() };
        corrected::write(&folder, dataset.as_ref(), &named, &robot, &description, UnitChanges::default())?;
    }
    let mut faults = all_faults(&train, &test, &reference, &robot);
    if faults.iter().any(|fault| fault.consequence == Consequence::Stops) {
        bar.finish_and_clear();
        let result = report::stopped(&robot, arguments.alpha, &faults);
        folder.write_json("diagnosis.json", SCHEMA, &result)?;
        let logs: Vec<&Recording> = [&train, &test, &reference].into_iter().flat_map(|logs| recordings(logs)).collect();
        let provenance = Provenance::here(global.seed);
        let page = html::stopped::page(&robot, &logs, &faults, provenance);
        folder.write_text(html::FILE, &page.render())?;
        let path = folder.finish()?;
        print::result(global, SCHEMA, &result, || {
            format!("{}\nResults in {}", report::stopped_lines(&faults), path.display())
        })?;
        return Ok(DONE);
    }

    let input = Input {
        train: recordings(&train),
        test: recordings(&test),
        reference: recordings(&reference),
        present: effects,
    };
    let options = Options {
        trust: arguments.trust,
        alpha: arguments.alpha,
        max_findings: arguments.max_findings.into(),
        seed: global.seed.unwrap_or_default(),
        candidates: arguments.candidates.clone(),
    };
    let still: Vec<usize> = still_joints(&train, &robot).into_iter().map(|(joint, _)| joint).collect();
    let Observed { model, left_out } = observed(&robot, &input, &still)?;
    faults.extend(left_out);
    bar.set_message("testing every effect on every joint");
    let conclusion = conclude(&model, &input, &options, &mut |found| {
        bar.set_message(format!("{found} found, testing for the next"));
        bar.inc(1);
        // How many rounds it takes depends on what is found: one more at the least, and the simulation behind.
        bar.set_length(bar.position() + 2);
    })?;
    bar.inc(1);
    bar.set_length(bar.position() + 1);
    bar.set_message("simulating the extended model");
    let extended = conclusion.extended()?;
    let resimulation = match arguments.no_resimulation {
        true => None,
        false => match conclusion.resimulate(&extended, arguments.engine) {
            Ok(run) => Some(run),
            Err(problem) => {
                tracing::warn!("the extended model was not simulated: {problem}");
                None
            }
        },
    };
    bar.finish_and_clear();

    let diagnosis = &conclusion.diagnosis;
    let measured = conclusion.measured(&input.train);
    let written = Scenario::of(
        &extended.robot,
        EXTENDED_URDF.as_ref(),
        &extended.effects,
        scenario.as_ref(),
        &measured,
        options.seed,
    );
    folder.write_text(EXTENDED_URDF, &robot::with_parameters(&extended.robot)?)?;
    folder.write_text(EXTENDED_SCENARIO, &format!("{EXTENDED_NOTE}{}", written.to_toml()?))?;
    let result = report::result(&robot, diagnosis, resimulation.as_ref(), &faults);
    folder.write_json("diagnosis.json", SCHEMA, &result)?;
    let lines = report::lines(&robot, diagnosis, resimulation.as_ref(), &faults);
    let held_out = held_out(&input);
    let held_out: Vec<&Recording> = held_out.iter().collect();
    let logs = html::diagnosis::Logs { train: &input.train, held_out: &held_out, faults: &faults };
    let provenance = Provenance::here(Some(options.seed));
    let page = html::diagnosis::page(&robot, diagnosis, resimulation.as_ref(), logs, provenance);
    folder.write_text(html::FILE, &page.render())?;
    let simulated = resimulation.as_ref().map(|run| &run.positions[..]);
    viewer::add(&folder, || Ok(viewer::diagnosis::film(&robot, &held_out, diagnosis, &lines, simulated)))?;
    let path = folder.finish()?;
    print::result(global, SCHEMA, &result, || format!("{lines}\nResults in {}", path.display()))?;
    Ok(DONE)
}

/// The simulation as it stands.
struct Simulation {
    /// The arm as the logs know it, where a file of it is named.
    arm: Option<LoggedArm>,
    robot: Robot,
    scenario: Option<Scenario>,
}

fn simulation(arguments: &Arguments, dataset: Option<&Dataset>) -> Result<Simulation> {
    let known = arguments.scenario.as_ref().map(|path| Arm::load(path, None)).transpose()?;
    if let Some(file) = arguments.arm.file(dataset) {
        let described = dataset.map(Dataset::files).unwrap_or_default();
        let logs =
            [&arguments.train, &arguments.test, &arguments.reference].into_iter().flatten().cloned().chain(described);
        let arm = arguments.arm.open(&file, arguments.trust, dataset, &logs.collect::<Vec<_>>())?;
        let robot = arm.robot.clone();
        return Ok(Simulation { arm: Some(arm), robot, scenario: known.map(|known| known.scenario) });
    }
    let Some(known) = known else {
        return Err(Error::request("--robot", "give the arm's URDF, or a --scenario or --dataset that names one"));
    };
    let mut robot = known.known;
    if let Some(dataset) = dataset {
        dataset.mount(&mut robot)?;
    }
    robot.gravity = arguments.arm.gravity.unwrap_or(robot.gravity);
    Ok(Simulation { arm: None, robot, scenario: Some(known.scenario) })
}

/// The effects that the simulation has.
fn present(arguments: &Arguments, scenario: Option<&Scenario>, robot: &Robot) -> Result<Vec<Placed>> {
    let (Some(path), Some(scenario)) = (&arguments.scenario, scenario) else { return Ok(Vec::new()) };
    let place = |spec: &crate::scenario::EffectSpec| {
        spec.place(robot).map_err(|problem| Error::input(path, None, "effect", problem))
    };
    scenario.effects.iter().map(place).collect()
}

/// Logs of one time, screened together.
fn screened(logs: Vec<(PathBuf, Sieved)>, robot: &Robot) -> Result<Vec<Screened>> {
    let named = logs.into_iter().map(|(path, sieved)| (path.display().to_string(), sieved));
    screen_all(named.collect(), robot)?.into_iter().collect()
}

fn recordings(logs: &[Screened]) -> Vec<&Recording> {
    logs.iter().flat_map(|log| &log.pieces).collect()
}

/// Logs that only judge may be shorter than those that are found from, but a moment tells nothing.
fn check_held_out(option: &str, logs: &[Screened]) -> Result<()> {
    let seconds: f64 = logs.iter().flat_map(|log| &log.pieces).map(Recording::duration).sum();
    if logs.is_empty() || seconds >= SHORTEST_HELD_OUT_S {
        return Ok(());
    }
    let problem = format!(
        "the logs last {seconds:.1} s together; give {SHORTEST_HELD_OUT_S} s at the least, or none: the last part of every \
         training log is held out then"
    );
    Err(Error::request(option, problem))
}

/// A log that is given twice, or in part, judges nothing, and counts for no more than once. Two recordings have hardly a sample in common.
fn refuse_twice(given: [(&str, &[Screened]); 3]) -> Result<()> {
    let mut seen: Vec<(String, HashSet<u64>)> = Vec::new();
    for (option, logs) in given {
        for log in logs {
            let samples = samples(log);
            let twice = seen.iter().find(|(_, other)| {
                let common = samples.intersection(other).count();
                2 * common > samples.len().min(other.len())
            });
            let name = format!("{option} {}", log.name);
            if let Some((other, _)) = twice {
                let problem = format!("has the samples of {other}; give every log once, and judge by another motion");
                return Err(Error::request(name, problem));
            }
            seen.push((name, samples));
        }
    }
    Ok(())
}

/// The samples of a log whatever their time: hashes of positions and torques to the last bit.
fn samples(log: &Screened) -> HashSet<u64> {
    let of_piece = |piece: &Recording| -> Vec<u64> {
        let hash = |k: usize| {
            let mut hasher = DefaultHasher::new();
            piece.q.iter().chain(piece.tau.iter()).for_each(|signal| hasher.write_u64(signal[k].to_bits()));
            hasher.finish()
        };
        (0..piece.samples()).map(hash).collect()
    };
    log.pieces.iter().flat_map(of_piece).collect()
}
