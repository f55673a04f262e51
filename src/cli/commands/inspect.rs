//! `tauscope inspect`: faults of measured logs.

use crate::cli::shared::{ArmArguments, DONE, Global, corrected, print, progress};
use crate::dataset::{self, Dataset, Named};
use crate::error::{Error, Result};
use crate::identification::effect_model::Trust;
use crate::output::ResultFolder;
use crate::quality::{self, Together, UnitChanges};
use crate::recording;
use crate::recording::lenient::{self, ColumnMap, Sieved};
use crate::report::quality as report;
use crate::robot::Robot;
use std::path::{Path, PathBuf};

/// Arguments of `tauscope inspect`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  tauscope inspect monday.csv tuesday.csv --robot arm.urdf")]
pub(crate) struct Arguments {
    /// Log: .csv, .parquet, .npz, .mcap, .db3, or the folder of a ROS 2 bag. Several logs of one arm are examined together.
    /// Default: those of the dataset, which may also stand here by itself.
    #[arg(required_unless_present = "dataset")]
    log: Vec<PathBuf>,
    #[command(flatten)]
    arm: ArmArguments,
    /// Dataset: a TOML file that describes the logs (columns, units, motors, payload, mounting).
    #[arg(long, value_name = "TOML", help_heading = "Logs")]
    dataset: Option<PathBuf>,
    /// Also write the usable rows of one log to this file: .csv, .parquet, .mcap or .db3; with a dataset in its units and
    /// order.
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    convert: Option<PathBuf>,
}

impl Arguments {
    /// The dataset and the logs. A single file of TOML in place of a log is a dataset.
    fn given(&self) -> (Option<&PathBuf>, &[PathBuf]) {
        match (&self.dataset, &self.log[..]) {
            (None, [only]) if only.extension().is_some_and(|extension| extension == "toml") => (Some(only), &[]),
            (dataset, logs) => (dataset.as_ref(), logs),
        }
    }
}

/// Examines the logs and prints the findings; a log that cannot be used is an error after the report.
pub(crate) fn run(arguments: &Arguments, global: &Global) -> Result<u8> {
    let (described, logs) = arguments.given();
    let dataset = described.map(Dataset::load).transpose()?;
    let mut files = match &dataset {
        Some(dataset) if logs.is_empty() => dataset.files(),
        _ => logs.to_vec(),
    };
    // Parts of one log are examined together.
    files.dedup();
    let file = arguments.arm.file(dataset.as_ref());
    let open = |file: PathBuf| arguments.arm.open(&file, Trust::Structure, dataset.as_ref(), &files);
    let mut arm = file.map(open).transpose()?;
    let [first, others @ ..] = &files[..] else { return Err(Error::request("LOG", "give a log")) };
    if arguments.convert.is_some() && !others.is_empty() {
        return Err(Error::request("--convert", "takes one log; give the logs one by one"));
    }
    let mut stages = progress::Stages::new(global, &[1, 1]);
    stages.begin("reading the log");
    let read = |log: &PathBuf| match (&dataset, arm.as_ref().map(|arm| &arm.robot)) {
        (None, Some(robot)) => dataset::read(log, robot),
        (None, None) => lenient::load(log, None, &ColumnMap::default()),
        (Some(dataset), Some(robot)) => dataset.read(log, robot),
        (Some(_), None) => {
            let problem = "give the arm's URDF, here or as `robot` in the dataset: it names the joints";
            Err(Error::request("--robot", problem))
        }
    };
    let read = |log: &PathBuf| Ok((log.clone(), read(log)?));
    let mut logs = [files.iter().map(read).collect::<Result<Vec<(PathBuf, Sieved)>>>()?];
    // A converted log keeps the joints that stand still.
    let converted = arguments.convert.as_ref().map(|path| convert(path, first, &logs[0][0].1)).transpose()?;
    if let Some(arm) = &mut arm {
        arm.settle(dataset.as_ref(), &mut logs)?;
    }
    let robot = arm.map(|arm| arm.robot);
    let [logs] = logs;
    let sieved: Vec<Sieved> = logs.into_iter().map(|(_, sieved)| sieved).collect();
    stages.begin("examining the log");
    let together = quality::examine_together(&sieved.iter().collect::<Vec<_>>(), robot.as_ref())?;
    let named = Named { robot: arguments.arm.robot.clone(), train: files.clone(), test: Vec::new() };
    let corrected = match &robot {
        Some(robot) => correct(&named, global, dataset.as_ref(), robot, &together)?,
        None => None,
    };
    stages.finish();
    let each: Vec<(&Path, &quality::Report)> = files.iter().map(PathBuf::as_path).zip(&together.reports).collect();
    let result = report::together(each[0], &each[1..], robot.as_ref());
    print::result(global, report::SCHEMA, &result, || {
        let texts = report::texts(&each, robot.as_ref());
        let notes: String =
            robot.iter().flat_map(|robot| &robot.notes).map(|note| format!("\nNote: {note}.")).collect();
        let notes = if notes.is_empty() { notes } else { format!("\n{notes}") };
        let converted = converted.map_or(String::new(), |line| format!("\n\n{line}"));
        let corrected =
            corrected.map_or(String::new(), |path| format!("\n\nA corrected description is in {}", path.display()));
        texts + &notes + &converted + &corrected
    })?;
    match each.iter().find_map(|(log, found)| Some((log, found.fatal()?))) {
        Some((log, finding)) => {
            let problem = format!("the log cannot be used: {}", finding.text);
            Err(Error::input(*log, None, finding.place.as_str(), problem))
        }
        None => Ok(DONE),
    }
}

/// Writes the corrected description, if something is wrong with the given one; returns its path.
fn correct(
    named: &Named,
    global: &Global,
    dataset: Option<&Dataset>,
    robot: &Robot,
    together: &Together,
) -> Result<Option<PathBuf>> {
    let verdict = together.verdict.as_ref();
    // One recorder made all logs: a fault that one shows and another does not is not corrected for all.
    let units = UnitChanges::shared(&together.reports);
    // What describes the log of this robot does not describe that of another.
    let is_another = together.reports.iter().any(quality::Report::is_of_another_robot);
    if (verdict.is_none() && units.is_none()) || is_another {
        return Ok(None);
    }
    // What is sure of the units stays to be written.
    let open = verdict.filter(|verdict| verdict.leaves_much());
    if let Some(open) = open {
        corrected::refused(open);
        if units.is_none() {
            return Ok(None);
        }
    }
    let verdict = verdict.filter(|_| open.is_none());
    let description = verdict.map(|verdict| &verdict.description);
    let name = named.train[0].file_stem().map_or("log".into(), |stem| stem.to_string_lossy());
    let folder = ResultFolder::create(global.folder(&format!("inspect_{name}")))?;
    if !corrected::write(&folder, dataset, named, robot, description, verdict, units)? {
        return Ok(None);
    }
    Ok(Some(folder.finish()?.join(corrected::FILE)))
}

/// Writes the usable rows to `path`, whole or not at all, and returns a line on it.
fn convert(path: &Path, log: &Path, sieved: &Sieved) -> Result<String> {
    let failed = |source| Error::io(path, "write the converted log", source);
    if let (Ok(one), Ok(other)) = (path.canonicalize(), log.canonicalize())
        && one == other
    {
        return Err(Error::request("--convert", "is the log itself; give another name"));
    }
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    recording::writable(path)?;
    let scratch = tempfile::Builder::new().prefix(".tauscope").tempdir_in(folder).map_err(failed)?;
    let draft = scratch.path().join(path.file_name().unwrap_or_default());
    let lost = recording::save(&draft, &sieved.recording).map_err(|error| error.named(&draft, path))?;
    std::fs::rename(&draft, path).map_err(failed)?;
    let (rows, place) = (sieved.recording.samples(), path.display());
    Ok(match lost.is_empty() {
        true => format!("{place}: {rows} rows written"),
        false => format!("{place}: {rows} rows written; the format has no place for {}", lost.join(" and ")),
    })
}
