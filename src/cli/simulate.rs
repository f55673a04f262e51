//! `tauscope simulate`: simulate and measure, without identifying.

use super::{DONE, Global, progress};
use crate::error::Result;
use crate::output::ResultFolder;
use crate::recording;
use crate::scenario::Setup;
use crate::study::testbed::{self, Runs};
use std::path::PathBuf;

/// Arguments of `tauscope simulate`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Scenario file.
    #[arg(default_value = "scenarios/irb1600.toml")]
    scenario: PathBuf,
}

/// Simulates both motions of the scenario and writes their recordings.
pub fn run(arguments: &Arguments, global: &Global) -> Result<u8> {
    let setup = Setup::load(&arguments.scenario, global.seed)?;
    let folder = ResultFolder::create(global.folder(&setup.scenario.name))?;
    let bar = progress::bar(global, "simulating", testbed::samples(&setup));
    let runs = testbed::record(&setup, &mut |done| bar.set_position(done as u64))?;
    bar.finish_and_clear();
    write_recordings(&folder, &setup, &runs)?;
    let path = folder.finish()?;
    if !global.quiet {
        println!("Recordings in {}", path.display());
    }
    Ok(DONE)
}

/// Writes the training and held-out recordings as CSV and Parquet, and the merged scenario.
pub(super) fn write_recordings(folder: &ResultFolder, setup: &Setup, runs: &Runs) -> Result<()> {
    for (name, run) in [("recording", &runs.training), ("held_out", &runs.held_out)] {
        recording::csv::write(&folder.file(&format!("{name}.csv"))?, &run.recording)?;
        recording::parquet::write(&folder.file(&format!("{name}.parquet"))?, &run.recording)?;
    }
    folder.write_text("scenario.toml", &setup.merged()?)
}
