//! The model with its effects and their present parameters.

use super::arm::Arm;
use super::arm_parameters::{ArmParameter, Trust, arm_name, arm_parameters, drive_of, is_merged, leader, stands_for};
use crate::effects::{Gear, Placed, Role, Scope, Site, inside};
use crate::error::{Error, Result};
use crate::identification::model::Model;
use crate::identification::preparation::prepare::{self, Prepared, Smoothing};
use crate::identification::preparation::reversals::Band;
use crate::identification::preparation::smoothing_choice::{
    USUAL_ORDER, usual_decimation, usual_window, window_of_log,
};
use crate::identification::regression::joint_regression::JointRegression;
use crate::identification::regression::least_squares::require_rows;
use crate::identification::regression::undetermined::undetermined;
use crate::recording::Recording;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// How measured logs are made ready.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::identification::effect_model::Preparation;
/// use tauscope::identification::reversals::Band;
/// use tauscope::identification::smoothing_choice;
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/payload/arm.urdf", InertiaCheck::Ignored)?;
/// # let log = recording::load("../tests/reference/payload/before.csv", None)?;
///
/// // By the noise of a log; or the usual window at its rate.
/// let chosen = Preparation { smoothing: smoothing_choice::savitzky_golay(&[&log])?, band: Band::OfNoise };
/// let usual = Preparation::usual(&log);
/// assert_eq!((chosen.band, usual.band), (Band::OfNoise, Band::OfNoise));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Preparation {
    /// Smoothing, differentiation and the filter of torque and columns.
    pub smoothing: Smoothing,
    /// Where the direction of a joint is certain.
    pub band: Band,
}

impl Preparation {
    /// Savitzky-Golay over the usual window at the rate of `log`, directions certain by the noise of the velocities.
    pub fn usual(log: &Recording) -> Self {
        Self::over(usual_window(log.rate_hz()))
    }

    /// [`Preparation::usual`] with a longer window where the positions of `log` are noisy ([`window_of_log`]).
    pub fn of_noise(log: &Recording) -> Self {
        Self::over(window_of_log(log))
    }

    fn over(window: usize) -> Self {
        let decimation = usual_decimation(window);
        let smoothing = Smoothing::SavitzkyGolay { window, order: USUAL_ORDER, decimation };
        Preparation { smoothing, band: Band::OfNoise }
    }
}

/// A model with effects on a set of logs.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::effects::{Placed, StribeckFriction};
/// use tauscope::identification::effect_model::{EffectModel, Preparation, Trust};
/// use tauscope::identification::model::Model;
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/payload/arm.urdf", InertiaCheck::Ignored)?;
/// # let log = recording::load("../tests/reference/payload/before.csv", None)?;
///
/// // The arm with a Stribeck curve on joint 2: its rise is linear, its velocity is searched.
/// let (model, stribeck) = (Model::new(&robot), Placed::typical(&StribeckFriction, 1));
/// let effects = EffectModel::new(&model, Trust::Structure, &[&log], Preparation::usual(&log), vec![stribeck])?;
/// assert_eq!(effects.linear_names().len(), model.base().len() + 1);
/// assert_eq!((effects.amplitudes(), effects.nonlinear()), (vec![(0, 0)], vec![(0, 1)]));
/// assert_eq!(effects.parameter_name((0, 0)), "stribeck_friction:j2 rise");
/// # Ok::<(), tauscope::error::Error>(())
/// ```
pub struct EffectModel<'a> {
    pub(super) model: &'a Model,
    pub(super) trust: Trust,
    pub(super) logs: Vec<(&'a Recording, Prepared<'a>)>,
    pub(super) preparation: Preparation,
    pub(super) placed: Vec<Placed>,
    /// The arm's own parameters that are fitted.
    pub(super) arm: Vec<ArmParameter>,
    /// Those taken from the URDF because an effect stands for what differs from them, with their values.
    pub(super) nominal: Vec<(ArmParameter, f64)>,
    /// The arm's parameters as last solved for.
    pub(super) baseline: Vec<f64>,
    /// The arm whose bodies laws at the joints follow.
    pub(super) bodies: Arm,
    /// Those that the logs do not determine, with the values at which they are held; None before a regression was seen.
    undetermined: Option<Vec<(usize, f64)>>,
    /// Ends fits of the model once it is raised.
    stop: Option<Arc<AtomicBool>>,
}

/// Refuses to go on once `stop` is raised.
///
/// # Errors
/// If it is.
pub(in crate::identification) fn goes_on(stop: Option<&Arc<AtomicBool>>) -> Result<()> {
    match stop.is_some_and(|stop| stop.load(Ordering::Relaxed)) {
        true => Err(Error::request("identification", "was stopped before it was done; run it again")),
        false => Ok(()),
    }
}

/// Where a parameter of an effect is: index of the effect, index of the parameter.
pub type Place = (usize, usize);

impl<'a> EffectModel<'a> {
    /// The model with `placed` effects on `logs`.
    ///
    /// # Errors
    /// If a log is too short for its preparation.
    pub fn new(
        model: &'a Model,
        trust: Trust,
        logs: &[&'a Recording],
        preparation: Preparation,
        placed: Vec<Placed>,
    ) -> Result<Self> {
        let logs = logs
            .iter()
            .map(|&log| Ok((log, prepare::measured(log, &preparation.smoothing, preparation.band)?)))
            .collect::<Result<_>>()?;
        let stood_for = |parameter: ArmParameter| {
            drive_of(model, parameter).is_some_and(|drive| placed.iter().any(|placed| stands_for(placed, drive)))
        };
        let (nominal, arm): (Vec<_>, Vec<_>) =
            arm_parameters(model, trust).into_iter().partition(|(p, _)| stood_for(*p));
        let (arm, baseline) = arm.into_iter().unzip();
        let bodies = Arm::new(model.robot(), trust);
        let (undetermined, stop) = (None, None);
        Ok(EffectModel { model, trust, logs, preparation, placed, arm, nominal, baseline, bodies, undetermined, stop })
    }

    /// Positions between which a law may bend on a joint, rad or m, by those that the logs have; None without a log.
    pub(in crate::identification) fn bends_between(&self, joint: usize) -> Option<[f64; 2]> {
        let positions = || self.logs.iter().flat_map(|(log, _)| log.q.channel(joint)).copied();
        let ends = [positions().fold(f64::INFINITY, f64::min), positions().fold(f64::NEG_INFINITY, f64::max)];
        (ends[0] < ends[1]).then(|| inside(ends))
    }

    /// Lets `stop` end fits of the model.
    #[must_use]
    pub(in crate::identification) fn with_stop(mut self, stop: Option<&Arc<AtomicBool>>) -> Self {
        self.stop = stop.cloned();
        self
    }

    /// Refuses to go on once fits are to end.
    ///
    /// # Errors
    /// If they are.
    pub(in crate::identification) fn goes_on(&self) -> Result<()> {
        goes_on(self.stop.as_ref())
    }

    /// Lets laws at the joints follow the bodies of `arm` instead of those described.
    #[must_use]
    pub(crate) fn with_bodies(mut self, arm: Arm) -> Self {
        self.bodies = arm;
        self
    }

    /// Leaves out the rows that see a reversal or slow motion, except on joints where they are to be `kept`.
    #[must_use]
    pub(in crate::identification) fn with_reversals(mut self, kept: &[bool]) -> Self {
        self.logs.iter_mut().for_each(|(_, prepared)| prepared.keep_reversals(kept));
        self
    }

    /// Number of joints.
    pub fn joints(&self) -> usize {
        self.model.dof()
    }

    /// The effects with their present parameters.
    pub fn placed(&self) -> &[Placed] {
        &self.placed
    }

    /// Names of the linear parameters: those of the arm, then the amplitudes.
    pub fn linear_names(&self) -> Vec<String> {
        let mut names: Vec<String> = self.arm.iter().map(|&parameter| arm_name(self.model, parameter)).collect();
        names.extend(self.amplitudes().into_iter().map(|place| self.parameter_name(place)));
        names
    }

    /// Units of the arm's linear parameters.
    pub(crate) fn baseline_units(&self) -> Vec<&'static str> {
        self.arm.iter().map(|&parameter| self.model.unit_on_joint(leader(self.model, parameter))).collect()
    }

    /// Indices of the arm's viscous and Coulomb frictions among its linear parameters: neither can be negative.
    pub fn frictions(&self) -> Vec<usize> {
        let is_friction = |parameter: ArmParameter| drive_of(self.model, parameter).is_some_and(|(_, which)| which > 0);
        (0..self.arm.len()).filter(|&index| is_friction(self.arm[index])).collect()
    }

    /// Number of linear parameters that belong to the arm.
    pub fn baseline_len(&self) -> usize {
        self.baseline.len()
    }

    /// Name of an effect's parameter with its joints: "stribeck_friction:joint_2 rise".
    pub fn parameter_name(&self, (effect, parameter): Place) -> String {
        let placed = &self.placed[effect];
        let joints: Vec<&str> = placed.joints().iter().map(|&j| self.model.robot().joints[j].name.as_str()).collect();
        let at = if joints.is_empty() { String::new() } else { format!(":{}", joints.join("+")) };
        format!("{}{at} {}", placed.effect.about().name, placed.effect.parameters()[parameter].name)
    }

    /// The amplitudes of all effects.
    pub fn amplitudes(&self) -> Vec<Place> {
        self.places(|role| role == Role::Amplitude)
    }

    /// The shapes and departures of all effects.
    pub fn nonlinear(&self) -> Vec<Place> {
        self.places(|role| matches!(role, Role::Shape | Role::Departure))
    }

    fn places(&self, wanted: impl Fn(Role) -> bool) -> Vec<Place> {
        let of = |(index, placed): (usize, &Placed)| -> Vec<Place> {
            let parameters = placed.effect.parameters().iter().enumerate();
            parameters.filter(|(_, p)| wanted(p.role)).map(|(k, _)| (index, k)).collect()
        };
        self.placed.iter().enumerate().flat_map(of).collect()
    }

    /// Sets parameters of effects.
    pub fn set(&mut self, places: &[Place], values: &[f64]) {
        for (&(effect, parameter), &value) in places.iter().zip(values) {
            self.placed[effect].parameters[parameter] = value;
        }
    }

    /// Values of parameters of effects.
    pub fn get(&self, places: &[Place]) -> Vec<f64> {
        places.iter().map(|&(effect, parameter)| self.placed[effect].parameters[parameter]).collect()
    }

    /// Whether the regression itself depends on the linear parameters (under elastic gears and clipping sensors), so that
    /// solving takes more than one round.
    pub fn settles(&self) -> bool {
        (0..self.model.dof()).any(|joint| self.gear(joint).is_some() || self.sensors(joint).next().is_some())
    }

    /// Holds the arm's parameters that `regression`, the first one, does not separate from others.
    ///
    /// # Errors
    /// Names a joint with too few rows.
    pub(in crate::identification) fn settle_undetermined(&mut self, regression: &[JointRegression]) -> Result<()> {
        if self.undetermined.is_none() {
            require_rows(regression)?;
            let merged = |parameter: &ArmParameter| is_merged(self.model, *parameter);
            let merged: Vec<bool> = self.arm.iter().map(merged).collect();
            self.undetermined = Some(undetermined(regression, &self.baseline, &self.baseline_units(), &merged));
        }
        Ok(())
    }

    /// The arm's parameters that are held because the logs do not determine them, with their values.
    pub fn undetermined(&self) -> &[(usize, f64)] {
        self.undetermined.as_deref().unwrap_or_default()
    }

    /// The arm's linear parameters as last solved for.
    pub fn baseline(&self) -> &[f64] {
        &self.baseline
    }

    /// Takes over the arm's linear parameters, under which gears twist.
    pub(crate) fn set_baseline(&mut self, values: &[f64]) {
        let arm = self.baseline.len();
        self.baseline.copy_from_slice(&values[..arm]);
    }

    /// Present values of all linear parameters.
    pub(super) fn all_linear(&self) -> Vec<f64> {
        let mut values = self.baseline.clone();
        values.extend(self.get(&self.amplitudes()));
        values
    }

    /// The effects that distort the torque log of a joint.
    pub(super) fn sensors(&self, joint: usize) -> impl Iterator<Item = &Placed> + Clone {
        self.placed.iter().filter(move |placed| {
            let about = placed.effect.about();
            about.site == Site::Sensor && (about.scope == Scope::Arm || placed.joint == joint)
        })
    }

    /// Values of the arm's parameters as last solved for, those that effects stand for as described, in the order in which [`Arm::take`]
    /// has them.
    pub(super) fn baseline_of_arm(&self) -> Vec<f64> {
        let fitted = self.arm.iter().zip(&self.baseline).map(|(parameter, value)| (*parameter, *value));
        let all: Vec<(ArmParameter, f64)> = fitted.chain(self.nominal.iter().copied()).collect();
        let value = |wanted: ArmParameter| all.iter().find(|(own, _)| *own == wanted).map_or(0.0, |(_, value)| *value);
        let base = 0..self.model.base().len();
        match self.trust {
            Trust::Structure => base.map(|b| value(ArmParameter::Base(b))).collect(),
            Trust::Nominal => {
                let frictions = base.filter(|&b| self.model.is_friction(b)).filter_map(|b| self.model.drive_of(b));
                let rotors =
                    (0..self.model.dof()).filter(|&joint| self.model.has_equation(joint)).map(|joint| (joint, 0));
                frictions.chain(rotors).map(|(joint, which)| value(ArmParameter::Drive(joint, which))).collect()
            }
        }
    }

    /// The gear of a joint, if it is not rigid.
    pub(super) fn gear(&self, joint: usize) -> Option<Gear> {
        let gears = self.placed.iter().filter(|placed| placed.joint == joint);
        let gear = gears.filter_map(|placed| placed.effect.gear(&placed.parameters)).reduce(Gear::in_series)?;
        (!gear.is_rigid()).then_some(gear)
    }
}
