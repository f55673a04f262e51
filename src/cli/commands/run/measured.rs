//! `tauscope run --dataset`: identify and score with measured logs in place of the simulation.

use super::usual_way::compared;
use crate::cli::commands::identify;
use crate::cli::shared::{DONE, Global, corrected, print, progress};
use crate::dataset::arm::{Asked, LoggedArm};
use crate::dataset::{self, Dataset, Logs, Named};
use crate::error::{Error, Result};
use crate::identification::consistent::consistent;
use crate::identification::effect_model::{Preparation, Trust};
use crate::identification::fit;
use crate::identification::model::Model;
use crate::identification::smoothing_choice;
use crate::output::ResultFolder;
use crate::recording::Recording;
use crate::report::html::{self, Provenance};
use crate::report::measured::Compared;
use crate::report::{fit as fit_report, measured as report, viewer};
use crate::study::measured;
use crate::study::testbed::Variant;
use std::path::Path;

/// Whether no torque of a joint was measured in any log.
fn lacks_torque(logs: &[Recording], joint: usize) -> bool {
    logs.iter().all(|log| log.tau.channel(joint).iter().all(|torque| !torque.is_finite()))
}

/// Identifies from the data set's training logs and writes its results folder.
pub(super) fn run(path: &Path, global: &Global) -> Result<u8> {
    let dataset = Dataset::load(path)?;
    let named = dataset
        .robot()
        .ok_or_else(|| Error::input(path, None, "robot", "is missing: name the arm's URDF, relative to this file"))?;
    let mut arm = LoggedArm::open(&named, &Asked::default(), Trust::Structure, Some(&dataset), &dataset.files())?;
    let mut stages = progress::Stages::new(global, &[2, 4, 4, 4, 4, 1]);
    stages.begin("reading the logs");
    let mut logs = dataset.sieved(&arm.robot)?;
    arm.settle(Some(&dataset), &mut logs)?;
    let mut robot = arm.robot;
    let Logs { train, test, mut notes, correction, torque_is_scaled, units } = dataset::ready(logs, &robot)?;
    notes.extend(robot.notes.clone());
    if let Some(joint) = (0..robot.dof()).find(|&joint| lacks_torque(&train, joint)) {
        let problem = "no torque of it is in the training logs, and the ways to smooth them are compared by all torques; `tauscope identify` takes \
                       joints without";
        return Err(Error::input(path, None, robot.joints[joint].name.as_str(), problem));
    }
    let folder = ResultFolder::create(global.folder(&format!("run_{}", robot.name)))?;
    if let Some(description) = &correction {
        robot.gravity = description.gravity;
    }
    corrected::write(&folder, Some(&dataset), &Named::default(), &robot, correction.as_ref(), None, units)?;
    let model = Model::new(&robot);
    let usual_preparation = Preparation::usual(&train[0]);
    let (train, test): (Vec<&Recording>, Vec<&Recording>) = (train.iter().collect(), test.iter().collect());
    let preparation = Preparation { smoothing: smoothing_choice::savitzky_golay(&train)?, ..usual_preparation.clone() };
    let logs = fit::Logs { train: &train, test: &test };

    let mut identified = |variant| {
        stages.begin("identifying");
        measured::identify(&model, logs, variant, [preparation.clone(), usual_preparation.clone()])
    };
    let (raw, smoothed) = (identified(Variant::Raw)?, identified(Variant::SavitzkyGolay)?);
    let (usual, missing) = compared(identified(Variant::Butterworth));
    let ways = Compared { raw: &raw, smoothed: &smoothed, usual: usual.as_ref(), missing: missing.as_deref() };
    let plain = &smoothed.fitted;
    stages.begin("finding consistent parameters");
    let bodies = consistent(&model, logs, preparation.clone(), plain)?;
    let identified = bodies.robot(&robot);

    let found = fit_report::Found { plain, extended: None, consistent: Some(&bodies), torque_is_scaled };
    let identification = fit_report::result(&robot, Trust::Structure, found, &notes);
    folder.write_json("identification.json", fit_report::SCHEMA, &identification)?;
    identify::write_robot(&folder, &identified)?;
    let scores = report::result(&robot, ways, &notes);
    folder.write_json("score.json", report::SCHEMA, &scores)?;
    let page = html::measured::page(&robot, logs, ways, &notes, Provenance::here(global.seed));
    folder.write_text(html::FILE, &page.render())?;
    stages.begin("simulating the identified arm");
    let replayed = identify::replayed(&identified, logs, preparation);
    let shown = viewer::fit::Shown { plain, extended: None, replayed: replayed.as_deref() };
    viewer::add(&folder, || Ok(viewer::fit::film(&robot, logs, shown)))?;
    stages.finish();
    let out = folder.finish()?;
    print::result(global, report::SCHEMA, &scores, || {
        let notes = notes.iter().fold(String::new(), |text, note| text + note + "\n");
        format!("{notes}{}\n\nResults in {}", report::text(&robot, ways), out.display())
    })?;
    Ok(DONE)
}
