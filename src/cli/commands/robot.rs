//! `tauscope robot`: what a robot file holds, and which joints are under study.

use crate::cli::shared::{DONE, Global, print};
use crate::error::{Error, Result};
use crate::report::robot as report;
use crate::robot::{Choice, InertiaCheck, description, to_urdf};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Arguments of `tauscope robot`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  tauscope robot arm.urdf --tip tool0 --urdf reduced.urdf")]
pub(crate) struct Arguments {
    /// Robot file, URDF or MJCF.
    file: PathBuf,
    /// Joints under study, comma-separated; all others are held. Default: all that move by themselves.
    #[arg(long, value_name = "NAMES", value_delimiter = ',', help_heading = "Joints")]
    joints: Vec<String>,
    /// Link at the end of the arm: the joints between the base and this link are under study.
    #[arg(long, value_name = "LINK", conflicts_with = "joints", help_heading = "Joints")]
    tip: Option<String>,
    /// Position of a joint that is held, rad or m; repeatable. Default: the middle of its range.
    #[arg(long, value_name = "NAME=VALUE", value_parser = position, help_heading = "Joints")]
    hold: Vec<(String, f64)>,
    /// Also write the robot under study to this URDF, with held joints fixed.
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    urdf: Option<PathBuf>,
}

fn position(text: &str) -> std::result::Result<(String, f64), String> {
    let (name, value) = text.split_once('=').ok_or("give a joint and its position: NAME=VALUE")?;
    let position = value.trim().parse::<f64>().ok().filter(|position| position.is_finite());
    Ok((name.trim().to_owned(), position.ok_or_else(|| format!("`{value}` is no position"))?))
}

/// Reads the robot and prints it.
pub(crate) fn run(arguments: &Arguments, global: &Global) -> Result<u8> {
    let file = description::read(&arguments.file)?;
    let hold: BTreeMap<String, f64> = arguments.hold.iter().cloned().collect();
    if let Some(unknown) = hold.keys().find(|name| !file.moving().iter().any(|joint| joint.name == **name)) {
        let names: Vec<&str> = file.moving().iter().map(|joint| joint.name.as_str()).collect();
        let problem = format!("`{unknown}` is no joint that turns or slides; there are {}", names.join(", "));
        return Err(Error::request("--hold", problem));
    }
    let joints = Some(arguments.joints.clone()).filter(|joints| !joints.is_empty());
    let robot = file.robot(&Choice { joints, tip: arguments.tip.clone(), hold }, InertiaCheck::Ignored)?;
    if let Some(path) = &arguments.urdf {
        std::fs::write(path, to_urdf(&robot)).map_err(|source| Error::io(path, "write the URDF", source))?;
    }
    print::result(global, report::SCHEMA, &report::result(&file, &robot), || report::text(&file, &robot))?;
    Ok(DONE)
}
