//! The whole way in one call: logs before and after in, load out.

use super::answer::{Changed, Estimator, Other, Payload, Quantity, SCALED_BY, Verdict};
use super::controllers::Controllers;
use super::determined::{Determined, determined};
use super::equations::{CHANGES, Change, Equations, all_rows, baseline, differences};
use super::estimate::{Estimate, Estimates, Fitting, MATTERS};
use super::expected::Expected;
use super::load_columns::LoadColumns;
use super::rows::LogRows;
use super::shares::{shares, sized};
use crate::error::{Error, Result};
use crate::identification::equal_states::{EqualState, matched};
use crate::identification::equations::{no_torque, with_torque};
use crate::identification::model::Model;
use crate::linear::root_mean_square;
use crate::recording::Recording;
use crate::robot::{PARAMETERS, Robot, Unit};
use nalgebra::DMatrix;

/// Length of a block, s: longer than filters and most of what a model lacks stay alike.
const BLOCK_S: f64 = 1.0;

/// Most blocks of all logs; they get longer where the logs are long.
const MOST_BLOCKS: f64 = 240.0;

/// Fewest blocks that standard errors between them can come from.
const FEWEST_BLOCKS: usize = 8;

/// Share of the rows after a change that must have an equal state before, so that differences are worth while: below it they see
/// only a part of the motion.
const MATCHED: f64 = 0.5;

/// Fewest rows of a joint that count.
const FEWEST_ROWS: usize = 30;

/// A question for the load between logs, from [`Payload::between`]. [`PayloadBuilder::run`] answers it.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::payload::Expected;
/// # use tauscope::payload::Payload;
/// # use tauscope::robot::{self, InertiaCheck};
/// # use tauscope::recording;
/// # let robot = robot::load("../tests/reference/payload/arm.urdf", InertiaCheck::Ignored)?;
/// # let log = |name: &str| recording::load(format!("../tests/reference/payload/{name}.csv"), None);
///
/// // The load that was put on the tool flange, and should weigh 1.5 kg.
/// let (before, after) = (log("before")?, log("after")?);
/// let question = Payload::between(&robot).before([&before]).after([&after]);
/// let load = question.frame("tool0").expected(Expected::mass(1.5)?).run()?;
/// assert!(load.is_as_expected() && load.frame == "tool0");
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[must_use = "no load is found before `run`"]
#[derive(Debug)]
pub struct PayloadBuilder<'a> {
    robot: &'a Robot,
    before: Vec<&'a Recording>,
    after: Vec<&'a Recording>,
    frame: String,
    expected: Option<Expected>,
}

impl Payload {
    /// Begins the question which load was added to `robot` between logs. The load hangs on the robot's flange; masses of the
    /// robot's description play no part.
    ///
    /// ```
    /// # extern crate tauscope_core as tauscope;
    /// use tauscope::payload::Payload;
    /// use tauscope::recording;
    /// use tauscope::robot::{self, InertiaCheck};
    ///
    /// let robot = robot::load("../tests/reference/payload/arm.urdf", InertiaCheck::Ignored)?;
    /// let before = recording::load("../tests/reference/payload/before.csv", None)?;
    /// let after = recording::load("../tests/reference/payload/after.csv", None)?;
    ///
    /// let load = Payload::between(&robot).before([&before]).after([&after]).run()?;
    ///
    /// let mass = load.mass_kg.expect("the motions determine it");
    /// assert!((mass.value - 1.5).abs() < 3.0 * mass.standard_error);
    /// # Ok::<(), tauscope::error::Error>(())
    /// ```
    pub fn between(robot: &Robot) -> PayloadBuilder<'_> {
        let frame = "flange".to_owned();
        PayloadBuilder { robot, before: Vec::new(), after: Vec::new(), frame, expected: None }
    }
}

impl<'a> PayloadBuilder<'a> {
    /// Adds logs without the load, at even steps.
    pub fn before(mut self, logs: impl IntoIterator<Item = &'a Recording>) -> Self {
        self.before.extend(logs);
        self
    }

    /// Adds logs with it.
    pub fn after(mut self, logs: impl IntoIterator<Item = &'a Recording>) -> Self {
        self.after.extend(logs);
        self
    }

    /// What the frame of the robot's flange is called.
    pub fn frame(mut self, name: impl Into<String>) -> Self {
        self.frame = name.into();
        self
    }

    /// The load that is expected, if any.
    pub fn expected(mut self, expected: impl Into<Option<Expected>>) -> Self {
        self.expected = expected.into();
        self
    }

    /// Finds the load.
    ///
    /// # Errors
    /// No log before or after, logs of other joints, logs too short or without motion, a load that was taken off.
    pub fn run(self) -> Result<Payload> {
        self.check()?;
        let mut notes = Vec::new();
        let (model, before, after) = self.rows(&mut notes)?;
        let length: f64 = self.before.iter().chain(&self.after).map(|log| log.duration()).sum();
        let block_s = BLOCK_S.max(length / MOST_BLOCKS);
        let torque = torques(&model, &before, &after);
        let [states_before, states_after] =
            [&before, &after].map(|logs| logs.iter().map(|log| &log.states).collect::<Vec<_>>());
        let matched = matched(&states_before, &states_after);
        let share = matched_share(&model, (&before, &after), &matched);
        let joint_fit = all_rows(&model, &before, &after, block_s);
        let mut candidates = vec![candidate(Estimator::JointFit, joint_fit, &torque, &after)];
        if share >= MATCHED {
            let arm = baseline(&model, &before, block_s);
            let equations = differences(&model, (&before, &after), &matched, &arm, block_s);
            candidates.push(candidate(Estimator::Difference, equations, &torque, &after));
        }
        candidates.retain(|candidate| candidate.estimates.changed.blocks >= FEWEST_BLOCKS);
        candidates.sort_by(|a, b| a.uncertainty.total_cmp(&b.uncertainty));
        if candidates.is_empty() {
            let problem = format!(
                "they last too short: standard errors need {FEWEST_BLOCKS} blocks of {block_s:.0} s in which the arm moves"
            );
            return Err(Error::request("the logs", problem));
        }
        let mut candidates = candidates.into_iter();
        let (Some(best), other) = (candidates.next(), candidates.next()) else { unreachable!("there is one") };
        self.answer(best, other, share, (torque, notes))
    }

    fn check(&self) -> Result<()> {
        for (logs, name) in [(&self.before, "BEFORE"), (&self.after, "AFTER")] {
            if logs.is_empty() {
                return Err(Error::request(name, "give at least one log"));
            }
            let names = self.robot.joint_names();
            if let Some(log) = logs.iter().find(|log| log.joints != names) {
                let problem =
                    format!("its joints {} are not those of the arm, {}", log.joints.join(", "), names.join(", "));
                return Err(Error::request(name, problem));
            }
        }
        Ok(())
    }

    /// The rows of the logs, for the joints whose torque is logged and that move.
    fn rows(&self, notes: &mut Vec<String>) -> Result<(Model, Vec<LogRows>, Vec<LogRows>)> {
        let all = || self.before.iter().chain(&self.after).copied();
        let mut equations = with_torque(self.robot.dof(), all());
        let names = self.robot.joint_names();
        for (joint, _) in equations.iter().enumerate().filter(|(_, has)| !**has) {
            notes.push(format!("joint `{}`: {}", names[joint], no_torque()));
        }
        loop {
            if equations.iter().all(|has| !has) {
                return Err(Error::request("the logs", "no joint moves with a torque that is logged"));
            }
            let model = Model::with_equations(self.robot, &equations);
            let load = LoadColumns::new(self.robot, &equations);
            let rows = |logs: &[&Recording]| -> Result<Vec<LogRows>> {
                logs.iter().map(|log| LogRows::new(log, &model, &load)).collect()
            };
            let (before, after) = (rows(&self.before)?, rows(&self.after)?);
            let moves = |logs: &[LogRows], joint: usize| {
                logs.iter().map(|log| log.arm[joint].rows()).sum::<usize>() >= FEWEST_ROWS
            };
            let still = |joint: &usize| equations[*joint] && !(moves(&before, *joint) && moves(&after, *joint));
            let standing: Vec<usize> = (0..equations.len()).filter(still).collect();
            if standing.is_empty() {
                return Ok((model, before, after));
            }
            for joint in standing {
                equations[joint] = false;
                notes.push(format!(
                    "joint `{}` hardly moves before or after: stiction hides what its torque shows, which is left out",
                    names[joint]
                ));
            }
        }
    }

    fn answer(
        &self,
        best: Candidate,
        other: Option<Candidate>,
        matched_share: f64,
        (torque, mut notes): (Vec<f64>, Vec<String>),
    ) -> Result<Payload> {
        let reach = self.robot.reach();
        let read = |candidate: &Candidate, estimate: &Estimate| {
            let matters = sized(&candidate.equations, estimate)
                .iter()
                .zip(&torque)
                .any(|(load, torque)| *load > MATTERS * torque && *load > 0.0);
            determined(estimate, reach, matters)
        };
        let (mut used, mut found) = (&best.estimates.changed, read(&best, &best.estimates.changed));
        let alone = read(&best, &best.estimates.plain);
        if (found.taken_off || found.verdict == Verdict::NoBody) && alone.verdict == Verdict::Load && !alone.taken_off {
            // Changes that leave no possible body are wrong torque constants in another guise.
            notes.push(format!(
                "{} would differ between the logs as well, but what that leaves is no body's torque: the load alone is given; torque \
                 constants that differ between the joints look like that",
                listed(&self.changed(used))
            ));
            (used, found) = (&best.estimates.plain, alone);
        }
        if found.taken_off {
            let mass = found.raw_mass.map_or(0.0, |mass| -mass.value);
            let problem = format!("a load of {mass:.3} kg was taken off between them; give them in the other order");
            return Err(Error::request("BEFORE and AFTER", problem));
        }
        let free = read(&best, &best.estimates.free_offsets);
        let found = if free.verdict == Verdict::NoLoad && !free.taken_off { found.or_offsets() } else { found };
        let found = if best.estimator == Estimator::JointFit { found.without_inertia() } else { found };
        let Determined { mut words, body, .. } = found.clone();
        let changed = self.changed(used);
        if !changed.is_empty() && found.mass.is_none() {
            // What is not separable from offsets is stated, not printed as a number of its own.
            if let Some(mass) = read(&best, &best.estimates.plain).mass {
                words.push(format!(
                    "with {} free to change, torques of the load and of the joints are not separated; if nothing but the load changed, \
                     it weighs {:.3} +- {:.3} kg",
                    listed(&changed),
                    mass.value,
                    mass.standard_error
                ));
            }
        }
        let joints = shares(self.robot, &best.equations, used);
        notes.extend(found.notes);
        notes.extend(found.mass.and_then(|mass| offsets(&mass, &free)));
        notes.extend(super::shares::disagreement(&joints));
        let controllers = body.map(|(mass, center, inertia)| Controllers::new(mass, center, inertia));
        let other = other.map(|other| Other {
            estimator: other.estimator,
            mass_kg: read(&other, &other.estimates.changed).mass,
            uncertainty: other.uncertainty,
        });
        let mut payload = Payload {
            robot: self.robot.name.clone(),
            frame: self.frame.clone(),
            logs: [self.before.len(), self.after.len()],
            verdict: found.verdict,
            estimator: best.estimator,
            matched_share,
            blocks: used.blocks,
            uncertainty: best.uncertainty,
            mass_kg: found.mass,
            mass_below_kg: found.mass_below,
            center_m: found.center,
            inertia_kg_m2: found.inertia,
            first_moment_kg_m: found.first_moment,
            inertia_about_frame_kg_m2: found.inertia_about_frame,
            not_determined: words,
            changed,
            joints,
            mass_with_free_offsets_kg: free.mass,
            other,
            scaled_by: SCALED_BY,
            notes,
            expected: None,
            controllers: controllers.filter(|_| found.verdict == Verdict::Load),
            raw_mass: found.raw_mass,
        };
        payload.expected = self.expected.map(|expected| expected.compare(&payload));
        Ok(payload)
    }

    fn changed(&self, estimate: &Estimate) -> Vec<Changed> {
        let change = |&(joint, kind, value, standard_error): &(usize, usize, f64, f64)| {
            let (spec, what) = (&self.robot.joints[joint], CHANGES[kind]);
            let unit = spec.kind.unit(if what == Change::Viscous { Unit::Damping } else { Unit::Effort });
            Changed { joint: spec.name.clone(), what, change: Quantity { value, standard_error }, unit }
        };
        estimate.changes.iter().map(change).collect()
    }
}

/// One estimator's result.
struct Candidate {
    estimator: Estimator,
    equations: Equations,
    estimates: Estimates,
    /// Root mean square of the uncertainty of the load's torque.
    uncertainty: f64,
}

fn candidate(estimator: Estimator, equations: Equations, torque: &[f64], after: &[LogRows]) -> Candidate {
    let estimates = Fitting::new(&equations, torque).run();
    let uncertainty = uncertainty(&estimates.changed, after);
    Candidate { estimator, equations, estimates, uncertainty }
}

/// Root mean square over the rows after, of all joints, of the uncertainty of the load's torque.
fn uncertainty(estimate: &Estimate, after: &[LogRows]) -> f64 {
    let (mut gram, mut rows) = (DMatrix::zeros(PARAMETERS, PARAMETERS), 0usize);
    for (arm, load) in after.iter().flat_map(|log| log.arm.iter().zip(&log.load)) {
        if load.channels() == 0 {
            continue;
        }
        let table =
            DMatrix::from_fn(
                load.samples(),
                PARAMETERS,
                |row, k| {
                    if arm.valid[row] { load.channel(k)[row] } else { 0.0 }
                },
            );
        gram += table.tr_mul(&table);
        rows += arm.rows();
    }
    ((gram * &estimate.covariance).trace() / rows.max(1) as f64).max(0.0).sqrt()
}

/// Root mean square of each joint's torque in the valid rows.
fn torques(model: &Model, before: &[LogRows], after: &[LogRows]) -> Vec<f64> {
    let of = |joint: usize| {
        let logs = before.iter().chain(after).map(|log| &log.arm[joint]);
        let rows = logs.flat_map(|own| own.torque.iter().zip(&own.valid).filter_map(|(tau, ok)| ok.then_some(*tau)));
        root_mean_square(&rows.collect::<Vec<_>>())
    };
    (0..model.dof()).map(of).collect()
}

/// Share of the rows after that count on some joint and have an equal state before.
fn matched_share(model: &Model, (before, after): (&[LogRows], &[LogRows]), matched: &[Vec<EqualState>]) -> f64 {
    let (mut with, mut all) = (0usize, 0usize);
    for (log, matched) in after.iter().zip(matched) {
        for (row, there) in matched.iter().enumerate() {
            for joint in (0..model.dof()).filter(|&joint| log.arm[joint].valid[row]) {
                all += 1;
                with += usize::from(there.is_some_and(|(other, there)| before[other].arm[joint].valid[there]));
            }
        }
    }
    with as f64 / all.max(1) as f64
}

/// A sentence on what a mass owes to offsets that stay.
fn offsets(mass: &Quantity, free: &Determined) -> Option<String> {
    /// Standard errors of the freer fit by which both may differ.
    const DEVIATIONS: f64 = 3.0;
    match free.mass {
        Some(other) if (other.value - mass.value).abs() <= DEVIATIONS * other.standard_error.max(mass.standard_error) => None,
        Some(other) => Some(format!(
            "with a free torque offset at every joint the mass would be {:.3} +- {:.3} kg",
            other.value, other.standard_error
        )),
        None => Some(
            "with a free torque offset at every joint these logs would not determine the mass: it holds if offsets stayed as they were; move \
             the arm through more attitudes"
                .into(),
        ),
    }
}

/// What changed, in words.
fn listed(changed: &[Changed]) -> String {
    let name = |change: &Changed| {
        let what = match change.what {
            Change::Offset => "the torque offset",
            Change::Viscous => "viscous friction",
            Change::Coulomb => "Coulomb friction",
        };
        format!("{what} of {}", change.joint)
    };
    changed.iter().map(name).collect::<Vec<_>>().join(" and ")
}
