//! The whole way in one call: logs in, identified arm out.

use super::identified::{Identification, Progress};
use super::wanted::{Wanted, placed, separable};
use crate::error::{Error, Result};
use crate::identification::consistent::consistent;
use crate::identification::effect_model::{Preparation, Trust, goes_on};
use crate::identification::equations;
use crate::identification::fit::{Logs, fit_effects_until};
use crate::recording::Recording;
use crate::robot::Robot;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// An identification in the making, from [`Identification::of`]. [`IdentificationBuilder::run`] makes it.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::identification::Identification;
/// use tauscope::identification::effect_model::Trust;
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/payload/arm.urdf", InertiaCheck::Ignored)?;
/// # let log = |name: &str| recording::load(format!("../tests/reference/payload/{name}.csv"), None);
/// # let (monday, tuesday) = (log("before")?, log("nothing")?);
///
/// // With the inertias of the description believed, and an effect on one joint.
/// let question = Identification::of(&robot).train([&monday]).test([&tuesday]);
/// let found = question.trust(Trust::Nominal).effects(["torque_ripple:j2"]).run()?;
/// let with_effects = found.with_effects.as_ref().expect("an effect was asked for");
/// assert!(with_effects.test_rms[1] < 0.8 * found.without_effects.test_rms[1]);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[must_use = "nothing is identified before `run`"]
pub struct IdentificationBuilder<'a> {
    robot: &'a Robot,
    train: Vec<&'a Recording>,
    test: Vec<&'a Recording>,
    wanted: Vec<Wanted>,
    trust: Trust,
    preparation: Option<Preparation>,
    progress: Box<dyn FnMut(Progress) + 'a>,
    stop: Option<Arc<AtomicBool>>,
}

impl Identification {
    /// Begins an identification of `robot`: its base parameters, friction and rotors, and named effects. Give it logs, and
    /// [`run`](IdentificationBuilder::run) it.
    ///
    /// The logs are taken as they are: in SI units at the joints, at even steps. [`dataset::ready`](crate::dataset::ready) makes logs of
    /// files so.
    ///
    /// ```no_run
    /// # extern crate tauscope_core as tauscope;
    /// use tauscope::identification::Identification;
    /// use tauscope::recording;
    /// use tauscope::robot::{self, InertiaCheck};
    ///
    /// let robot = robot::load("arm.urdf", InertiaCheck::Ignored)?;
    /// let (monday, tuesday) = (recording::load("monday.csv", None)?, recording::load("tuesday.csv", None)?);
    ///
    /// let found = Identification::of(&robot).train([&monday]).test([&tuesday]).run()?;
    ///
    /// println!("{}", robot::with_parameters(&found.robot)?);
    /// # Ok::<(), tauscope::error::Error>(())
    /// ```
    pub fn of(robot: &Robot) -> IdentificationBuilder<'_> {
        IdentificationBuilder {
            robot,
            train: Vec::new(),
            test: Vec::new(),
            wanted: Vec::new(),
            trust: Trust::Structure,
            preparation: None,
            progress: Box::new(|_| ()),
            stop: None,
        }
    }
}

impl<'a> IdentificationBuilder<'a> {
    /// Adds logs to identify from. At least one is needed.
    pub fn train(mut self, logs: impl IntoIterator<Item = &'a Recording>) -> Self {
        self.train.extend(logs);
        self
    }

    /// Adds held-out logs of other motions, which the fit does not see. Default: none, and no held-out residuals.
    pub fn test(mut self, logs: impl IntoIterator<Item = &'a Recording>) -> Self {
        self.test.extend(logs);
        self
    }

    /// Adds effects to fit together with the arm's parameters: names of the library, as `stribeck_friction` for every joint or
    /// `stribeck_friction:joint_2` for one, or [`Placed`](crate::effects::Placed) laws. Default: none.
    pub fn effects<E: Into<Wanted>>(mut self, effects: impl IntoIterator<Item = E>) -> Self {
        self.wanted.extend(effects.into_iter().map(E::into));
        self
    }

    /// Whether the inertias of the description are believed, or estimated. Default: estimated.
    pub fn trust(mut self, trust: Trust) -> Self {
        self.trust = trust;
        self
    }

    /// How the logs are smoothed. Default: [`Preparation::of_noise`] of the first training log, as of the command.
    pub fn preparation(mut self, preparation: Preparation) -> Self {
        self.preparation = Some(preparation);
        self
    }

    /// Receives what begins.
    pub fn progress(mut self, progress: impl FnMut(Progress) + 'a) -> Self {
        self.progress = Box::new(progress);
        self
    }

    /// Ends the identification with an error once `stop` is raised, between two solutions of its search.
    pub fn stop(mut self, stop: Arc<AtomicBool>) -> Self {
        self.stop = Some(stop);
        self
    }

    /// Identifies the arm. Joints without torque in the logs, or that stand still, have no equation, and a note says so. An effect that
    /// is wanted on every joint is left out, with a note, where the logs do not separate it from the arm's parameters.
    ///
    /// # Errors
    /// No training log; a log of other joints, with times that do not increase or positions that are not finite; one that is too short;
    /// an effect or joint that is unknown; a motion that does not separate the parameters (named); and if it is stopped.
    pub fn run(self) -> Result<Identification> {
        let IdentificationBuilder { robot, train, test, wanted, trust, preparation, mut progress, stop } = self;
        let stop = stop.as_ref();
        let first = train.first();
        let first = first.ok_or_else(|| Error::request("training logs", "are missing; give at least one"))?;
        for (kind, logs) in [("training", &train), ("test", &test)] {
            logs.iter().enumerate().try_for_each(|(k, log)| check(&format!("{kind} log {}", k + 1), log, robot))?;
        }
        wanted.iter().try_for_each(|wanted| wanted.check(robot))?;
        goes_on(stop)?;
        let logs = Logs { train: &train, test: &test };
        let preparation = preparation.unwrap_or_else(|| Preparation::of_noise(first));
        let equations::Observed { model, mut notes } = equations::observed(robot, logs, preparation.clone(), trust)?;
        let placed = placed(&wanted, robot, &model)?;
        let fit = |placed, logs, rows: &[bool]| {
            fit_effects_until(&model, trust, logs, preparation.clone(), placed, rows, stop)
        };
        progress(Progress::Arm);
        let mut plain = fit(Vec::new(), logs, &vec![true; model.dof()])?;
        let mut extended = None;
        if !placed.is_empty() {
            progress(Progress::Effects);
            let fitted = match fit(placed.clone(), logs, &plain.reversals) {
                Ok(fitted) => fitted,
                Err(problem) => {
                    let training = Logs { test: &[], ..logs };
                    let alone = |one: &_| fit(vec![Clone::clone(one)], training, &plain.reversals).is_ok();
                    let (kept, note) = separable(&wanted, placed, robot, alone).ok_or(problem)?;
                    notes.push(note);
                    fit(kept, logs, &plain.reversals)?
                }
            };
            if fitted.reversals != plain.reversals {
                plain = fit(Vec::new(), logs, &fitted.reversals)?;
            }
            extended = Some(fitted);
        }
        goes_on(stop)?;
        progress(Progress::Bodies);
        // Inertias of the description are consistent already; with effects in the fit, the bodies are those of the fit without.
        let bodies = match trust {
            Trust::Structure => Some(consistent(&model, logs, preparation.clone(), &plain)?),
            Trust::Nominal => None,
        };
        let identified = match &bodies {
            Some(found) => found.robot(robot),
            None => extended.as_ref().unwrap_or(&plain).with_drives(robot),
        };
        Ok(Identification {
            joints: robot.joint_names(),
            effort_units: robot.effort_units(),
            trust,
            notes,
            without_effects: plain,
            with_effects: extended,
            consistent: bodies,
            robot: identified,
            model,
            preparation,
        })
    }
}

/// Refuses a log that cannot be fitted; `name` is what errors call it.
fn check(name: &str, log: &Recording, robot: &Robot) -> Result<()> {
    let refused = |problem: String| Err(Error::request(name, problem));
    if log.joints() != robot.dof() {
        let names = robot.joint_names().join(", ");
        return refused(format!("has {} joints; {} has {}: {names}", log.joints(), robot.name, robot.dof()));
    }
    if let Some(place) =
        log.time.windows(2).position(|pair| pair[0].partial_cmp(&pair[1]) != Some(std::cmp::Ordering::Less))
    {
        let (before, after) = (log.time[place], log.time[place + 1]);
        return refused(format!(
            "time goes from {before} to {after} s at sample {}; give times that increase",
            place + 2
        ));
    }
    let unknown = |(_, q): &(&String, &[f64])| q.iter().any(|position| !position.is_finite());
    if let Some((joint, _)) = log.joints.iter().zip(log.q.iter()).find(unknown) {
        return refused(format!(
            "positions of `{joint}` are not all finite; leave out such samples, as `dataset::ready` does"
        ));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identification::fit::fit_effects;
    use crate::identification::model::Model;
    use crate::recording;
    use crate::robot::{InertiaCheck, load};
    use std::sync::atomic::Ordering;

    const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/reference/payload");

    fn arm() -> (Robot, [Recording; 2]) {
        let log = |name: &str| recording::load(format!("{FOLDER}/{name}.csv"), None).unwrap();
        (load(format!("{FOLDER}/arm.urdf"), InertiaCheck::Ignored).unwrap(), [log("before"), log("nothing")])
    }

    #[test]
    fn defaults_give_what_the_single_steps_give() {
        let (robot, [train, test]) = arm();
        let found = Identification::of(&robot).train([&train]).test([&test]).run().unwrap();
        let logs = Logs { train: &[&train], test: &[&test] };
        let (model, preparation) = (Model::new(&robot), Preparation::usual(&train));
        let plain = fit_effects(&model, Trust::Structure, logs, preparation.clone(), Vec::new()).unwrap();
        let bodies = consistent(&model, logs, preparation, &plain).unwrap();
        assert_eq!(found.fitted().fit.estimate.beta, plain.fit.estimate.beta);
        assert_eq!((&found.robot, found.notes.len()), (&bodies.robot(&robot), 0));
        assert_eq!((found.consistent.unwrap(), found.without_effects.test_rms), (bodies, plain.test_rms));
    }

    #[test]
    fn logs_that_cannot_be_fitted_are_named() {
        let (robot, [train, _]) = arm();
        let with = |alter: fn(&mut Recording)| {
            let mut log = train.clone();
            alter(&mut log);
            Identification::of(&robot).train([&train, &log]).run().unwrap_err().to_string()
        };
        let message = Identification::of(&robot).run().unwrap_err().to_string();
        assert_eq!(message, "training logs: are missing; give at least one");
        let message = with(|log| log.time[7] = log.time[6]);
        assert!(message.starts_with("training log 2: time goes from") && message.contains("at sample 8"), "{message}");
        let message = with(|log| log.q.channel_mut(1)[3] = f64::NAN);
        assert!(message.starts_with("training log 2: positions of `j2`"), "{message}");
        let message = with(|log| *log = Recording::new(["a"], [0.0], [[0.0]], [[0.0]]).unwrap());
        assert!(message.starts_with("training log 2: has 1 joints; "), "{message}");
    }

    #[test]
    fn a_raised_flag_ends_it() {
        let (robot, [train, _]) = arm();
        let stop = Arc::new(AtomicBool::new(false));
        let question = || Identification::of(&robot).train([&train]).effects(["stribeck_friction:j2"]);
        let raise = |at: Progress| {
            stop.store(false, Ordering::Relaxed);
            let watch = |now: Progress| stop.store(stop.load(Ordering::Relaxed) || now == at, Ordering::Relaxed);
            question().stop(Arc::clone(&stop)).progress(watch).run().map(drop).unwrap_err().to_string()
        };
        for at in [Progress::Arm, Progress::Effects] {
            assert_eq!(raise(at), "identification: was stopped before it was done; run it again");
        }
    }
}
