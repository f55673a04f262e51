//! The result of `tauscope run` on a measured data set.

use super::console::{TorqueErrors, by_joint, smoothings};
use crate::identification::smoothing_choice::Described;
use crate::robot::Robot;
use crate::study::measured::Scored;
use serde::Serialize;

/// Schema of the `score.json` of a measured data set.
pub(crate) const SCHEMA: &str = "tauscope.measured/1";

/// How well each variant predicts the torque.
#[derive(Debug, Serialize)]
pub(crate) struct Scores<'a> {
    robot: &'a str,
    joints: Vec<String>,
    effort_units: Vec<&'static str>,
    notes: &'a [String],
    variants: Vec<Variant<'a>>,
    /// Why nothing was identified with the usual low-pass; null where something was.
    butterworth_problem: Option<&'a str>,
}

#[derive(Debug, Serialize)]
struct Variant<'a> {
    signals: &'static str,
    /// Null where signals are not smoothed.
    smoothing: Option<Described>,
    condition_number: f64,
    torque_std_training_nm: &'a [f64],
    torque_std_held_out_nm: &'a [f64],
}

/// What a run on measured logs identified: from raw signals and with Savitzky-Golay, and with the usual low-pass or why not.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Compared<'a> {
    /// Signals as they are.
    pub raw: &'a Scored,
    /// Savitzky-Golay.
    pub smoothed: &'a Scored,
    /// The usual low-pass.
    pub usual: Option<&'a Scored>,
    /// Why there is no identification with it.
    pub missing: Option<&'a str>,
}

impl<'a> Compared<'a> {
    fn all(&self) -> impl Iterator<Item = &'a Scored> {
        [self.raw, self.smoothed].into_iter().chain(self.usual)
    }

    /// How the signals were smoothed, a line for each way.
    pub(super) fn smoothings(&self) -> Vec<String> {
        smoothings(&self.all().map(|one| one.smoothing.clone()).collect::<Vec<_>>(), true, self.missing)
    }

    /// Torque errors of the ways.
    fn errors(&self, of: fn(&Scored) -> &Vec<f64>) -> TorqueErrors<'a> {
        TorqueErrors {
            raw: of(self.raw),
            butterworth: self.usual.map(|usual| of(usual).as_slice()),
            savitzky_golay: of(self.smoothed),
        }
    }
}

/// The content of `score.json`.
pub(crate) fn result<'a>(robot: &'a Robot, compared: Compared<'a>, notes: &'a [String]) -> Scores<'a> {
    let variants = compared.all().map(|one| Variant {
        signals: one.variant.name(),
        smoothing: one.smoothing.clone(),
        condition_number: one.fitted.fit.estimate.condition_number,
        torque_std_training_nm: &one.torque_std_training_nm,
        torque_std_held_out_nm: &one.torque_std_held_out_nm,
    });
    Scores {
        robot: &robot.name,
        joints: robot.joint_names(),
        effort_units: robot.effort_units(),
        notes,
        variants: variants.collect(),
        butterworth_problem: compared.missing,
    }
}

/// The tables for people: torque error per joint from raw signals, with the usual low-pass and with Savitzky-Golay, the ratios, and how
/// signals were smoothed.
pub(crate) fn text(robot: &Robot, compared: Compared) -> String {
    let (unit, names) = by_joint(robot);
    let training = compared.errors(|one| &one.torque_std_training_nm);
    let mut text = training.table(&format!("torque error, std in {unit}"), &names, &[]);
    if !compared.raw.torque_std_held_out_nm.is_empty() {
        let held_out = compared.errors(|one| &one.torque_std_held_out_nm);
        text += "\n\n";
        text += &held_out.table(&format!("held out, std in {unit}"), &names, &[]);
    }
    text + "\n\n" + &compared.smoothings().join("\n")
}
