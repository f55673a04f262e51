//! `tauscope paper`: the paper's study, reproduced and judged.

use crate::cli::shared::{DONE, Global, print, progress};
use crate::error::Result;
use crate::output::ResultFolder;
use crate::paper::procedure::{Procedure, Stage};
use crate::report::html::{self, Provenance};
use crate::report::paper::{SCHEMA, Verdict, figures, results, tables};
use crate::scenario::Setup;
use crate::{paper, study::testbed};
use std::path::PathBuf;

/// Arguments of `tauscope paper`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  tauscope paper scenarios/paper.toml --out results/paper")]
pub(crate) struct Arguments {
    /// Scenario file; its arm must have six joints.
    #[arg(default_value = "scenarios/paper.toml")]
    scenario: PathBuf,
}

/// Runs the study and writes its results folder.
pub(crate) fn run(arguments: &Arguments, global: &Global) -> Result<u8> {
    let mut procedure = Procedure::default();
    let setup = procedure.time(Stage::Excitation, || Setup::load(&arguments.scenario, global.seed))?;
    let folder = ResultFolder::create(global.folder(&setup.scenario.name))?;
    let bar = progress::bar(global, "model", testbed::samples(&setup));
    let study = paper::study(&setup, procedure, &mut |stage, samples| {
        bar.set_message(stage.name().replace('_', " "));
        bar.set_position(bar.position().max(samples as u64));
    })?;
    bar.finish_and_clear();

    let verdict = Verdict::new(&study);
    let found = results::results(&setup, &study, &verdict);
    super::simulate::write_recordings(&folder, &setup, &study.runs)?;
    folder.write_json("paper.json", SCHEMA, &found)?;
    let (tables, figures) = (tables::tables(&setup, &study, &verdict), figures::figures(&setup, &study));
    folder.write_text("tables.md", &tables)?;
    for (name, svg) in &figures {
        folder.write_text(name, svg)?;
    }
    let provenance = Provenance::here(Some(setup.scenario.seed));
    let page = html::paper::page(&setup.scenario.name, &verdict, &tables, &figures, provenance);
    folder.write_text(html::FILE, &page.render())?;
    let path = folder.finish()?;
    print::result(global, SCHEMA, &found, || {
        format!("{}\nTables, figures and numbers in {}", verdict.console(&setup, &study), path.display())
    })?;
    Ok(DONE)
}
