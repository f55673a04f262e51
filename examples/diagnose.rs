//! Diagnoses an arm from a program of one's own: its URDF, a training log, and held-out logs of other motions where there are.
//!
//! `cargo run --release --example diagnose -- arm.urdf train.csv test.csv`

use std::path::PathBuf;
use tauscope::dataset;
use tauscope::diagnosis::Diagnosis;
use tauscope::error::{Error, Result};
use tauscope::robot::{self, InertiaCheck};

fn main() -> Result<()> {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let [urdf, train, test @ ..] = &arguments[..] else {
        return Err(Error::request("arguments", "give a URDF, a training log, and test logs if there are any"));
    };
    // The inertias of the URDF are estimated from the logs, so it does not matter whether they are right.
    let robot = robot::load(urdf, InertiaCheck::Ignored)?;

    let answer = Diagnosis::of(&robot)
        .train([(train, dataset::read(train, &robot)?)])
        .test(dataset::read_all(test, &robot)?)
        .alpha(0.05)
        .run()?;

    println!("{}: {:?}", robot.name, answer.verdict());
    for fault in &answer.faults {
        println!("{}, {}: {} ({:?})", fault.log, fault.place, fault.text, fault.consequence);
    }
    for finding in answer.findings() {
        println!("{} on {}: {}", finding.effect, finding.joints.join(", "), finding.explanation);
        for parameter in &finding.parameters {
            println!("  {} = {:.4} +- {:.4} {}", parameter.name, parameter.value, parameter.std, parameter.unit);
        }
    }
    if let Some(diagnosis) = answer.diagnosis() {
        println!("next: {}", diagnosis.next_experiment);
    }
    Ok(())
}
