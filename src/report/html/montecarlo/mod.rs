//! The report of a Monte Carlo study.

mod curves;
mod labels;

use labels::{level, levels, smoothing};

use super::{Block, Page, Provenance, Section, Tone};
use crate::report::console::significant;
use crate::report::montecarlo::{FIGURES, figures, milliseconds, noise, smoothing as short};
use crate::report::svg::Color;
use crate::report::svg::chart::{Chart, Mark, Trace};
use crate::study::montecarlo::{Cell, Summary, Timings};
use crate::study::testbed::Variant;

/// Coverage of the 95 % intervals below which they are too short.
const HONEST: f64 = 0.9;

/// The report of a study, or of a part of one.
pub(crate) fn page(summary: &Summary, times: &Timings, provenance: Provenance) -> Page {
    let best: Vec<&Cell> = (0..levels(summary)).filter_map(|level| best(summary, level)).collect();
    let (verdict, tone) = verdict(summary, &best);
    let mut sections = vec![comparison(summary, times)];
    sections.extend(curves::by_window(summary));
    sections.extend(curves::by_noise(summary));
    sections.push(parameters(summary, &best));
    sections.push(quality(summary));
    Page {
        kind: format!("Monte Carlo study of {}", summary.scenario),
        verdict,
        tone,
        lead: lead(summary, &best),
        next: next(summary, &best),
        sections,
        provenance,
    }
}

/// What came closest to the true parameters at a noise level, of those that mostly gave an estimate.
fn best(summary: &Summary, level: u32) -> Option<&Cell> {
    let own = summary.cells.iter().filter(|cell| cell.noise_level == level && cell.found > cell.failed);
    own.filter(|cell| cell.d_beta.is_some()).min_by(|a, b| median(a).total_cmp(&median(b)))
}

fn median(cell: &Cell) -> f64 {
    cell.d_beta.map_or(f64::NAN, |quantiles| quantiles.p50)
}

fn verdict(summary: &Summary, best: &[&Cell]) -> (String, Tone) {
    let whose = |cell: &Cell| format!("{} with {}", cell.estimator, smoothing(cell.signals, cell.sg_window));
    let tone = match best {
        [] => Tone::Bad,
        _ if best.iter().any(|cell| cell.coverage.is_some_and(|share| share < HONEST)) => Tone::Warn,
        _ if summary.cells.iter().any(|cell| cell.failed > 0) => Tone::Warn,
        _ => Tone::Good,
    };
    let verdict = match best {
        [] => "No estimator gave an estimate in most of the trials.".to_owned(),
        [only] => format!(
            "Closest to the true parameters is {}: median d_beta {}, {} of its 95 % intervals hold the truth.",
            whose(only),
            significant(median(only)),
            percent(only.coverage)
        ),
        [first, .., last] if whose(first) == whose(last) => format!(
            "Closest to the true parameters is {}: median d_beta {} at {}, {} at {}.",
            whose(first),
            significant(median(first)),
            level(first),
            significant(median(last)),
            level(last)
        ),
        [first, .., last] => format!(
            "Closest to the true parameters: {} at {} (median d_beta {}), {} at {} ({}).",
            whose(first),
            level(first),
            significant(median(first)),
            whose(last),
            level(last),
            significant(median(last))
        ),
    };
    (verdict, tone)
}

fn lead(summary: &Summary, best: &[&Cell]) -> Vec<String> {
    let part = match summary.trials_of_study {
        all if all == summary.trials => String::new(),
        all => format!(", one part of a study of {all}"),
    };
    let mut lead = vec![format!(
        "{} trials{part}: each draws new noise (and what else the scenario draws), and every estimator gets the same \
         draws. {} base parameters of {} joints. d_beta is the mean distance from the true parameters, 0 at best and 2 at \
         worst.",
        summary.trials,
        summary.parameters.len(),
        summary.joints.len()
    )];
    for cell in best {
        let biased = cell.biased.map_or(String::new(), |share| {
            format!(" {:.0} % of the parameters are biased beyond chance.", 100.0 * share)
        });
        lead.push(format!(
            "At {}: {} with {}, 90 % of trials between {} and {}; {} of its 95 % intervals hold the truth.{biased}",
            level(cell),
            cell.estimator,
            smoothing(cell.signals, cell.sg_window),
            cell.d_beta.map_or("-".to_owned(), |q| significant(q.p05)),
            cell.d_beta.map_or("-".to_owned(), |q| significant(q.p95)),
            percent(cell.coverage),
        ));
    }
    lead
}

fn next(summary: &Summary, best: &[&Cell]) -> Option<String> {
    let usual = summary.best_windows.iter().any(|best| best.signals == Variant::Butterworth);
    let smoothed: Vec<u32> = summary.best_windows.iter().map(|best| best.sg_window).filter(|&size| size > 0).collect();
    let largest = summary.cells.iter().map(|cell| cell.sg_window).max().unwrap_or(0);
    match best {
        [] => Some("look at the reasons of the failures below".into()),
        _ if !usual && !smoothed.is_empty() && smoothed.iter().all(|&size| size == largest) => Some(format!(
            "try windows wider than {largest} samples (--sg-windows): the widest was the best at every noise level."
        )),
        [only] if only.coverage.is_some_and(|share| share < HONEST) => Some(
            "mistrust the intervals: bias is larger than they allow for. Try other windows or the estimator iv.".into(),
        ),
        _ => None,
    }
}

fn percent(share: Option<f64>) -> String {
    share.map_or("-".to_owned(), |share| format!("{:.1} %", 100.0 * share))
}

fn comparison(summary: &Summary, times: &Timings) -> Section {
    let rows = summary.cells.iter().map(|cell| {
        let others = [percent(cell.coverage), cell.failed.to_string(), milliseconds(cell, times)];
        figures(cell).into_iter().chain(others).collect()
    });
    let header: Vec<&str> = FIGURES.into_iter().chain(["failed", "ms"]).collect();
    let torque = summary.cells.iter().map(|cell| {
        let head = [noise(cell.encoder_rad), short(cell.signals, cell.sg_window), cell.estimator.clone()];
        head.into_iter().chain(cell.torque_std_nm.iter().map(|&std| significant(std))).collect()
    });
    let joints = ["noise q, rad", "smoothing", "estimator"].map(str::to_owned).into_iter();
    Section::new(
        "Comparison",
        vec![
            Block::text(
                "Bias and spread are those of estimate minus truth over the truth, median of the parameters; biased: \
                 parameters whose bias is more than three of its standard errors; coverage: 95 % intervals that hold the \
                 truth; ms: time of one estimate.",
            ),
            Block::table(header, rows.collect()),
            Block::text("Standard deviation of the torque error on the held-out motion, mean of the trials, N m or N:"),
            Block::table(joints.chain(summary.joints.iter().cloned()), torque.collect()),
        ],
    )
}

/// Bias of every parameter against its spread, for the best of each noise level.
fn parameters(summary: &Summary, best: &[&Cell]) -> Section {
    let mut blocks = vec![Block::text(
        "Mean error of every base parameter over its standard deviation between trials, for what came closest at each noise \
         level. Between the dashed lines it is chance: three standard errors.",
    )];
    let mut charts = Vec::new();
    let mut folded = Vec::new();
    for cell in best.iter().filter(|cell| !cell.spread.is_empty()) {
        let numbers: Vec<f64> = (1..=cell.bias.len()).map(|number| number as f64).collect();
        let chance = 3.0 / (cell.found as f64).sqrt();
        let right = numbers.len() as f64 + 1.0;
        let flat =
            |height: f64| Trace { mark: Mark::Dashed(1.0), color: Color::Ink, x: vec![0.0, right], y: vec![height; 2] };
        let ratio = cell.bias.iter().zip(&cell.spread).map(|(bias, spread)| bias / spread).collect();
        let points = Trace { mark: Mark::Points, color: Color::Blue, x: numbers, y: ratio };
        charts.push(Chart {
            title: format!("{} at {}", cell.estimator, level(cell)),
            note: "bias / spread".into(),
            x_label: "base parameter".into(),
            traces: vec![flat(-chance), flat(chance), points],
            log_y: false,
        });
        let rows = summary.parameters.iter().enumerate().map(|(k, name)| {
            let (bias, spread) = (cell.bias[k], cell.spread[k]);
            let error = spread / (cell.found as f64).sqrt();
            let number = (k + 1).to_string();
            vec![name.clone(), number, significant(bias), significant(spread), significant(bias / error)]
        });
        let header = ["base parameter", "number", "bias", "spread", "bias / standard error"];
        let what = format!("All {} parameters: {} at {}", summary.parameters.len(), cell.estimator, level(cell));
        folded.push(Block::Folded(what, vec![Block::table(header, rows.collect())]));
    }
    if charts.is_empty() {
        return Section::new("Parameters", vec![Block::text("Bias and spread need two trials.")]);
    }
    let legend = vec![
        ("a parameter".to_owned(), Color::Blue, Mark::Points),
        ("limits of chance".to_owned(), Color::Ink, Mark::Dashed(1.0)),
    ];
    blocks.push(Block::Charts { legend, charts });
    blocks.extend(folded);
    Section::new("Parameters", blocks)
}

fn quality(summary: &Summary) -> Section {
    let failed = summary.cells.iter().filter(|cell| cell.failed > 0).map(|cell| {
        vec![
            noise(cell.encoder_rad),
            short(cell.signals, cell.sg_window),
            cell.estimator.clone(),
            cell.failed.to_string(),
            (cell.failed + cell.found).to_string(),
            cell.failure.clone().unwrap_or_default(),
        ]
    });
    let failed: Vec<Vec<String>> = failed.collect();
    let block = if failed.is_empty() {
        Block::text("Every trial gave an estimate.")
    } else {
        Block::table(["noise q, rad", "smoothing", "estimator", "failed", "of", "why the first did"], failed)
    };
    Section::new(
        "Trials without an estimate",
        vec![block, Block::text("Every row is in trials.parquet; --trial K replays trial K alone.")],
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::montecarlo::Quantiles;

    fn cell(noise_level: u32, sg_window: u32, d_beta: Option<f64>) -> Cell {
        let signals = if sg_window == 0 { Variant::Raw } else { Variant::SavitzkyGolay };
        let quantiles = d_beta.map(|p50| Quantiles { mean: p50, p05: 0.9 * p50, p50, p95: 1.1 * p50 });
        let found = if d_beta.is_some() { 4 } else { 0 };
        Cell {
            noise_level,
            encoder_rad: Some(1e-4 * 10f64.powi(noise_level as i32)),
            torque_nm: None,
            signals,
            sg_window,
            estimator: "wls".into(),
            found,
            failed: 4 - found,
            failure: (found == 0).then(|| "no rows <at all>".to_owned()),
            d_beta: quantiles,
            coverage: d_beta.map(|_| 0.95),
            torque_std_nm: vec![1.5; found.min(1)],
            bias: vec![0.1; found.min(1)],
            spread: vec![0.2; found.min(1)],
            relative_bias: d_beta.map(|_| 0.01),
            relative_spread: d_beta.map(|_| 0.02),
            biased: d_beta.map(|_| 0.0),
        }
    }

    fn rendered(cells: Vec<Cell>) -> String {
        let summary = Summary {
            scenario: "arm".into(),
            seed: 3,
            trials: 4,
            trials_of_study: 8,
            joints: vec!["elbow".into()],
            parameters: vec!["Izz of elbow".into()],
            cells,
            best_windows: Vec::new(),
        };
        page(&summary, &Timings::default(), Provenance::of(["tauscope", "montecarlo"], Some(3))).render()
    }

    #[test]
    fn the_closest_is_named_and_every_level_is_drawn() {
        let page =
            rendered(vec![cell(0, 0, Some(0.5)), cell(0, 31, Some(0.2)), cell(1, 0, Some(0.7)), cell(1, 31, None)]);
        assert!(
            page.contains(
                "parameters: wls with a window of 31 samples at 1e-4 rad of noise (median d_beta 0.200), wls"
            ),
            "{page}"
        );
        assert!(page.contains("wls with no smoothing at 0.001 rad of noise (0.700)"));
        assert!(page.contains("one part of a study of 8") && page.contains("no rows &lt;at all&gt;"));
        // Two windows with two quantities over the noise, and the parameters of two levels.
        assert_eq!(page.matches("class=\"ts-figure chart\"").count(), 2 * 2 + 2);
        assert!(!page.contains("NaN"));
    }

    #[test]
    fn a_study_without_estimates_says_so() {
        let page = rendered(vec![cell(0, 0, None)]);
        assert!(page.contains("No estimator gave an estimate") && page.contains("class=\"bad\""), "{page}");
    }
}
