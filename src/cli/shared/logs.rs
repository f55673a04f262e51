//! Options that say which logs to take, shared by all commands that identify from logs.

use crate::dataset::{self, Dataset, Named};
use crate::error::Result;
use crate::recording::lenient::Sieved;
use crate::robot::Robot;
use std::path::PathBuf;

/// Training logs, held-out logs, or a dataset that names both.
#[derive(Debug, Clone, clap::Args)]
#[command(next_help_heading = "Logs")]
pub(crate) struct LogArguments {
    /// Training logs: parameters are estimated from them. Repeatable.
    #[arg(long, value_name = "LOG", num_args = 1..)]
    pub train: Vec<PathBuf>,
    /// Held-out logs of different motions: no parameter is fitted to them. Repeatable.
    #[arg(long, value_name = "LOG", num_args = 1..)]
    pub test: Vec<PathBuf>,
    /// Dataset: a TOML file that describes logs (columns, units, motors, payload, mounting) and names training and held-out logs.
    #[arg(long, value_name = "TOML", conflicts_with_all = ["train", "test"])]
    pub dataset: Option<PathBuf>,
}

impl LogArguments {
    /// The dataset, where one is given.
    ///
    /// # Errors
    /// Those of [`Dataset::load`].
    pub(crate) fn described(&self) -> Result<Option<Dataset>> {
        self.dataset.as_ref().map(Dataset::load).transpose()
    }

    /// All log files, those of the `dataset` last.
    pub(crate) fn files(&self, dataset: Option<&Dataset>) -> Vec<PathBuf> {
        let described = dataset.map(Dataset::files).unwrap_or_default();
        self.train.iter().chain(&self.test).cloned().chain(described).collect()
    }

    /// The training and the held-out logs.
    ///
    /// # Errors
    /// Those of reading a log.
    pub(crate) fn read(&self, dataset: Option<&Dataset>, robot: &Robot) -> Result<[Vec<(PathBuf, Sieved)>; 2]> {
        match dataset {
            Some(dataset) => dataset.sieved(robot),
            None => Ok([dataset::read_all(&self.train, robot)?, dataset::read_all(&self.test, robot)?]),
        }
    }

    /// The files as a corrected dataset names them, with the `robot` of the command line.
    pub(crate) fn named(&self, robot: Option<PathBuf>) -> Named {
        Named { robot, train: self.train.clone(), test: self.test.clone() }
    }
}
