//! Monte Carlo studies and accuracy checks as tables for people.

use super::console::{significant, table};
use crate::study::check::{Report, Verdict};
use crate::study::montecarlo::{Cell, Found, Row, Summary, Timings};
use crate::study::testbed::Variant;

/// Heads of the figures of every cell of a study.
pub(super) const FIGURES: [&str; 11] = [
    "noise q, rad",
    "tau, N m",
    "smoothing",
    "estimator",
    "d_beta 5 %",
    "50 %",
    "95 %",
    "bias",
    "biased",
    "spread",
    "coverage",
];

/// The table of a study, and the best window per noise level.
pub(crate) fn summary(summary: &Summary, times: &Timings) -> String {
    let header: Vec<&str> = FIGURES.into_iter().chain(["torque std / joint, N m", "failed", "ms"]).collect();
    let rows = summary.cells.iter().map(|cell| cell_row(cell, times)).collect();
    let part = if summary.trials == summary.trials_of_study {
        String::new()
    } else {
        format!(" (this part of {})", summary.trials_of_study)
    };
    let mut text = format!(
        "{}: {} trials{part}, seed {}, {} base parameters\n\n{}\n\n\
         bias and spread: of estimate minus truth over the truth, median of the parameters; biased: parameters whose bias is \
         more than\nthree of its standard errors; coverage: 95 % intervals that hold the truth; torque std: of the torque \
         error on the held-out motion",
        summary.scenario,
        summary.trials,
        summary.seed,
        summary.parameters.len(),
        table(&header, rows)
    );
    for cell in summary.cells.iter().filter(|cell| cell.failed > 0) {
        let why = cell.failure.as_deref().unwrap_or_default();
        let (at, smoothed, estimator) =
            (noise(cell.encoder_rad), smoothing(cell.signals, cell.sg_window), &cell.estimator);
        text +=
            &format!("\n{estimator} at noise {at}, smoothing {smoothed}, failed {} times, first: {why}", cell.failed);
    }
    if !summary.best_windows.is_empty() {
        let rows = summary
            .best_windows
            .iter()
            .map(|best| {
                let level = summary.cells.iter().find(|cell| cell.noise_level == best.noise_level);
                vec![
                    noise(level.and_then(|cell| cell.encoder_rad)),
                    noise(level.and_then(|cell| cell.torque_nm)),
                    best.estimator.clone(),
                    smoothing(best.signals, best.sg_window),
                    significant(best.d_beta),
                ]
            })
            .collect();
        let header = ["noise q, rad", "tau, N m", "estimator", "best smoothing", "median d_beta"];
        text += &format!("\n\n{}", table(&header, rows));
    }
    text
}

/// The figures of a cell but for its coverage.
pub(super) fn figures(cell: &Cell) -> Vec<String> {
    let number = |value: Option<f64>| value.map_or("-".to_owned(), significant);
    vec![
        noise(cell.encoder_rad),
        noise(cell.torque_nm),
        smoothing(cell.signals, cell.sg_window),
        cell.estimator.clone(),
        number(cell.d_beta.map(|q| q.p05)),
        number(cell.d_beta.map(|q| q.p50)),
        number(cell.d_beta.map(|q| q.p95)),
        percent(cell.relative_bias),
        percent(cell.biased),
        percent(cell.relative_spread),
    ]
}

/// The mean time of a fit in a table, ms.
pub(super) fn milliseconds(cell: &Cell, times: &Timings) -> String {
    times.mean(cell.signals, cell.sg_window, &cell.estimator).map_or("-".to_owned(), |s| format!("{:.1}", 1e3 * s))
}

fn percent(share: Option<f64>) -> String {
    share.map_or("-".to_owned(), |share| format!("{} %", significant(100.0 * share)))
}

fn cell_row(cell: &Cell, times: &Timings) -> Vec<String> {
    let torque: Vec<String> = cell.torque_std_nm.iter().map(|&std| significant(std)).collect();
    let others = [percent(cell.coverage), torque.join(" "), cell.failed.to_string(), milliseconds(cell, times)];
    figures(cell).into_iter().chain(others).collect()
}

/// A noise level in a table.
pub(super) fn noise(std: Option<f64>) -> String {
    std.map_or("scenario's".to_owned(), size)
}

/// A size of any order, in its shortest form.
pub(super) fn size(value: f64) -> String {
    if value != 0.0 && !(1e-3..1e5).contains(&value.abs()) { format!("{value:e}") } else { format!("{value}") }
}

/// A smoothing in a table.
pub(super) fn smoothing(signals: Variant, window: u32) -> String {
    match signals {
        Variant::SavitzkyGolay => format!("S-G {window}"),
        Variant::Butterworth => "Butterworth".to_owned(),
        Variant::Raw | Variant::Exact => "none".to_owned(),
    }
}

/// One trial, replayed.
pub(crate) fn trial(rows: &[Row]) -> String {
    let header = ["noise level", "smoothing", "estimator", "d_beta", "coverage", "torque std / joint, N m"];
    let cells = rows
        .iter()
        .map(|row| {
            let mut cells = vec![row.level.to_string(), smoothing(row.signals, row.window), row.estimator.clone()];
            match &row.outcome {
                Ok(Found { d_beta, coverage, torque_std, .. }) => {
                    let torque: Vec<String> = torque_std.iter().map(|&std| significant(std)).collect();
                    cells.extend([significant(*d_beta), format!("{:.0} %", 100.0 * coverage), torque.join(" ")]);
                }
                Err(problem) => cells.extend([problem.clone(), String::new(), String::new()]),
            }
            cells
        })
        .collect();
    table(&header, cells)
}

/// What an accuracy check found: the figures that are worse, or that none is.
pub(crate) fn check(report: &Report) -> String {
    let worse: Vec<Vec<String>> = report
        .metrics
        .iter()
        .filter(|metric| metric.verdict == Verdict::Worse)
        .map(|metric| {
            vec![
                metric.name.clone(),
                significant(metric.baseline),
                significant(metric.now),
                significant(metric.spread),
                metric.deviations.map_or("-".to_owned(), |z| format!("{z:.1}")),
            ]
        })
        .collect();
    let better = report.metrics.iter().filter(|metric| metric.verdict == Verdict::Better).count();
    if worse.is_empty() {
        let better =
            if better > 0 { format!("; {better} are better: --update would keep that") } else { String::new() };
        return format!("{}: none of {} figures is worse{better}", report.scenario, report.metrics.len());
    }
    let header = ["worse", "baseline", "now", "spread over trials", "standard errors"];
    format!(
        "{}: {} of {} figures are worse\n\n{}",
        report.scenario,
        worse.len(),
        report.metrics.len(),
        table(&header, worse)
    )
}
