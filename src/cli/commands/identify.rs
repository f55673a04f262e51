//! `tauscope identify`: fit an arm's parameters, and named effects, to logs.

use crate::cli::shared::{ArmArguments, DONE, Global, LogArguments, corrected, interrupt, print, progress, trust};
use crate::dataset::arm::LoggedArm;
use crate::dataset::{self, Dataset, Logs};
use crate::diagnosis::{Diagnosis, Estimated, Followed};
use crate::error::{Error, Result};
use crate::identification::effect_model::{Preparation, Trust};
use crate::identification::fit;
use crate::identification::prepare::Smoothing;
use crate::identification::reversals::Band;
use crate::identification::smoothing_choice::{usual_block, usual_decimation, window_of_log};
use crate::identification::{Identification, Progress, Wanted};
use crate::output::ResultFolder;
use crate::recording::Recording;
use crate::recording::lenient::Sieved;
use crate::report::fit::{self as report, SCHEMA};
use crate::report::viewer;
use crate::robot::{self, Robot};
use crate::scenario::Setup;
use crate::study::{replay, testbed};
use std::path::PathBuf;

/// Arguments of `tauscope identify`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example:\n  tauscope identify --robot arm.urdf --train monday.csv --test tuesday.csv --effect stribeck_friction:joint_2"
)]
pub(crate) struct Arguments {
    #[command(flatten)]
    logs: LogArguments,
    #[command(flatten)]
    arm: ArmArguments,
    /// Scenario whose arm, sensors and identification settings are used. Without logs its two motions are simulated.
    #[arg(long, value_name = "SCENARIO", help_heading = "Model")]
    scenario: Option<PathBuf>,
    /// Effect to fit together with the arm's parameters, `NAME` or `NAME:JOINT`; without a joint, on every joint. Repeatable.
    #[arg(long, value_name = "EFFECT", help_heading = "Model")]
    effect: Vec<String>,
    /// Estimate the effects as `diagnose` estimates its findings: with its preparation of the logs, its noise and its standard deviations,
    /// without a search. The arm is then fitted without them.
    #[arg(
        long,
        requires = "effect",
        conflicts_with_all = ["window", "order", "low_pass_hz", "block_means_hz", "decimation", "band"],
        help_heading = "Model"
    )]
    as_diagnose: bool,
    /// Estimate the inertias (structure), or take them from the URDF (nominal).
    #[arg(long, value_parser = trust::parser(), default_value = "structure", help_heading = "Model")]
    trust: Trust,
    /// Savitzky-Golay window, samples, odd. Default: that of the scenario, else 0.12 s, longer where positions are noisy.
    #[arg(long, value_name = "SAMPLES", help_heading = "Smoothing")]
    window: Option<usize>,
    /// Savitzky-Golay polynomial order. Default: that of the scenario, else 6.
    #[arg(long, value_name = "N", help_heading = "Smoothing")]
    order: Option<usize>,
    /// Zero-phase low-pass with this cut-off in place of Savitzky-Golay, Hz.
    #[arg(long, value_name = "HZ", conflicts_with_all = ["window", "order"], help_heading = "Smoothing")]
    low_pass_hz: Option<f64>,
    /// As `diagnose` prepares logs, in place of Savitzky-Golay: positions through a zero-phase low-pass with this cut-off, Hz
    /// (`position_cutoffs_hz` of diagnosis.json has those of a diagnosis), torque and regressor as means over 20 ms.
    /// One for all joints, or one for each, separated by commas.
    #[arg(
        long,
        value_name = "HZ",
        value_delimiter = ',',
        conflicts_with_all = ["window", "order", "low_pass_hz"],
        help_heading = "Smoothing"
    )]
    block_means_hz: Vec<f64>,
    /// Keep every N-th sample after smoothing; with block means, samples in a block. Default: that of the scenario, else a twelfth of
    /// the window; 20 ms.
    #[arg(long, value_name = "N", help_heading = "Smoothing")]
    decimation: Option<usize>,
    /// Leave out samples of a joint slower than this, rad/s or m/s, and those that the smoothing mixes with them. Default: samples
    /// whose direction is uncertain under the noise of the joint's own velocity.
    #[arg(long, value_name = "RAD_S", help_heading = "Smoothing")]
    band: Option<f64>,
}

/// Relative times of reading logs, a fit without effects, one with effects, their estimates as of a diagnosis, and the simulation.
const READING: u64 = 2;
const FIT: u64 = 4;
const WITH_EFFECTS: u64 = 16;
const AS_DIAGNOSE: u64 = 24;
const SIMULATING: u64 = 1;

/// Fits and writes the results folder.
pub(crate) fn run(arguments: &Arguments, global: &Global) -> Result<u8> {
    let setup = arguments.scenario.as_ref().map(|path| Setup::load(path, global.seed)).transpose()?;
    let dataset = arguments.logs.described()?;
    let mut arm = arm(arguments, setup.as_ref(), dataset.as_ref())?;
    let simulates = dataset.is_none() && arguments.logs.train.is_empty() && setup.is_some();
    let reading = if simulates { 0 } else { READING };
    let of_effects = match arguments.as_diagnose {
        _ if arguments.effect.is_empty() => 0,
        true => AS_DIAGNOSE,
        false => WITH_EFFECTS,
    };
    arguments.effect.iter().try_for_each(|effect| Wanted::from(effect).check(arm.robot()))?;
    let mut stages = progress::Stages::new(global, &[reading, FIT + of_effects, FIT, SIMULATING]);
    stages.begin("reading the logs");
    let (Logs { mut train, mut test, mut notes, correction, torque_is_scaled, units }, as_read) =
        logs(arguments, setup.as_ref(), dataset.as_ref(), &mut arm, global)?;
    let mut robot = arm.into_robot();
    let as_diagnosed = match arguments.as_diagnose {
        true => {
            stages.begin("estimating the effects");
            Some(as_diagnosed(arguments, &robot, as_read, [&train, &test], global)?)
        }
        false => None,
    };
    notes.extend(robot.notes.clone());
    if let Some(description) = &correction {
        robot.gravity = description.gravity;
    }
    let preparation = preparation(arguments, setup.as_ref(), &train[0])?;
    notes.extend(report::longer_window(&preparation.smoothing, &train[0]).filter(|_| arguments.window.is_none()));
    notes.extend(without_short_pieces([&mut train, &mut test], &preparation.smoothing)?);
    let folder = ResultFolder::create(global.folder(&format!("identify_{}", robot.name)))?;
    let named = arguments.logs.named(arguments.arm.robot.clone());
    corrected::write(&folder, dataset.as_ref(), &named, &robot, correction.as_ref(), None, units)?;
    let (train, test): (Vec<&Recording>, Vec<&Recording>) = (train.iter().collect(), test.iter().collect());
    let logs = fit::Logs { train: &train, test: &test };
    let question = Identification::of(&robot).train(logs.train.iter().copied()).test(logs.test.iter().copied());
    let of_fit = if arguments.as_diagnose { &[][..] } else { &arguments.effect };
    let question = question.effects(of_fit).trust(arguments.trust).preparation(preparation.clone());
    let question = question.progress(|now| match now {
        Progress::Arm => stages.begin("identifying"),
        Progress::Bodies => stages.begin("finding consistent parameters"),
        _ => {}
    });
    let found = match interrupt::of_host(global) {
        Some(stop) => question.stop(stop).run()?,
        None => question.run()?,
    };
    let (plain, extended, consistent) =
        (&found.without_effects, found.with_effects.as_ref(), found.consistent.as_ref());
    let (fitted, identified) = (found.fitted(), &found.robot);
    notes.extend(found.notes.iter().cloned());
    notes.extend(report::undetermined(found.model.base(), plain));
    notes.extend(report::constants(&robot, fitted));
    notes.extend(report::falling_friction(&robot, fitted));
    notes.extend(report::negative_coulomb(&robot, fitted));
    notes.extend(report::negative_rotor(&robot, fitted, identified, logs.train));
    notes.extend(report::between_logs(fitted));
    if arguments.trust == Trust::Nominal {
        notes.extend(report::unlike_described(&robot, fitted, logs.train));
    }
    notes.extend(consistent.and_then(|bodies| report::not_of_bodies(&robot, plain, bodies)));
    notes.extend(consistent.and_then(|bodies| report::undetermined_held_out(&robot, plain, bodies)));
    notes.extend(report::of_another_arm(&robot, plain, consistent));
    write_robot(&folder, identified)?;
    let found = report::Found { plain, extended, consistent, torque_is_scaled };
    let result = report::result(&robot, arguments.trust, found, &notes).with_estimates(as_diagnosed.clone());
    folder.write_json("identification.json", SCHEMA, &result)?;
    stages.begin("simulating the identified arm");
    let replayed = replayed(identified, logs, preparation);
    let shown = viewer::fit::Shown { plain, extended, replayed: replayed.as_deref() };
    viewer::add(&folder, || Ok(viewer::fit::film(&robot, logs, shown)))?;
    stages.finish();
    let path = folder.finish()?;
    print::result(global, SCHEMA, &result, || {
        let notes = notes.iter().fold(String::new(), |text, note| text + note + "\n");
        let estimates = as_diagnosed.iter().map(|one| format!("\n\n{}", report::estimates(&robot, one)));
        let tables = report::tables(&robot, found) + &estimates.collect::<String>();
        format!("{notes}{tables}\n\nResults in {}", path.display())
    })?;
    Ok(DONE)
}

/// Writes an identified arm as a URDF and as a MuJoCo model.
///
/// # Errors
/// If a file cannot be written, or that of the robot cannot be read any longer.
pub(crate) fn write_robot(folder: &ResultFolder, identified: &Robot) -> Result<()> {
    folder.write_text("identified.urdf", &robot::with_parameters(identified)?)?;
    folder.write_text("identified.xml", &robot::to_mjcf(identified))
}

/// The arm that is identified.
enum Subject {
    /// That of logs.
    Logged(Box<LoggedArm>),
    /// That of a scenario.
    Simulated(Box<Robot>),
}

impl Subject {
    fn robot(&self) -> &Robot {
        match self {
            Subject::Logged(arm) => &arm.robot,
            Subject::Simulated(robot) => robot,
        }
    }

    fn into_robot(self) -> Robot {
        match self {
            Subject::Logged(arm) => arm.robot,
            Subject::Simulated(robot) => *robot,
        }
    }
}

fn arm(arguments: &Arguments, setup: Option<&Setup>, dataset: Option<&Dataset>) -> Result<Subject> {
    if let Some(file) = arguments.arm.file(dataset) {
        let logs = arguments.logs.files(dataset);
        return Ok(Subject::Logged(Box::new(arguments.arm.open(&file, arguments.trust, dataset, &logs)?)));
    }
    let Some(setup) = setup else {
        return Err(Error::request("--robot", "give the arm's URDF, or a --dataset or --scenario that names one"));
    };
    let mut robot = setup.known.clone();
    if let Some(dataset) = dataset {
        dataset.mount(&mut robot)?;
    }
    robot.gravity = arguments.arm.gravity.unwrap_or(robot.gravity);
    Ok(Subject::Simulated(Box::new(robot)))
}

/// Training and held-out logs as they are in files.
type AsRead = [Vec<(PathBuf, Sieved)>; 2];

/// Logs made ready, and as they were read where a diagnosis is to make them ready.
fn logs(
    arguments: &Arguments,
    setup: Option<&Setup>,
    dataset: Option<&Dataset>,
    arm: &mut Subject,
    global: &Global,
) -> Result<(Logs, Option<AsRead>)> {
    if dataset.is_some() || !arguments.logs.train.is_empty() {
        let mut logs = arguments.logs.read(dataset, arm.robot())?;
        if let Subject::Logged(arm) = arm {
            arm.settle(dataset, &mut logs)?;
        }
        let as_read = arguments.as_diagnose.then(|| logs.clone());
        return Ok((dataset::ready(logs, arm.robot())?, as_read));
    }
    let Some(setup) = setup else {
        return Err(Error::request("--train", "give at least one log, a --dataset, or a --scenario to simulate"));
    };
    let bar = progress::bar(global, "simulating", testbed::samples(setup));
    let runs = testbed::record(setup, &mut |done| bar.set_position(done as u64))?;
    bar.finish_and_clear();
    let logs = Logs { train: vec![runs.training.recording], test: vec![runs.held_out.recording], ..Logs::default() };
    Ok((logs, None))
}

/// The effects as a diagnosis of the logs estimates them: of those `as_read` from files, else of the `simulated` ones.
fn as_diagnosed(
    arguments: &Arguments,
    robot: &Robot,
    as_read: Option<AsRead>,
    simulated: [&[Recording]; 2],
    global: &Global,
) -> Result<Estimated> {
    let question = Diagnosis::of(robot).trust(arguments.trust).seed(global.seed.unwrap_or_default());
    let question = match as_read {
        Some([train, test]) => question.train(train).test(test),
        None => question.train(simulated[0]).test(simulated[1]),
    };
    match interrupt::of_host(global) {
        Some(stop) => question.stop(stop).estimate(&arguments.effect),
        None => question.estimate(&arguments.effect),
    }
}

/// The identified arm in the simulator along the logs that the viewer shows; nothing without the viewer, or where the
/// logs are long or the arm runs away.
pub(super) fn replayed(identified: &Robot, logs: fit::Logs, preparation: Preparation) -> Option<Vec<Followed>> {
    let shown = viewer::fit::shown_logs(logs);
    if !cfg!(feature = "viewer") || !replay::is_short(shown) {
        return None;
    }
    match replay::replay(identified, shown, preparation) {
        Ok(followed) => Some(followed),
        Err(problem) => {
            // The viewer shows the logs without it; what was identified does not depend on it.
            tracing::debug!("the identified arm was not simulated for the viewer: {problem}");
            None
        }
    }
}

/// Leaves out the pieces between gaps that are shorter than the smoothing window, with a note.
fn without_short_pieces(logs: [&mut Vec<Recording>; 2], smoothing: &Smoothing) -> Result<Option<String>> {
    let Smoothing::SavitzkyGolay { window, .. } = smoothing else { return Ok(None) };
    let [train, test] = logs;
    let seconds = |logs: &[Recording]| logs.iter().map(Recording::duration).sum::<f64>();
    let (pieces, before) = (train.len() + test.len(), seconds(train) + seconds(test));
    // A log of one piece has no gaps: that it is too short is said where it is smoothed.
    if pieces < 3 || train.iter().chain(&*test).all(|piece| piece.samples() >= *window) {
        return Ok(None);
    }
    let had_test = !test.is_empty();
    train.retain(|piece| piece.samples() >= *window);
    test.retain(|piece| piece.samples() >= *window);
    if train.is_empty() || (had_test && test.is_empty()) {
        let which = if train.is_empty() { "training" } else { "held-out" };
        let problem = format!(
            "no piece of the {which} logs between two gaps has as many samples as the smoothing window ({window}): log without gaps, or give a \
             shorter window"
        );
        return Err(Error::request("--window", problem));
    }
    let (left, after) = (pieces - train.len() - test.len(), seconds(train) + seconds(test));
    Ok(Some(format!(
        "{left} of {pieces} pieces between gaps of the logs, {:.1} of {before:.1} s together, are shorter than the smoothing window ({window} samples) and \
         are left out (--window sets it)",
        before - after
    )))
}

fn preparation(arguments: &Arguments, setup: Option<&Setup>, log: &Recording) -> Result<Preparation> {
    let spec = setup.map(|setup| &setup.scenario.identification);
    let window = arguments.window.or(spec.and_then(|s| s.smoothing_window));
    let window = window.unwrap_or_else(|| window_of_log(log));
    let order = arguments.order.or(spec.map(|s| s.smoothing_order)).unwrap_or(6);
    let decimation = arguments.decimation.or(spec.map(|s| s.decimation)).unwrap_or_else(|| usual_decimation(window));
    if decimation == 0 {
        return Err(Error::request("--decimation", "must be 1 or more"));
    }
    let band = arguments.band.or(spec.map(|s| s.reversal_band_rad_s)).map_or(Band::OfNoise, Band::Given);
    let low_pass = arguments.low_pass_hz.or(spec.and_then(|s| s.low_pass_hz).filter(|_| arguments.window.is_none()));
    let smoothing = match (&arguments.block_means_hz[..], low_pass) {
        ([], Some(cutoff_hz)) => Smoothing::LowPass { cutoff_hz, decimation },
        ([], None) => Smoothing::SavitzkyGolay { window, order, decimation },
        (cutoffs_hz, _) => {
            let block = arguments.decimation.unwrap_or(usual_block(log.rate_hz()));
            Smoothing::BlockMeans { cutoffs_hz: cutoffs_hz.to_vec(), block }
        }
    };
    Ok(Preparation { smoothing, band })
}
