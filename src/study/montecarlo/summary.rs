//! A study in numbers: bias, spread, coverage and quantiles by noise level, smoothing and estimator.

use super::plan::{Identity, smoothings};
use super::table::{float, text};
use crate::error::Result;
use crate::study::testbed::Variant;
use arrow_array::{Array, RecordBatch};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Bias over its standard error beyond which it does not come from the draws.
const SIGNIFICANT: f64 = 3.0;

/// The 5 %, 50 % and 95 % quantiles of a quantity and its mean; none without values.
///
/// ```
/// use tauscope::study::montecarlo::Quantiles;
///
/// let quantiles = Quantiles::of((0..=100).map(f64::from).collect()).expect("there are values");
/// assert_eq!((quantiles.p05, quantiles.p50, quantiles.p95, quantiles.mean), (5.0, 50.0, 95.0, 50.0));
/// assert_eq!(Quantiles::of(Vec::new()), None);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Quantiles {
    /// Mean.
    pub mean: f64,
    /// 5 %.
    pub p05: f64,
    /// Median.
    pub p50: f64,
    /// 95 %.
    pub p95: f64,
}

impl Quantiles {
    /// The quantiles of values in any order, by linear interpolation; None without values.
    pub fn of(mut values: Vec<f64>) -> Option<Self> {
        if values.is_empty() {
            return None;
        }
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        values.sort_by(f64::total_cmp);
        let at = |share: f64| {
            let place = share * (values.len() - 1) as f64;
            let (low, high) = (values[place.floor() as usize], values[place.ceil() as usize]);
            low + (high - low) * place.fract()
        };
        Some(Quantiles { mean, p05: at(0.05), p50: at(0.5), p95: at(0.95) })
    }
}

/// One estimator at one noise level with one smoothing.
///
/// ```
/// # use tauscope::scenario::Setup;
/// # use tauscope::study::montecarlo::{Overrides, Plan, Study};
/// # let setup = Setup::load("tests/scenarios/pendulum.toml", None)?;
/// # let (estimators, windows) = (Some(vec!["wls".to_owned()]), Some(vec![0, 61]));
/// # let overrides = Overrides { trials: Some(4), estimators, windows, ..Overrides::default() };
/// # let study = Study::new(setup.clone(), Plan::new(&setup, overrides)?)?;
/// # let folder = tempfile::tempdir().unwrap();
/// # let (stop, path) = (std::sync::atomic::AtomicBool::new(false), folder.path().join("study"));
/// # use tauscope::study::montecarlo::{Progress, Shard, StudyFolder};
/// # let opened = StudyFolder::open(&path, &study, Shard::WHOLE, false)?;
/// # let finished = opened.run(&study, &Progress { done: &|_| (), stop: &stop }, &|_, _| String::new())?;
/// # let (summary, timings, _) = finished.expect("nothing stopped it");
///
/// // The summary of a study with one estimator and two smoothings: none, and Savitzky-Golay over 61 samples.
/// let [raw, smoothed] = &summary.cells[..] else { unreachable!() };
/// assert_eq!((smoothed.sg_window, smoothed.found, smoothed.failed), (61, 4, 0));
/// let median = |cell: &tauscope::study::montecarlo::Cell| cell.d_beta.expect("it was found").p50;
/// assert!(median(smoothed) < median(raw));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Cell {
    /// Index of the noise level.
    pub noise_level: u32,
    /// Encoder noise of the level, rad; None for the scenario's.
    pub encoder_rad: Option<f64>,
    /// Torque noise of the level, N m; None for the scenario's.
    pub torque_nm: Option<f64>,
    /// How the signals were smoothed: raw, Savitzky-Golay or Butterworth.
    pub signals: Variant,
    /// Savitzky-Golay window in samples, 0 where there is none.
    pub sg_window: u32,
    /// Name of the estimator.
    pub estimator: String,
    /// Trials that gave an estimate.
    pub found: usize,
    /// Trials that did not.
    pub failed: usize,
    /// Why the first of them did not.
    pub failure: Option<String>,
    /// Distance from the true parameters.
    pub d_beta: Option<Quantiles>,
    /// Mean share of the parameters whose 95 % interval holds the truth.
    pub coverage: Option<f64>,
    /// Mean over the trials of the torque error's standard deviation on the held-out motion, per joint, N m.
    pub torque_std_nm: Vec<f64>,
    /// Mean of estimate minus truth, per parameter.
    pub bias: Vec<f64>,
    /// Standard deviation over the trials of estimate minus truth, per parameter.
    pub spread: Vec<f64>,
    /// Median over the parameters of |bias| / |truth|.
    pub relative_bias: Option<f64>,
    /// Median over the parameters of spread / |truth|.
    pub relative_spread: Option<f64>,
    /// Share of the parameters whose bias is more than three of its standard errors; None for fewer than two trials.
    pub biased: Option<f64>,
}

/// The smoothing with the smallest median parameter error of an estimator at a noise level.
///
/// ```
/// # use tauscope::scenario::Setup;
/// # use tauscope::study::montecarlo::{Overrides, Plan, Study};
/// # let setup = Setup::load("tests/scenarios/pendulum.toml", None)?;
/// # let (estimators, windows) = (Some(vec!["wls".to_owned()]), Some(vec![0, 61]));
/// # let overrides = Overrides { trials: Some(4), estimators, windows, ..Overrides::default() };
/// # let study = Study::new(setup.clone(), Plan::new(&setup, overrides)?)?;
/// # let folder = tempfile::tempdir().unwrap();
/// # let (stop, path) = (std::sync::atomic::AtomicBool::new(false), folder.path().join("study"));
/// # use tauscope::study::montecarlo::{Progress, Shard, StudyFolder};
/// # let opened = StudyFolder::open(&path, &study, Shard::WHOLE, false)?;
/// # let finished = opened.run(&study, &Progress { done: &|_| (), stop: &stop }, &|_, _| String::new())?;
/// # let (summary, timings, _) = finished.expect("nothing stopped it");
///
/// // Of no smoothing and a window of 61 samples, the window gives the smaller parameter error.
/// let best = &summary.best_windows[0];
/// assert_eq!((&best.estimator[..], best.sg_window), ("wls", 61));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BestWindow {
    /// Index of the noise level.
    pub noise_level: u32,
    /// Name of the estimator.
    pub estimator: String,
    /// How the signals were smoothed.
    pub signals: Variant,
    /// Savitzky-Golay window in samples, 0 where there is none.
    pub sg_window: u32,
    /// Its median d_beta.
    pub d_beta: f64,
}

/// A study in numbers.
///
/// ```
/// # use tauscope::scenario::Setup;
/// # use tauscope::study::montecarlo::{Overrides, Plan, Study};
/// # let setup = Setup::load("tests/scenarios/pendulum.toml", None)?;
/// # let (estimators, windows) = (Some(vec!["wls".to_owned()]), Some(vec![0, 61]));
/// # let overrides = Overrides { trials: Some(4), estimators, windows, ..Overrides::default() };
/// # let study = Study::new(setup.clone(), Plan::new(&setup, overrides)?)?;
/// # let folder = tempfile::tempdir().unwrap();
/// # let (stop, path) = (std::sync::atomic::AtomicBool::new(false), folder.path().join("study"));
/// # use tauscope::study::montecarlo::{Progress, Shard, StudyFolder};
/// # let opened = StudyFolder::open(&path, &study, Shard::WHOLE, false)?;
/// # let finished = opened.run(&study, &Progress { done: &|_| (), stop: &stop }, &|_, _| String::new())?;
/// # let (summary, timings, _) = finished.expect("nothing stopped it");
///
/// // Four trials of a pendulum's identification.
/// assert_eq!((summary.trials, summary.trials_of_study), (4, 4));
/// assert_eq!((summary.joints.len(), summary.parameters.len(), summary.cells.len()), (1, 5, 2));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Name of the scenario.
    pub scenario: String,
    /// Seed of all draws.
    pub seed: u64,
    /// Trials in the rows summed up: all of the study, or a shard's.
    pub trials: usize,
    /// Trials of the study.
    pub trials_of_study: usize,
    /// Joints of the arm.
    pub joints: Vec<String>,
    /// Names of the base parameters.
    pub parameters: Vec<String>,
    /// By noise level, smoothing and estimator.
    pub cells: Vec<Cell>,
    /// By noise level and estimator, where more than one smoothing was tried.
    pub best_windows: Vec<BestWindow>,
}

/// Sums over the rows seen so far; what grows with the trials is one number a row.
pub(super) struct Sums {
    identity: Identity,
    trials: usize,
    cells: Vec<CellSums>,
}

#[derive(Clone, Default)]
struct CellSums {
    d_beta: Vec<f64>,
    coverage: f64,
    torque_std: Vec<f64>,
    /// Per parameter: mean of the error, sum of its squared deviations (Welford 1962), mean of the truth's size.
    error: Vec<[f64; 3]>,
    failed: usize,
    failure: Option<String>,
}

impl Sums {
    pub(super) fn new(identity: &Identity) -> Self {
        let empty = CellSums {
            torque_std: vec![0.0; identity.joints.len()],
            error: vec![[0.0; 3]; identity.parameters.len()],
            ..CellSums::default()
        };
        Sums { trials: 0, cells: vec![empty; identity.cells()], identity: identity.clone() }
    }

    /// Adds the rows of a chunk, which stand trial by trial in the order of the cells.
    pub(super) fn add(&mut self, path: &Path, batch: &RecordBatch) -> Result<()> {
        let cells = self.cells.len();
        let failure = text(path, batch, "failure")?;
        let (d_beta, coverage) = (float(path, batch, "d_beta")?, float(path, batch, "coverage")?);
        let columns =
            |names: Vec<String>| -> Result<Vec<_>> { names.iter().map(|name| float(path, batch, name)).collect() };
        let torque = columns(self.identity.joints.iter().map(|joint| format!("torque_std_{joint}")).collect())?;
        let numbered = |what: &str| (1..=self.identity.parameters.len()).map(|k| format!("{what}_{k}")).collect();
        let (beta, truth) = (columns(numbered("beta"))?, columns(numbered("true"))?);
        for row in 0..batch.num_rows() {
            let cell = &mut self.cells[row % cells];
            if !failure.is_null(row) {
                cell.failed += 1;
                cell.failure.get_or_insert_with(|| failure.value(row).to_owned());
                continue;
            }
            cell.d_beta.push(d_beta.value(row));
            cell.coverage += coverage.value(row);
            for (sum, column) in cell.torque_std.iter_mut().zip(&torque) {
                *sum += column.value(row);
            }
            let count = cell.d_beta.len() as f64;
            for ((sums, beta), truth) in cell.error.iter_mut().zip(&beta).zip(&truth) {
                let error = beta.value(row) - truth.value(row);
                let off = error - sums[0];
                sums[0] += off / count;
                sums[1] += off * (error - sums[0]);
                sums[2] += (truth.value(row).abs() - sums[2]) / count;
            }
        }
        self.trials += batch.num_rows() / cells;
        Ok(())
    }

    pub(super) fn summary(self) -> Summary {
        let Identity { scenario, seed, montecarlo: spec, joints, parameters, .. } = self.identity;
        let mut cells = Vec::new();
        let mut sums = self.cells.into_iter();
        let smoothings = smoothings(&spec);
        for (level, noise) in spec.noise.iter().enumerate() {
            for &(signals, sg_window) in &smoothings {
                for (estimator, sums) in spec.estimators.iter().zip(&mut sums) {
                    cells.push(Cell {
                        noise_level: level as u32,
                        encoder_rad: noise.encoder_rad,
                        torque_nm: noise.torque_nm,
                        signals,
                        sg_window,
                        estimator: estimator.clone(),
                        ..sums.cell()
                    });
                }
            }
        }
        let best_windows = if smoothings.len() > 1 { best_windows(&cells) } else { Vec::new() };
        let trials_of_study = spec.trials;
        Summary { scenario, seed, trials: self.trials, trials_of_study, joints, parameters, cells, best_windows }
    }
}

impl CellSums {
    fn cell(self) -> Cell {
        let found = self.d_beta.len();
        let count = found as f64;
        let mean = |sum: f64| sum / count;
        let bias: Vec<f64> = self.error.iter().map(|[mean, ..]| *mean).collect();
        let spread: Vec<f64> =
            self.error.iter().map(|[_, squares, _]| (squares / (count - 1.0).max(1.0)).sqrt()).collect();
        // A parameter that is zero to rounding has no relative error.
        let largest = self.error.iter().map(|[.., size]| *size).fold(0.0, f64::max);
        let relative = |values: &[f64]| {
            let sized = values.iter().zip(&self.error).filter(|(_, [.., size])| *size > 1e-9 * largest);
            Quantiles::of(sized.map(|(value, [.., size])| value.abs() / size).collect()).map(|q| q.p50)
        };
        let significant = bias.iter().zip(&spread).filter(|(b, s)| b.abs() > SIGNIFICANT * **s / count.sqrt()).count();
        let some = found > 0;
        Cell {
            noise_level: 0,
            encoder_rad: None,
            torque_nm: None,
            signals: Variant::Raw,
            sg_window: 0,
            estimator: String::new(),
            found,
            failed: self.failed,
            failure: self.failure,
            coverage: some.then(|| mean(self.coverage)),
            torque_std_nm: if some { self.torque_std.iter().map(|&sum| mean(sum)).collect() } else { Vec::new() },
            relative_bias: relative(&bias).filter(|_| some),
            relative_spread: relative(&spread).filter(|_| found > 1),
            biased: (found > 1).then(|| significant as f64 / bias.len().max(1) as f64),
            bias: if some { bias } else { Vec::new() },
            spread: if found > 1 { spread } else { Vec::new() },
            d_beta: Quantiles::of(self.d_beta),
        }
    }
}

/// The best smoothing of each noise level and estimator, among those with which most trials gave an estimate.
fn best_windows(cells: &[Cell]) -> Vec<BestWindow> {
    let mut best: Vec<BestWindow> = Vec::new();
    for cell in cells.iter().filter(|cell| cell.found > cell.failed) {
        let Some(d_beta) = cell.d_beta else { continue };
        let candidate = BestWindow {
            noise_level: cell.noise_level,
            estimator: cell.estimator.clone(),
            signals: cell.signals,
            sg_window: cell.sg_window,
            d_beta: d_beta.p50,
        };
        let same = |b: &&mut BestWindow| b.noise_level == cell.noise_level && b.estimator == cell.estimator;
        match best.iter_mut().find(same) {
            Some(known) if known.d_beta <= candidate.d_beta => {}
            Some(known) => *known = candidate,
            None => best.push(candidate),
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_interpolate() {
        let q = Quantiles::of(vec![3.0, 1.0, 2.0, 4.0, 5.0]).unwrap();
        assert_eq!((q.mean, q.p50), (3.0, 3.0));
        assert!((q.p05 - 1.2).abs() < 1e-12 && (q.p95 - 4.8).abs() < 1e-12, "{q:?}");
        assert_eq!(Quantiles::of(Vec::new()), None);
    }
}
