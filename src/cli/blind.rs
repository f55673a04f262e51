//! `tauscope blind`: hide effects in simulated arms and count how often the diagnosis names them.

use super::{DONE, Global, print, progress};
use crate::effects::{Placed, Scope, find};
use crate::error::{Error, Result};
use crate::identification::effect_model::Trust;
use crate::output::ResultFolder;
use crate::report::blind::{self as report, SCHEMA};
use crate::scenario::{Setup, effect_joint};
use crate::study::blind::{draw, run as blind_run};
use std::path::PathBuf;

/// Arguments of `tauscope blind`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Scenario whose arm, limits and sensors are used.
    #[arg(long, value_name = "SCENARIO", default_value = "scenarios/irb1600.toml")]
    scenario: PathBuf,
    /// Runs to make.
    #[arg(long, default_value_t = 10)]
    runs: u64,
    /// Effect to hide, `NAME` or `NAME:JOINT`; `none` for nothing; drawn from the library where absent.
    #[arg(long, value_name = "EFFECT")]
    effect: Option<String>,
    /// Size of the effect: what it adds beyond the baseline over the torque noise, both root mean square.
    #[arg(long, default_value_t = 1.0)]
    severity: f64,
    /// Correlation times of the torque noise, s, taken in turn.
    #[arg(long, value_name = "S", value_delimiter = ',', default_value = "0,0.13,0.5")]
    correlation: Vec<f64>,
    /// Whether the URDF's inertias are believed, or re-identified.
    #[arg(long, value_enum, default_value = "nominal")]
    trust: Trust,
}

/// Makes the runs and writes the table.
pub fn run(arguments: &Arguments, global: &Global) -> Result<u8> {
    let setup = Setup::load(&arguments.scenario, global.seed)?;
    if arguments.correlation.is_empty() || !(arguments.severity > 0.0 && arguments.severity.is_finite()) {
        return Err(Error::request("--severity", "must be a positive number, with at least one --correlation"));
    }
    let folder = ResultFolder::create(global.folder("blind"))?;
    let bar = progress::bar(global, "blind runs", arguments.runs as usize);
    let mut rows = Vec::new();
    for index in 0..arguments.runs {
        let seed = setup.scenario.seed + index;
        let correlation_s = arguments.correlation[index as usize % arguments.correlation.len()];
        let mut case = draw(&setup, seed, arguments.severity, correlation_s, arguments.trust);
        if let Some(wanted) = &arguments.effect {
            case.hidden = hidden(wanted, &setup, index)?;
        }
        rows.push(report::row(&setup, &case, &blind_run(&setup, &case)));
        bar.inc(1);
        if !global.quiet && !global.json {
            bar.println(report::line(&rows[rows.len() - 1]));
        }
    }
    bar.finish_and_clear();
    let result = report::result(rows);
    folder.write_json("blind.json", SCHEMA, &result)?;
    let path = folder.finish()?;
    print::result(global, SCHEMA, &result, || format!("{}\n\nResults in {}", report::counts(&result), path.display()))?;
    Ok(DONE)
}

/// The effect asked for; without a joint it takes all joints in turn.
fn hidden(wanted: &str, setup: &Setup, index: u64) -> Result<Option<Placed>> {
    if wanted == "none" {
        return Ok(None);
    }
    let (name, joint) = wanted.split_once(':').map_or((wanted, None), |(name, joint)| (name, Some(joint)));
    let effect = find(name)?;
    let dof = setup.known.dof();
    let joint = match (effect.about().scope, joint) {
        (Scope::Joint, None) => index as usize % dof,
        (Scope::Pair, None) => index as usize % (dof - 1).max(1),
        _ => effect_joint(effect, joint, &setup.known).map_err(|problem| Error::request(wanted, problem))?,
    };
    Ok(Some(Placed::typical(effect, joint)))
}
