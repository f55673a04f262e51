//! What all commands share: options and exit codes.

use super::host::Host;
use clap::Args;
use std::path::PathBuf;
use std::sync::Arc;

/// Done.
pub const DONE: u8 = 0;
/// A check failed.
pub const FAILED: u8 = 1;
/// Bad input or usage.
pub const BAD_INPUT: u8 = 2;

/// Options of every command.
///
/// ```
/// use std::path::Path;
/// use tauscope::cli::Global;
///
/// // Where results go, with and without --out.
/// let global = Global::default();
/// assert_eq!(global.folder("short"), Path::new("results/short"));
/// let global = Global { out: Some("elsewhere".into()), ..global };
/// assert_eq!(global.folder("short"), Path::new("elsewhere"));
/// ```
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "General")]
pub struct Global {
    /// Print the result as JSON on standard output instead of tables.
    #[arg(long, global = true)]
    pub json: bool,
    /// Seed of every random number. Default: the scenario's, else 0 (check: the baseline's; diagnose: 0).
    #[arg(long, global = true, value_name = "N")]
    pub seed: Option<u64>,
    /// Folder for the results. Default: `results/NAME`.
    #[arg(long, global = true, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print errors only: no progress bar, no tables.
    #[arg(long, short, global = true)]
    pub quiet: bool,
    /// The program that runs the command inside itself, if any.
    #[arg(skip)]
    pub host: Option<Arc<Host>>,
}

impl Global {
    /// The results folder of something called `name`.
    pub fn folder(&self, name: &str) -> PathBuf {
        self.out.clone().unwrap_or_else(|| PathBuf::from("results").join(name))
    }
}
