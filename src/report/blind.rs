//! What blind runs tell: one line a run, and counts.

use super::console::table;
use crate::error::Result;
use crate::scenario::Setup;
use crate::study::blind::{BlindRun, Case, Outcome, name};
use serde::Serialize;

/// Schema of the `blind.json` that `tauscope blind` writes.
pub const SCHEMA: &str = "tauscope.blind/1";

/// All runs with their counts.
#[derive(Debug, Serialize)]
pub struct BlindResult {
    runs: Vec<Row>,
    counts: Vec<Count>,
}

/// One run.
#[derive(Debug, Serialize)]
pub struct Row {
    seed: u64,
    hidden: String,
    size: Vec<f64>,
    severity: f64,
    correlation_s: f64,
    outcome: Option<Outcome>,
    found: Vec<String>,
    unexplained: Vec<String>,
    cutoff_hz: f64,
    gap_closed: f64,
    seconds: f64,
    error: Option<String>,
}

#[derive(Debug, Serialize)]
struct Count {
    outcome: Outcome,
    runs: usize,
}

/// The line of a run, made or failed.
pub fn row(setup: &Setup, case: &Case, run: &Result<BlindRun>) -> Row {
    let hidden = case.hidden.as_ref().map_or("nothing".to_owned(), |placed| name(setup, placed));
    let mut row = Row {
        seed: case.seed,
        hidden,
        size: Vec::new(),
        severity: case.severity,
        correlation_s: case.correlation_s,
        outcome: None,
        found: Vec::new(),
        unexplained: Vec::new(),
        cutoff_hz: 0.0,
        gap_closed: 0.0,
        seconds: 0.0,
        error: None,
    };
    match run {
        Ok(run) => {
            row.size = run.hidden.as_ref().map_or_else(Vec::new, |placed| placed.parameters.clone());
            row.outcome = Some(run.outcome);
            row.cutoff_hz = run.diagnosis.cutoff_hz;
            row.gap_closed = run.diagnosis.gap_closed;
            row.seconds = run.seconds;
            for found in &run.diagnosis.found {
                let mut text = name(setup, &found.member.placed);
                let values = found.member.placed.parameters.iter().zip(&found.member.std);
                for (value, std) in values {
                    text += &format!(" {value:.4e}+-{std:.1e}");
                }
                text += &format!(" p {:.1e}", found.family_wise_p);
                for other in &found.alternatives {
                    text += &format!(" or {}:{}", other.family.effect, other.family.joint + 1);
                }
                row.found.push(text);
            }
            let left = run.diagnosis.unexplained.iter();
            row.unexplained = left.map(|left| setup.known.joints[left.joint].name.clone()).collect();
        }
        Err(error) => row.error = Some(error.to_string()),
    }
    row
}

/// A run in one line.
pub fn line(row: &Row) -> String {
    let outcome = row.outcome.map_or("failed".to_owned(), |outcome| format!("{outcome:?}"));
    format!(
        "{} {} at {} x, noise {} s: {outcome} [{}] unexplained [{}] cut-off {} Hz, {:.1} s {}",
        row.seed,
        row.hidden,
        row.severity,
        row.correlation_s,
        row.found.join(", "),
        row.unexplained.join(", "),
        row.cutoff_hz,
        row.seconds,
        row.error.as_deref().unwrap_or_default()
    )
}

/// All runs with their counts.
pub fn result(runs: Vec<Row>) -> BlindResult {
    const ALL: [Outcome; 6] =
        [Outcome::Named, Outcome::OneOf, Outcome::Missed, Outcome::Wrong, Outcome::Quiet, Outcome::FalseAlarm];
    let of = |outcome: Outcome| runs.iter().filter(|row| row.outcome == Some(outcome)).count();
    let counts = ALL.into_iter().map(|outcome| Count { outcome, runs: of(outcome) }).filter(|count| count.runs > 0);
    BlindResult { counts: counts.collect(), runs }
}

/// The counts for people.
pub fn counts(result: &BlindResult) -> String {
    let rows = result.counts.iter().map(|count| vec![format!("{:?}", count.outcome), count.runs.to_string()]).collect();
    table(&["outcome", "runs"], rows).to_string()
}
