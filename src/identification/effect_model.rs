//! The torque model extended by effects: base parameters and amplitudes are linear, shapes and departures are not.
//!
//! For given nonlinear parameters the model is a linear regression. Its rows are made the way the log was made: positions
//! as the encoders would have had to read without their errors, links behind their gears, torques at the joints, and then
//! what the torque sensors make of them; every column goes through the same sensors and filter as the torque.

use super::least_squares::JointRegression;
use super::model::Model;
use super::prepare::{self, Prepared, Smoothing};
use crate::channels::Channels;
use crate::dynamics::{Motion, inverse_dynamics};
use crate::effects::{Along, Gear, Placed, Role, Scope, contributions};
use crate::error::Result;
use crate::recording::Recording;
use crate::signal::first_derivative;

/// Rounds in which encoder errors are taken back out of the measured positions, and links put behind their gears.
const UNDO_ROUNDS: usize = 4;

/// Rows without weight between two logs, so that the noise of one is not carried into the next.
const SEPARATION: usize = 32;

/// Size of the small signal on which linear sensors are told from clipping ones, of the torque's.
const SMALL: f64 = 1e-6;

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
    /// Velocity below which a joint's direction is not certain, rad/s.
    pub band: f64,
}

/// A model with effects on a set of logs.
pub struct EffectModel<'a> {
    model: &'a Model,
    trust: Trust,
    logs: Vec<(&'a Recording, Prepared)>,
    preparation: Preparation,
    placed: Vec<Placed>,
    /// Base parameters as last solved for: gears twist under the torque that they predict.
    baseline: Vec<f64>,
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
        let baseline = baseline_values(model, trust);
        Ok(EffectModel { model, trust, logs, preparation, placed, baseline })
    }

    /// The effects with their present parameters.
    pub fn placed(&self) -> &[Placed] {
        &self.placed
    }

    /// Names of the linear parameters: those of the arm, then the amplitudes.
    pub fn linear_names(&self) -> Vec<String> {
        let mut names = baseline_names(self.model, self.trust);
        names.extend(self.amplitudes().into_iter().map(|place| self.parameter_name(place)));
        names
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

    /// The regression rows of one log.
    fn rows(&self, recording: &Recording, prepared: &Prepared) -> Result<Vec<JointRegression>> {
        let corrected;
        let prepared = match self.without_encoder_errors(recording) {
            Some(log) => {
                corrected = prepare::measured(&log, self.preparation.smoothing, self.preparation.band)?;
                &corrected
            }
            None => prepared,
        };
        let period = 1.0 / recording.rate_hz();
        let link = self.link_motion(prepared, period)?;
        let parts = Parts::new(self, prepared, &link);
        (0..self.model.dof())
            .map(|joint| {
                let sensed = |signal: &[f64]| -> Vec<f64> { self.sensed(joint, signal, period) };
                let mut parameters = Vec::new();
                let mut columns = Vec::new();
                for (parameter, column) in parts.columns(joint) {
                    parameters.push(parameter);
                    columns.push(prepared.thinned(&sensed(&column))?);
                }
                for (index, (effect, k)) in self.amplitudes().into_iter().enumerate() {
                    let Some(column) = self.sensor_amplitude(joint, effect, k, recording.samples(), period) else {
                        continue;
                    };
                    parameters.push(self.baseline.len() + index);
                    columns.push(prepared.thinned(&column)?);
                }
                let fixed = self.fixed(joint, &parts, &sensed, period);
                let rest: Vec<f64> = prepared
                    .torque
                    .channel(joint)
                    .iter()
                    .zip(fixed)
                    .map(|(measured, known)| measured - known)
                    .collect();
                Ok(JointRegression {
                    parameters,
                    columns: Channels::from_vectors(&columns),
                    torque: prepared.thinned(&rest)?,
                    valid: prepared.rows_to_use(joint),
                })
            })
            .collect()
    }

    /// Logged torque without free parameter: what is known, and what sensors do beyond being linear.
    fn fixed(&self, joint: usize, parts: &Parts, sensed: &impl Fn(&[f64]) -> Vec<f64>, period: f64) -> Vec<f64> {
        let mut fixed = sensed(&parts.known[joint]);
        if self.sensors(joint).next().is_some() {
            let total = parts.predicted(joint, &self.all_linear());
            let logged = self.distorted(joint, &total, period, |placed| placed.parameters.clone());
            let amplitudes: Vec<f64> = {
                let mut sum = vec![0.0; total.len()];
                for (effect, k) in self.amplitudes() {
                    if let Some(column) = self.sensor_amplitude(joint, effect, k, total.len(), period) {
                        let value = self.placed[effect].parameters[k];
                        sum.iter_mut().zip(column).for_each(|(s, c)| *s += value * c);
                    }
                }
                sum
            };
            let linear = sensed(&total);
            for (((value, logged), linear), extra) in fixed.iter_mut().zip(logged).zip(linear).zip(amplitudes) {
                *value += logged - linear - extra;
            }
        }
        fixed
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

    /// A torque signal of a joint as its sensors would log it, with the parameters that `of` gives each.
    fn distorted(&self, joint: usize, signal: &[f64], period: f64, of: impl Fn(&Placed) -> Vec<f64>) -> Vec<f64> {
        let mut logged = signal.to_vec();
        for placed in self.sensors(joint) {
            placed.effect.distort_torque(&of(placed), &mut logged, period);
        }
        logged
    }

    /// The linear part of what the sensors do: their small-signal response.
    fn sensed(&self, joint: usize, signal: &[f64], period: f64) -> Vec<f64> {
        if self.sensors(joint).next().is_none() {
            return signal.to_vec();
        }
        let largest = signal.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        if largest == 0.0 {
            return signal.to_vec();
        }
        let scale = SMALL / largest;
        let small: Vec<f64> = signal.iter().map(|v| v * scale).collect();
        let response = self.distorted(joint, &small, period, without_amplitudes);
        response.iter().map(|v| v / scale).collect()
    }

    /// Logged torque per unit of an amplitude that acts in the sensor of `joint`.
    fn sensor_amplitude(&self, joint: usize, effect: usize, k: usize, samples: usize, period: f64) -> Option<Vec<f64>> {
        let placed = &self.placed[effect];
        if !self.sensors(joint).any(|other| std::ptr::eq(other, placed)) {
            return None;
        }
        let mut unit = without_amplitudes(placed);
        unit[k] = 1.0;
        let mut column = vec![0.0; samples];
        placed.effect.distort_torque(&unit, &mut column, period);
        Some(column)
    }

    /// The recording with the encoders' errors taken out of its positions, if effects put any in.
    fn without_encoder_errors(&self, recording: &Recording) -> Option<Recording> {
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

    /// The gear of a joint, if it is not rigid.
    fn gear(&self, joint: usize) -> Option<Gear> {
        let gears = self.placed.iter().filter(|placed| placed.joint == joint);
        let gear = gears.filter_map(|placed| placed.effect.gear(&placed.parameters)).reduce(Gear::in_series)?;
        (!gear.is_rigid()).then_some(gear)
    }

    /// Motion of the links: that of the motors less the twist of the gears under the torque they carry.
    fn link_motion(&self, prepared: &Prepared, period: f64) -> Result<Motion> {
        let mut link = prepared.motion.clone();
        if (0..self.model.dof()).all(|joint| self.gear(joint).is_none()) {
            return Ok(link);
        }
        for _ in 0..UNDO_ROUNDS {
            let parts = Parts::without_effects(self, prepared, &link);
            let mut next = prepared.motion.clone();
            for joint in 0..self.model.dof() {
                let Some(gear) = self.gear(joint) else { continue };
                let rotor = self.model.robot().joints[joint].drive.armature;
                let gear = gear.completed(rotor);
                let twist: Vec<f64> = parts.carried(joint).iter().map(|&torque| gear.twist(torque)).collect();
                let mut rate = vec![0.0; twist.len()];
                let mut second = rate.clone();
                first_derivative(&twist, period, &mut rate)?;
                first_derivative(&rate, period, &mut second)?;
                for (channel, change) in [
                    (next.q.channel_mut(joint), &twist),
                    (next.qd.channel_mut(joint), &rate),
                    (next.qdd.channel_mut(joint), &second),
                ] {
                    channel.iter_mut().zip(change).for_each(|(value, c)| *value -= c);
                }
            }
            link = next;
        }
        Ok(link)
    }
}

/// Torque of all parts along one motion, before sensors and filter.
struct Parts<'a> {
    owner: &'a EffectModel<'a>,
    arm: Vec<Channels>,
    /// Per amplitude: torque per unit.
    amplitudes: Vec<Channels>,
    /// Torque without free parameter.
    known: Vec<Vec<f64>>,
    motor: &'a Motion,
    link: &'a Motion,
    inertial: Channels,
}

impl<'a> Parts<'a> {
    fn without_effects(owner: &'a EffectModel, prepared: &'a Prepared, link: &'a Motion) -> Self {
        let model = owner.model;
        let arm = model.columns_behind_gears(&prepared.motion, link, &prepared.time, 0.0);
        let inertial = inverse_dynamics(model.chain(), &model.robot().inertial_parameters(), link);
        let known = (0..model.dof())
            .map(|joint| match owner.trust {
                Trust::Nominal => inertial.channel(joint).to_vec(),
                // A rotor that is lumped with its link moves apart from it behind a gear.
                Trust::Structure if !model.rotor_stands_alone(joint) => {
                    let rotor = model.robot().joints[joint].drive.armature;
                    let motor = prepared.motion.qdd.channel(joint);
                    motor.iter().zip(link.qdd.channel(joint)).map(|(m, l)| rotor * (m - l)).collect()
                }
                Trust::Structure => vec![0.0; link.samples()],
            })
            .collect();
        Parts { owner, arm, amplitudes: Vec::new(), known, motor: &prepared.motion, link, inertial }
    }

    fn new(owner: &'a EffectModel, prepared: &'a Prepared, link: &'a Motion) -> Self {
        let mut parts = Self::without_effects(owner, prepared, link);
        let model = owner.model;
        let along = Along::new(model.robot(), model.chain(), &prepared.time, &prepared.motion, 0.0);
        let silent: Vec<Placed> = owner
            .placed
            .iter()
            .map(|placed| Placed { parameters: without_amplitudes(placed), ..placed.clone() })
            .collect();
        let mut all = silent.clone();
        for (effect, k) in owner.amplitudes() {
            let mut unit = silent[effect].clone();
            unit.parameters[k] = 1.0;
            all.push(unit);
        }
        let mut torques = contributions(&all, &along);
        let mut units = torques.split_off(silent.len());
        for (unit, (effect, _)) in units.iter_mut().zip(owner.amplitudes()) {
            let base = torques[effect].as_slice();
            unit.as_mut_slice().iter_mut().zip(base).for_each(|(value, b)| *value -= b);
        }
        for torque in &torques {
            for (known, extra) in parts.known.iter_mut().zip(torque.iter()) {
                known.iter_mut().zip(extra).for_each(|(value, e)| *value += e);
            }
        }
        parts.amplitudes = units;
        parts
    }

    /// All columns that can act on a joint, with the index of their linear parameter.
    fn columns(&self, joint: usize) -> Vec<(usize, Vec<f64>)> {
        let mut columns = self.arm_columns(joint);
        let offset = self.owner.baseline.len();
        for (index, torque) in self.amplitudes.iter().enumerate() {
            let column = torque.channel(joint);
            if column.iter().any(|&v| v != 0.0) {
                columns.push((offset + index, column.to_vec()));
            }
        }
        columns
    }

    fn arm_columns(&self, joint: usize) -> Vec<(usize, Vec<f64>)> {
        let model = self.owner.model;
        let active = model.active(joint);
        match self.owner.trust {
            Trust::Structure => active.into_iter().zip(self.arm[joint].iter().map(<[f64]>::to_vec)).collect(),
            Trust::Nominal => {
                let mut columns = vec![(3 * joint, self.motor.qdd.channel(joint).to_vec())];
                // Viscous and Coulomb friction are base parameters of their own on every arm, in this order.
                let friction = active.iter().zip(self.arm[joint].iter()).filter(|(b, _)| model.is_friction(**b));
                columns.extend(friction.enumerate().map(|(k, (_, column))| (3 * joint + 1 + k, column.to_vec())));
                columns
            }
        }
    }

    /// Torque on a joint that the present parameters predict, before sensors.
    fn predicted(&self, joint: usize, linear: &[f64]) -> Vec<f64> {
        let mut torque = self.known[joint].clone();
        for (parameter, column) in self.columns(joint) {
            torque.iter_mut().zip(column).for_each(|(value, x)| *value += linear[parameter] * x);
        }
        torque
    }

    /// Torque that the gear of a joint carries: that of the rigid bodies, without rotor and friction.
    fn carried(&self, joint: usize) -> Vec<f64> {
        let model = self.owner.model;
        match self.owner.trust {
            Trust::Nominal => self.inertial.channel(joint).to_vec(),
            Trust::Structure => {
                let lumped = !model.rotor_stands_alone(joint);
                let rotor = if lumped { model.robot().joints[joint].drive.armature } else { 0.0 };
                let mut torque: Vec<f64> = self.link.qdd.channel(joint).iter().map(|a| -rotor * a).collect();
                for (b, column) in model.active(joint).into_iter().zip(self.arm[joint].iter()) {
                    if model.is_inertial(b) {
                        torque.iter_mut().zip(column).for_each(|(value, x)| *value += self.owner.baseline[b] * x);
                    }
                }
                torque
            }
        }
    }
}

/// Parameters of an effect with its amplitudes at zero.
fn without_amplitudes(placed: &Placed) -> Vec<f64> {
    let parameters = placed.effect.parameters().iter().zip(&placed.parameters);
    parameters.map(|(p, &value)| if p.role == Role::Amplitude { 0.0 } else { value }).collect()
}

/// Names of the arm's linear parameters.
fn baseline_names(model: &Model, trust: Trust) -> Vec<String> {
    match trust {
        Trust::Structure => model.base().groupings().iter().map(|g| g.name.clone()).collect(),
        Trust::Nominal => (1..=model.dof()).flat_map(|j| ["Ia", "Fv", "Fc"].map(|s| format!("{s}{j}"))).collect(),
    }
}

/// The arm's linear parameters according to its URDF: where fits start.
fn baseline_values(model: &Model, trust: Trust) -> Vec<f64> {
    match trust {
        Trust::Structure => model.base().values(&Model::standard_values(model.robot())),
        Trust::Nominal => model
            .robot()
            .joints
            .iter()
            .flat_map(|joint| [joint.drive.armature, joint.drive.viscous, joint.drive.coulomb])
            .collect(),
    }
}
