//! The whole way in one call: logs in, answer out.

use super::conclusion::conclude;
use super::diagnosis::Diagnosis;
use super::equations::{Observed, observed};
use super::mounting::refined_gravity;
use super::outcome::{Answer, Outcome};
use crate::diagnosis::Options;
use crate::diagnosis::logs::{
    CleanLogs, Consequence, DataFault, GivenLog, Input, Screened, all_faults, check_held_out, check_length, correct,
    refuse_twice, screen_all, screen_in_own_units, shared_verdict, still_joints,
};
use crate::diagnosis::watch::{Progress, Watch};
use crate::effects::Placed;
use crate::error::{Error, Result};
use crate::identification::effect_model::Trust;
use crate::identification::model::Model;
use crate::quality::descriptions::{self, Change, words};
use crate::quality::{Kind, UnitChanges};
use crate::robot::Robot;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

/// A diagnosis in the making, from [`Diagnosis::of`]. [`DiagnosisBuilder::run`] makes it.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use std::time::Duration;
/// use tauscope::diagnosis::Diagnosis;
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Ignored)?;
/// # let log = |name: &str| recording::load(format!("../tests/reference/pendulum/{name}.csv"), None);
/// # let (train, test) = (log("train")?, log("test")?);
///
/// // With a smaller alpha, two laws to look for, and a minute of time.
/// let question = Diagnosis::of(&robot).train([("monday.csv", &train)]).test([("tuesday.csv", &test)]);
/// let question = question.alpha(0.01).candidates(["torque_ripple", "backlash"]).budget(Duration::from_secs(60));
/// let answer = question.run()?;
/// assert_eq!(answer.alpha, 0.01);
/// assert!(answer.findings().iter().all(|finding| finding.effect == "torque_ripple"));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[must_use = "nothing is diagnosed before `run`"]
pub struct DiagnosisBuilder<'a> {
    robot: &'a Robot,
    train: Vec<GivenLog<'a>>,
    test: Vec<GivenLog<'a>>,
    reference: Vec<GivenLog<'a>>,
    present: Vec<Placed>,
    truth: Vec<Placed>,
    options: Options,
    corrects: bool,
    labels: [String; 3],
    watch: Watch<'a>,
}

impl Diagnosis {
    /// Begins a diagnosis of `robot`: what does its model miss? Give it logs, and [`run`](DiagnosisBuilder::run) it.
    ///
    /// The logs are screened first. Wrong columns, signs and units that are beyond doubt are corrected, samples that cannot
    /// be used are left out, joints without torque or motion are left out, and where a fault forbids an answer the
    /// diagnosis stops and reports it.
    ///
    /// ```no_run
    /// # extern crate tauscope_core as tauscope;
    /// use tauscope::diagnosis::{Diagnosis, Verdict};
    /// use tauscope::recording;
    /// use tauscope::robot::{self, InertiaCheck};
    ///
    /// let robot = robot::load("arm.urdf", InertiaCheck::Ignored)?;
    /// let [monday, tuesday] = ["monday.csv", "tuesday.csv"].map(|log| recording::load(log, None));
    ///
    /// let answer = Diagnosis::of(&robot).train([&monday?]).test([&tuesday?]).run()?;
    ///
    /// if answer.verdict() == Verdict::Named {
    ///     answer.findings().iter().for_each(|finding| println!("{} on {}", finding.effect, finding.joints.join(", ")));
    /// }
    /// # Ok::<(), tauscope::error::Error>(())
    /// ```
    pub fn of(robot: &Robot) -> DiagnosisBuilder<'_> {
        DiagnosisBuilder {
            robot,
            train: Vec::new(),
            test: Vec::new(),
            reference: Vec::new(),
            present: Vec::new(),
            truth: Vec::new(),
            options: Options::default(),
            corrects: true,
            labels: ["training logs", "test logs", "reference logs"].map(str::to_owned),
            watch: Watch::idle(),
        }
    }
}

impl<'a> DiagnosisBuilder<'a> {
    /// Adds logs to identify from. At least one is needed; two motions of 20 s are worth while.
    pub fn train<L: Into<GivenLog<'a>>>(mut self, logs: impl IntoIterator<Item = L>) -> Self {
        self.train.extend(logs.into_iter().map(L::into));
        self
    }

    /// Adds held-out logs of other motions. Default: parts of every training log.
    pub fn test<L: Into<GivenLog<'a>>>(mut self, logs: impl IntoIterator<Item = L>) -> Self {
        self.test.extend(logs.into_iter().map(L::into));
        self
    }

    /// Adds logs from before a change. The question is then what changed since.
    pub fn reference<L: Into<GivenLog<'a>>>(mut self, logs: impl IntoIterator<Item = L>) -> Self {
        self.reference.extend(logs.into_iter().map(L::into));
        self
    }

    /// Effects that the simulation of the arm has already.
    pub fn present(mut self, effects: impl IntoIterator<Item = Placed>) -> Self {
        self.present.extend(effects);
        self
    }

    /// Sets all options at once.
    pub fn options(mut self, options: Options) -> Self {
        self.options = options;
        self
    }

    /// Whether the inertias of the description are believed, or estimated. Default: estimated.
    pub fn trust(mut self, trust: Trust) -> Self {
        self.options.trust = trust;
        self
    }

    /// Family-wise false-alarm rate: probability of reporting any effect when the model is correct. Default: 0.05.
    pub fn alpha(mut self, alpha: f64) -> Self {
        self.options.alpha = alpha;
        self
    }

    /// Seed of all random numbers. Default: 0.
    pub fn seed(mut self, seed: u64) -> Self {
        self.options.seed = seed;
        self
    }

    /// Most effects that are reported. Default: 24.
    pub fn max_findings(mut self, count: usize) -> Self {
        self.options.max_findings = count;
        self
    }

    /// Names of the effects to look for. Default: all of the library.
    pub fn candidates<S: Into<String>>(mut self, names: impl IntoIterator<Item = S>) -> Self {
        self.options.candidates = names.into_iter().map(S::into).collect();
        self
    }

    /// Whether a description of the logs that is wrong beyond doubt is corrected. Default: it is; else the diagnosis stops.
    pub fn correct(mut self, corrects: bool) -> Self {
        self.corrects = corrects;
        self
    }

    /// Effects known to be at work, where logs are simulated: [`Conclusion::accounted_for`](super::Conclusion::accounted_for)
    /// compares what was found with them. The diagnosis does not see them.
    pub fn truth(mut self, effects: impl IntoIterator<Item = Placed>) -> Self {
        self.truth.extend(effects);
        self
    }

    /// What errors call training, test and reference logs.
    pub fn labels(mut self, labels: [String; 3]) -> Self {
        self.labels = labels;
        self
    }

    /// Receives how far it has come.
    pub fn progress(mut self, progress: impl FnMut(Progress) + 'a) -> Self {
        self.watch.report_to(progress);
        self
    }

    /// Ends the search after this time, counted from [`DiagnosisBuilder::run`]. What is known by then is the answer, marked as
    /// unfinished; judging it takes a little longer.
    pub fn budget(mut self, budget: Duration) -> Self {
        self.watch.end_after(budget);
        self
    }

    /// Ends the search in the same way once `stop` is raised.
    pub fn stop(mut self, stop: Arc<AtomicBool>) -> Self {
        self.watch.end_on(stop);
        self
    }

    /// Screens the logs and diagnoses the arm. Faults of the data that forbid an answer are an [`Outcome::Stopped`], no error.
    ///
    /// # Errors
    /// If there is no training log, a log cannot be used at all, is too short, is given twice, or does not fit the arm; an
    /// option out of range; a motion that leaves the parameters undetermined.
    pub fn run(self) -> Result<Answer> {
        let Examined { mut arm, logs, still, given, present, truth, options, mut watch } = self.examined()?;
        let outcome = if arm.is_stopped() {
            Outcome::Stopped
        } else {
            let input = logs.input(present);
            let model = arm.model(given, &input, &still, &options, &mut watch)?;
            let concluded = conclude(&model, &input, &options, &mut watch)?;
            Outcome::Concluded(Box::new(concluded.into_conclusion(&input.train, &truth)?))
        };
        let Described { robot, faults, description, units } = arm;
        Ok(Answer { robot, alpha: options.alpha, logs, faults, description, units, outcome })
    }

    /// Screens the logs.
    ///
    /// # Errors
    /// Those of the logs and of the options of [`DiagnosisBuilder::run`].
    pub(super) fn examined(self) -> Result<Examined<'a>> {
        let DiagnosisBuilder { robot: given, present, truth, options, labels, mut watch, .. } = self;
        watch.start();
        options.check()?;
        let mut robot = given.clone();
        let [train, test, reference] = [(self.train, "training"), (self.test, "test"), (self.reference, "reference")]
            .map(|(logs, kind)| {
                let named = |(k, log): (usize, GivenLog)| log.into_named(|| format!("{kind} log {}", k + 1));
                logs.into_iter().enumerate().map(named).collect::<Vec<_>>()
            });
        // Logs of one time are screened together.
        let screened = |logs| -> Result<(Vec<Screened>, UnitChanges)> {
            let (screened, units) = match self.corrects {
                true => screen_in_own_units(logs, given)?,
                false => (screen_all(logs, given)?, UnitChanges::default()),
            };
            Ok((screened.into_iter().collect::<Result<_>>()?, units))
        };
        let (mut reference, _) = screened(reference)?;
        let trained = train.len();
        let (mut train, units) = screened(train.into_iter().chain(test).collect())?;
        let mut test = train.split_off(trained);
        if train.is_empty() {
            return Err(Error::request(&*labels[0], "are missing; give at least one log to identify from"));
        }
        let [of_train, of_test, of_reference] = labels.each_ref().map(String::as_str);
        check_length(of_train, &train)?;
        check_held_out(of_test, &test)?;
        check_length(of_reference, &reference)?;
        refuse_twice([(of_train, &train), (of_test, &test), (of_reference, &reference)])?;

        let mut all: Vec<&mut Screened> = train.iter_mut().chain(&mut test).chain(&mut reference).collect();
        let description = shared_verdict(&all);
        if self.corrects {
            correct(&mut all, &mut robot);
        }
        let faults = all_faults(&train, &test, &reference, &robot);
        let still: Vec<usize> = still_joints(&train, &robot).into_iter().map(|(joint, _)| joint).collect();
        let [train, test, reference] =
            [train, test, reference].map(|logs| logs.into_iter().flat_map(|log| log.pieces).collect());
        let logs = CleanLogs { train, test, reference };
        let arm = Described { robot, faults, description, units };
        Ok(Examined { arm, logs, still, given, present, truth, options, watch })
    }
}

/// Screened logs, and what a diagnosis of them is asked.
pub(super) struct Examined<'a> {
    /// The arm as the logs show it.
    pub arm: Described,
    /// The logs as they are used.
    pub logs: CleanLogs,
    /// Joints that hardly move.
    pub still: Vec<usize>,
    /// The arm as it was given.
    pub given: &'a Robot,
    /// Effects that the simulation has.
    pub present: Vec<Placed>,
    /// Effects known to be at work.
    pub truth: Vec<Placed>,
    /// The options.
    pub options: Options,
    /// Who follows.
    pub watch: Watch<'a>,
}

/// An arm with its description corrected where logs show another beyond doubt.
pub(super) struct Described {
    /// The arm.
    pub robot: Robot,
    /// Faults of the data, those that stop first.
    pub faults: Vec<DataFault>,
    /// What is wrong with the description of all logs alike.
    pub description: Option<descriptions::Verdict>,
    /// Units that were converted.
    pub units: UnitChanges,
}

impl Described {
    /// Whether a fault forbids an answer.
    pub(super) fn is_stopped(&self) -> bool {
        self.faults.iter().any(|fault| fault.consequence == Consequence::Stops)
    }

    /// The model of the joints that have an equation in the logs of `input`; `given` is the arm as it was given, joints in `still` hardly
    /// move. A direction of gravity that was corrected is refined.
    ///
    /// # Errors
    /// If a log is too short or does not fit the arm.
    pub(super) fn model(
        &mut self,
        given: &Robot,
        input: &Input,
        still: &[usize],
        options: &Options,
        watch: &mut Watch,
    ) -> Result<Model> {
        let observe = |robot: &Robot| observed(robot, input, still, options.criteria.levels.misfit);
        let Observed { mut model, left_out } = observe(&self.robot)?;
        self.faults.extend(left_out);
        watch.tell(Progress::Screened);
        // A direction of gravity that was corrected is an axis of the base, and bases are not exactly level.
        if self.robot.gravity != given.gravity
            && let Some(gravity) = refined_gravity(&model, input, options)?
        {
            self.robot.gravity = gravity;
            if let Some(verdict) = &mut self.description {
                verdict.description = verdict.description.with_gravity(gravity);
            }
            let words = format!("; refined by the diagnosis: {}", words(Change::Gravity(gravity.into()), &[]));
            let mountings = self.faults.iter_mut().filter(|fault| fault.kind == Kind::Mounting);
            mountings.for_each(|fault| fault.text.push_str(&words));
            Observed { model, .. } = observe(&self.robot)?;
        }
        Ok(model)
    }
}
