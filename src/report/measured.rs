//! The result of `tauscope run` on a measured data set.

use super::console::{by_joint, significant, table};
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
}

#[derive(Debug, Serialize)]
struct Variant<'a> {
    signals: &'static str,
    condition_number: f64,
    torque_std_training_nm: &'a [f64],
    torque_std_held_out_nm: &'a [f64],
}

/// The content of `score.json`.
pub(crate) fn result<'a>(robot: &'a Robot, scored: &'a [Scored], notes: &'a [String]) -> Scores<'a> {
    let variants = scored.iter().map(|one| Variant {
        signals: one.variant.name(),
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
    }
}

/// The table for people: torque error per joint of every variant, and that of the last over that of the first.
pub(crate) fn text(robot: &Robot, scored: &[Scored]) -> String {
    let [Some(first), Some(last)] = [scored.first(), scored.last()] else { return String::new() };
    let held_out = !first.torque_std_held_out_nm.is_empty();
    let (unit, names) = by_joint(robot);
    let title = format!("torque error, std in {unit}");
    let mut header = vec![title.as_str(), "raw", "Savitzky-Golay", "ratio"];
    if held_out {
        header.extend(["held-out raw", "held-out S-G", "ratio"]);
    }
    let three = |raw: f64, smoothed: f64| [significant(raw), significant(smoothed), format!("{:.3}", smoothed / raw)];
    let rows = names.into_iter().enumerate().map(|(j, name)| {
        let mut row = vec![name];
        row.extend(three(first.torque_std_training_nm[j], last.torque_std_training_nm[j]));
        if held_out {
            row.extend(three(first.torque_std_held_out_nm[j], last.torque_std_held_out_nm[j]));
        }
        row
    });
    table(&header, rows.collect())
}
