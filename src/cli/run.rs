//! `tauscope run`: simulate, measure, identify, score.

use super::{DONE, Global, progress};
use crate::error::Result;
use crate::identification::model::Model;
use crate::identification::paper78::tables::PRINTED_TABLE_3;
use crate::output::ResultFolder;
use crate::report::{console, results};
use crate::scenario::Setup;
use crate::study::testbed::{self, Variant};
use std::path::PathBuf;

/// Arguments of `tauscope run`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Scenario file.
    #[arg(default_value = "scenarios/irb1600.toml")]
    scenario: PathBuf,
}

impl Default for Arguments {
    fn default() -> Self {
        Arguments { scenario: PathBuf::from("scenarios/irb1600.toml") }
    }
}

/// Runs the scenario and writes its results folder.
pub fn run(arguments: &Arguments, global: &Global) -> Result<u8> {
    let setup = Setup::load(&arguments.scenario, global.seed)?;
    let folder = ResultFolder::create(global.folder(&setup.scenario.name))?;
    let bar = progress::bar(global, "simulating", testbed::samples(&setup));
    let runs = testbed::record(&setup, &mut |done| bar.set_position(done as u64))?;
    bar.finish_and_clear();

    let bar = progress::bar(global, "identifying", Variant::ALL.len());
    let model = Model::new(&setup.known);
    let mut scored = Vec::new();
    for variant in Variant::ALL {
        scored.push(testbed::identify(&setup, &model, &runs, variant)?);
        bar.inc(1);
    }
    bar.finish_and_clear();

    let printed: Vec<f64> = PRINTED_TABLE_3.iter().map(|[alone, smoothed]| smoothed / alone).collect();
    let gain = results::smoothing_gain(&scored[1], &scored[2], &printed);
    let scores = results::scores(&setup, &model, &scored, gain.clone());
    super::simulate::write_recordings(&folder, &setup, &runs)?;
    folder.write_json(
        "identification.json",
        results::IDENTIFICATION_SCHEMA,
        &results::identification(&setup, &model, &scored),
    )?;
    folder.write_json("score.json", results::SCORE_SCHEMA, &scores)?;
    let path = folder.finish()?;
    if global.json {
        println!("{}", serde_json::to_string_pretty(&scores).expect("scores are plain numbers and text"));
    } else if !global.quiet {
        println!("{}\n\nResults in {}", console::scores(&setup, &scored, &gain, model.base().len()), path.display());
    }
    Ok(DONE)
}
