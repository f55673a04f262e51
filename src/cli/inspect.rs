//! `tauscope inspect`: what a log is worth.

use super::{DONE, Global, print};
use crate::error::{Error, Result};
use crate::quality;
use crate::report::quality as report;
use crate::robot::{self, InertiaCheck};
use std::path::PathBuf;

/// Arguments of `tauscope inspect`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// The log, .csv or .parquet.
    log: PathBuf,
    /// URDF of the arm, for its limits and for checks of torque against motion.
    #[arg(long, value_name = "URDF")]
    robot: Option<PathBuf>,
}

/// Examines the log and prints what it finds; a log that cannot be used is an error behind the report.
pub fn run(arguments: &Arguments, global: &Global) -> Result<u8> {
    let robot = arguments.robot.as_ref().map(|path| robot::load(path, InertiaCheck::Ignored)).transpose()?;
    let found = quality::inspect(&arguments.log, robot.as_ref())?;
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
