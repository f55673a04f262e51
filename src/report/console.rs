//! Tables for people.

use super::results::{AtEffortLimit, SmoothingGain};
pub(super) use crate::output::significant;
use crate::robot::{Joint, JointKind, Robot};
use crate::scenario::Setup;
use crate::study::testbed::{Scored, Variant};
use comfy_table::{CellAlignment, ContentArrangement, Table, presets};

/// A plain aligned table: first column left, numbers right.
pub(super) fn table(header: &[&str], rows: Vec<Vec<String>>) -> String {
    let mut table = Table::new();
    table.load_preset(presets::NOTHING).set_content_arrangement(ContentArrangement::Disabled).set_header(header);
    table.add_rows(rows);
    for column in table.column_iter_mut().skip(1) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    table.trim_fmt()
}

/// The scores of a scenario run: torque error per joint with and without smoothing, then one line per variant.
pub(crate) fn scores(setup: &Setup, scored: &[Scored], gain: &SmoothingGain, parameters: usize) -> String {
    let find = |variant: Variant| scored.iter().find(|result| result.variant == variant);
    let (Some(raw), Some(smoothed)) = (find(Variant::Raw), find(Variant::SavitzkyGolay)) else {
        return String::new();
    };
    let (unit, names) = by_joint(&setup.plant);
    let title = format!("torque error, std in {unit}");
    let mut header = vec![title.as_str(), "raw", "Savitzky-Golay", "ratio"];
    if !gain.paper_table_3.is_empty() {
        header.push("paper's ratio");
    }
    header.extend(["held-out raw", "held-out S-G", "ratio"]);
    let rows = names
        .into_iter()
        .enumerate()
        .map(|(j, name)| {
            let [raw, smoothed] = [&raw.score, &smoothed.score];
            let mut row = vec![
                name,
                significant(raw.torque_std_training_nm[j]),
                significant(smoothed.torque_std_training_nm[j]),
                format!("{:.3}", gain.training[j]),
            ];
            row.extend(gain.paper_table_3.get(j).map(|ratio| format!("{ratio:.2}")));
            row.extend([
                significant(raw.torque_std_held_out_nm[j]),
                significant(smoothed.torque_std_held_out_nm[j]),
                format!("{:.3}", gain.held_out[j]),
            ]);
            row
        })
        .collect();
    let per_joint = table(&header, rows);
    let header = ["signals", "d_beta", "median rel. error", "condition number", "residual / noise", "time"];
    let noise: Vec<f64> = setup.sensors.iter().map(|sensor| sensor.torque_noise).collect();
    let rows = scored
        .iter()
        .map(|result| {
            vec![
                result.variant.name().to_owned(),
                significant(result.score.d_beta),
                format!("{} %", significant(100.0 * median_size(&result.score.relative_errors))),
                format!("{:.2}", result.estimate.condition_number),
                noise_ratio(&result.residual_rms, &noise),
                format!("{:.0} ms", 1e3 * result.seconds),
            ]
        })
        .collect();
    let per_variant = table(&header, rows);
    format!(
        "{}: {} base parameters of {} joints, identified from {:.1} s, judged on {:.1} s\n\n{}\n\n{}",
        setup.scenario.name,
        parameters,
        setup.plant.dof(),
        crate::excitation::Reference::duration_s(&setup.motion),
        crate::excitation::Reference::duration_s(&setup.held_out),
        per_joint,
        per_variant,
    )
}

/// Whether an identification predicts the torque of the held-out motion to within the sensors' noise, and that in words.
pub(crate) fn verdict(setup: &Setup, scored: &Scored) -> (bool, String) {
    let errors = scored.score.torque_std_held_out_nm.iter().zip(&setup.sensors);
    let above: Vec<&str> = setup
        .plant
        .joints
        .iter()
        .zip(errors)
        .filter(|(_, (error, sensor))| **error > sensor.torque_noise)
        .map(|(joint, _)| joint.name.as_str())
        .collect();
    let words = match above.is_empty() {
        true => "The identified model predicts the torque of an unseen motion to within the noise of the torque sensors, on \
                 every joint."
            .to_owned(),
        false => format!(
            "The identified model misses the torque of an unseen motion by more than the sensors' noise on {}.",
            above.join(", ")
        ),
    };
    (above.is_empty(), words)
}

/// A line for every joint whose drive was at its limit; nothing where none was.
pub(crate) fn at_effort_limit(setup: &Setup, limited: &AtEffortLimit) -> String {
    let mut text = String::new();
    for (motion, shares) in [("training", &limited.training), ("held-out", &limited.held_out)] {
        for (joint, share) in setup.plant.joints.iter().zip(shares).filter(|(_, share)| **share > 0.0) {
            let limit = format!("{} {}", joint.limits.effort, joint.effort_unit());
            let percent = significant(100.0 * share);
            text += &format!("{} was at its limit of {limit} for {percent} % of the {motion} motion\n", joint.name);
        }
    }
    text
}

/// The unit of efforts in a table with a line for each joint, for its header, and the names of the lines, which say it where a
/// joint has another.
pub(super) fn by_joint(robot: &Robot) -> (&'static str, Vec<String>) {
    if let Some(unit) = robot.common_effort_unit() {
        return (unit, robot.joint_names());
    }
    let name = |joint: &Joint| match joint.kind {
        JointKind::Revolute => joint.name.clone(),
        JointKind::Prismatic => format!("{} (slides, in {})", joint.name, joint.effort_unit()),
    };
    (JointKind::Revolute.unit("N m"), robot.joints.iter().map(name).collect())
}

/// Root mean square over the joints of residual over torque noise; a dash without noise.
fn noise_ratio(residual: &[f64], noise: &[f64]) -> String {
    if noise.iter().any(|&n| n <= 0.0) {
        return "-".to_owned();
    }
    let sum: f64 = residual.iter().zip(noise).map(|(r, n)| (r / n).powi(2)).sum();
    significant((sum / noise.len() as f64).sqrt())
}

/// Median of the sizes.
fn median_size(values: &[f64]) -> f64 {
    let mut sizes: Vec<f64> = values.iter().map(|v| v.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    match sizes.len() {
        0 => f64::NAN,
        n if n.is_multiple_of(2) => 0.5 * (sizes[n / 2 - 1] + sizes[n / 2]),
        n => sizes[n / 2],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn median_of_an_odd_and_an_even_number() {
        assert_eq!(median_size(&[-3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median_size(&[-3.0, 1.0, 2.0, 5.0]), 2.5);
    }
}
