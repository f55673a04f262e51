//! `tauscope montecarlo`: the same identification on many draws, on one machine or as parts of an array job.

use crate::cli::shared::{DONE, FAILED, Global, interrupt, print, progress};
use crate::error::{Error, Result};
use crate::report::html::{self, Provenance};
use crate::report::montecarlo as report;
use crate::scenario::{NoiseLevel, Setup};
use crate::study::montecarlo::{
    self, Overrides, Plan, Progress, SUMMARY_SCHEMA, Shard, Study, StudyFolder, Summary, Timings,
};
use std::path::PathBuf;

/// Schema of a replayed trial.
const TRIAL_SCHEMA: &str = "tauscope.montecarlo.trial/1";

/// Arguments of `tauscope montecarlo`.
#[derive(Debug, clap::Args)]
#[command(args_conflicts_with_subcommands = true)]
#[command(
    after_help = "Example:\n  tauscope montecarlo scenarios/irb1600.toml --trials 100 --estimators ols,wls,iv --sg-windows 0,31,61 --butterworth"
)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,
    /// Scenario file.
    #[arg(default_value = "scenarios/irb1600.toml")]
    scenario: PathBuf,
    /// Number of trials. Default: that of the scenario.
    #[arg(long, help_heading = "Study", value_name = "N")]
    trials: Option<usize>,
    /// Estimators, comma-separated: ols, wls, irls, lm, tls, iv, didim. Default: those of the scenario.
    #[arg(long, help_heading = "Study", value_name = "NAMES", value_delimiter = ',')]
    estimators: Option<Vec<String>>,
    /// Savitzky-Golay windows in samples, comma-separated, 0 for no smoothing. Default: those of the scenario, or none and its
    /// window.
    #[arg(long, help_heading = "Study", value_name = "WINDOWS", value_delimiter = ',')]
    sg_windows: Option<Vec<usize>>,
    /// Also smooth by common practice: zero-phase Butterworth, central differences, parallel filter and decimation.
    #[arg(long, help_heading = "Study")]
    butterworth: bool,
    /// Noise levels, comma-separated: encoder noise in rad, or with torque noise in N m after a colon, as in 1e-4:0.05.
    /// Default: those of the scenario.
    #[arg(long, help_heading = "Study", value_name = "LEVELS", value_delimiter = ',', value_parser = noise_level)]
    noise_levels: Option<Vec<NoiseLevel>>,
    /// Continue a study that was stopped.
    #[arg(long, help_heading = "Array job")]
    resume: bool,
    /// Compute part I of N only, counted from 0. Default: that of the environment in an array job of Slurm or Kubernetes, else all.
    #[arg(long, help_heading = "Array job", value_name = "I/N")]
    shard: Option<Shard>,
    /// Number of parts of the array job, where the scheduler does not give it (Kubernetes; a Slurm task that is submitted again
    /// alone). Parts are then numbered from 0.
    #[arg(long, help_heading = "Array job", value_name = "N", conflicts_with = "shard")]
    shards: Option<usize>,
    /// Replay one trial and show it; nothing is written.
    #[arg(long, help_heading = "Study", value_name = "K", conflicts_with_all = ["resume", "shard", "shards"])]
    trial: Option<u32>,
}

#[derive(Debug, clap::Subcommand)]
enum Command {
    /// Join the parts of a study, after checking that no trial is missing or double.
    #[command(after_help = "Example:\n  tauscope montecarlo merge study --out study/all")]
    Merge {
        /// Folders of the parts, or folders that contain them.
        #[arg(required = true, value_name = "DIR")]
        folders: Vec<PathBuf>,
    },
}

/// Runs the study, a part of it, one trial, or the merger.
pub(crate) fn run(arguments: &Arguments, global: &Global) -> Result<u8> {
    if let Some(Command::Merge { folders }) = &arguments.command {
        let out = global.out.clone().unwrap_or_else(|| PathBuf::from("results/merged"));
        let (summary, times, path) = montecarlo::merge(folders, &out, &page)?;
        let text = || format!("{}\n\nResults in {}", report::summary(&summary, &times), path.display());
        print::result(global, SUMMARY_SCHEMA, &summary, text)?;
        return Ok(DONE);
    }
    let setup = Setup::load(&arguments.scenario, global.seed)?;
    let overrides = Overrides {
        trials: arguments.trials,
        estimators: arguments.estimators.clone(),
        windows: arguments.sg_windows.clone(),
        butterworth: arguments.butterworth,
        noise: arguments.noise_levels.clone(),
    };
    let plan = Plan::new(&setup, overrides)?;
    if let Some(trial) = arguments.trial {
        return replay(setup, plan, trial, global);
    }
    let shard = match arguments.shard {
        Some(shard) => shard,
        None => Shard::from_environment(|name| std::env::var(name).ok(), arguments.shards)?.unwrap_or(Shard::WHOLE),
    };
    let out = global.folder(&format!("{}_montecarlo", setup.scenario.name));
    let study = Study::new(setup, plan)?;
    let folder = StudyFolder::open(&out, &study, shard, arguments.resume)?;
    let stop = interrupt::flag(global)?;
    let bar = progress::bar(global, "trials", folder.trials(&study));
    let done = |trials: usize| bar.inc(trials as u64);
    let finished = folder.run(&study, &Progress { done: &done, stop: &stop }, &page)?;
    let left = folder.trials(&study) as u64 - bar.position();
    bar.finish_and_clear();
    let Some((summary, times, path)) = finished else {
        if !global.quiet {
            eprintln!("Stopped with {left} trials to go; --resume continues");
        }
        return Ok(FAILED);
    };
    let text = || format!("{}\n\nResults in {}", report::summary(&summary, &times), path.display());
    print::result(global, SUMMARY_SCHEMA, &summary, text)?;
    Ok(DONE)
}

/// The study on a page.
fn page(summary: &Summary, times: &Timings) -> String {
    html::montecarlo::page(summary, times, Provenance::here(Some(summary.seed))).render()
}

/// One trial of a study, replayed.
#[derive(serde::Serialize)]
struct Replayed<'a> {
    scenario: &'a str,
    trial: u32,
    parameters: Vec<String>,
    rows: &'a [montecarlo::Row],
}

fn replay(setup: Setup, plan: Plan, trial: u32, global: &Global) -> Result<u8> {
    if trial as usize >= plan.spec.trials {
        let problem = format!("the study has trials 0 to {}", plan.spec.trials - 1);
        return Err(Error::request("--trial", problem));
    }
    let study = Study::new(setup, plan)?;
    let rows = study.trial(trial);
    let scenario = &study.setup.scenario.name;
    let replayed = Replayed { scenario, trial, parameters: study.parameters(), rows: &rows };
    print::result(global, TRIAL_SCHEMA, &replayed, || {
        format!("{scenario}, trial {trial}\n\n{}", report::trial(&rows))
    })?;
    Ok(DONE)
}

fn noise_level(text: &str) -> std::result::Result<NoiseLevel, String> {
    let number = |text: &str| text.parse::<f64>().map_err(|_| format!("`{text}` is no number"));
    let (encoder, torque) = text.split_once(':').map_or((text, None), |(encoder, torque)| (encoder, Some(torque)));
    Ok(NoiseLevel { encoder_rad: Some(number(encoder)?), torque_nm: torque.map(number).transpose()? })
}
