//! Results of blind runs: one line a run, a table of the classes, the confusion matrix.

use super::{console, markdown};
use crate::study::blind::row::{Answer, Row};
use crate::study::blind::summary::{ClassSummary, Summary};
use crate::study::blind::{Class, Outcome};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// Schema of the `blind.json` that `tauscope blind` writes.
pub(crate) const SCHEMA: &str = "tauscope.blind/2";

/// All runs with what they come to.
#[derive(Debug, Serialize)]
pub(crate) struct BlindResult {
    /// Seed of the study.
    pub seed: u64,
    /// Counts with intervals.
    #[serde(flatten)]
    pub summary: Summary,
    /// Every run.
    pub runs: Vec<Row>,
}

/// A run in one line.
pub(crate) fn line(row: &Row) -> String {
    let outcome = row.outcome.map_or("failed", outcome);
    let trust = if row.inertias_believed { "nominal" } else { "structure" };
    let noise = if row.correlation_s > 0.0 { format!("{} s", row.correlation_s) } else { "white".to_owned() };
    let mut text = format!(
        "{} {} {} at {} x, {trust}, noise {noise}: {outcome}",
        row.run,
        class(row.class),
        row.hidden_text(),
        row.severity
    );
    let answers: Vec<String> = row.answers.iter().map(answer).collect();
    let left: Vec<String> = row.unexplained.iter().map(|(joint, structure)| format!("{joint} {structure}")).collect();
    for (what, list) in [("answers", answers), ("unexplained", left), ("data faults", row.faults.clone())] {
        if !list.is_empty() {
            text += &format!("; {what} [{}]", list.join(", "));
        }
    }
    match &row.error {
        Some(error) => text += &format!("; {error}"),
        None => text += &format!("; {:.1} s", row.seconds),
    }
    text
}

fn answer(answer: &Answer) -> String {
    let values = answer.parameters.iter().zip(&answer.std).map(|(value, std)| match std {
        Some(std) => format!(" {value:.3e}+-{std:.0e}"),
        None => " not estimated".to_owned(),
    });
    let taken_back = if answer.verdict == "unexplained" { " (tentative)" } else { "" };
    let p = answer.family_wise_p.map_or_else(String::new, |p| format!(" p {p:.0e}"));
    format!("{}{}{taken_back}{p}", answer.names.join(" or "), values.collect::<String>())
}

/// The counts for people.
pub(crate) fn counts(summary: &Summary) -> String {
    let rows = summary.classes.iter().map(class_row).collect();
    console::table(&HEADER, rows)
}

/// The counts and the confusion matrix as Markdown.
pub(crate) fn page(result: &BlindResult) -> String {
    let classes: Vec<Vec<String>> = result.summary.classes.iter().map(class_row).collect();
    let confusion: Vec<Vec<String>> = result
        .summary
        .confusion
        .iter()
        .map(|entry| {
            vec![class(entry.class).to_owned(), entry.hidden.clone(), entry.answered.clone(), entry.rate.text()]
        })
        .collect();
    let wrong = result.runs.iter().filter(|row| {
        row.error.is_some() || !row.wrong.is_empty() || row.outcome.is_some_and(|outcome| !outcome.is_right())
    });
    let wrong: Vec<String> = wrong.map(|row| format!("- {}\n", line(row))).collect();
    format!(
        "# Blind runs, seed {}\n\nShares with 95 % intervals (Wilson).\n\n{}\n## What was hidden and what was answered\n\n{}\n## \
         Runs that did not come out as they should\n\n{}",
        result.seed,
        markdown::text_table(&HEADER, &classes),
        markdown::text_table(&["class", "hidden", "answered", "runs"], &confusion),
        wrong.concat()
    )
}

/// The confusion matrix as CSV: a line per hidden effect, a column per answer.
pub(crate) fn confusion_csv(summary: &Summary) -> String {
    let answers: BTreeSet<&str> = summary.confusion.iter().map(|entry| entry.answered.as_str()).collect();
    let mut rows: BTreeMap<(Class, &str), BTreeMap<&str, usize>> = BTreeMap::new();
    for entry in &summary.confusion {
        rows.entry((entry.class, &entry.hidden)).or_default().insert(&entry.answered, entry.rate.hits);
    }
    let head: Vec<&str> = ["class", "hidden"].into_iter().chain(answers.iter().copied()).collect();
    let mut text = head.join(",") + "\n";
    for ((of, hidden), counts) in rows {
        let cells = answers.iter().map(|answer| counts.get(answer).copied().unwrap_or(0).to_string());
        let cells: Vec<String> = [class(of).to_owned(), hidden.to_owned()].into_iter().chain(cells).collect();
        text += &(cells.join(",") + "\n");
    }
    text
}

const HEADER: [&str; 10] = [
    "class",
    "outcomes",
    "as it should be",
    "the best of all tests",
    "through the encoders",
    "a wrong name",
    "unexplained",
    "parameters within 3 std",
    "90 % of the gap closed",
    "time",
];

fn class_row(summary: &ClassSummary) -> Vec<String> {
    let mut outcomes: Vec<String> = Outcome::ALL
        .iter()
        .filter_map(|one| Some(format!("{} {}", summary.outcomes.get(one)?, outcome(*one))))
        .collect();
    if summary.failed > 0 {
        outcomes.push(format!("{} failed", summary.failed));
    }
    let share = |share: Option<f64>| share.map_or("-".to_owned(), |share| format!("{:.0} %", 100.0 * share));
    vec![
        class(summary.class).to_owned(),
        outcomes.join(", "),
        summary.right.text(),
        share(summary.power),
        share(summary.power_as_measured),
        summary.wrong_names.text(),
        summary.unexplained.text(),
        summary.parameters.text(),
        summary.gap_closed.text(),
        format!("{:.1} s", summary.median_seconds),
    ]
}

fn class(class: Class) -> &'static str {
    match class {
        Class::Quiet => "nothing hidden",
        Class::Single => "one effect",
        Class::Faint => "one faint effect",
        Class::Pair => "two effects",
        Class::Outside => "outside the library",
        Class::Fault => "fault of the data",
        Class::Asked => "as asked",
    }
}

fn outcome(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Named => "named",
        Outcome::OneOf => "one of two",
        Outcome::WideSet => "one of more",
        Outcome::Half => "half",
        Outcome::Missed => "missed",
        Outcome::Wrong => "wrong",
        Outcome::Flagged => "flagged",
        Outcome::Quiet => "quiet",
        Outcome::FalseAlarm => "false alarm",
    }
}
