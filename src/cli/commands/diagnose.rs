//! `tauscope diagnose`: what the model of an arm misses, from logs. [`Diagnosis::of`] does the work; this file reads and writes.

use crate::cli::shared::{
    ArmArguments, BAD_INPUT, DONE, Global, LogArguments, corrected, interrupt, print, progress, time, trust,
};
use crate::dataset::arm::LoggedArm;
use crate::dataset::{self, Dataset};
use crate::diagnosis::{
    Answer, Conclusion, Consequence, Criteria, DIAGNOSIS_SCHEMA, DataFault, Diagnosis, EXTENDED_MJCF,
    EXTENDED_SCENARIO, EXTENDED_URDF, Options, Outcome, Progress,
};
use crate::effects::Placed;
use crate::error::{Error, Result};
use crate::identification::effect_model::Trust;
use crate::output::ResultFolder;
use crate::recording::Recording;
use crate::report::diagnosis as report;
use crate::report::html::{self, Provenance};
use crate::report::viewer;
use crate::robot::{self, Robot};
use crate::scenario::{Arm, Scenario};
use crate::simulation::engine::EngineKind;
use clap::ArgGroup;
use std::path::PathBuf;
use std::time::Duration;

/// Header of the written scenario.
const EXTENDED_NOTE: &str = "\
# The model of the arm as `tauscope diagnose` found it. Bodies, rotors and friction of the drives are in extended.urdf, what the
# arm does beyond is in the [[effect]] tables.

";

/// Rounds of the search that there are even where nothing is found.
const LEAST_ROUNDS: usize = 2;

/// Arguments of `tauscope diagnose`.
#[derive(Debug, clap::Args)]
#[command(
    group = ArgGroup::new("identified from").args(["train", "dataset"]).required(true),
    mut_arg("test", |test| test.help("Held-out logs of different motions. Repeatable. Default: the last 30 % of each training log")),
    after_help = "\
Exit codes: 0 an answer, also that nothing is missing; 2 bad input, also logs whose faults forbid an answer (not_testable).

Example:
  tauscope diagnose --robot arm.urdf --train monday.csv --test tuesday.csv --out results/arm"
)]
pub(crate) struct Arguments {
    #[command(flatten)]
    logs: LogArguments,
    /// Reference logs: those from before a change. The question is then what changed: a payload, wear, a new hose. Repeatable.
    #[arg(long, value_name = "LOG", num_args = 1.., help_heading = "Logs")]
    reference: Vec<PathBuf>,
    #[command(flatten)]
    arm: ArmArguments,
    /// Simulation of the arm: its bodies, friction, gravity and effects are known, and are part of the baseline.
    #[arg(long, value_name = "SCENARIO", help_heading = "Model")]
    scenario: Option<PathBuf>,
    /// Estimate the inertias (structure), or take them from the URDF (nominal).
    #[arg(long, value_parser = trust::parser(), default_value = "structure", help_heading = "Model")]
    trust: Trust,
    /// Family-wise false-alarm rate: probability of reporting any effect when the model is correct.
    #[arg(long, default_value_t = 0.05, help_heading = "Search")]
    alpha: f64,
    /// Largest number of effects that are reported.
    #[arg(long, default_value = "24", value_parser = clap::value_parser!(u16).range(1..), help_heading = "Search")]
    max_findings: u16,
    /// Effects to test, comma-separated or repeated. Default: all of the library.
    #[arg(long, value_name = "EFFECTS", value_delimiter = ',', help_heading = "Search")]
    candidates: Vec<String>,
    /// Least size of a finding, % of a joint's torque rms; a tenth of what the joint misses counts too.
    #[arg(long, value_name = "PERCENT", default_value_t = 2.0, help_heading = "Search")]
    least_share: f64,
    /// Time for the search, as 60s or 2min; what is known by then is written, marked as unfinished. Ctrl-C and a kill (SIGTERM) do the same.
    #[arg(long, value_name = "TIME", value_parser = time, help_heading = "Search")]
    budget: Option<Duration>,
    /// Skip the simulation of the extended model along the held-out motions.
    #[arg(long, help_heading = "Simulation")]
    no_resimulation: bool,
    /// Forward dynamics of that simulation: rapier, or the project's own, the same to rounding.
    #[arg(long, value_enum, default_value = "rapier", help_heading = "Simulation")]
    engine: EngineKind,
}

/// Diagnoses and writes the results folder.
pub(crate) fn run(arguments: &Arguments, global: &Global) -> Result<u8> {
    let options = arguments.options(global)?;
    let dataset = arguments.logs.described()?;
    let Simulation { arm, mut robot, scenario } = simulation(arguments, dataset.as_ref())?;
    let bar = progress::bar(global, "examining the logs", LEAST_ROUNDS + 1);
    let [train, test] = arguments.logs.read(dataset.as_ref(), &robot)?;
    let mut logs = [train, test, dataset::read_all(&arguments.reference, &robot)?];
    if let Some(mut arm) = arm {
        arm.settle(dataset.as_ref(), &mut logs)?;
        robot = arm.robot;
    }
    let [train, test, reference] = logs;
    let folder = ResultFolder::create(global.folder(&format!("diagnose_{}", robot.name)))?;
    let stop = interrupt::flag(global)?;
    let mut diagnosis = Diagnosis::of(&robot)
        .train(train)
        .test(test)
        .reference(reference)
        .present(present(arguments, scenario.as_ref(), &robot)?)
        .options(options)
        .labels(arguments.labels())
        .stop(stop)
        .progress(|progress| match progress {
            Progress::Screened => bar.set_message("fitting the arm"),
            Progress::Map(map) => {
                bar.set_message("testing every effect on every joint");
                if let Some(table) = report::followed(&robot, &map) {
                    bar.println(format!("First answer, while the search for laws goes on:\n{table}"));
                }
            }
            Progress::Found(found) => {
                bar.set_message(format!("{found} found, testing for the next"));
                bar.inc(1);
                // How many rounds it takes depends on what is found: one more at the least, and the simulation behind.
                bar.set_length(bar.position() + 2);
            }
        });
    if let Some(budget) = arguments.budget {
        diagnosis = diagnosis.budget(budget);
    }
    let mut answer = diagnosis.run()?;
    let mut not_simulated = None;
    if let Outcome::Concluded(conclusion) = &mut answer.outcome {
        bar.inc(1);
        bar.set_length(bar.position() + 1);
        bar.set_message("simulating the extended model");
        conclusion.extended()?;
        if !arguments.no_resimulation {
            not_simulated = conclusion.resimulate(arguments.engine).err();
        }
    }
    bar.finish_and_clear();

    let named = arguments.logs.named(arguments.arm.robot.clone());
    // A description that the diagnosis went on with is written; one of the log of another robot is none.
    let has = |test: fn(&DataFault) -> bool| answer.faults.iter().any(test);
    let is_another =
        has(|fault| fault.kind.is_another_robot()) && !has(|fault| fault.consequence == Consequence::Corrected);
    let description = answer.description.as_ref().filter(|_| !is_another);
    let open = description.filter(|verdict| verdict.leaves_much());
    open.into_iter().for_each(corrected::refused);
    // What is sure of the units stays to be written.
    let verdict = description.filter(|_| open.is_none());
    let description = verdict.map(|verdict| &verdict.description);
    corrected::write(&folder, dataset.as_ref(), &named, &answer.robot, description, verdict, answer.units.clone())?;
    folder.write_json("diagnosis.json", DIAGNOSIS_SCHEMA, &answer)?;
    let text = match answer.conclusion() {
        Some(conclusion) => {
            let lines = write_conclusion(&folder, &answer, conclusion, scenario.as_ref(), global)?;
            let not_simulated = not_simulated.as_ref().map(report::not_simulated);
            [lines].into_iter().chain(not_simulated).collect::<Vec<_>>().join("\n")
        }
        None => {
            let logs: Vec<&Recording> = answer.logs.all().collect();
            let page = html::stopped::page(&answer.robot, &logs, &answer.faults, Provenance::here(global.seed));
            folder.write_text(html::FILE, &page.render())?;
            report::stopped_lines(&answer.faults)
        }
    };
    let path = folder.finish()?;
    print::result(global, DIAGNOSIS_SCHEMA, &answer, || format!("{text}\nResults in {}", path.display()))?;
    // A script must not take logs that forbid an answer for logs that show nothing.
    Ok(if answer.conclusion().is_some() { DONE } else { BAD_INPUT })
}

impl Arguments {
    fn options(&self, global: &Global) -> Result<Options> {
        let options = Options {
            trust: self.trust,
            alpha: self.alpha,
            max_findings: self.max_findings.into(),
            seed: global.seed.unwrap_or_default(),
            candidates: self.candidates.clone(),
            criteria: Criteria { share_of_torque: 0.01 * self.least_share, ..Criteria::default() },
        };
        options.check().map_err(|problem| match problem {
            Error::Request { subject, problem } if subject == "alpha" => Error::request("--alpha", problem),
            other => other,
        })?;
        Ok(options)
    }

    /// Where training, test and reference logs are given.
    fn labels(&self) -> [String; 3] {
        let [train, test] = match &self.logs.dataset {
            Some(path) => ["train", "test"].map(|key| format!("{}: {key}", path.display())),
            None => ["--train", "--test"].map(str::to_owned),
        };
        [train, test, "--reference".to_owned()]
    }
}

/// Writes the extended model, the report and the viewer's file of a diagnosis, and returns its lines.
fn write_conclusion(
    folder: &ResultFolder,
    answer: &Answer,
    conclusion: &Conclusion,
    scenario: Option<&Scenario>,
    global: &Global,
) -> Result<String> {
    let Answer { robot, faults, .. } = answer;
    let Conclusion { diagnosis, measured, .. } = conclusion;
    let resimulation = conclusion.resimulation.as_ref();
    let seed = global.seed.unwrap_or_default();
    let extended = conclusion.extended()?;
    let written =
        Scenario::of(&extended.robot, EXTENDED_URDF.as_ref(), &extended.effects, scenario, measured, seed).to_toml()?;
    folder.write_text(EXTENDED_URDF, &robot::with_parameters(&extended.robot)?)?;
    folder.write_text(EXTENDED_MJCF, &robot::to_mjcf(&extended.robot))?;
    folder.write_text(EXTENDED_SCENARIO, &format!("{EXTENDED_NOTE}{written}"))?;
    let lines = report::lines(robot, diagnosis, resimulation, faults);
    let held_out = answer.logs.held_out();
    let held_out: Vec<&Recording> = held_out.iter().collect();
    let train: Vec<&Recording> = answer.logs.train.iter().collect();
    let logs = html::diagnosis::Logs { train: &train, held_out: &held_out, faults };
    let page = html::diagnosis::page(robot, diagnosis, resimulation, logs, Provenance::here(Some(seed)));
    folder.write_text(html::FILE, &page.render())?;
    let simulated = resimulation.map(|run| &run.positions[..]);
    viewer::add(folder, || Ok(viewer::diagnosis::film(robot, &held_out, diagnosis, &lines, simulated)))?;
    Ok(lines)
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
        let logs = [arguments.logs.files(dataset), arguments.reference.clone()].concat();
        let arm = arguments.arm.open(&file, arguments.trust, dataset, &logs)?;
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
