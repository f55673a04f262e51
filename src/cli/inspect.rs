//! `tauscope inspect`: what a log is worth.

use super::{DONE, Global, print, progress};
use crate::dataset::Dataset;
use crate::error::{Error, Result};
use crate::quality;
use crate::recording;
use crate::recording::lenient::{self, ColumnMap, Sieved};
use crate::report::quality as report;
use crate::robot::{self, InertiaCheck, Robot};
use std::path::{Path, PathBuf};

/// Arguments of `tauscope inspect`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// The log: .csv, .parquet, .mcap, .db3, or the folder of a ROS 2 bag.
    log: PathBuf,
    /// URDF of the arm, for its limits and for checks of torque against motion.
    #[arg(long, value_name = "URDF")]
    robot: Option<PathBuf>,
    /// Description of the log: columns, units, motors, payload, mounting.
    #[arg(long, value_name = "TOML")]
    dataset: Option<PathBuf>,
    /// Also write the rows that can be used to this file: .csv, .parquet, .mcap or .db3; with a dataset in its units and
    /// order.
    #[arg(long, value_name = "FILE")]
    convert: Option<PathBuf>,
}

/// Examines the log and prints what it finds; a log that cannot be used is an error behind the report.
pub fn run(arguments: &Arguments, global: &Global) -> Result<u8> {
    let dataset = arguments.dataset.as_ref().map(Dataset::load).transpose()?;
    let named = arguments.robot.clone().or_else(|| dataset.as_ref().and_then(Dataset::robot));
    let mut robot = named.map(|path| robot::load(path, InertiaCheck::Ignored)).transpose()?;
    let mut stages = progress::Stages::new(global, &[1, 1]);
    stages.begin("reading the log");
    let sieved = match (&dataset, &mut robot) {
        (None, robot) => {
            let names = robot.as_ref().map(Robot::joint_names);
            lenient::load(&arguments.log, names.as_deref(), &ColumnMap::default())?
        }
        (Some(dataset), Some(robot)) => {
            dataset.mount(robot)?;
            dataset.read(&arguments.log, robot)?
        }
        (Some(_), None) => {
            let problem = "give the arm's URDF, here or as `robot` in the dataset: it names the joints";
            return Err(Error::request("--robot", problem));
        }
    };
    stages.begin("looking at the log");
    let found = quality::examine(&sieved, robot.as_ref())?;
    let converted = arguments.convert.as_ref().map(|path| convert(path, &arguments.log, &sieved)).transpose()?;
    stages.finish();
    let result = report::result(&arguments.log, robot.as_ref(), &found);
    print::result(global, report::SCHEMA, &result, || {
        let converted = converted.map_or(String::new(), |line| format!("\n\n{line}"));
        report::text(&arguments.log, robot.as_ref(), &found) + &converted
    })?;
    match found.fatal() {
        Some(finding) => {
            let problem = format!("the log cannot be used: {}", finding.text);
            Err(Error::input(&arguments.log, None, finding.place.as_str(), problem))
        }
        None => Ok(DONE),
    }
}

/// Writes the usable rows to `path`, whole or not at all, and says so.
fn convert(path: &Path, log: &Path, sieved: &Sieved) -> Result<String> {
    let failed = |source| Error::io(path, "write the converted log", source);
    if let (Ok(one), Ok(other)) = (path.canonicalize(), log.canonicalize())
        && one == other
    {
        return Err(Error::request("--convert", "is the log itself; give another name"));
    }
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let scratch = tempfile::Builder::new().prefix(".tauscope").tempdir_in(folder).map_err(failed)?;
    let draft = scratch.path().join(path.file_name().unwrap_or_default());
    let lost = recording::save(&draft, &sieved.recording)?;
    std::fs::rename(&draft, path).map_err(failed)?;
    let (rows, place) = (sieved.recording.samples(), path.display());
    Ok(match lost.is_empty() {
        true => format!("{place}: {rows} rows written"),
        false => format!("{place}: {rows} rows written; the format has no place for {}", lost.join(" and ")),
    })
}
