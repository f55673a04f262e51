//! Options that say which arm the logs belong to, shared by all commands that read logs.

use super::gravity;
use crate::dataset::Dataset;
use crate::dataset::arm::{Asked, LoggedArm};
use crate::error::Result;
use crate::identification::effect_model::Trust;
use std::path::{Path, PathBuf};

/// The arm and its joints.
#[derive(Debug, Clone, clap::Args)]
#[command(next_help_heading = "Arm")]
pub(crate) struct ArmArguments {
    /// Robot file, URDF or MJCF. Default: that of the dataset or of the scenario.
    #[arg(long, value_name = "ROBOT")]
    pub robot: Option<PathBuf>,
    /// Joints under study, comma-separated; all others are held. Default: those that the logs name, without those that stand
    /// still in all of them.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub joints: Vec<String>,
    /// Link at the end of the arm: the joints between the base and this link are under study.
    #[arg(long, value_name = "LINK", conflicts_with = "joints")]
    pub tip: Option<String>,
    /// Gravity in the base frame, m/s2. Default: that of the dataset, else 9.81 along -z.
    #[arg(long, value_name = "X,Y,Z", value_parser = gravity::parse, allow_hyphen_values = true)]
    pub gravity: Option<nalgebra::Vector3<f64>>,
}

impl ArmArguments {
    /// The file of the arm, named here or by the dataset.
    pub(crate) fn file(&self, dataset: Option<&Dataset>) -> Option<PathBuf> {
        self.robot.clone().or_else(|| dataset.and_then(Dataset::robot))
    }

    /// The arm in `file`, of which `logs` are.
    ///
    /// # Errors
    /// Those of [`LoggedArm::open`].
    pub(crate) fn open(
        &self,
        file: &Path,
        trust: Trust,
        dataset: Option<&Dataset>,
        logs: &[PathBuf],
    ) -> Result<LoggedArm> {
        let joints = Some(self.joints.clone()).filter(|joints| !joints.is_empty());
        let asked = Asked { joints, tip: self.tip.clone(), gravity: self.gravity };
        LoggedArm::open(file, &asked, trust, dataset, logs)
    }
}
