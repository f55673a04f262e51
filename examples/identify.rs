//! Identifies an arm from a program of one's own: its URDF, a training log, and held-out logs of other motions where there are. Writes a
//! URDF with possible inertias that has the identified base parameters, friction and rotors.
//!
//! `cargo run --release --example identify -- arm.urdf train.csv test.csv`

use std::path::PathBuf;
use tauscope::dataset;
use tauscope::error::{Error, Result};
use tauscope::identification::effect_model::{Preparation, Trust};
use tauscope::identification::fit::{self, fit_effects};
use tauscope::identification::reversals::Band;
use tauscope::identification::{consistent, equations, smoothing_choice};
use tauscope::recording::Recording;
use tauscope::robot::{self, InertiaCheck};

fn main() -> Result<()> {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let [urdf, train, test @ ..] = &arguments[..] else {
        return Err(Error::request("arguments", "give a URDF, a training log, and test logs if there are any"));
    };
    let robot = robot::load(urdf, InertiaCheck::Ignored)?;
    let train = dataset::read(train, &robot)?.recording;
    let test: Vec<Recording> = dataset::read_all(test, &robot)?.into_iter().map(|(_, read)| read.recording).collect();

    // Positions are smoothed as their own noise asks for; samples in which a joint's direction is uncertain do not count.
    let train = [&train];
    let test: Vec<&Recording> = test.iter().collect();
    let preparation = Preparation { smoothing: smoothing_choice::savitzky_golay(&train)?, band: Band::OfNoise };
    let logs = fit::Logs { train: &train, test: &test };

    // Joints without torque in the logs, or that stand still, have no equation.
    let equations::Observed { model, notes } = equations::observed(&robot, logs, preparation, Trust::Structure)?;
    notes.iter().for_each(|note| println!("{note}"));
    let fitted = fit_effects(&model, Trust::Structure, logs, preparation, Vec::new())?;
    for (joint, spec) in robot.joints.iter().enumerate() {
        let held_out = fitted.test_rms.get(joint).map_or(String::new(), |rms| format!(", held out {rms:.4}"));
        println!("{}: residual {:.4}{held_out} {}", spec.name, fitted.train_rms[joint], spec.effort_unit());
    }
    // Base parameters are what the torque determines; bodies that can exist share them out.
    let identified = consistent::consistent(&model, logs, preparation, &fitted)?.robot(&robot);
    std::fs::write("identified.urdf", robot::with_parameters(&identified)?)
        .map_err(|error| Error::io("identified.urdf", "write the robot", error))?;
    println!("identified.urdf is written");
    Ok(())
}
