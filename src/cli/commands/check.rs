//! `tauscope check`: whether identification is worse than a baseline.

use crate::cli::shared::{DONE, FAILED, Global, print, progress};
use crate::error::{Error, Result};
use crate::output;
use crate::report::montecarlo as report;
use crate::scenario::Setup;
use crate::study::check::{Baseline, SCHEMA, TRIALS};
use std::path::{Path, PathBuf};

/// Schema of what `--json` prints.
const REPORT_SCHEMA: &str = "tauscope.check/1";

/// Arguments of `tauscope check`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  tauscope check scenarios/irb1600.toml --baseline results/baseline/irb1600.json")]
pub(crate) struct Arguments {
    /// Scenario file.
    scenario: PathBuf,
    /// Baseline to compare with.
    #[arg(long, value_name = "FILE", help_heading = "Baseline")]
    baseline: PathBuf,
    /// Write a new baseline instead of comparing.
    #[arg(long, help_heading = "Baseline")]
    update: bool,
    /// Number of trials. Default: that of the baseline, 16 for a new one.
    #[arg(long, value_name = "N", help_heading = "Trials", value_parser = clap::value_parser!(u32).range(2..))]
    trials: Option<u32>,
    /// Number of blind diagnoses; fewer than five can never show a significant worsening. Default: that of the baseline, 0 for a
    /// new one.
    #[arg(long, value_name = "N", help_heading = "Trials")]
    diagnoses: Option<usize>,
}

/// Measures, and compares or updates.
pub(crate) fn run(arguments: &Arguments, global: &Global) -> Result<u8> {
    let path = &arguments.baseline;
    let old = if path.exists() || !arguments.update { Some(Baseline::read(path)?) } else { None };
    // The scenario's seed keeps its motions and its controller; another seed makes other draws of noise alone.
    let mut setup = Setup::load(&arguments.scenario, None)?;
    let drawn_before = old.as_ref().map(|old| old.seed);
    setup.scenario.seed = global.seed.or(drawn_before).unwrap_or(setup.scenario.seed);
    let trials = arguments.trials.map_or_else(|| old.as_ref().map_or(TRIALS, |old| old.trials), |n| n as usize);
    let runs = arguments.diagnoses.unwrap_or_else(|| old.as_ref().and_then(|old| old.diagnosis).map_or(0, |d| d.runs));
    let bar = progress::bar(global, "checking", trials + runs);
    let now = Baseline::measure(&setup, trials, runs, &|| bar.inc(1))?;
    bar.finish_and_clear();
    if arguments.update {
        write(path, &now)?;
        print::result(global, SCHEMA, &now, || format!("Baseline of {} written to {}", now.scenario, path.display()))?;
        return Ok(DONE);
    }
    let Some(old) = old else { return Err(Error::request("--baseline", "there is none; --update makes one")) };
    let found = old.compare(&now)?;
    print::result(global, REPORT_SCHEMA, &found, || report::check(&found))?;
    Ok(if found.failed() { FAILED } else { DONE })
}

fn write(path: &Path, baseline: &Baseline) -> Result<()> {
    let failed = |source| Error::io(path, "write the baseline", source);
    let mut text = Vec::new();
    output::json(&mut text, SCHEMA, baseline).map_err(failed)?;
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    std::fs::create_dir_all(folder).map_err(failed)?;
    let staged = tempfile::NamedTempFile::new_in(folder).map_err(failed)?;
    std::fs::write(staged.path(), text).map_err(failed)?;
    staged.persist(path).map(drop).map_err(|problem| failed(problem.error))
}
