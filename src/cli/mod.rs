//! The command line: one file per command, each thin: parse, call the library, print.

mod arm;
mod blind;
mod check;
mod corrected;
mod diagnose;
mod effects;
mod excite;
mod global;
mod gravity;
mod identify;
mod inspect;
mod interrupt;
mod logs;
mod measured;
mod montecarlo;
mod paper;
mod payload;
mod print;
mod progress;
mod robot;
mod run;
mod simulate;
mod usual_way;
mod view;

pub use global::{BAD_INPUT, DONE, FAILED, Global};

use clap::{Parser, Subcommand};
use std::io::Write;
use std::process::ExitCode;
use tracing_subscriber::EnvFilter;

/// Says what the dynamic model of a robot arm misses, by how much, and what to do about it.
#[derive(Debug, Parser)]
#[command(name = "tauscope", version, about, long_about = LONG_ABOUT, after_help = EXAMPLE, max_term_width = 120)]
struct Cli {
    #[command(flatten)]
    global: Global,
    #[command(subcommand)]
    command: Option<Command>,
}

const LONG_ABOUT: &str = "\
Says what the dynamic model of a robot arm misses, by how much, and what to do about it. `diagnose`, `inspect` and \
`identify` work on logs of a real arm. `run` is the testbed: it simulates an arm in rapier along an excitation motion, \
adds sensor noise, identifies the dynamic parameters and scores them against the truth. `blind`, `montecarlo` and \
`check` measure the tool itself.

Without a command it runs `tauscope run scenarios/irb1600.toml`.

Exit codes: 0 done, 1 a check failed, 2 bad input or usage.";

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
    /// Say from logs what the model of an arm misses: effect, joint, size.
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
    let cli = Cli::parse();
    log_warnings(&cli.global);
    let command = cli.command.unwrap_or_else(|| Command::Run(run::Arguments::default()));
    let result = match command {
        Command::Run(arguments) => run::run(&arguments, &cli.global),
        Command::Identify(arguments) => identify::run(&arguments, &cli.global),
        Command::Inspect(arguments) => inspect::run(&arguments, &cli.global),
        Command::Paper(arguments) => paper::run(&arguments, &cli.global),
        Command::Simulate(arguments) => simulate::run(&arguments, &cli.global),
        Command::Excite(arguments) => excite::run(&arguments, &cli.global),
        Command::Diagnose(arguments) => diagnose::run(&arguments, &cli.global),
        Command::Payload(arguments) => payload::run(&arguments, &cli.global),
        Command::Blind(arguments) => blind::run(&arguments, &cli.global),
        Command::Montecarlo(arguments) => montecarlo::run(&arguments, &cli.global),
        Command::Check(arguments) => check::run(&arguments, &cli.global),
        Command::Robot(arguments) => robot::run(&arguments, &cli.global),
        Command::View(arguments) => view::run(&arguments, &cli.global),
        Command::Effects(arguments) => effects::run(&arguments, &cli.global),
    };
    match result {
        Ok(code) => ExitCode::from(code),
        Err(error) => {
            // If standard error cannot be written, the exit code still reports the failure.
            let red = anstyle::AnsiColor::Red.on_default().bold();
            let _ = writeln!(anstream::stderr(), "{red}tauscope:{red:#} {error}");
            ExitCode::from(BAD_INPUT)
        }
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
