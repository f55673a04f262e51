//! Torque of the arm and of its effects along one motion, before sensors and filter.

use super::arm::Arm;
use super::arm_parameters::{ArmParameter, Trust, drive_of};
use super::sensing::without_amplitudes;
use super::state::EffectModel;
use crate::channels::Channels;
use crate::dynamics::{Motion, inverse_dynamics};
use crate::effects::{Placed, direction};
use crate::identification::preparation::prepare::Prepared;
use std::borrow::Cow;
use std::cell::OnceCell;

/// Torque of all parts along one motion, before sensors and filter.
pub(super) struct Parts<'a> {
    owner: &'a EffectModel<'a>,
    /// Columns of the base parameters on each joint, made when they are asked for: those of all joints of a long log are
    /// the largest thing there is.
    base: Vec<OnceCell<Channels>>,
    link: &'a Motion,
    /// Per amplitude: torque per unit.
    amplitudes: Vec<Channels>,
    /// Torque without free parameter: of bodies and drives from the URDF, and of effects through their departures. Empty where
    /// there is none.
    known: Vec<Vec<f64>>,
    motor: &'a Motion,
}

impl<'a> Parts<'a> {
    pub(super) fn new(owner: &'a EffectModel, arm: &Arm, prepared: &'a Prepared, link: &'a Motion) -> Self {
        let model = owner.model;
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
        let mut torques = owner.bodies.contributions(&all, &prepared.time, &prepared.motion);
        let units = torques.split_off(silent.len());
        let with_units = units.iter().zip(owner.amplitudes());
        let amplitudes = with_units.map(|(unit, (effect, _))| {
            let mut torque = Channels::zeros(model.dof(), link.samples());
            unit.add_to(1.0, &mut torque);
            torques[effect].add_to(-1.0, &mut torque);
            torque
        });
        let amplitudes = amplitudes.collect();
        let bodies = Self::bodies(owner, arm, prepared, link);
        let mut parts = Parts {
            owner,
            base: vec![OnceCell::new(); model.dof()],
            link,
            amplitudes,
            known: bodies,
            motor: &prepared.motion,
        };
        for joint in 0..model.dof() {
            let mut sum = std::mem::take(&mut parts.known[joint]);
            let mut add = |scale: f64, column: &[f64]| {
                sum.resize(column.len(), 0.0);
                sum.iter_mut().zip(column).for_each(|(value, x)| *value += scale * x);
            };
            for torque in torques.iter().filter_map(|torque| torque.on(joint)) {
                add(1.0, torque);
            }
            for &(parameter, value) in &owner.nominal {
                if let Some(column) = parts.column(parameter, joint) {
                    add(value, &column);
                }
            }
            parts.known[joint] = sum;
            parts.release(joint);
        }
        parts
    }

    /// Forgets the columns of the base parameters on a joint until they are asked for again.
    pub(super) fn release(&mut self, joint: usize) {
        self.base[joint].take();
    }

    fn base(&self, joint: usize) -> &Channels {
        self.base[joint].get_or_init(|| self.owner.model.columns_on(joint, self.motor, self.link, 0.0))
    }

    /// Torque on a joint that has no free parameter; None where there is none.
    pub(super) fn known(&self, joint: usize) -> Option<&[f64]> {
        Some(self.known[joint].as_slice()).filter(|torque| !torque.is_empty())
    }

    /// Torque of bodies that is not fitted.
    fn bodies(owner: &EffectModel, arm: &Arm, prepared: &Prepared, link: &Motion) -> Vec<Vec<f64>> {
        let model = owner.model;
        let joints = 0..model.dof();
        match owner.trust {
            Trust::Nominal => {
                let torque = inverse_dynamics(model.chain(), &model.robot().inertial_parameters(), link);
                joints.map(|joint| torque.channel(joint).to_vec()).collect()
            }
            // A rotor that is lumped with its link moves apart from it behind a gear.
            Trust::Structure => joints
                .map(|joint| {
                    let is_lumped = !model.rotor_stands_alone(joint);
                    let rotor = if is_lumped { arm.found().joints[joint].drive.armature } else { 0.0 };
                    if rotor == 0.0 || std::ptr::eq(link, &prepared.motion) {
                        return Vec::new();
                    }
                    let motor = prepared.motion.qdd.channel(joint);
                    motor.iter().zip(link.qdd.channel(joint)).map(|(m, l)| rotor * (m - l)).collect()
                })
                .collect(),
        }
    }

    /// Torque on a joint per unit of a parameter of the arm; None where it cannot act.
    pub(super) fn column(&self, parameter: ArmParameter, joint: usize) -> Option<Cow<'_, [f64]>> {
        let model = self.owner.model;
        match (drive_of(model, parameter), parameter) {
            (Some((own, _)), _) if own != joint => None,
            (Some((_, 0)), _) => Some(self.motor.qdd.channel(joint).into()),
            (Some((_, 1)), _) => Some(self.motor.qd.channel(joint).into()),
            (Some(_), _) => Some(self.motor.qd.channel(joint).iter().map(|&v| direction(v, 0.0)).collect()),
            (None, ArmParameter::Base(base)) => {
                let place = model.active(joint).iter().position(|&b| b == base)?;
                Some(self.base(joint).channel(place).into())
            }
            (None, ArmParameter::Drive(..)) => None,
        }
    }

    /// All columns that can act on a joint, with the index of their linear parameter.
    pub(super) fn columns(&self, joint: usize) -> Vec<(usize, Cow<'_, [f64]>)> {
        let arm = self.owner.arm.iter().enumerate();
        let arm = arm.filter_map(|(index, &parameter)| Some((index, self.column(parameter, joint)?)));
        arm.chain(self.amplitudes(joint).map(|(index, column)| (index, column.into()))).collect()
    }

    /// The columns of amplitudes that can act on a joint, with the index of their linear parameter.
    pub(super) fn amplitudes(&self, joint: usize) -> impl Iterator<Item = (usize, &[f64])> {
        let offset = self.owner.baseline.len();
        let columns = self.amplitudes.iter().enumerate().map(move |(k, torque)| (offset + k, torque.channel(joint)));
        columns.filter(|(_, column)| column.iter().any(|&v| v != 0.0))
    }

    /// Torque on a joint that the present parameters predict, before sensors.
    pub(super) fn predicted(&self, joint: usize, linear: &[f64]) -> Vec<f64> {
        let mut torque = vec![0.0; self.motor.samples()];
        if let Some(known) = self.known(joint) {
            torque.copy_from_slice(known);
        }
        for (parameter, column) in self.columns(joint) {
            torque.iter_mut().zip(column.iter()).for_each(|(value, x)| *value += linear[parameter] * x);
        }
        torque
    }
}
