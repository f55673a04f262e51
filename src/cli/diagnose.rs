//! `tauscope diagnose`: name what the model of an arm misses, from logs.

use super::{DONE, Global, print};
use crate::diagnosis::{self, Options, diagnose};
use crate::effects;
use crate::error::{Error, Result};
use crate::identification::effect_model::Trust;
use crate::output::ResultFolder;
use crate::recording::{self, Recording};
use crate::report::diagnosis::{self as report, SCHEMA};
use crate::report::html::{self, Provenance};
use crate::report::viewer;
use crate::robot::{self, InertiaCheck};
use indicatif::{ProgressBar, ProgressDrawTarget};
use std::path::PathBuf;
use std::time::Duration;

/// Arguments of `tauscope diagnose`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// URDF of the arm.
    #[arg(long, value_name = "URDF")]
    robot: PathBuf,
    /// Log to identify from; repeat for more.
    #[arg(long, value_name = "LOG", required = true)]
    train: Vec<PathBuf>,
    /// Log of another motion to judge by; repeat for more. Without any, the last part of every training log.
    #[arg(long, value_name = "LOG")]
    test: Vec<PathBuf>,
    /// Whether the URDF's inertias are believed, or re-identified.
    #[arg(long, value_enum, default_value = "structure")]
    trust: Trust,
    /// Gravity in the base frame, m/s2.
    #[arg(long, value_name = "X,Y,Z", value_delimiter = ',', num_args = 3, allow_hyphen_values = true)]
    gravity: Option<Vec<f64>>,
    /// Probability of naming anything where there is nothing.
    #[arg(long, default_value_t = 0.05)]
    alpha: f64,
    /// Most effects that are named.
    #[arg(long, default_value_t = 6)]
    max_findings: usize,
    /// Effect to look for; repeat for more. All of the library where absent.
    #[arg(long, value_name = "EFFECT")]
    candidates: Vec<String>,
}

/// Diagnoses and writes the results folder.
pub fn run(arguments: &Arguments, global: &Global) -> Result<u8> {
    if !(arguments.alpha > 0.0 && arguments.alpha < 1.0) {
        return Err(Error::request("--alpha", format!("is {}; give a probability between 0 and 1", arguments.alpha)));
    }
    for name in &arguments.candidates {
        effects::find(name)?;
    }
    let check = match arguments.trust {
        Trust::Nominal => InertiaCheck::Required,
        Trust::Structure => InertiaCheck::Ignored,
    };
    let mut robot = robot::load(&arguments.robot, check)?;
    if let Some(gravity) = &arguments.gravity {
        robot.gravity = nalgebra::Vector3::from_column_slice(gravity);
    }
    let names = robot.joint_names();
    let load = |paths: &[PathBuf]| -> Result<Vec<Recording>> {
        paths.iter().map(|path| recording::load(path, Some(&names))).collect()
    };
    let (train, test) = (load(&arguments.train)?, load(&arguments.test)?);
    let (train, test): (Vec<&Recording>, Vec<&Recording>) = (train.iter().collect(), test.iter().collect());
    let folder = ResultFolder::create(global.folder(&format!("diagnose_{}", robot.name)))?;
    let options = Options {
        trust: arguments.trust,
        alpha: arguments.alpha,
        max_findings: arguments.max_findings,
        seed: global.seed.unwrap_or_default(),
        candidates: arguments.candidates.clone(),
    };
    let bar = spinner(global);
    let diagnosis = diagnose(&robot, &train, &test, &options, &mut |found| {
        bar.set_message(format!("{found} effects found so far, testing the next"));
    })?;
    bar.finish_and_clear();

    let result = report::result(&robot, &diagnosis);
    folder.write_json("diagnosis.json", SCHEMA, &result)?;
    let held_out = diagnosis::held_out(&train, &test);
    let logs: Vec<&Recording> = held_out.iter().collect();
    let page = html::diagnosis::page(&robot, &diagnosis, &train, &logs, Provenance::here(Some(options.seed)));
    folder.write_text(html::FILE, &page.render())?;
    viewer::add(&folder, || Ok(viewer::diagnosis::film(&robot, &logs, &diagnosis, None)))?;
    let path = folder.finish()?;
    print::result(global, SCHEMA, &result, || {
        format!("{}\nResults in {}", report::lines(&robot, &diagnosis), path.display())
    })?;
    Ok(DONE)
}

/// How many rounds it takes depends on what is found, so there is no bar to fill.
fn spinner(global: &Global) -> ProgressBar {
    let hidden = global.quiet || global.json;
    let target = if hidden { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
    let bar = ProgressBar::with_draw_target(None, target).with_message("testing all candidates");
    bar.enable_steady_tick(Duration::from_millis(200));
    bar
}
