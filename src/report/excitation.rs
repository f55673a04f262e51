//! What a search for excitation motions found.

use super::console::table as plain_table;
use crate::design::Problem;
use crate::internal::design::{CHECK_RATE_HZ, Clearance, Comparison, Outcome, Request, Row};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Schema of what a search found, as JSON.
pub(crate) const SCHEMA: &str = "tauscope.excitation/1";

/// Schema of a comparison, as JSON.
pub(crate) const COMPARISON_SCHEMA: &str = "tauscope.excitation_comparison/1";

/// What a search found.
#[derive(Debug, Serialize)]
pub(crate) struct Found {
    file: PathBuf,
    robot: String,
    kind: &'static str,
    duration_s: f64,
    seed: u64,
    criterion: &'static str,
    value: f64,
    evaluations: usize,
    stopped: bool,
    clearance: Clearance,
    motion: Row,
    random_median: Option<Row>,
}

/// The content of the JSON result.
pub(crate) fn found(
    problem: &Problem,
    request: &Request,
    outcome: &Outcome,
    path: &Path,
    row: &Row,
    random_median: Option<&Row>,
) -> Found {
    Found {
        file: path.to_owned(),
        robot: problem.envelope.robot().name.clone(),
        kind: request.family.name(),
        duration_s: request.duration_s,
        seed: request.seed,
        criterion: problem.criterion.name(),
        value: outcome.value,
        evaluations: outcome.evaluations,
        stopped: outcome.stopped,
        clearance: outcome.clearance,
        motion: row.clone(),
        random_median: random_median.cloned(),
    }
}

/// The motions side by side.
pub(crate) fn table(parameters: usize, rows: &[Row]) -> String {
    let header = [
        "motion",
        "rank",
        "kappa",
        "D",
        "peak acc.",
        "of limit",
        "rel. std %, median",
        "worst",
        "held-out error, sigma",
        "",
    ];
    let cells = rows
        .iter()
        .map(|row| {
            vec![
                row.name.clone(),
                format!("{} of {parameters}", row.rank),
                number(row.condition_number, 2),
                number(row.d, 3),
                format!("{:.1} rad/s2", row.peak_acceleration),
                format!("{:.0} %", 100.0 * row.acceleration_used),
                number(100.0 * row.median_deviation, 3),
                number(100.0 * row.worst_deviation, 2),
                row.held_out.map_or("-".to_owned(), |error| number(error, 4)),
                row.held_out_change.map_or(String::new(), change),
            ]
        })
        .collect();
    plain_table(&header, cells)
}

/// The comparison with what its columns mean.
pub(crate) fn comparison(problem: &Problem, comparison: &Comparison) -> String {
    format!(
        "{}: motions of {} s, each found by {}\n\n{}\n\n\
         kappa: rows divided by the torque noise, columns of unit length, proximal base parameters. D: nats a parameter.\n\
         Relative std: of the base parameters, those under a hundredth of the largest in the same unit taken as that large.\n\
         Held-out: root mean square over random motions, and its change against the median random motion.",
        problem.envelope.robot().name,
        comparison.duration_s,
        problem.criterion.name(),
        table(comparison.parameters, &comparison.rows),
    )
}

/// How the search went and what the motion keeps clear of.
pub(crate) fn summary(problem: &Problem, request: &Request, outcome: &Outcome) -> String {
    let Clearance { effort_used, floor_m, column_m } = outcome.clearance;
    let mut text = format!(
        "{} {:.4} after {} evaluations{} (seed {}). In samples at {CHECK_RATE_HZ} Hz: {:.0} % of the effort limits",
        problem.criterion.name(),
        outcome.value,
        outcome.evaluations,
        if outcome.stopped { ", stopped" } else { "" },
        request.seed,
        100.0 * effort_used,
    );
    if let (Some(floor), Some(column)) = (floor_m, column_m) {
        text += &format!(", {floor:.3} m above the floor, {column:.3} m clear of the base column");
    }
    text
}

/// A number with the digits given, or a word when there is none.
fn number(value: f64, digits: usize) -> String {
    if value.is_finite() { format!("{value:.digits$}") } else { "infinite".to_owned() }
}

fn change(share: f64) -> String {
    if share.is_finite() { format!("{:+.0} %", 100.0 * share) } else { String::new() }
}
