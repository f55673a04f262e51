//! Effects that are given, estimated as those that a search finds.

use super::builder::{DiagnosisBuilder, Examined};
use super::conclusion::{halves, known_before};
use super::outcome::stopped;
use super::searched::fit_to_the_end;
use super::words::{Finding, NamedParameter, finding, joints};
use crate::diagnosis::logs::{DataFault, split};
use crate::diagnosis::model::Family;
use crate::diagnosis::preparation::prepare;
use crate::diagnosis::regression::rms;
use crate::diagnosis::search::{Given, members, take};
use crate::effects::{self, Nature, Placed};
use crate::error::{Error, Result};
use crate::identification::Wanted;
use serde::Serialize;

/// What is said of an effect that the logs do not show by itself, and of play.
const NOT_SEPARATED: &str = "is not separated from the other parameters by the logs";
const BY_IMPACTS: &str = "is measured by its impacts, which a search looks for; use a diagnosis";

/// Given effects as a diagnosis estimates them, from [`DiagnosisBuilder::estimate`].
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::diagnosis::{Diagnosis, Estimated};
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Ignored)?;
/// # let log = |name: &str| recording::load(format!("../tests/reference/pendulum/{name}.csv"), None);
/// # let (train, test) = (log("train")?, log("test")?);
///
/// // With the ripple the held-out residual is a tenth of that without it.
/// let estimated: Estimated = Diagnosis::of(&robot).train([&train]).test([&test]).estimate(["torque_ripple:pivot"])?;
/// assert!(estimated.left_out.is_empty() && estimated.test_rms_nm[0] < 0.1 * estimated.test_rms_without_nm[0]);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Serialize)]
pub struct Estimated {
    /// Names of the joints from base to flange: the order of all that is per joint.
    pub joints: Vec<String>,
    /// Units of their efforts and residuals: N m, or N of a joint that slides.
    pub effort_units: Vec<&'static str>,
    /// Cut-off of the low-pass of each joint's positions, Hz.
    pub position_cutoffs_hz: Vec<f64>,
    /// The effects in the model, in the order in which they were taken into it.
    pub effects: Vec<EstimatedEffect>,
    /// The effects that are not in it, and why.
    pub left_out: Vec<LeftOut>,
    /// Root mean square of the held-out residual of the arm without effects, per joint, N m (N).
    pub test_rms_without_nm: Vec<f64>,
    /// The same with all effects that are in the model.
    pub test_rms_nm: Vec<f64>,
    /// Faults of the data, and joints that have no equation, a line each.
    pub notes: Vec<String>,
}

/// An effect that was given, with its estimate.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// # use tauscope::diagnosis::Diagnosis;
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Ignored)?;
/// # let log = |name: &str| recording::load(format!("../tests/reference/pendulum/{name}.csv"), None);
/// # let (train, test) = (log("train")?, log("test")?);
/// use tauscope::diagnosis::EstimatedEffect;
///
/// let estimated = Diagnosis::of(&robot).train([&train]).test([&test]).estimate(["torque_ripple"])?;
/// let EstimatedEffect { effect, joints, parameters } = &estimated.effects[0];
/// assert_eq!((*effect, &joints[..]), ("torque_ripple", &["pivot".to_owned()][..]));
/// let harmonic = parameters.iter().find(|parameter| parameter.name == "harmonic").expect("a shape");
/// assert!((harmonic.value - 7.0).abs() < 3.0 * harmonic.std);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Serialize)]
pub struct EstimatedEffect {
    /// Name of the effect.
    pub effect: &'static str,
    /// Names of its joints; none for an effect of the whole arm.
    pub joints: Vec<String>,
    /// Its parameters, with standard deviations that hold the scatter between blocks of the logs.
    pub parameters: Vec<NamedParameter>,
}

/// An effect that was given and is not in the model.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// # use tauscope::diagnosis::Diagnosis;
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Ignored)?;
/// # let log = |name: &str| recording::load(format!("../tests/reference/pendulum/{name}.csv"), None);
/// # let (train, test) = (log("train")?, log("test")?);
/// use tauscope::diagnosis::LeftOut;
///
/// // Coulomb friction is a parameter of the arm already.
/// let estimated = Diagnosis::of(&robot).train([&train]).test([&test]).estimate(["coulomb_friction:pivot"])?;
/// let LeftOut { effect, joints, why } = &estimated.left_out[0];
/// assert_eq!((*effect, &joints[..]), ("coulomb_friction", &["pivot".to_owned()][..]));
/// assert!(why.contains("not separated"));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Serialize)]
pub struct LeftOut {
    /// Name of the effect.
    pub effect: &'static str,
    /// Names of its joints; none for an effect of the whole arm.
    pub joints: Vec<String>,
    /// Why, as the end of a sentence that begins with it.
    pub why: &'static str,
}

impl DiagnosisBuilder<'_> {
    /// Screens the logs and estimates given effects as a diagnosis estimates those that it finds: with its preparation of the logs, its
    /// noise and its standard deviations, and without a search. No test asks whether they act.
    ///
    /// Effects are named as `stribeck_friction:joint_2`, or `stribeck_friction` for every joint, or are [`Placed`] laws, whose parameters
    /// play no part: shapes start where the grid of the search fits best. `candidates` and `max_findings` are of a search; with reference
    /// logs one is made among these.
    ///
    /// # Errors
    /// Those of [`DiagnosisBuilder::run`]; faults of the data that forbid an answer; an effect or joint that is unknown, or without an
    /// equation; no effect at all; and if it is stopped.
    pub fn estimate<E: Into<Wanted>>(self, given: impl IntoIterator<Item = E>) -> Result<Estimated> {
        let wanted: Vec<Wanted> = given.into_iter().map(E::into).collect();
        if wanted.is_empty() {
            return Err(Error::request("effects", "are missing; give at least one to estimate"));
        }
        let Examined { mut arm, logs, still, given, present, options, mut watch, .. } = self.examined()?;
        if arm.is_stopped() {
            return Err(stopped(&arm.faults));
        }
        let input = logs.input(present);
        let model = arm.model(given, &input, &still, &options, &mut watch)?;
        let robot = &arm.robot;
        let placed = wanted.iter().map(|wanted| wanted.placed(robot, Some(&model))).collect::<Result<Vec<_>>>()?;
        let mut left_out = Vec::new();
        let mut families: Vec<Family> = Vec::new();
        for Placed { effect, joint, .. } in placed.into_iter().flatten() {
            let family = Family { effect: effect.about().name, joint };
            match effect.about().nature == Nature::Play {
                true => left_out.push((family, BY_IMPACTS)),
                false if families.contains(&family) => {}
                false => families.push(family),
            }
        }
        if families.is_empty() {
            return Err(Error::request(effects::play().about().name, BY_IMPACTS));
        }
        let (known, _) = known_before(&model, &input, &options, &mut watch)?;
        let cut = split(&input.train);
        let (train, test) = halves(&input, &cut);
        let mut session = prepare(&model, options.trust, known, &train, &test, options.criteria)?;
        let Given { mut found, left_out: failed, mut whitener, first_whitener } =
            take(&mut session, &families, &options, &mut watch)?;
        if watch.has_ended() {
            return Err(Error::request("estimate", "was stopped before it was done; run it again"));
        }
        fit_to_the_end(&mut session, &mut found, &mut whitener)?;

        let test = &session.logs.test;
        let left = |residual| rms(&test.rows.valid, &residual);
        let failed = failed.into_iter();
        left_out.extend(failed.map(|(family, gate)| (family, gate.map_or(NOT_SEPARATED, |one| one.gate.reason()))));
        let left_out = left_out.into_iter().map(|(family, why)| LeftOut {
            effect: family.effect,
            joints: joints(robot, family),
            why,
        });
        let effects = found.iter().map(|one| {
            let Finding { effect, joints, parameters, .. } = finding(robot, one, &[], &options.criteria.levels);
            EstimatedEffect { effect, joints, parameters }
        });
        let note = |DataFault { log, place, text, .. }: &DataFault| format!("{log}: {place}: {text}");
        Ok(Estimated {
            joints: robot.joint_names(),
            effort_units: robot.effort_units(),
            position_cutoffs_hz: session.logs.cutoffs_hz.clone(),
            effects: effects.collect(),
            left_out: left_out.collect(),
            test_rms_without_nm: left(session.baseline_residual_on(test, &first_whitener)?),
            test_rms_nm: left(session.held_out_residual(&members(&found), &whitener)?),
            notes: arm.faults.iter().map(note).collect(),
        })
    }
}
