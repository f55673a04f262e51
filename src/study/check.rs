//! Accuracy regression: whether identification is significantly worse than a stored baseline.

use super::blind;
use super::montecarlo::{Overrides, Plan, Row, Study};
use crate::error::{Error, Result};
use crate::identification::effect_model::Trust;
use crate::scenario::Setup;
use crate::study::testbed::Variant;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Layout of a baseline file.
pub(crate) const SCHEMA: &str = "tauscope.baseline/1";

/// Trials of a new baseline.
pub(crate) const TRIALS: usize = 16;

/// Worsening, in standard errors of the difference of two means, that counts as significant.
const WORSE: f64 = 3.0;

/// Relative change that is rounding, whatever the spread.
const ROUNDING: f64 = 1e-6;

/// Significance level of Fisher's exact test of the diagnoses.
const CHANCE: f64 = 0.01;

/// Severity of hidden effects, over the torque noise.
const SEVERITY: f64 = 3.0;

/// Accuracy of the identification when the baseline was made.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Baseline {
    /// Name of the scenario.
    pub scenario: String,
    /// Seed of the trials.
    pub seed: u64,
    /// Number of trials.
    pub trials: usize,
    /// Figures of merit, the smaller the better.
    pub figures: Vec<Figure>,
    /// Blind diagnoses, if any were made.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub diagnosis: Option<Diagnoses>,
}

/// A figure of merit over the trials, the smaller the better.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Figure {
    /// What it is.
    pub name: String,
    /// Mean over the trials.
    pub mean: f64,
    /// Standard deviation over the trials.
    pub spread: f64,
}

/// Outcomes of blind diagnoses.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Diagnoses {
    /// Runs made.
    pub runs: usize,
    /// Runs in which what was hidden was named, alone or as one of a set.
    pub right: usize,
}

/// How a figure stands against the baseline.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Verdict {
    /// Beyond chance.
    Worse,
    /// Within chance.
    Same,
    /// Beyond chance.
    Better,
}

/// A figure now and in the baseline.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Metric {
    /// What it is.
    pub name: String,
    /// Mean in the baseline.
    pub baseline: f64,
    /// Mean now.
    pub now: f64,
    /// Standard deviation over the trials of the baseline.
    pub spread: f64,
    /// Difference of the means over its standard error; None where there is no spread, as of diagnoses.
    pub deviations: Option<f64>,
    /// Verdict.
    pub verdict: Verdict,
}

/// What a check found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Report {
    /// Name of the scenario.
    pub scenario: String,
    /// Every figure.
    pub metrics: Vec<Metric>,
}

impl Report {
    /// Whether anything got worse.
    pub(crate) fn failed(&self) -> bool {
        self.metrics.iter().any(|metric| metric.verdict == Verdict::Worse)
    }
}

impl Baseline {
    /// Measures the accuracy of the identification now, over `trials` draws of noise and `runs` blind diagnoses. Figures with common
    /// practice's smoothing are left out if that gives no estimate in some trial.
    ///
    /// # Errors
    /// If a simulation fails, or the identification from raw or Savitzky-Golay signals.
    pub(crate) fn measure(setup: &Setup, trials: usize, runs: usize, tick: &(dyn Fn() + Sync)) -> Result<Self> {
        let window = setup.scenario.identification.fixed_window(setup.scenario.sensors.rate_hz);
        let overrides = Overrides {
            trials: Some(trials),
            estimators: Some(vec!["wls".to_owned()]),
            windows: Some(vec![0, window]),
            butterworth: true,
            noise: Some(Vec::new()),
        };
        let study = Study::new(setup.clone(), Plan::new(setup, overrides)?)?;
        let rows: Vec<Vec<Row>> = (0..trials as u32)
            .into_par_iter()
            .map(|trial| {
                let rows = study.trial(trial);
                tick();
                rows
            })
            .collect();
        let rows = rows.concat();
        let mut figures = Vec::new();
        for signals in [Variant::Raw, Variant::SavitzkyGolay, Variant::Butterworth] {
            let own = self::figures(setup, signals, rows.iter().filter(|row| row.signals == signals));
            match own {
                Err(problem) if signals == Variant::Butterworth => {
                    tracing::warn!("left out of the check: {problem}");
                }
                own => figures.extend(own?),
            }
        }
        let diagnosis = (runs > 0).then(|| diagnose(setup, runs, tick)).transpose()?;
        Ok(Baseline { scenario: setup.scenario.name.clone(), seed: setup.scenario.seed, trials, figures, diagnosis })
    }

    /// Reads a baseline.
    ///
    /// # Errors
    /// If there is none (the error names the option that makes one), or it is not well formed.
    pub(crate) fn read(path: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(path)
            .map_err(|source| Error::io(path, "read the baseline (--update makes one)", source))?;
        let bad =
            |problem: serde_json::Error| Error::input(path, Some(problem.line()), "baseline", problem.to_string());
        let mut value: serde_json::Value = serde_json::from_str(&text).map_err(bad)?;
        let schema = value.as_object_mut().and_then(|object| object.remove("schema"));
        if schema != Some(SCHEMA.into()) {
            return Err(Error::input(path, None, "schema", format!("is not `{SCHEMA}`")));
        }
        serde_json::from_value(value).map_err(|problem| Error::input(path, None, "baseline", problem.to_string()))
    }

    /// Compares the accuracy `now` with this baseline. A figure of common practice's smoothing that could not be measured now is worse.
    ///
    /// # Errors
    /// If the two are not of the same figures.
    pub(crate) fn compare(&self, now: &Baseline) -> Result<Report> {
        let find = |name: &str| now.figures.iter().find(|figure| figure.name == name);
        let is_missing = |figure: &Figure| find(&figure.name).is_none();
        let of_usual = |figure: &Figure| figure.name.starts_with(Variant::Butterworth.name());
        let is_other = self.figures.iter().any(|figure| is_missing(figure) && !of_usual(figure));
        let is_more = now.figures.iter().any(|figure| self.figures.iter().all(|before| before.name != figure.name));
        if self.scenario != now.scenario || is_other || is_more {
            let problem = format!(
                "is of `{}` with other figures than `{}` has; make a new one with --update",
                self.scenario, now.scenario
            );
            return Err(Error::request("baseline", problem));
        }
        let metric_of = |before: &Figure| {
            let mean = find(&before.name).map_or(f64::NAN, |figure| figure.mean);
            metric(before, mean, self.trials, now.trials)
        };
        let mut metrics: Vec<Metric> = self.figures.iter().map(metric_of).collect();
        if let (Some(before), Some(after)) = (self.diagnosis, now.diagnosis) {
            metrics.push(diagnosis_metric(before, after));
        }
        Ok(Report { scenario: now.scenario.clone(), metrics })
    }
}

/// Parameter error, missed intervals and torque error of each joint over the trials.
fn figures<'a>(setup: &Setup, signals: Variant, rows: impl Iterator<Item = &'a Row>) -> Result<Vec<Figure>> {
    let signals = signals.name();
    let mut values: Vec<Vec<f64>> = vec![Vec::new(); 2 + setup.known.dof()];
    for row in rows {
        let found = row.outcome.as_ref().map_err(|problem| {
            Error::request(format!("identification from {signals} signals"), format!("trial {}: {problem}", row.trial))
        })?;
        let errors = found.beta.iter().zip(&row.truth).map(|(b, t)| ((b - t) / t).abs());
        let mut errors: Vec<f64> = errors.filter(|e| e.is_finite()).collect();
        errors.sort_by(f64::total_cmp);
        values[0].push(found.d_beta);
        values[1].push(errors.get(errors.len() / 2).copied().unwrap_or(0.0));
        for (own, std) in values[2..].iter_mut().zip(&found.torque_std) {
            own.push(*std);
        }
    }
    let joints = setup
        .known
        .joints
        .iter()
        .map(|joint| format!("{signals}: torque std of {}, {}", joint.name, joint.effort_unit()));
    let names = [format!("{signals}: parameter error d_beta"), format!("{signals}: median relative parameter error")];
    let figure = |(name, values): (String, &Vec<f64>)| {
        let count = values.len().max(1) as f64;
        let mean = values.iter().sum::<f64>() / count;
        let squares: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
        Figure { name, mean, spread: (squares / (count - 1.0).max(1.0)).sqrt() }
    };
    Ok(names.into_iter().chain(joints).zip(&values).map(figure).collect())
}

/// Hides effects and counts how often they are named.
fn diagnose(setup: &Setup, runs: usize, tick: &dyn Fn()) -> Result<Diagnoses> {
    let mut right = 0;
    for run in 0..runs {
        let case = blind::draw(setup, setup.scenario.seed + run as u64, SEVERITY, 0.0, Trust::Nominal);
        let outcome = blind::run(setup, &case)?.judgement.outcome;
        right += usize::from(matches!(outcome, blind::Outcome::Named | blind::Outcome::OneOf));
        tick();
    }
    Ok(Diagnoses { runs, right })
}

/// A figure of the baseline against its mean `now`.
fn metric(before: &Figure, now: f64, trials_before: usize, trials_now: usize) -> Metric {
    let variance = |spread: f64, trials: usize| spread * spread / trials.max(1) as f64;
    // The spread of the baseline is used for both: a larger spread now must not hide a worse mean.
    let error = (variance(before.spread, trials_before) + variance(before.spread, trials_now)).sqrt();
    let change = now - before.mean;
    let rounding = ROUNDING * before.mean.abs();
    let verdict = match change {
        // Not a number is worse than any number.
        _ if change.is_nan() || change > (WORSE * error).max(rounding) => Verdict::Worse,
        _ if change < -(WORSE * error).max(rounding) => Verdict::Better,
        _ => Verdict::Same,
    };
    let deviations = (error > 0.0).then(|| change / error);
    Metric { name: before.name.clone(), baseline: before.mean, now, spread: before.spread, deviations, verdict }
}

/// Fewer right answers, judged by Fisher's exact test.
fn diagnosis_metric(before: Diagnoses, after: Diagnoses) -> Metric {
    let share = |d: Diagnoses| 1.0 - d.right as f64 / d.runs.max(1) as f64;
    let verdict = if as_few_right(before, after) < CHANCE {
        Verdict::Worse
    } else if as_few_right(after, before) < CHANCE {
        Verdict::Better
    } else {
        Verdict::Same
    };
    Metric {
        name: "diagnosis: share of hidden effects not named".to_owned(),
        baseline: share(before),
        now: share(after),
        spread: 0.0,
        deviations: None,
        verdict,
    }
}

/// Probability of as few right answers as `after` or fewer, if both had the same chance of each (hypergeometric).
fn as_few_right(before: Diagnoses, after: Diagnoses) -> f64 {
    let (total, right) = (before.runs + after.runs, before.right + after.right);
    let log_choose = |n: usize, k: usize| -> f64 { (0..k).map(|i| ((n - i) as f64 / (k - i) as f64).ln()).sum() };
    let fewest = right.saturating_sub(before.runs);
    (fewest..=after.right.min(right))
        .map(|k| (log_choose(after.runs, k) + log_choose(before.runs, right - k) - log_choose(total, right)).exp())
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn baseline(mean: f64, diagnosis: Option<Diagnoses>) -> Baseline {
        let figures = vec![Figure { name: "d_beta".into(), mean, spread: 0.1 }];
        Baseline { scenario: "a".into(), seed: 1, trials: 8, figures, diagnosis }
    }

    fn verdict(before: f64, after: f64) -> Verdict {
        baseline(before, None).compare(&baseline(after, None)).unwrap().metrics[0].verdict
    }

    #[test]
    fn beyond_three_standard_errors_is_worse() {
        // Standard error of the difference: 0.1 sqrt(2 / 8) = 0.05.
        assert_eq!(verdict(1.0, 1.14), Verdict::Same);
        assert_eq!(verdict(1.0, 1.16), Verdict::Worse);
        assert_eq!(verdict(1.0, 0.84), Verdict::Better);
        assert_eq!(verdict(1.0, f64::NAN), Verdict::Worse);
    }

    #[test]
    fn fishers_test_by_hand() {
        // Of 3 + 3 runs 3 right, none of them now: 1 / C(6, 3).
        let (before, after) = (Diagnoses { runs: 3, right: 3 }, Diagnoses { runs: 3, right: 0 });
        assert!((as_few_right(before, after) - 0.05).abs() < 1e-12);
        assert!((as_few_right(after, before) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn diagnoses_get_worse_only_beyond_chance() {
        let of = |right| Some(Diagnoses { runs: 10, right });
        let report = |after| baseline(1.0, of(9)).compare(&baseline(1.0, of(after))).unwrap();
        assert!(!report(7).failed());
        assert!(report(2).failed());
    }

    fn with_usual(mut of: Baseline, mean: f64) -> Baseline {
        of.figures.push(Figure { name: "butterworth: parameter error d_beta".into(), mean, spread: 0.1 });
        of
    }

    #[test]
    fn common_practice_may_get_worse_too() {
        let failed = |before: f64, now: Option<f64>| {
            let alone = baseline(1.0, None);
            let now = now.map_or(alone.clone(), |mean| with_usual(alone.clone(), mean));
            with_usual(alone, before).compare(&now).unwrap().failed()
        };
        assert!(!failed(1.0, Some(1.14)));
        assert!(failed(1.0, Some(1.16)));
        // Without an estimate it is worse; a baseline without it does not hold it.
        assert!(failed(1.0, None));
        let more = with_usual(baseline(1.0, None), 1.0);
        assert!(baseline(1.0, None).compare(&more).unwrap_err().to_string().contains("--update"));
        // The other figures may not be left out.
        let less = Baseline { figures: Vec::new(), ..baseline(1.0, None) };
        assert!(baseline(1.0, None).compare(&less).is_err());
    }

    #[test]
    fn another_scenario_is_refused() {
        let other = Baseline { scenario: "b".into(), ..baseline(1.0, None) };
        assert!(baseline(1.0, None).compare(&other).unwrap_err().to_string().contains("--update"));
    }
}
