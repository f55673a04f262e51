//! The command line: one file per command (`commands`), each thin: parse, call the library, print. What they share is in `shared`, which
//! uses no command.

mod commands;
mod shared;

pub use shared::{BAD_INPUT, DONE, FAILED, Global, Host, Printed};

use crate::error::{Error, Result};
use clap::{Parser, Subcommand};
use commands::{
    blind, check, diagnose, effects, excite, identify, inspect, montecarlo, paper, payload, robot, run, simulate, view,
};
use std::ffi::OsString;
use std::io::Write;
use std::process::ExitCode;
use std::sync::Arc;
use tracing_subscriber::EnvFilter;

/// Finds what the dynamic model of a robot arm lacks, by how much, and what to do about it.
#[derive(Debug, Parser)]
#[command(name = "tauscope", version, about, long_about = LONG_ABOUT, after_help = EXAMPLE, max_term_width = 120)]
struct Cli {
    #[command(flatten)]
    global: Global,
    #[command(subcommand)]
    command: Option<Command>,
}

const LONG_ABOUT: &str = "\
Reports what the dynamic model of a robot arm misses, by how much, and what to do about it. `diagnose`, `inspect` and \
`identify` work on logs of a real arm. `run` is the testbed: it simulates an arm in rapier along an excitation motion, \
adds sensor noise, identifies the dynamic parameters and scores them against the truth. `blind`, `montecarlo` and \
`check` measure the tool itself.

Without a command it runs `tauscope run scenarios/irb1600.toml`.

Exit codes: 0 done, 1 a check failed, 2 bad input or usage, also logs that forbid a diagnosis.";

const EXAMPLE: &str = "\
Example:
  tauscope diagnose --robot arm.urdf --train monday.csv --test tuesday.csv";

#[derive(Debug, Subcommand)]
enum Command {
    /// Simulate, measure, identify and score a scenario: the main job.
    Run(run::Arguments),
    /// Fit an arm's parameters, and named effects, to logs.
    Identify(Box<identify::Arguments>),
    /// Check measured logs for faults: clock, bad rows, channels, units, signs, range, dead time.
    Inspect(inspect::Arguments),
    /// Reproduce the paper's study (78-parameter model, tables, figures) and compare it with the printed one.
    Paper(paper::Arguments),
    /// Simulate and measure a scenario, without identifying.
    Simulate(simulate::Arguments),
    /// Search for an excitation motion inside all limits; ctrl-C keeps the best so far.
    Excite(excite::Arguments),
    /// Find what the model of an arm lacks, from logs: effect, joint, size.
    Diagnose(diagnose::Arguments),
    /// Find the load that was added to an arm between logs: mass, centre, inertia.
    Payload(payload::Arguments),
    /// Measure the diagnosis: hide effects in simulated arms and count how often they are named.
    Blind(blind::Arguments),
    /// Repeat the identification on many draws of noise, plants or motions, and compare estimators and smoothing.
    Montecarlo(Box<montecarlo::Arguments>),
    /// Fail if identification is significantly worse than a stored baseline.
    Check(check::Arguments),
    /// Show what a robot file holds: joints under study, coupled and held joints, notes.
    Robot(robot::Arguments),
    /// Open the recording of a results folder in the rerun viewer.
    View(view::Arguments),
    /// List the physical effects of the library, or describe one.
    Effects(effects::Arguments),
}

/// Parses the command line and runs the command.
pub fn main() -> ExitCode {
    ExitCode::from(main_with(std::env::args_os()))
}

/// [`main`] with a command line of one's own, the name of the program first. Returns the exit code. Ends the program where the command
/// line asks for help or is wrong.
pub fn main_with(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    let cli = Cli::parse_from(arguments);
    log_warnings(&cli.global);
    execute(cli).unwrap_or_else(|error| {
        // If standard error cannot be written, the exit code still reports the failure.
        let red = anstyle::AnsiColor::Red.on_default().bold();
        let _ = writeln!(anstream::stderr(), "{red}tauscope:{red:#} {error}");
        BAD_INPUT
    })
}

/// Runs a command inside a program: `arguments` are those of the command line without the program's name. Nothing is printed; `host`
/// has the answer, also where a command ends with an error after it. Returns the exit code.
///
/// ```
/// use std::sync::Arc;
/// use tauscope::cli::{self, Host};
///
/// let host = Arc::new(Host::default());
/// assert_eq!(cli::call(["effects", "backlash"], &host)?, cli::DONE);
/// assert!(host.take().is_some_and(|printed| printed.json.contains("tauscope.effects/1")));
///
/// let refused = cli::call(["effects", "--seed", "x"], &host).unwrap_err();
/// assert!(refused.to_string().starts_with("arguments: invalid value 'x' for '--seed <N>'"));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
///
/// # Errors
/// Those of the command; a command line that is wrong.
pub fn call<A: Into<OsString>>(arguments: impl IntoIterator<Item = A>, host: &Arc<Host>) -> Result<u8> {
    let arguments = arguments.into_iter().map(A::into);
    let mut cli =
        Cli::try_parse_from(std::iter::once(OsString::from("tauscope")).chain(arguments)).map_err(|problem| {
            let text = problem.to_string();
            let lines = text.lines().map(str::trim).take_while(|line| !line.is_empty());
            let line = lines.collect::<Vec<_>>().join(" ");
            Error::request("arguments", line.strip_prefix("error: ").unwrap_or(&line))
        })?;
    cli.global.host = Some(Arc::clone(host));
    cli.global.quiet = true;
    execute(cli)
}

fn execute(Cli { global, command }: Cli) -> Result<u8> {
    match command.unwrap_or_else(|| Command::Run(run::Arguments::default())) {
        Command::Run(arguments) => run::run(&arguments, &global),
        Command::Identify(arguments) => identify::run(&arguments, &global),
        Command::Inspect(arguments) => inspect::run(&arguments, &global),
        Command::Paper(arguments) => paper::run(&arguments, &global),
        Command::Simulate(arguments) => simulate::run(&arguments, &global),
        Command::Excite(arguments) => excite::run(&arguments, &global),
        Command::Diagnose(arguments) => diagnose::run(&arguments, &global),
        Command::Payload(arguments) => payload::run(&arguments, &global),
        Command::Blind(arguments) => blind::run(&arguments, &global),
        Command::Montecarlo(arguments) => montecarlo::run(&arguments, &global),
        Command::Check(arguments) => check::run(&arguments, &global),
        Command::Robot(arguments) => robot::run(&arguments, &global),
        Command::View(arguments) => view::run(&arguments, &global),
        Command::Effects(arguments) => effects::run(&arguments, &global),
    }
}

/// Warnings go to standard error: of this program all, of its libraries errors only; `TAUSCOPE_LOG` asks for more or less.
fn log_warnings(global: &Global) {
    let standard = if global.quiet { "error" } else { "error,tauscope=warn" };
    let filter = EnvFilter::try_from_env("TAUSCOPE_LOG").unwrap_or_else(|_| EnvFilter::new(standard));
    let log = tracing_subscriber::fmt().with_env_filter(filter).without_time().with_target(false);
    let colored = anstream::AutoStream::choice(&std::io::stderr()) != anstream::ColorChoice::Never;
    let log = log.with_ansi(colored).with_writer(std::io::stderr);
    // A second subscriber, as in a test that calls this twice, changes nothing.
    let _ = log.try_init();
}
