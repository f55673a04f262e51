//! `tauscope run`: simulate, measure, identify, score.

mod measured;
mod usual_way;

use crate::cli::commands::simulate;
use crate::cli::shared::{DONE, Global, print, progress};
use crate::error::Result;
use crate::identification::model::Model;
use crate::report::html::{self, Provenance};
use crate::report::{console, results, viewer};
use crate::study::testbed::{self, Variant};
use std::path::PathBuf;
use usual_way::compared;

/// Arguments of `tauscope run`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  tauscope run scenarios/irb1600.toml --seed 7 --out results/seed_7")]
pub(crate) struct Arguments {
    /// Scenario file.
    #[arg(default_value = "scenarios/irb1600.toml")]
    scenario: PathBuf,
    /// Dataset: a TOML file that describes measured logs to identify from and to score on, in place of a simulation.
    #[arg(long, value_name = "TOML", conflicts_with = "scenario", help_heading = "Logs")]
    dataset: Option<PathBuf>,
}

impl Default for Arguments {
    fn default() -> Self {
        Arguments { scenario: PathBuf::from("scenarios/irb1600.toml"), dataset: None }
    }
}

/// Runs the scenario and writes its results folder.
pub(crate) fn run(arguments: &Arguments, global: &Global) -> Result<u8> {
    if let Some(dataset) = &arguments.dataset {
        return measured::run(dataset, global);
    }
    let (setup, folder, runs) = simulate::simulated(&arguments.scenario, global)?;

    let bar = progress::bar(global, "identifying", Variant::ALL.len());
    let model = Model::new(&setup.known);
    let identified = |variant| {
        let scored = testbed::identify(&setup, &model, &runs, variant);
        bar.inc(1);
        scored
    };
    let [exact, raw, smoothed, usual] = Variant::ALL.map(identified);
    let (usual, missing) = compared(usual);
    let mut scored = vec![exact?, raw?, smoothed?];
    scored.extend(usual);
    bar.finish_and_clear();

    let (raw, smoothed) = (&scored[1], &scored[2]);
    let gain = results::smoothing_gain(raw, scored.get(3), smoothed);
    let limited = results::AtEffortLimit::new(&setup, &runs);
    let scores = results::scores(&setup, &model, (&scored, missing.as_deref()), gain.clone(), limited.clone());
    simulate::write_recordings(&folder, &setup, &runs)?;
    folder.write_json(
        "identification.json",
        results::IDENTIFICATION_SCHEMA,
        &results::identification(&setup, &model, &scored),
    )?;
    folder.write_json("score.json", results::SCORE_SCHEMA, &scores)?;
    let found = html::run::Found {
        model: &model,
        scored: &scored,
        gain: &gain,
        limited: &limited,
        missing: missing.as_deref(),
    };
    let page = html::run::page(&setup, &runs, found, Provenance::here(Some(setup.scenario.seed)))?;
    folder.write_text(html::FILE, &page.render())?;
    viewer::add(&folder, || viewer::scenario::film(&setup, &runs, Some((&model, smoothed))))?;
    let path = folder.finish()?;
    print::result(global, results::SCORE_SCHEMA, &scores, || {
        let tables = console::scores(&setup, (&scored, missing.as_deref()), &gain, model.base().len());
        let notes = simulate::notes(&setup);
        format!("{notes}{tables}\n{}\nResults in {}", console::at_effort_limit(&setup, &limited), path.display())
    })?;
    Ok(DONE)
}
