//! From the units and the side of the gear that a file is in to SI units at the joints.

use super::description::Dataset;
use super::spec::{PerJoint, Side};
use super::units::{OfJoints, UnitOf};
use crate::channels::Channels;
use crate::error::Result;
use crate::recording::Recording;
use crate::recording::lenient::Sieved;
use crate::robot::LinearMap;
use nalgebra::DMatrix;
use std::f64::consts::TAU;

/// Fewest joints that move whose angles may be in rad where the dataset has them in degrees.
const FEWEST_DEGREES: usize = 2;

impl Dataset {
    /// Converts a log, whose joints are in the order of the file's columns.
    pub(super) fn convert(&self, sieved: &mut Sieved) -> Result<()> {
        let log = &mut sieved.recording;
        let (units, motors) = (&self.spec.units, &self.spec.motors);
        let dof = log.joints();
        let gear = self.list("motors.gear_ratio", &motors.gear_ratio, dof)?;
        let constant = self.list("motors.torque_constant_nm_a", &motors.torque_constant_nm_a, dof)?;
        let sign = self.signs("motors.sign", &motors.sign, dof)?;
        let torque_sign = self.signs("motors.torque_sign", &motors.torque_sign, dof)?;
        let needs = |key: &str, reason: &str| self.error(key, format!("is missing: {reason}"));

        let at_motor = |side: Option<Side>, otherwise: Side| side.unwrap_or(otherwise) == Side::Motor;
        let motion_gear = match (at_motor(motors.position_at, Side::Joint), &gear) {
            (true, None) => return Err(needs("motors.gear_ratio", "positions are at the motors")),
            (true, Some(gear)) => gear.clone(),
            (false, _) => vec![1.0; dof],
        };
        let mut torque_factor = vec![units.torque.map_or(1.0, UnitOf::factor); dof];
        // Currents by their name become torques where the dataset says how.
        let currents = units.torque.is_some_and(UnitOf::is_current) || (sieved.currents && constant.is_some());
        if currents {
            let Some(constant) = &constant else {
                return Err(needs("motors.torque_constant_nm_a", "torque is given as a current"));
            };
            scale(&mut torque_factor, constant);
        }
        sieved.currents &= units.torque.is_none() && !currents;
        // A torque constant without a gear is that at the joint.
        let usual = if currents && gear.is_some() { Side::Motor } else { Side::Joint };
        match (at_motor(motors.torque_at, usual), &gear) {
            (true, None) => return Err(needs("motors.gear_ratio", "torques are at the motors")),
            (true, Some(gear)) => scale(&mut torque_factor, gear),
            (false, _) => {}
        }
        scale(&mut torque_factor, &sign);
        scale(&mut torque_factor, &torque_sign);

        let clock = self.time_factor()?;
        log.time.iter_mut().for_each(|t| *t *= clock);
        let moved = |unit: Vec<f64>| -> Vec<f64> { (0..dof).map(|j| unit[j] * sign[j] / motion_gear[j]).collect() };
        let position = self.units("units.position", &units.position, dof)?;
        let velocity = self.units("units.velocity", &units.velocity, dof)?;
        let acceleration = self.units("units.acceleration", &units.acceleration, dof)?;
        sieved.corrections.extend(self.doubt_on_degrees(&log.q, &position, &motion_gear));
        apply(&mut log.q, &moved(position));
        for (joint, offset) in
            self.offsets("motors.position_offset", &motors.position_offset, dof)?.into_iter().enumerate()
        {
            log.q.channel_mut(joint).iter_mut().for_each(|position| *position += offset);
        }
        if let Some(qd) = &mut log.qd {
            apply(qd, &moved(velocity));
        }
        if let Some(qdd) = &mut log.qdd {
            apply(qdd, &moved(acceleration));
        }
        apply(&mut log.tau, &torque_factor);
        for (joint, offset) in self.offsets("motors.torque_offset", &motors.torque_offset, dof)?.into_iter().enumerate()
        {
            log.tau.channel_mut(joint).iter_mut().for_each(|torque| *torque -= offset);
        }
        log.truth = None;
        // Offsets are in SI units: what was added to converted values cannot be converted back with them.
        let has_offset = [motors.position_offset.is_some(), motors.torque_offset.is_some()];
        sieved.doubts.retain(|doubt| !has_offset[usize::from(doubt.is_of_torque())]);

        if let Some((joints, motors)) = self.coupling(dof)? {
            log.q = joints.positions(&log.q);
            log.qd = log.qd.as_ref().map(|qd| joints.rates(qd));
            log.qdd = log.qdd.as_ref().map(|qdd| joints.rates(qdd));
            log.tau = motors.torques(&log.tau);
        }
        Ok(())
    }

    /// The joints as they follow the motors, and the motors as they follow the joints.
    ///
    /// The motors follow the joints as a joint follows one that it mimics, and their torques come to the joints by the same
    /// law. The joints stay the coordinates: limits, friction and the laws of the effects are theirs, and the identified URDF
    /// has no place for a coordinate that is no joint.
    fn coupling(&self, dof: usize) -> Result<Option<(LinearMap, LinearMap)>> {
        let key = "motors.coupling";
        let Some(rows) = &self.spec.motors.coupling else { return Ok(None) };
        if rows.len() != dof || rows.iter().any(|row| row.len() != dof) {
            return Err(self.error(key, format!("must have {dof} rows of {dof} numbers")));
        }
        let joints = LinearMap::of_matrix(&DMatrix::from_fn(dof, dof, |i, j| rows[i][j]));
        match joints.inverse() {
            Some(motors) => Ok(Some((joints, motors))),
            None => Err(self.error(key, "is singular: some motion of the motors would not move the joints")),
        }
    }

    /// What is said of degrees in which no joint goes as far as a turn has radians: the dataset decides it, though few arms move so little.
    fn doubt_on_degrees(&self, q: &Channels, unit: &[f64], gear: &[f64]) -> Option<String> {
        let largest =
            |joint: usize| q.channel(joint).iter().filter(|q| q.is_finite()).fold(0.0f64, |m, q| m.max(q.abs()));
        let in_degrees = (0..unit.len()).filter(|&joint| unit[joint] == 1f64.to_radians() && gear[joint] == 1.0);
        let sizes: Vec<f64> = in_degrees.map(largest).filter(|size| *size > 0.0).collect();
        let most = sizes.iter().copied().fold(0.0, f64::max);
        (sizes.len() >= FEWEST_DEGREES && most <= TAU).then(|| {
            format!(
                "positions are in deg by units.position of the dataset, and none exceeds {most:.3} deg: if they are in rad, set it to \"rad\""
            )
        })
    }

    /// The factor of the unit of each joint.
    fn units<const QUANTITY: usize>(
        &self,
        key: &str,
        given: &Option<OfJoints<UnitOf<QUANTITY>>>,
        dof: usize,
    ) -> Result<Vec<f64>> {
        let Some(given) = given else { return Ok(vec![1.0; dof]) };
        match given {
            OfJoints::All(unit) => Ok(vec![unit.factor(); dof]),
            OfJoints::Each(units) if units.len() == dof => Ok(units.iter().map(|unit| unit.factor()).collect()),
            OfJoints::Each(units) => Err(self.error(key, format!("{} units for {dof} joints", units.len()))),
        }
    }

    /// True seconds per second of the log.
    fn time_factor(&self) -> Result<f64> {
        match self.spec.units.time_factor {
            None => Ok(1.0),
            Some(factor) if factor.is_finite() && factor > 0.0 => Ok(factor),
            Some(bad) => Err(self.error("units.time_factor", format!("{bad} must be a finite number above zero"))),
        }
    }

    /// Offsets of the joints, which may be zero.
    fn offsets(&self, key: &str, given: &Option<PerJoint>, dof: usize) -> Result<Vec<f64>> {
        let values = match given {
            None => return Ok(vec![0.0; dof]),
            Some(PerJoint::All(value)) => vec![*value; dof],
            Some(PerJoint::Each(values)) => values.clone(),
        };
        if values.len() != dof {
            return Err(self.error(key, format!("{} values for {dof} joints", values.len())));
        }
        match values.iter().find(|value| !value.is_finite()) {
            Some(bad) => Err(self.error(key, format!("{bad} must be a finite number"))),
            None => Ok(values),
        }
    }

    /// Exchanges the columns of pairs of joints, in a log whose joints are in the robot's order.
    pub(super) fn exchange(&self, log: &mut Recording) -> Result<()> {
        let motors = &self.spec.motors;
        for (key, pairs) in
            [("torques_exchanged", &motors.torques_exchanged), ("positions_exchanged", &motors.positions_exchanged)]
        {
            for pair in pairs.iter().flatten() {
                let mut places = [0; 2];
                for (place, name) in places.iter_mut().zip(pair) {
                    *place = log.joints.iter().position(|joint| joint == name).ok_or_else(|| {
                        let problem =
                            format!("`{name}` is no joint of the arm; its joints are {}", log.joints.join(", "));
                        self.error(&format!("motors.{key}"), problem)
                    })?;
                }
                let exchanged = |table: &Channels| {
                    let of = |joint: usize| match places.iter().position(|place| *place == joint) {
                        Some(at) => places[1 - at],
                        None => joint,
                    };
                    table.map(|joint, _| table.channel(of(joint)).to_vec())
                };
                if key == "torques_exchanged" {
                    log.tau = exchanged(&log.tau);
                } else {
                    log.q = exchanged(&log.q);
                    log.qd = log.qd.as_ref().map(exchanged);
                    log.qdd = log.qdd.as_ref().map(exchanged);
                }
            }
        }
        Ok(())
    }

    fn list(&self, key: &str, given: &Option<PerJoint>, dof: usize) -> Result<Option<Vec<f64>>> {
        let values = match given {
            None => return Ok(None),
            Some(PerJoint::All(value)) => vec![*value; dof],
            Some(PerJoint::Each(values)) => values.clone(),
        };
        if values.len() != dof {
            return Err(self.error(key, format!("{} values for {dof} joints", values.len())));
        }
        match values.iter().find(|value| !value.is_finite() || **value == 0.0) {
            Some(bad) => Err(self.error(key, format!("{bad} must be a finite number other than zero"))),
            None => Ok(Some(values)),
        }
    }

    fn signs(&self, key: &str, given: &Option<PerJoint>, dof: usize) -> Result<Vec<f64>> {
        let signs = self.list(key, given, dof)?.unwrap_or(vec![1.0; dof]);
        match signs.iter().find(|sign| sign.abs() != 1.0) {
            Some(bad) => Err(self.error(key, format!("{bad} is no sign; give 1 or -1"))),
            None => Ok(signs),
        }
    }
}

fn scale(values: &mut [f64], factors: &[f64]) {
    values.iter_mut().zip(factors).for_each(|(value, factor)| *value *= factor);
}

fn apply(table: &mut Channels, factors: &[f64]) {
    for (joint, factor) in factors.iter().enumerate() {
        table.channel_mut(joint).iter_mut().for_each(|value| *value *= factor);
    }
}
