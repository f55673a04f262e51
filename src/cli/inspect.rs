//! `tauscope inspect`: what a log is worth.

use super::{DONE, Global, print};
use crate::dataset::Dataset;
use crate::error::{Error, Result};
use crate::quality;
use crate::report::quality as report;
use crate::robot::{self, InertiaCheck};
use std::path::PathBuf;

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
}

/// Examines the log and prints what it finds; a log that cannot be used is an error behind the report.
pub fn run(arguments: &Arguments, global: &Global) -> Result<u8> {
    let dataset = arguments.dataset.as_ref().map(Dataset::load).transpose()?;
    let named = arguments.robot.clone().or_else(|| dataset.as_ref().and_then(Dataset::robot));
    let mut robot = named.map(|path| robot::load(path, InertiaCheck::Ignored)).transpose()?;
    let found = match (&dataset, &mut robot) {
        (None, _) => quality::inspect(&arguments.log, robot.as_ref())?,
        (Some(dataset), Some(robot)) => {
            dataset.mount(robot)?;
            quality::examine(&dataset.read(&arguments.log, robot)?, Some(robot))?
        }
        (Some(_), None) => {
            let problem = "give the arm's URDF, here or as `robot` in the dataset: it names the joints";
            return Err(Error::request("--robot", problem));
        }
    };
    let result = report::result(&arguments.log, robot.as_ref(), &found);
    print::result(global, report::SCHEMA, &result, || report::text(&arguments.log, robot.as_ref(), &found))?;
    match found.fatal() {
        Some(finding) => {
            let problem = format!("the log cannot be used: {}", finding.text);
            Err(Error::input(&arguments.log, None, finding.place.as_str(), problem))
        }
        None => Ok(DONE),
    }
}
