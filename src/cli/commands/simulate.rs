//! `tauscope simulate`: simulate and measure, without identifying.

use crate::cli::shared::{DONE, Global, print, progress};
use crate::error::{Error, Result};
use crate::output::ResultFolder;
use crate::recording;
use crate::report::viewer;
use crate::scenario::Setup;
use crate::study::testbed::{self, Runs};
use std::path::{Path, PathBuf};

/// Schema of what `--json` prints.
const SCHEMA: &str = "tauscope.simulated/1";

/// What `--json` prints.
#[derive(serde::Serialize)]
struct Simulated<'a> {
    scenario: &'a str,
    folder: &'a Path,
}

/// Arguments of `tauscope simulate`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  tauscope simulate scenarios/effects/stribeck_friction.toml --out logs")]
pub(crate) struct Arguments {
    /// Scenario file.
    #[arg(default_value = "scenarios/irb1600.toml")]
    scenario: PathBuf,
}

/// Simulates both motions of the scenario and writes their recordings.
pub(crate) fn run(arguments: &Arguments, global: &Global) -> Result<u8> {
    let (setup, folder, runs) = simulated(&arguments.scenario, global)?;
    write_recordings(&folder, &setup, &runs)?;
    viewer::add(&folder, || viewer::scenario::film(&setup, &runs, None))?;
    let path = folder.finish()?;
    let simulated = Simulated { scenario: &setup.scenario.name, folder: &path };
    print::result(global, SCHEMA, &simulated, || format!("{}Recordings in {}", notes(&setup), path.display()))?;
    Ok(DONE)
}

/// What was read differently from the robot file, and which joints are held, a line each.
pub(super) fn notes(setup: &Setup) -> String {
    setup.known.notes.iter().map(|note| format!("{note}\n")).collect()
}

/// Loads a scenario, makes sure that its results can be written, and simulates and measures both motions.
pub(super) fn simulated(scenario: &Path, global: &Global) -> Result<(Setup, ResultFolder, Runs)> {
    let setup = Setup::load(scenario, global.seed)?;
    let folder = ResultFolder::create(global.folder(&setup.scenario.name))?;
    let bar = progress::bar(global, "simulating", testbed::samples(&setup));
    let runs = testbed::record(&setup, &mut |done| bar.set_position(done as u64))?;
    bar.finish_and_clear();
    Ok((setup, folder, runs))
}

/// Writes the training and held-out recordings as CSV and Parquet, and the merged scenario with the files it refers to.
pub(super) fn write_recordings(folder: &ResultFolder, setup: &Setup, runs: &Runs) -> Result<()> {
    for (name, run) in [("recording", &runs.training), ("held_out", &runs.held_out)] {
        folder.write_with(&format!("{name}.csv"), |path| recording::csv::write(path, &run.recording))?;
        folder.write_with(&format!("{name}.parquet"), |path| recording::parquet::write(path, &run.recording))?;
    }
    for (name, source) in setup.inputs() {
        let text =
            std::fs::read_to_string(source).map_err(|e| Error::io(source, "read what the scenario refers to", e))?;
        folder.write_text(name, &text)?;
    }
    folder.write_text("scenario.toml", &setup.merged()?)
}
