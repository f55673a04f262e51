//! The torque model extended by effects: base parameters and amplitudes are linear, shapes and departures are not.
//!
//! For given nonlinear parameters the model is a linear regression. Its rows are made the way the log was made: positions
//! as the encoders would have had to read without their errors, links behind their gears, torques at the joints, and then
//! what the torque sensors make of them; every column goes through the same sensors and filter as the torque.

mod parts;
mod sensing;
mod signals;

use parts::{ArmParameter, Parts, arm_name, arm_parameters, drive_of, leader, stands_for};
use sensing::Sensing;
use signals::{derivatives, difference, put_behind};

use super::joint_regression::JointRegression;
use super::least_squares::require_rows;
use super::model::Model;
use super::prepare::{self, Prepared, Smoothing};
use super::reversals::Band;
use super::undetermined::undetermined;
use crate::channels::Channels;
use crate::dynamics::Motion;
use crate::effects::{DAMPING_TIME_S, Gear, Placed, Role, Scope};
use crate::error::Result;
use crate::recording::Recording;
use std::borrow::Cow;

/// Rounds in which encoder errors are taken back out of the measured positions.
const UNDO_ROUNDS: usize = 4;

/// Rounds in which links are put behind their gears.
const GEAR_ROUNDS: usize = 4;

/// Rows without weight between two logs, so that the noise of one is not carried into the next.
const SEPARATION: usize = 32;

/// Which parameters of the arm are believed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, clap::ValueEnum)]
#[serde(rename_all = "snake_case")]
pub enum Trust {
    /// The URDF's inertias are believed; friction and rotor inertia of every joint are fitted.
    Nominal,
    /// Only the geometry is believed; all base parameters are fitted.
    Structure,
}

/// How measured logs are made ready.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Preparation {
    /// Smoothing, differentiation and the filter of torque and columns.
    pub smoothing: Smoothing,
    /// Where the direction of a joint is certain.
    pub band: Band,
}

/// A model with effects on a set of logs.
pub struct EffectModel<'a> {
    model: &'a Model,
    trust: Trust,
    logs: Vec<(&'a Recording, Prepared<'a>)>,
    preparation: Preparation,
    placed: Vec<Placed>,
    /// The arm's own parameters that are fitted.
    arm: Vec<ArmParameter>,
    /// Those that are believed because an effect stands for what differs from them, with their values.
    believed: Vec<(ArmParameter, f64)>,
    /// The arm's parameters as last solved for.
    baseline: Vec<f64>,
    /// Those that the logs do not determine, with the values at which they are held; None before a regression was seen.
    undetermined: Option<Vec<(usize, f64)>>,
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
            .map(|&log| Ok((log, prepare::measured(log, preparation.smoothing, preparation.band)?)))
            .collect::<Result<_>>()?;
        let stood_for = |parameter: ArmParameter| {
            drive_of(model, parameter).is_some_and(|drive| placed.iter().any(|placed| stands_for(placed, drive)))
        };
        let (believed, arm): (Vec<_>, Vec<_>) =
            arm_parameters(model, trust).into_iter().partition(|(p, _)| stood_for(*p));
        let (arm, baseline) = arm.into_iter().unzip();
        Ok(EffectModel { model, trust, logs, preparation, placed, arm, believed, baseline, undetermined: None })
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
    pub fn baseline_units(&self) -> Vec<&'static str> {
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

    /// Holds the arm's parameters that `regression`, the first one, cannot tell from others.
    ///
    /// # Errors
    /// Names a joint with too few rows to tell anything.
    pub(super) fn settle_undetermined(&mut self, regression: &[JointRegression]) -> Result<()> {
        if self.undetermined.is_none() {
            require_rows(regression)?;
            self.undetermined = Some(undetermined(regression, &self.baseline, &self.baseline_units()));
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
    pub fn set_baseline(&mut self, values: &[f64]) {
        let arm = self.baseline.len();
        self.baseline.copy_from_slice(&values[..arm]);
    }

    /// The linear regression at the present nonlinear parameters, all logs one after the other: torque less what has no
    /// free parameter, columns of the arm's parameters and of the amplitudes.
    ///
    /// # Errors
    /// If a log is too short for its preparation.
    pub fn regression(&self) -> Result<Vec<JointRegression>> {
        let mut joints: Vec<Vec<JointRegression>> = (0..self.model.dof()).map(|_| Vec::new()).collect();
        for (recording, prepared) in &self.logs {
            for (all, one) in joints.iter_mut().zip(self.rows(recording, prepared)?) {
                all.push(one);
            }
        }
        Ok(joints.into_iter().map(|parts| JointRegression::joined(parts, SEPARATION)).collect())
    }

    /// Time of every row of [`EffectModel::regression`], each log's own, s; NaN for the rows that only separate logs.
    ///
    /// # Errors
    /// If a log is too short for its preparation.
    pub fn row_times(&self) -> Result<Vec<f64>> {
        let mut times = Vec::new();
        for (_, prepared) in &self.logs {
            if !times.is_empty() {
                times.extend([f64::NAN; SEPARATION]);
            }
            times.extend(prepared.row_times()?);
        }
        Ok(times)
    }

    /// Position and velocity of every joint at those rows, `[joint][row]`; NaN for the rows that only separate logs.
    ///
    /// # Errors
    /// If a log is too short for its preparation.
    pub fn row_motion(&self) -> Result<[Vec<Vec<f64>>; 2]> {
        let mut tables = [vec![Vec::new(); self.joints()], vec![Vec::new(); self.joints()]];
        for (_, prepared) in &self.logs {
            for joint in 0..self.joints() {
                for (table, own) in tables.iter_mut().zip(prepared.row_motion(joint)?) {
                    if !table[joint].is_empty() {
                        table[joint].extend([f64::NAN; SEPARATION]);
                    }
                    table[joint].extend(own);
                }
            }
        }
        Ok(tables)
    }

    /// Standard deviation of the white noise in the torque of the rows, for each joint, N m: what no model can explain.
    ///
    /// # Errors
    /// If a log is too short for its preparation.
    pub fn torque_noise(&self) -> Result<Vec<f64>> {
        let mut squares = vec![0.0; self.joints()];
        for (_, prepared) in &self.logs {
            for (sum, noise) in squares.iter_mut().zip(prepared.torque_noise()?) {
                *sum += noise * noise / self.logs.len() as f64;
            }
        }
        Ok(squares.into_iter().map(f64::sqrt).collect())
    }

    /// The regression rows of one log.
    fn rows(&self, recording: &Recording, prepared: &Prepared) -> Result<Vec<JointRegression>> {
        let undone = self.without_encoder_errors(recording);
        let corrected;
        let (recording, prepared) = match &undone {
            Some(log) => {
                corrected = prepare::measured(log, self.preparation.smoothing, self.preparation.band)?;
                (log, &corrected)
            }
            None => (recording, prepared),
        };
        let period = 1.0 / recording.rate_hz();
        let link = self.link_motion(recording, prepared)?;
        let mut parts = Parts::new(self, prepared, &link);
        let mut base = match self.trust {
            Trust::Structure => prepared.columns(self.model, &link)?,
            Trust::Nominal => vec![Channels::default(); self.model.dof()],
        };
        (0..self.model.dof())
            .map(|joint| {
                if !self.model.has_equation(joint) {
                    let name = self.model.robot().joints[joint].name.clone();
                    return Ok(JointRegression::without_equation(name, prepared.row_times()?.len()));
                }
                let sensing = Sensing::new(self.sensors(joint).collect(), period);
                let rows = match sensing.acts() {
                    true => self.sensed_rows(joint, &parts, prepared, recording.samples(), &sensing),
                    false => self.plain_rows(joint, &parts, prepared, std::mem::take(&mut base[joint])),
                };
                parts.release(joint);
                rows
            })
            .collect()
    }

    /// The regression rows of one joint of one log whose sensors say what is; `base` are those of its base columns, where
    /// they are fitted.
    fn plain_rows(&self, joint: usize, parts: &Parts, prepared: &Prepared, base: Channels) -> Result<JointRegression> {
        let active = self.model.active(joint);
        let place = |parameter: ArmParameter| match parameter {
            ArmParameter::Base(base) => active.iter().position(|&own| own == base),
            ArmParameter::Drive(..) => None,
        };
        let places: Vec<Option<usize>> = self.arm.iter().map(|&parameter| place(parameter)).collect();
        let all = places.iter().flatten().count() == base.channels();
        let mut parameters = Vec::new();
        let mut columns = Channels::default();
        for (index, &parameter) in self.arm.iter().enumerate() {
            if let Some(place) = places[index] {
                if !all {
                    columns.push(base.channel(place));
                }
            } else if let Some(column) = parts.column(parameter, joint) {
                columns.push(&prepared.thinned(&column)?);
            } else {
                continue;
            }
            parameters.push(index);
        }
        if all && base.channels() > 0 {
            columns = base;
        }
        for (index, column) in parts.amplitudes(joint) {
            columns.push(&prepared.thinned(column)?);
            parameters.push(index);
        }
        let torque = prepared.torque.channel(joint);
        let torque = match parts.known(joint) {
            Some(known) => prepared.thinned(&difference(torque, known))?,
            None => prepared.thinned(torque)?,
        };
        self.joint_rows(joint, parameters, columns, torque, prepared)
    }

    /// The regression rows of one joint of one log whose torque went through `sensing`.
    fn sensed_rows(
        &self,
        joint: usize,
        parts: &Parts,
        prepared: &Prepared,
        samples: usize,
        sensing: &Sensing,
    ) -> Result<JointRegression> {
        let sensed = |column: &[f64]| sensing.small_signal(column);
        let columns = parts.columns(joint);
        let mut own: Vec<(usize, Vec<f64>)> = columns.iter().map(|(k, column)| (*k, sensed(column))).collect();
        for (index, (effect, k)) in self.amplitudes().into_iter().enumerate() {
            if let Some(column) = sensing.amplitude(&self.placed[effect], k, samples) {
                own.push((self.baseline.len() + index, column));
            }
        }
        let mut known = parts.known(joint).map_or_else(|| sensed(&vec![0.0; samples]), sensed);
        let total = parts.predicted(joint, &self.all_linear());
        sensing.clip(&total, &mut known, &mut own);
        let mut columns = Channels::default();
        for (_, column) in &own {
            columns.push(&prepared.thinned(column)?);
        }
        let torque = prepared.thinned(&difference(prepared.torque.channel(joint), &known))?;
        self.joint_rows(joint, own.into_iter().map(|(index, _)| index).collect(), columns, torque, prepared)
    }

    fn joint_rows(
        &self,
        joint: usize,
        parameters: Vec<usize>,
        columns: Channels,
        torque: Vec<f64>,
        prepared: &Prepared,
    ) -> Result<JointRegression> {
        // Without a column there are no rows to count.
        let columns = if parameters.is_empty() { Channels::zeros(0, torque.len()) } else { columns };
        let name = self.model.robot().joints[joint].name.clone();
        Ok(JointRegression { joint: name, parameters, columns, torque, valid: prepared.rows_to_use(joint) })
    }

    /// Present values of all linear parameters.
    fn all_linear(&self) -> Vec<f64> {
        let mut values = self.baseline.clone();
        values.extend(self.get(&self.amplitudes()));
        values
    }

    /// The effects that distort the torque log of a joint.
    fn sensors(&self, joint: usize) -> impl Iterator<Item = &Placed> {
        self.placed.iter().filter(move |placed| {
            let about = placed.effect.about();
            about.site == crate::effects::Site::Sensor && (about.scope == Scope::Arm || placed.joint == joint)
        })
    }

    /// The recording with the encoders' errors taken out of its positions, if effects put any in.
    fn without_encoder_errors(&self, recording: &Recording) -> Option<Recording> {
        if (0..self.model.dof()).all(|joint| self.sensors(joint).next().is_none()) {
            return None;
        }
        let mut q = recording.q.clone();
        for joint in 0..self.model.dof() {
            let distorted = |signal: &[f64]| -> Vec<f64> {
                let mut read = signal.to_vec();
                for placed in self.sensors(joint) {
                    placed.effect.distort_position(&placed.parameters, &mut read);
                }
                read
            };
            let measured = recording.q.channel(joint);
            for _ in 0..UNDO_ROUNDS {
                let read = distorted(q.channel(joint));
                for ((value, measured), read) in q.channel_mut(joint).iter_mut().zip(measured).zip(read) {
                    *value += measured - read;
                }
            }
        }
        (q != recording.q).then(|| Recording { q, ..recording.clone() })
    }

    /// Rotor inertia of a joint that is fitted as part of its link's.
    fn lumped_rotor(&self, joint: usize) -> f64 {
        let lumped = self.trust == Trust::Structure && !self.model.rotor_stands_alone(joint);
        if lumped { self.model.robot().joints[joint].drive.armature } else { 0.0 }
    }

    /// The gear of a joint, if it is not rigid.
    fn gear(&self, joint: usize) -> Option<Gear> {
        let gears = self.placed.iter().filter(|placed| placed.joint == joint);
        let gear = gears.filter_map(|placed| placed.effect.gear(&placed.parameters)).reduce(Gear::in_series)?;
        (!gear.is_rigid()).then_some(gear)
    }

    /// Motion of the links: that of the motors less the twist of the gears under the torque that the model says they
    /// carry. (The measured torque would bring its noise into the columns, and with it a bias larger than what most gears
    /// yield.) Twists pass the filter of torque and columns: above the frequency at which the link swings on its gear the
    /// rounds would amplify every error.
    fn link_motion<'b>(&self, log: &Recording, prepared: &'b Prepared) -> Result<Cow<'b, Motion>> {
        let period = 1.0 / log.rate_hz();
        if (0..self.model.dof()).all(|joint| self.gear(joint).is_none()) {
            return Ok(Cow::Borrowed(&prepared.motion));
        }
        let gears: Vec<(usize, Gear)> = (0..self.model.dof())
            .filter_map(|joint| {
                let rotor = self.model.robot().joints[joint].drive.armature;
                Some((joint, self.gear(joint)?.completed(rotor)))
            })
            .collect();
        let (with_play, springs): (Vec<_>, Vec<_>) = gears.into_iter().partition(|(_, gear)| gear.half_gap > 0.0);
        let mut played = prepared.motion.clone();
        for (joint, gear) in with_play {
            put_behind(&mut played, joint, self.play(gear, joint, log, prepared)?);
        }
        let mut link = played.clone();
        for _ in 0..if springs.is_empty() { 0 } else { GEAR_ROUNDS } {
            let parts = Parts::new(self, prepared, &link);
            let mut next = played.clone();
            for &(joint, gear) in &springs {
                let carried = parts.carried(joint, link.qdd.channel(joint));
                let steady: Vec<f64> = carried.into_iter().map(|torque| gear.twist(torque)).collect();
                let [steady, rate, _] = derivatives(prepared.filtered(&steady)?, period)?;
                let twist = steady.iter().zip(rate).map(|(twist, rate)| twist - DAMPING_TIME_S * rate);
                put_behind(&mut next, joint, derivatives(twist.collect(), period)?);
            }
            link = next;
        }
        Ok(Cow::Owned(link))
    }

    /// Twist of a gear with play: the link falls from flank to flank, which no steady state describes, so its motion is
    /// followed in time. It is followed on the unsmoothed motion, since smoothing would make impacts come too early;
    /// following integrates twice, which takes care of the noise. Then the twist is smoothed like the positions.
    fn play(&self, gear: Gear, joint: usize, log: &Recording, prepared: &Prepared) -> Result<[Vec<f64>; 3]> {
        let period = 1.0 / log.rate_hz();
        let sharp = prepare::measured(log, Smoothing::None, self.preparation.band)?;
        let carried = |motion: &Motion| Parts::new(self, &sharp, motion).carried(joint, motion.qdd.channel(joint));
        let load = carried(&sharp.motion);
        let mut pushed = sharp.motion.clone();
        pushed.qdd.channel_mut(joint).iter_mut().for_each(|a| *a += 1.0);
        let inertia: Vec<f64> = carried(&pushed).iter().zip(&load).map(|(with, without)| with - without).collect();
        let [twist, ..] = gear.follow(&load, &inertia, period);
        derivatives(prepared.filtered_like_positions(&twist)?, period)
    }
}

/// Parameters of an effect with its amplitudes at zero.
fn without_amplitudes(placed: &Placed) -> Vec<f64> {
    let parameters = placed.effect.parameters().iter().zip(&placed.parameters);
    parameters.map(|(p, &value)| if p.role == Role::Amplitude { 0.0 } else { value }).collect()
}
