//! A blind run as a line of a file: what was hidden, what was answered, how it was weighed.

use super::blind_run::BlindRun;
use super::case::{ArmKind, Case, Class, MotionKind};
use super::fault::Fault;
use super::outcome::{ALL_INERTIAS, Outcome, text};
use crate::diagnosis::{Family, Verdict};
use crate::effects::{Placed, Scope};
use crate::error::Result;
use crate::identification::effect_model::Trust;
use serde::{Deserialize, Serialize};

/// One run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Row {
    /// Its place in the plan: `--run` repeats it.
    pub run: usize,
    /// What kind of thing it hides.
    pub class: Class,
    /// Seed of all that was drawn.
    pub seed: u64,
    /// The arm.
    pub arm: ArmKind,
    /// Its motions.
    pub motion: MotionKind,
    /// Whether the logs are cut out of longer motions.
    pub cut: bool,
    /// Whether the inertias were taken from the description.
    pub inertias_believed: bool,
    /// Correlation time of the torque noise, s.
    pub correlation_s: f64,
    /// Size of what is hidden over the noise.
    pub severity: f64,
    /// The effects hidden.
    pub hidden: Vec<Hidden>,
    /// The fault put into the logs.
    pub fault: Option<Fault>,
    /// How it came out; None where the run could not be made.
    pub outcome: Option<Outcome>,
    /// How each hidden effect came out.
    pub each: Vec<Outcome>,
    /// What was answered.
    pub answers: Vec<Answer>,
    /// Named effects that were not hidden.
    pub wrong: Vec<String>,
    /// Joints of which something is left unexplained, counted from 1, and what it follows.
    pub unexplained: Vec<(usize, String)>,
    /// Faults of the data that were found.
    pub faults: Vec<String>,
    /// Errors of estimated parameters in their standard deviations.
    pub errors: Vec<f64>,
    /// Share of the gap to the noise floor that the answer reports to close on the held-out log.
    pub gap_closed: Option<f64>,
    /// Share of what is hidden that the extended model adds to the held-out torque too.
    pub accounted_for: Option<f64>,
    /// How often the best of all tests would name each hidden effect.
    pub power: Vec<f64>,
    /// The same with measured positions.
    #[serde(default)]
    pub power_as_measured: Vec<f64>,
    /// Time of the diagnosis, s.
    pub seconds: f64,
    /// Why the run could not be made.
    pub error: Option<String>,
}

/// An effect that was hidden.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Hidden {
    /// Its name.
    pub effect: String,
    /// Its joint, counted from 1 (the first of a pair); None for the whole arm.
    pub joint: Option<usize>,
    /// Its parameters.
    pub parameters: Vec<f64>,
}

/// A finding.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Answer {
    /// `named`, `one_of`, or `unexplained` for a name that was taken back.
    pub verdict: String,
    /// Its names with their joints, the best first.
    pub names: Vec<String>,
    /// Parameters of the best.
    pub parameters: Vec<f64>,
    /// Their standard deviations; None where the logs do not determine them.
    pub std: Vec<Option<f64>>,
    /// Probability of as good a best candidate without any effect.
    pub family_wise_p: Option<f64>,
}

impl Row {
    /// The line of a run, made or failed.
    pub(crate) fn new(case: &Case, run: &Result<BlindRun>) -> Self {
        let hidden = run.as_ref().map_or(&case.hidden, |run| &run.hidden);
        let row = Row {
            run: case.index,
            class: case.class,
            seed: case.seed,
            arm: case.arm,
            motion: case.motion,
            cut: case.cut,
            inertias_believed: case.trust == Trust::Nominal,
            correlation_s: case.correlation_s,
            severity: case.severity,
            hidden: hidden.iter().map(Hidden::of).collect(),
            fault: case.fault,
            outcome: None,
            each: Vec::new(),
            answers: Vec::new(),
            wrong: Vec::new(),
            unexplained: Vec::new(),
            faults: Vec::new(),
            errors: Vec::new(),
            gap_closed: None,
            accounted_for: None,
            power: Vec::new(),
            power_as_measured: Vec::new(),
            seconds: 0.0,
            error: None,
        };
        match run {
            Ok(run) => row.of(run),
            Err(error) => Row { error: Some(error.to_string()), ..row },
        }
    }

    fn of(self, run: &BlindRun) -> Self {
        let diagnosis = run.diagnosis.as_ref();
        let mut faults: Vec<String> = run.faults.iter().map(|fault| format!("{:?}", fault.kind)).collect();
        faults.dedup();
        let left = diagnosis.iter().flat_map(|diagnosis| &diagnosis.unexplained);
        Row {
            outcome: Some(run.judgement.outcome),
            each: run.judgement.each.clone(),
            answers: answers(run),
            wrong: run.judgement.wrong.clone(),
            unexplained: left.map(|left| (left.joint + 1, left.structure.to_owned())).collect(),
            faults,
            errors: run.judgement.errors.clone(),
            gap_closed: diagnosis.map(|diagnosis| diagnosis.errors.gap_closed.value),
            accounted_for: run.accounted_for,
            power: run.power.clone(),
            power_as_measured: run.power_as_measured.clone(),
            seconds: run.seconds,
            ..self
        }
    }

    /// What was hidden, for tables.
    pub(crate) fn hidden_text(&self) -> String {
        match (&self.fault, &self.hidden[..]) {
            (Some(fault), _) => fault.name().to_owned(),
            (None, []) => "nothing".to_owned(),
            (None, hidden) => hidden.iter().map(Hidden::text).collect::<Vec<_>>().join(" and "),
        }
    }
}

impl Hidden {
    fn of(placed: &Placed) -> Self {
        let about = placed.effect.about();
        let joint = (about.scope != Scope::Arm).then_some(placed.joint + 1);
        Hidden { effect: about.name.to_owned(), joint, parameters: placed.parameters.clone() }
    }

    /// With its joint.
    pub(crate) fn text(&self) -> String {
        self.joint.map_or(self.effect.clone(), |joint| format!("{}:{joint}", self.effect))
    }
}

fn answers(run: &BlindRun) -> Vec<Answer> {
    let Some(diagnosis) = &run.diagnosis else { return Vec::new() };
    let named = |family: Family| {
        let scope = crate::effects::find(family.effect).map(|effect| effect.about().scope);
        if matches!(scope, Ok(Scope::Arm)) { family.effect.to_owned() } else { text(family) }
    };
    let mut answers: Vec<Answer> = diagnosis
        .found
        .iter()
        .map(|found| {
            let others = found.alternatives.iter().map(|other| other.family);
            let families = [found.member.candidate.family()].into_iter().chain(others);
            let verdict = match found.verdict {
                Verdict::Named => "named",
                Verdict::OneOf => "one_of",
                _ => "unexplained",
            };
            Answer {
                verdict: verdict.to_owned(),
                names: families.map(named).collect(),
                parameters: found.member.placed.parameters.clone(),
                std: found.member.std.iter().map(|std| std.is_finite().then_some(*std)).collect(),
                family_wise_p: Some(found.family_wise_p),
            }
        })
        .collect();
    if diagnosis.inertias.is_some() {
        answers.push(Answer {
            verdict: "named".to_owned(),
            names: vec![ALL_INERTIAS.to_owned()],
            parameters: Vec::new(),
            std: Vec::new(),
            family_wise_p: None,
        });
    }
    answers
}
