//! `tauscope view`: open the recording of a results folder in the rerun viewer.

use crate::cli::shared::{DONE, FAILED, Global};
use crate::error::{Error, Result};
use crate::report::viewer::{FILE, VIEWER_VERSION};
use std::io::ErrorKind;
use std::path::PathBuf;
use std::process::Command;

/// Arguments of `tauscope view`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  tauscope view results/irb1600")]
pub(crate) struct Arguments {
    /// Results folder, or an .rrd file.
    #[arg(value_name = "DIR")]
    place: PathBuf,
}

/// Opens the viewer and waits until it is closed.
pub(crate) fn run(arguments: &Arguments, _global: &Global) -> Result<u8> {
    let file = if arguments.place.is_dir() { arguments.place.join(FILE) } else { arguments.place.clone() };
    if !file.is_file() {
        let problem = format!(
            "is not there; `tauscope run`, `simulate`, `identify` and `diagnose` write {FILE} to their results folder, \
             unless tauscope was built without its feature `viewer`"
        );
        return Err(Error::request(file.display().to_string(), problem));
    }
    match Command::new("rerun").arg(&file).status() {
        Ok(status) if status.success() => Ok(DONE),
        Ok(_) => Ok(FAILED),
        Err(problem) if problem.kind() == ErrorKind::NotFound => {
            let problem = format!(
                "the viewer is not on the PATH: `pip install rerun-sdk=={VIEWER_VERSION}` brings it; then \
                 `rerun {}`, or this command again",
                file.display()
            );
            Err(Error::request("rerun", problem))
        }
        Err(problem) => Err(Error::io("rerun", "start the viewer", problem)),
    }
}
