//! `tauscope payload`: the load that was added between logs. The work is [`Payload::between`]'s; here are the files.

use crate::cli::shared::{ArmArguments, DONE, FAILED, Global, print, progress};
use crate::dataset::{self, Dataset, Logs};
use crate::error::{Error, Result};
use crate::identification::effect_model::Trust;
use crate::output::ResultFolder;
use crate::payload::{Expected, PAYLOAD_SCHEMA, Payload};
use crate::recording::Recording;
use crate::recording::lenient::Sieved;
use crate::report::payload as report;
use crate::robot::{Robot, description};
use std::path::{Path, PathBuf};

/// Arguments of `tauscope payload`.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLE)]
pub(crate) struct Arguments {
    /// Log without the load, or a dataset (.toml) of such logs.
    before: PathBuf,
    /// Log with the load, or a dataset (.toml) of such logs.
    after: PathBuf,
    /// More logs without the load; they stand behind the first two. Repeatable.
    #[arg(long = "before", value_name = "LOG", num_args = 1..)]
    more_before: Vec<PathBuf>,
    /// More logs with the load; they stand behind the first two. Repeatable.
    #[arg(long = "after", value_name = "LOG", num_args = 1..)]
    more_after: Vec<PathBuf>,
    #[command(flatten)]
    arm: ArmArguments,
    /// Link that carries the load and in whose frame it is given. Default: the flange, the link at the end of the arm.
    #[arg(long, value_name = "LINK", help_heading = "Load")]
    at: Option<String>,
    /// Load that is expected: a mass in kg, or a TOML file with mass_kg and, where wanted, tolerance_kg, center_m,
    /// tolerance_m. Exit code 1 if the load found differs. Default tolerance: two standard errors and 5 % of the mass.
    #[arg(long, value_name = "MASS|TOML", allow_hyphen_values = true, help_heading = "Load")]
    expect: Option<String>,
    /// By how much the mass may differ from the expected one, kg.
    #[arg(long, value_name = "KG", requires = "expect", help_heading = "Load")]
    tolerance: Option<f64>,
}

const EXAMPLE: &str = "\
Exit codes: 0 done, 1 the load differs from the expected one or cannot confirm it, 2 bad input or usage.

Example:
  tauscope payload empty.csv gripper.csv --robot arm.urdf --expect 0.9";

/// One side of the change.
struct Side {
    dataset: Option<Dataset>,
    files: Vec<PathBuf>,
}

impl Side {
    fn new(first: &Path, more: &[PathBuf]) -> Result<Self> {
        let is_dataset = first.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("toml"));
        let dataset = if is_dataset { Some(Dataset::load(first)?) } else { None };
        let own = match &dataset {
            Some(dataset) => dataset.files(),
            None => vec![first.to_owned()],
        };
        Ok(Side { dataset, files: own.into_iter().chain(more.iter().cloned()).collect() })
    }

    /// The logs as their files have them; those named one by one are read as the dataset describes them.
    fn read(&self, robot: &Robot) -> Result<Vec<(PathBuf, Sieved)>> {
        let Some(dataset) = &self.dataset else { return dataset::read_all(&self.files, robot) };
        let [train, test] = dataset.sieved(robot)?;
        let mut logs: Vec<(PathBuf, Sieved)> = train.into_iter().chain(test).collect();
        for file in &self.files[dataset.files().len()..] {
            logs.push((file.clone(), dataset.read(file, robot)?));
        }
        Ok(logs)
    }
}

/// Finds the load, writes the results folder, and compares with what is expected.
pub(crate) fn run(arguments: &Arguments, global: &Global) -> Result<u8> {
    let expected = arguments.expected()?;
    let before = Side::new(&arguments.before, &arguments.more_before)?;
    let after = Side::new(&arguments.after, &arguments.more_after)?;
    let dataset = before.dataset.as_ref().or(after.dataset.as_ref());
    let Some(file) = arguments.arm.file(dataset) else {
        return Err(Error::request("--robot", "give the arm's URDF, or a dataset that names one"));
    };
    let mut stages = progress::Stages::new(global, &[1, 2]);
    stages.begin("reading the logs");
    let files: Vec<PathBuf> = before.files.iter().chain(&after.files).cloned().collect();
    let mut arm = arguments.arm.open(&file, Trust::Structure, dataset, &files)?;
    let mut logs = [before.read(&arm.robot)?, after.read(&arm.robot)?];
    arm.settle(dataset, &mut logs)?;
    let Logs { train, test, mut notes, correction, .. } = dataset::ready(logs, &arm.robot)?;
    let mut robot = arm.robot;
    notes.extend(robot.notes.clone());
    if let Some(correction) = &correction {
        robot.gravity = correction.gravity;
    }
    let description = description::read(&file)?;
    let ends = match &arguments.at {
        Some(link) => {
            let at = robot.with_flange_at(&description, link).map_err(|problem| match problem {
                Error::Request { subject, problem } => Error::request(format!("--at: {subject}"), problem),
                other => other,
            })?;
            vec![(at, link.clone())]
        }
        None => robot.ends(&description),
    };
    let folder = ResultFolder::create(global.folder(&format!("payload_{}", robot.name)))?;
    stages.begin("finding the load");
    let mut payload = at_best_end(&ends, &train, &test, expected)?;
    payload.notes.splice(0..0, notes);
    stages.finish();
    folder.write_json("payload.json", PAYLOAD_SCHEMA, &payload)?;
    let path = folder.finish()?;
    print::result(global, PAYLOAD_SCHEMA, &payload, || {
        format!("{}\nResults in {}", report::text(&payload), path.display())
    })?;
    Ok(if payload.is_as_expected() { DONE } else { FAILED })
}

/// The load at the end of the arm at which it explains the torques best.
fn at_best_end(
    ends: &[(Robot, String)],
    before: &[Recording],
    after: &[Recording],
    expected: Option<Expected>,
) -> Result<Payload> {
    let at = |(robot, link): &(Robot, String)| {
        Payload::between(robot).before(before).after(after).frame(link).expected(expected).run()
    };
    let (mut found, mut problem) = (Vec::new(), None);
    for end in ends {
        match at(end) {
            Ok(payload) => found.push(payload),
            Err(own) => problem = problem.or(Some(own)),
        }
    }
    let tried: Vec<String> = found.iter().map(|payload| payload.frame.clone()).collect();
    // Joints that do not see one end have the same residual there, whatever its load.
    let misfit = |payload: &Payload| -> f64 {
        payload.joints.iter().map(|joint| joint.residual.max(f64::MIN_POSITIVE).ln()).sum()
    };
    let Some(mut best) = found.into_iter().min_by(|a, b| misfit(a).total_cmp(&misfit(b))) else {
        return Err(problem.unwrap_or_else(|| Error::request("the robot", "it has no end that could carry a load")));
    };
    if tried.len() > 1 {
        best.notes.insert(
            0,
            format!(
                "the robot has {} ends ({}): the load is looked for at each, and {} explains the torques best; another link is asked for with --at LINK",
                tried.len(),
                tried.join(", "),
                best.frame
            ),
        );
    }
    Ok(best)
}

impl Arguments {
    fn expected(&self) -> Result<Option<Expected>> {
        let Some(text) = &self.expect else { return Ok(None) };
        let mut expected = Expected::read(text)?;
        if let Some(tolerance) = self.tolerance {
            if !(tolerance.is_finite() && tolerance >= 0.0) {
                return Err(Error::request("--tolerance", format!("{tolerance} must be a number of zero or more")));
            }
            expected.tolerance_kg = Some(tolerance);
        }
        Ok(Some(expected))
    }
}
