//! The parameter error over the smoothing window and over the noise.

use super::labels::{legend, level, levels, smoothing};
use crate::report::console::significant;
use crate::report::html::{Block, Section};
use crate::report::montecarlo::{noise, smoothing as short};
use crate::report::svg::chart::{Chart, Mark, Trace};
use crate::study::montecarlo::{Cell, Quantiles, Summary};
use crate::study::testbed::Variant;

/// The parameter error over the smoothing window, where more than one smoothing was tried.
pub(super) fn by_window(summary: &Summary) -> Option<Section> {
    if summary.best_windows.is_empty() {
        return None;
    }
    let of_level = |level: u32| summary.cells.iter().filter(move |cell| cell.noise_level == level);
    let charts = (0..levels(summary)).filter_map(|number| {
        let any = of_level(number).next()?;
        Some(Chart {
            title: format!("d_beta at {}", level(any)),
            note: "thin: 5, 95 %".into(),
            x_label: "Savitzky-Golay window (samples)".into(),
            log_y: true,
            traces: curves(summary, |name| {
                let has_window = |cell: &&Cell| cell.signals != Variant::Butterworth && cell.estimator == name;
                let mut own: Vec<&Cell> = of_level(number).filter(has_window).collect();
                own.sort_by_key(|cell| cell.sg_window);
                own.into_iter().map(|cell| (f64::from(cell.sg_window), cell.d_beta)).collect()
            }),
        })
    });
    let rows = summary.best_windows.iter().map(|best| {
        let of = of_level(best.noise_level).next();
        vec![
            noise(of.and_then(|cell| cell.encoder_rad)),
            noise(of.and_then(|cell| cell.torque_nm)),
            best.estimator.clone(),
            short(best.signals, best.sg_window),
            significant(best.d_beta),
        ]
    });
    let header = ["noise q, rad", "tau, N m", "estimator", "best smoothing", "median d_beta"];
    Some(Section::new(
        "Smoothing",
        vec![Block::Charts { legend: legend(summary), charts: charts.collect() }, Block::table(header, rows.collect())],
    ))
}

/// What noise does, where more than one level was tried.
pub(super) fn by_noise(summary: &Summary) -> Option<Section> {
    let axis = |cell: &Cell| cell.encoder_rad.filter(|&std| std > 0.0).map_or(f64::NAN, f64::log10);
    let mut distinct: Vec<f64> = summary.cells.iter().map(axis).filter(|at| at.is_finite()).collect();
    distinct.sort_by(f64::total_cmp);
    distinct.dedup();
    if distinct.len() < 2 {
        return None;
    }
    let smoothing_of = |cell: &Cell| (cell.signals, cell.sg_window);
    let mut smoothings: Vec<(Variant, u32)> = summary.cells.iter().map(smoothing_of).collect();
    smoothings.sort_unstable();
    smoothings.dedup();
    let mut charts = Vec::new();
    for smoothed in smoothings {
        let own = |name: &str| -> Vec<&Cell> {
            let mut own: Vec<&Cell> =
                summary.cells.iter().filter(|cell| smoothing_of(cell) == smoothed && cell.estimator == name).collect();
            own.sort_by(|a, b| axis(a).total_cmp(&axis(b)));
            own
        };
        let exact = |value: f64| Quantiles { mean: value, p05: f64::NAN, p50: value, p95: f64::NAN };
        for (what, pick) in [
            ("d_beta", &(|cell: &Cell| cell.d_beta) as &dyn Fn(&Cell) -> Option<Quantiles>),
            ("relative bias", &|cell: &Cell| cell.relative_bias.map(exact)),
        ] {
            charts.push(Chart {
                title: format!("{what}, {}", smoothing(smoothed.0, smoothed.1)),
                note: "median".into(),
                x_label: "encoder noise, power of ten (rad)".into(),
                log_y: true,
                traces: curves(summary, |name| own(name).into_iter().map(|cell| (axis(cell), pick(cell))).collect()),
            });
        }
    }
    Some(Section::new("As the noise grows", vec![Block::Charts { legend: legend(summary), charts }]))
}

/// Median and thin 5 % and 95 % lines of each estimator, as decimal logarithms.
fn curves(summary: &Summary, points: impl Fn(&str) -> Vec<(f64, Option<Quantiles>)>) -> Vec<Trace> {
    let mut traces = Vec::new();
    for (name, color, mark) in legend(summary) {
        let points: Vec<(f64, Option<Quantiles>)> =
            points(&name).into_iter().filter(|(x, y)| x.is_finite() && y.is_some()).collect();
        let x: Vec<f64> = points.iter().map(|(x, _)| *x).collect();
        let line = |pick: fn(Quantiles) -> f64| -> Vec<f64> {
            points.iter().map(|(_, q)| q.map_or(f64::NAN, |q| pick(q).log10())).collect()
        };
        traces.push(Trace { mark: Mark::Points, color, x: x.clone(), y: line(|q| q.p50) });
        for (mark, y) in
            [(Mark::Line(0.7), line(|q| q.p05)), (Mark::Line(0.7), line(|q| q.p95)), (mark, line(|q| q.p50))]
        {
            if y.iter().any(|value| value.is_finite()) {
                traces.push(Trace { mark, color, x: x.clone(), y });
            }
        }
    }
    traces
}
