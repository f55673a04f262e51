//! Counts of blind runs with intervals, and the confusion matrix.

use super::case::Class;
use super::outcome::Outcome;
use super::row::{Hidden, Row};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// 97.5 % point of the normal distribution.
const NORMAL_95: f64 = 1.959_964;

/// Standard deviations within which an estimate counts as right.
const WITHIN: f64 = 3.0;

/// Share of the gap that what is hidden opens on held-out motions which is to be closed.
const CLOSED: f64 = 0.9;

/// A share of runs, with its 95 % interval (Wilson 1927).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(crate) struct Rate {
    /// Runs of which it holds.
    pub hits: usize,
    /// All runs.
    pub of: usize,
    /// Bounds of the share.
    pub interval: [f64; 2],
}

impl Rate {
    /// `hits` out of `of`.
    pub(crate) fn new(hits: usize, of: usize) -> Self {
        if of == 0 {
            return Rate { hits, of, interval: [0.0, 1.0] };
        }
        let (p, n, z2) = (hits as f64 / of as f64, of as f64, NORMAL_95 * NORMAL_95);
        let middle = p + z2 / (2.0 * n);
        let half = NORMAL_95 * (p * (1.0 - p) / n + z2 / (4.0 * n * n)).sqrt();
        let bound = |value: f64| (value / (1.0 + z2 / n)).clamp(0.0, 1.0);
        Rate { hits, of, interval: [bound(middle - half), bound(middle + half)] }
    }

    fn count<T>(all: &[T], holds: impl Fn(&T) -> bool) -> Self {
        Self::new(all.iter().filter(|one| holds(one)).count(), all.len())
    }

    /// In per cent with its interval.
    pub(crate) fn text(&self) -> String {
        let percent = |share: f64| (100.0 * share).round();
        let [low, high] = self.interval.map(percent);
        match self.of {
            0 => "-".to_owned(),
            of => {
                format!("{} of {of} = {} % ({low} to {high})", self.hits, percent(self.hits as f64 / of as f64))
            }
        }
    }
}

/// All runs of one class.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct ClassSummary {
    /// The class.
    pub class: Class,
    /// Runs that could not be made.
    pub failed: usize,
    /// How the others came out.
    pub outcomes: BTreeMap<Outcome, usize>,
    /// Runs that came out as they should.
    pub right: Rate,
    /// Runs that name something that was not hidden, with the right effect or in place of it.
    pub wrong_names: Rate,
    /// Runs in which something is left unexplained.
    pub unexplained: Rate,
    /// Estimated parameters within three standard deviations of the truth.
    pub parameters: Rate,
    /// Runs that close at least 90 % of the gap that what is hidden opens on the held-out motion.
    pub gap_closed: Rate,
    /// Mean over what is hidden of how often the best of all tests would name it; None where nothing is hidden.
    pub power: Option<f64>,
    /// The same with measured positions.
    pub power_as_measured: Option<f64>,
    /// Median time of a diagnosis, s.
    pub median_seconds: f64,
}

/// Runs by what was hidden and what was answered.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Confusion {
    /// The class.
    pub class: Class,
    /// Name of the effect or fault that was hidden, or `nothing`.
    pub hidden: String,
    /// Effect that was named; `set of two` or `wide set` for a set that holds the hidden one, `another set` for one
    /// that does not, `on another joint`, `unexplained`, `nothing`, `data fault`.
    pub answered: String,
    /// Runs, of all that hide the same.
    pub rate: Rate,
}

/// What a study comes to.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Summary {
    /// By class.
    pub classes: Vec<ClassSummary>,
    /// By hidden effect and answer.
    pub confusion: Vec<Confusion>,
}

impl Summary {
    /// The summary of these runs.
    pub(crate) fn new(rows: &[Row]) -> Self {
        let classes: BTreeSet<Class> = rows.iter().map(|row| row.class).collect();
        let classes = classes.into_iter().map(|class| {
            let own: Vec<&Row> = rows.iter().filter(|row| row.class == class).collect();
            of_class(class, &own)
        });
        Summary { classes: classes.collect(), confusion: confusion(rows) }
    }
}

fn of_class(class: Class, rows: &[&Row]) -> ClassSummary {
    let made: Vec<&Row> = rows.iter().copied().filter(|row| row.outcome.is_some()).collect();
    let mut outcomes = BTreeMap::new();
    for outcome in made.iter().filter_map(|row| row.outcome) {
        *outcomes.entry(outcome).or_insert(0) += 1;
    }
    let errors: Vec<f64> = made.iter().flat_map(|row| row.errors.iter().copied()).collect();
    let hiding: Vec<&Row> = made.iter().copied().filter(|row| !row.hidden.is_empty()).collect();
    let mut seconds: Vec<f64> = made.iter().map(|row| row.seconds).collect();
    seconds.sort_by(f64::total_cmp);
    ClassSummary {
        class,
        failed: rows.len() - made.len(),
        right: Rate::count(&made, |row| row.outcome.is_some_and(Outcome::is_right)),
        wrong_names: Rate::count(&made, |row| !row.wrong.is_empty()),
        unexplained: Rate::count(&made, |row| !row.unexplained.is_empty()),
        parameters: Rate::count(&errors, |error| error.abs() <= WITHIN),
        gap_closed: Rate::count(&hiding, |row| row.accounted_for.is_some_and(|share| share >= CLOSED)),
        power: mean(made.iter().flat_map(|row| row.power.iter().copied())),
        power_as_measured: mean(made.iter().flat_map(|row| row.power_as_measured.iter().copied())),
        median_seconds: seconds.get(seconds.len() / 2).copied().unwrap_or(0.0),
        outcomes,
    }
}

fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, count) = values.fold((0.0, 0usize), |(sum, count), value| (sum + value, count + 1));
    (count > 0).then(|| sum / count as f64)
}

/// One entry per hidden effect, so a run that hides two counts twice.
fn confusion(rows: &[Row]) -> Vec<Confusion> {
    let mut counts: BTreeMap<(Class, String), BTreeMap<String, usize>> = BTreeMap::new();
    for row in rows.iter().filter(|row| row.outcome.is_some()) {
        let mut add = |hidden: String, answered: String| {
            *counts.entry((row.class, hidden)).or_default().entry(answered).or_insert(0) += 1;
        };
        match (&row.fault, &row.hidden[..]) {
            (Some(fault), _) => add(
                fault.name().to_owned(),
                if row.outcome == Some(Outcome::Named) { fault.name().to_owned() } else { answered(row, None) },
            ),
            (None, []) => add("nothing".to_owned(), answered(row, None)),
            (None, hidden) => {
                for (index, one) in hidden.iter().enumerate() {
                    let answer = match row.each.get(index) {
                        Some(Outcome::Named) => one.effect.clone(),
                        Some(Outcome::OneOf) => "set of two".to_owned(),
                        Some(Outcome::WideSet) => "wide set".to_owned(),
                        _ => answered(row, Some(one)),
                    };
                    add(one.effect.clone(), answer);
                }
            }
        }
    }
    let entries = counts.into_iter().flat_map(|((class, hidden), answers)| {
        let of = answers.values().sum();
        answers.into_iter().map(move |(answered, hits)| Confusion {
            class,
            hidden: hidden.clone(),
            answered,
            rate: Rate::new(hits, of),
        })
    });
    entries.collect()
}

/// What a run answers where it does not name what is hidden: its first named effect, or what there is in place of one.
fn answered(row: &Row, hidden: Option<&Hidden>) -> String {
    if let Some(wrong) = row.wrong.first() {
        let name = wrong.split(':').next().unwrap_or(wrong);
        let other_joint = hidden.is_some_and(|hidden| hidden.effect == name);
        return if other_joint { "on another joint".to_owned() } else { name.to_owned() };
    }
    let verdict = |wanted: &str| row.answers.iter().any(|answer| answer.verdict == wanted);
    let text = if verdict("one_of") {
        "another set"
    } else if verdict("unexplained") || !row.unexplained.is_empty() {
        "unexplained"
    } else if !row.faults.is_empty() && row.gap_closed.is_none() {
        "data fault"
    } else {
        "nothing"
    };
    text.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wilson_intervals() {
        // Brown, Cai and DasGupta (2001): 0 of 10 gives an upper bound of z2 / (n + z2).
        let none = Rate::new(0, 10);
        assert!(none.interval[0].abs() < 1e-12 && (none.interval[1] - 3.8415 / 13.8415).abs() < 1e-4);
        let half = Rate::new(50, 100);
        assert!((half.interval[0] - 0.4038).abs() < 1e-4 && (half.interval[1] - 0.5962).abs() < 1e-4);
        assert_eq!(Rate::new(0, 0).text(), "-");
        assert_eq!(half.text(), "50 of 100 = 50 % (40 to 60)");
    }

    #[test]
    fn answers_go_to_their_column() {
        let case = super::super::case::Case::plain(1);
        let failed = Row::new(&case, &Err(crate::error::Error::request("x", "y")));
        let hidden = Hidden { effect: "backlash".into(), joint: Some(2), parameters: vec![] };
        let row = |outcome, each: &[Outcome], wrong: &[&str]| Row {
            class: Class::Single,
            outcome: Some(outcome),
            each: each.to_vec(),
            wrong: wrong.iter().map(|&name| name.to_owned()).collect(),
            hidden: vec![hidden.clone()],
            ..failed.clone()
        };
        let rows = [
            row(Outcome::Named, &[Outcome::Named], &["torque_lag:1"]),
            row(Outcome::Wrong, &[Outcome::Missed], &["torque_lag:1"]),
            row(Outcome::Wrong, &[Outcome::Missed], &["backlash:1"]),
            row(Outcome::Missed, &[Outcome::Missed], &[]),
            failed.clone(),
        ];
        let summary = Summary::new(&rows);
        let answers: Vec<&str> = summary.confusion.iter().map(|entry| entry.answered.as_str()).collect();
        assert_eq!(answers, ["backlash", "nothing", "on another joint", "torque_lag"]);
        let single = summary.classes.iter().find(|class| class.class == Class::Single).unwrap();
        assert_eq!((single.right.hits, single.wrong_names.hits, single.right.of, single.failed), (1, 3, 4, 0));
        assert_eq!(summary.classes[0].failed, 1);
    }
}
