//! The answer of a blind run against what was hidden.

use super::case::{Case, Class};
use crate::diagnosis::{Consequence, DataFault, Diagnosis, Family, Found, Verdict};
use crate::effects::Placed;

/// Most names of a set that counts as an answer.
const SMALL_SET: usize = 2;

/// What re-identified inertias are called among the names.
pub(crate) const ALL_INERTIAS: &str = "all_inertias";

/// How a blind run came out.
///
/// ```
/// use tauscope::study::blind::Outcome;
///
/// // Naming what was hidden is right, and so is naming nothing where nothing was.
/// let right: Vec<Outcome> = Outcome::ALL.into_iter().filter(|outcome| outcome.is_right()).collect();
/// assert!(right.contains(&Outcome::Named) && right.contains(&Outcome::Quiet));
/// assert!(!right.contains(&Outcome::Wrong) && !right.contains(&Outcome::FalseAlarm));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// All that was hidden was named, on its joint; or the fault of the data was.
    Named,
    /// It is one of two names.
    OneOf,
    /// It is one of more names.
    WideSet,
    /// One of two hidden effects was named or is one of two names.
    Half,
    /// No effect was named without alternatives.
    Missed,
    /// Something else was named without alternatives, and what was hidden was not.
    Wrong,
    /// A law outside the library is reported as unexplained on its joint, and no effect is named without alternatives.
    Flagged,
    /// Nothing was hidden and nothing named.
    Quiet,
    /// Nothing was hidden and something named.
    FalseAlarm,
}

impl Outcome {
    /// All of them.
    pub const ALL: [Outcome; 9] = [
        Outcome::Named,
        Outcome::OneOf,
        Outcome::WideSet,
        Outcome::Half,
        Outcome::Missed,
        Outcome::Wrong,
        Outcome::Flagged,
        Outcome::Quiet,
        Outcome::FalseAlarm,
    ];

    /// Whether it is what was asked of the diagnosis.
    pub fn is_right(self) -> bool {
        matches!(self, Outcome::Named | Outcome::OneOf | Outcome::Flagged | Outcome::Quiet)
    }
}

/// The answer weighed.
///
/// ```
/// use tauscope::scenario::Setup;
/// use tauscope::study::blind::{self, Case, Outcome};
///
/// // Nothing was hidden, nothing was named, and so nothing wrong.
/// let setup = Setup::load("tests/scenarios/pendulum.toml", None)?;
/// let judgement = blind::run(&setup, &Case::plain(7))?.judgement;
/// assert_eq!((judgement.outcome, judgement.wrong.len()), (Outcome::Quiet, 0));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Judgement {
    /// The outcome of the run as a whole.
    pub outcome: Outcome,
    /// The outcome of every hidden effect.
    pub each: Vec<Outcome>,
    /// Named effects that were not hidden, with the right ones or in place of them.
    pub wrong: Vec<String>,
    /// Errors of the estimated parameters of hidden effects, in their standard deviations.
    pub errors: Vec<f64>,
}

/// Weighs the answer to `case`, whose effects were hidden at the sizes of `hidden`.
pub(crate) fn judge(case: &Case, hidden: &[Placed], faults: &[DataFault], diagnosis: Option<&Diagnosis>) -> Judgement {
    let stopped = faults.iter().any(|fault| fault.consequence == Consequence::Stops);
    let found: &[Found] = diagnosis.map_or(&[], |diagnosis| &diagnosis.found);
    let inertias = diagnosis.is_some_and(|diagnosis| diagnosis.inertias.is_some());
    let names = usize::from(inertias) + found.iter().filter(|one| one.verdict != Verdict::Unexplained).count();
    let library = if case.class == Class::Outside { &[] } else { hidden };
    let (each, used, errors) = weigh(library, found);
    let others = found.iter().enumerate().filter(|(index, one)| one.verdict == Verdict::Named && !used.contains(index));
    let mut wrong: Vec<String> = others.map(|(_, one)| text(one.member.candidate.family())).collect();
    if inertias {
        wrong.push(ALL_INERTIAS.to_owned());
    }
    if stopped && case.fault.is_none() {
        wrong.extend(
            faults
                .iter()
                .filter(|fault| fault.consequence == Consequence::Stops)
                .map(|fault| format!("data fault {:?}", fault.kind)),
        );
    }
    let outcome = match (case.fault, case.class, &each[..]) {
        (Some(fault), ..) => match (names > 0, faults.iter().any(|found| found.kind == fault.kind())) {
            (true, _) => Outcome::Wrong,
            (false, true) => Outcome::Named,
            (false, false) => Outcome::Missed,
        },
        (None, Class::Outside, _) => {
            let joint = hidden.first().map(|placed| placed.joint);
            let left = diagnosis.iter().flat_map(|diagnosis| &diagnosis.unexplained);
            let flagged = left.into_iter().any(|left| Some(left.joint) == joint);
            match (wrong.is_empty(), flagged) {
                (false, _) => Outcome::Wrong,
                (true, true) => Outcome::Flagged,
                (true, false) => Outcome::Missed,
            }
        }
        (None, _, []) if names == 0 && !stopped => Outcome::Quiet,
        (None, _, []) => Outcome::FalseAlarm,
        (None, _, each) => overall(each, !wrong.is_empty()),
    };
    Judgement { outcome, each, wrong, errors }
}

/// Outcome of each hidden effect, which findings it used up, and errors of parameters.
fn weigh(hidden: &[Placed], found: &[Found]) -> (Vec<Outcome>, Vec<usize>, Vec<f64>) {
    let (mut each, mut used, mut errors) = (Vec::new(), Vec::new(), Vec::new());
    for placed in hidden {
        let family = Family { effect: placed.effect.about().name, joint: placed.joint };
        let holds = |one: &Found| {
            one.member.candidate.family() == family || one.alternatives.iter().any(|other| other.family == family)
        };
        let is_same =
            |(index, one): &(usize, &Found)| one.verdict != Verdict::Unexplained && !used.contains(index) && holds(one);
        let Some((index, one)) = found.iter().enumerate().find(is_same) else {
            each.push(Outcome::Missed);
            continue;
        };
        used.push(index);
        each.push(match (one.verdict, 1 + one.alternatives.len()) {
            (Verdict::Named, _) => Outcome::Named,
            (_, names) if names <= SMALL_SET => Outcome::OneOf,
            _ => Outcome::WideSet,
        });
        if one.member.candidate.family() == family {
            let values = one.member.placed.parameters.iter().zip(&one.member.std).zip(&placed.parameters);
            errors.extend(
                values
                    .filter(|((_, std), _)| **std > 0.0 && std.is_finite())
                    .map(|((value, std), truth)| (value - truth) / std),
            );
        }
    }
    (each, used, errors)
}

/// Outcome of a run from those of its hidden effects; `wrong` is whether something else was named.
fn overall(each: &[Outcome], wrong: bool) -> Outcome {
    let held = each.iter().filter(|outcome| matches!(outcome, Outcome::Named | Outcome::OneOf)).count();
    let all = |wanted: Outcome| each.iter().all(|outcome| *outcome == wanted);
    match (held == each.len(), each.contains(&Outcome::WideSet)) {
        (true, _) if all(Outcome::Named) => Outcome::Named,
        (true, _) => Outcome::OneOf,
        (false, _) if wrong && each.contains(&Outcome::Missed) => Outcome::Wrong,
        (false, _) if held > 0 => Outcome::Half,
        (false, true) => Outcome::WideSet,
        (false, false) => Outcome::Missed,
    }
}

/// A name with its joint, counted from 1.
pub(crate) fn text(family: Family) -> String {
    format!("{}:{}", family.effect, family.joint + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pair_is_as_good_as_its_worse_half() {
        use Outcome::*;
        for (each, wrong, outcome) in [
            ([Named, Named], false, Named),
            ([Named, Named], true, Named),
            ([Named, OneOf], false, OneOf),
            ([Named, Missed], false, Half),
            ([Named, Missed], true, Wrong),
            ([WideSet, WideSet], false, WideSet),
            ([OneOf, WideSet], true, Half),
            ([Missed, Missed], false, Missed),
        ] {
            assert_eq!(overall(&each, wrong), outcome, "{each:?} {wrong}");
        }
        assert_eq!(overall(&[Missed], true), Wrong);
        assert!(Named.is_right() && OneOf.is_right() && !WideSet.is_right() && !Half.is_right());
    }
}
