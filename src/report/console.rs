//! Tables for people.

use super::results::{AtEffortLimit, SmoothingGain};
use crate::identification::smoothing_choice::Described;
pub(super) use crate::output::{measured, significant};
use crate::robot::{Joint, JointKind, Robot, Unit};
use crate::scenario::Setup;
use crate::study::testbed::{Score, Scored, Variant};
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

/// Torque errors of every joint from raw signals, from common practice's smoothing, and from Savitzky-Golay.
#[derive(Debug, Clone, Copy)]
pub(super) struct TorqueErrors<'a> {
    /// Signals as they are.
    pub raw: &'a [f64],
    /// Butterworth low-pass; None where nothing was identified with it.
    pub butterworth: Option<&'a [f64]>,
    /// Savitzky-Golay.
    pub savitzky_golay: &'a [f64],
}

impl TorqueErrors<'_> {
    /// A line for each of the `names`, with the ratios to Savitzky-Golay and the `paper`'s where there are any.
    pub(crate) fn table(&self, title: &str, names: &[String], paper: &[f64]) -> String {
        let (mut header, mut ratios) = (vec![title, "raw"], vec!["S-G / raw"]);
        if self.butterworth.is_some() {
            header.push("Butterworth");
            ratios.push("S-G / Butterworth");
        }
        header.push("Savitzky-Golay");
        header.extend(ratios);
        if !paper.is_empty() {
            header.push("paper's ratio");
        }
        let rows = names.iter().enumerate().map(|(j, name)| {
            let smoothed = self.savitzky_golay[j];
            let others: Vec<f64> = [self.raw[j]].into_iter().chain(self.butterworth.map(|std| std[j])).collect();
            let mut row = vec![name.clone()];
            row.extend(others.iter().chain([&smoothed]).map(|&std| significant(std)));
            row.extend(others.iter().map(|other| format!("{:.3}", smoothed / other)));
            row.extend(paper.get(j).map(|ratio| format!("{ratio:.2}")));
            row
        });
        table(&header, rows.collect())
    }
}

/// How signals were smoothed, in words.
pub(super) fn smoothing(described: &Described) -> String {
    let every = |decimation: usize| match decimation {
        1 => "every row".to_owned(),
        n => format!("one row in {n}"),
    };
    match *described {
        Described::SavitzkyGolay { window, window_s, order, cutoff_hz, decimation } => format!(
            "Savitzky-Golay: window of {window} samples ({} s), order {order}, half the amplitude at {} Hz, {}",
            significant(window_s),
            significant(cutoff_hz),
            every(decimation)
        ),
        Described::Butterworth { order, position_cutoff_hz, torque_cutoff_hz, decimation } => format!(
            "Butterworth: order {order} forward and backward, half the amplitude of positions at {} Hz, of torque and regressor at \
             {} Hz, {}",
            significant(position_cutoff_hz),
            significant(torque_cutoff_hz),
            every(decimation)
        ),
        Described::BlockMeans { order, ref position_cutoffs_hz, block } => format!(
            "Block means: positions through a low-pass of order {order} forward and backward, half the amplitude at {} Hz, torque \
             and regressor as means over {block} samples",
            position_cutoffs_hz.iter().map(|hz| significant(*hz)).collect::<Vec<_>>().join(", ")
        ),
    }
}

/// A line for every variant that smooths, with its settings; the window of Savitzky-Golay may have been chosen `by_noise`, and common
/// practice may be `missing` for a reason.
pub(super) fn smoothings(described: &[Option<Described>], by_noise: bool, missing: Option<&str>) -> Vec<String> {
    let line = |one: &Described| match one {
        Described::SavitzkyGolay { .. } if by_noise => {
            format!("{} (window chosen by the noise of the positions)", smoothing(one))
        }
        _ => smoothing(one),
    };
    let missing = missing.map(|problem| format!("Butterworth: left out, since the identification failed ({problem})"));
    described.iter().flatten().map(line).chain(missing).collect()
}

/// The scores of a scenario run: torque error per joint with and without smoothing, then one line per variant; `missing` is why there is
/// no identification with the usual low-pass.
pub(crate) fn scores(
    setup: &Setup,
    (scored, missing): (&[Scored], Option<&str>),
    gain: &SmoothingGain,
    parameters: usize,
) -> String {
    let find = |variant: Variant| scored.iter().find(|result| result.variant == variant);
    let (Some(raw), Some(smoothed)) = (find(Variant::Raw), find(Variant::SavitzkyGolay)) else {
        return String::new();
    };
    let usual = find(Variant::Butterworth);
    let (unit, names) = by_joint(&setup.plant);
    let errors = |of: fn(&Score) -> &Vec<f64>| TorqueErrors {
        raw: of(&raw.score),
        butterworth: usual.map(|usual| of(&usual.score).as_slice()),
        savitzky_golay: of(&smoothed.score),
    };
    let training = errors(|score| &score.torque_std_training_nm);
    let held_out = errors(|score| &score.torque_std_held_out_nm);
    let per_joint = format!(
        "{}\n\n{}",
        training.table(&format!("torque error, std in {unit}"), &names, &gain.paper_table_3),
        held_out.table(&format!("held out, std in {unit}"), &names, &[])
    );
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
    let described: Vec<Option<Described>> = scored.iter().map(|one| one.described.clone()).collect();
    let smoothings =
        smoothings(&described, setup.scenario.identification.smoothing_window.is_none(), missing).join("\n");
    format!(
        "{}: {} base parameters of {} joints, identified from {:.1} s, judged on {:.1} s\n\n{}\n\n{}\n\n{smoothings}",
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

/// The unit of efforts in a table with a line for each joint, for its header, and the names of the lines, which say their own where joints
/// differ.
pub(super) fn by_joint(robot: &Robot) -> (&'static str, Vec<String>) {
    if let Some(unit) = robot.common_effort_unit() {
        return (unit, robot.joint_names());
    }
    let name = |joint: &Joint| {
        let moves = match joint.kind {
            JointKind::Revolute => "turns",
            JointKind::Prismatic => "slides",
        };
        format!("{} ({moves}, in {})", joint.name, joint.effort_unit())
    };
    ("N m or N", robot.joints.iter().map(name).collect())
}

/// The header of a column whose unit is that of the joints, and what follows a joint's value: the unit stands in the header where all joints
/// have one, else with each value.
pub(super) fn column_with_unit(robot: Option<&Robot>, what: &str, unit: Unit) -> (String, Vec<String>) {
    let joints = robot.map_or(&[][..], |robot| &robot.joints);
    let units: Vec<&str> = joints.iter().map(|joint| joint.kind.unit(unit)).collect();
    match units.first() {
        Some(first) if units.iter().all(|unit| unit == first) => {
            (format!("{what}, {first}"), vec![String::new(); units.len()])
        }
        _ => (what.to_owned(), units.iter().map(|unit| format!(" {unit}")).collect()),
    }
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

    #[test]
    fn torque_errors_have_their_ratios_and_no_column_of_what_is_missing() {
        let (raw, usual, smoothed) = ([4.0], [2.0], [1.0]);
        let errors = TorqueErrors { raw: &raw, butterworth: Some(&usual), savitzky_golay: &smoothed };
        let lines = |table: String| -> Vec<Vec<String>> {
            table.lines().map(|line| line.split_whitespace().map(str::to_owned).collect()).collect()
        };
        let all = lines(errors.table("std", &["j1".to_owned()], &[0.9]));
        assert_eq!(all[1], ["j1", "4.00", "2.00", "1.00", "0.250", "0.500", "0.90"]);
        let without = lines(TorqueErrors { butterworth: None, ..errors }.table("std", &["j1".to_owned()], &[]));
        assert_eq!(without[0], ["std", "raw", "Savitzky-Golay", "S-G", "/", "raw"]);
        assert_eq!(without[1], ["j1", "4.00", "1.00", "0.250"]);
        let said = smoothings(&[None], true, Some("too few rows"));
        assert!(said.len() == 1 && said[0].contains("too few rows"), "{said:?}");
    }
}
