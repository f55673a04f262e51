//! Identifies an arm from a program of one's own: its URDF, a training log, and held-out logs of other motions where there are. Writes a
//! URDF with possible inertias that has the identified base parameters, friction and rotors.
//!
//! `cargo run --release --example identify -- arm.urdf train.csv test.csv`

use std::path::PathBuf;
use tauscope::dataset;
use tauscope::error::{Error, Result};
use tauscope::identification::Identification;
use tauscope::robot::{self, InertiaCheck};

fn main() -> Result<()> {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let [urdf, train, test @ ..] = &arguments[..] else {
        return Err(Error::request("arguments", "give a URDF, a training log, and test logs if there are any"));
    };
    let robot = robot::load(urdf, InertiaCheck::Ignored)?;

    // Faults of the logs are noted, and corrected where that is beyond doubt. From arrays: `tauscope::Log::new(&robot, t, q, tau)?`.
    let read = |files| dataset::read_all(files, &robot);
    let logs = dataset::ready([read(std::slice::from_ref(train))?, read(test)?], &robot)?;
    let found = Identification::of(&robot).train(&logs.train).test(&logs.test).run()?;

    logs.notes.iter().chain(&found.notes).for_each(|note| println!("{note}"));
    let fitted = found.fitted();
    for (joint, (name, unit)) in found.joints.iter().zip(&found.effort_units).enumerate() {
        let held_out = fitted.test_rms.get(joint).map_or(String::new(), |rms| format!(", held out {rms:.4}"));
        println!("{name}: residual {:.4}{held_out} {unit}", fitted.train_rms[joint]);
    }
    // Base parameters are what the torque determines; bodies that can exist share them out.
    std::fs::write("identified.urdf", robot::with_parameters(&found.robot)?)
        .map_err(|error| Error::io("identified.urdf", "write the robot", error))?;
    println!("identified.urdf is written");
    Ok(())
}
