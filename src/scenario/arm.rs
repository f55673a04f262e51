//! The arm of a scenario with its sensors and limits: all that a scenario says before any motion.

use super::locate::Located;
use super::{PerJoint, RobotSpec, Scenario, load, motions};
use crate::error::{Error, Result};
use crate::excitation::JointLimits;
use crate::robot::{Choice, InertiaCheck, LARGEST, Robot, description};
use crate::simulation::sensors::JointSensors;
use std::path::Path;

/// An arm with its sensors and limits.
///
/// ```
/// use tauscope::scenario::Arm;
///
/// // A scenario's arm with its limits and sensors; its motions are not read.
/// let arm = Arm::load("tests/scenarios/pendulum.toml", None)?;
/// assert_eq!((arm.known.dof(), arm.limits[0].acceleration), (1, 20.0));
/// assert_eq!(arm.sensors[0].torque_noise, 0.05);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Arm {
    /// The scenario, with paths resolved.
    pub scenario: Scenario,
    /// The arm as it is known: the URDF with the scenario's friction, rotors and gravity.
    pub known: Robot,
    /// Sensors of every joint.
    pub sensors: Vec<JointSensors>,
    /// Limits of the motions.
    pub limits: Vec<JointLimits>,
}

impl Arm {
    /// Reads a scenario with its arm, but not its motions. `seed` replaces the scenario's seed where given.
    ///
    /// # Errors
    /// Names file, line and key for anything that is missing, malformed, impossible or meant for another arm.
    pub fn load(path: impl AsRef<Path>, seed: Option<u64>) -> Result<Self> {
        load::with_seed(path.as_ref(), seed, Self::new)
    }

    pub(super) fn new(scenario: Scenario, at: &Located) -> Result<Self> {
        let mut known = known(&scenario, at)?;
        if known.name != scenario.robot.name {
            let (wanted, file, found) = (&scenario.robot.name, known.source.display(), &known.name);
            return Err(at.error("robot.name", format!("the scenario is for `{wanted}`, but {file} is `{found}`")));
        }
        if let Some(gravity) = scenario.robot.gravity_m_s2 {
            known.gravity = gravity.into();
        }
        check_lengths(&scenario, known.dof(), at)?;
        override_drives(&scenario, &mut known);
        let limits = motions::limits(&scenario, &known);
        let sensors = sensors(&scenario, known.dof());
        Ok(Arm { scenario, known, sensors, limits })
    }
}

/// The arm in the scenario's file, its joints those that the scenario lets move.
fn known(scenario: &Scenario, at: &Located) -> Result<Robot> {
    let RobotSpec { urdf, joints, tip, hold, .. } = &scenario.robot;
    if joints.is_some() && tip.is_some() {
        return Err(at.error("robot.tip", "give `joints` or `tip`, not both"));
    }
    let choice = Choice { joints: joints.clone(), tip: tip.clone(), hold: hold.clone() };
    let key = if joints.is_some() { "robot.joints" } else { "robot.tip" };
    // Requests are about what the scenario asks of the file.
    let robot = description::read(urdf)?.robot(&choice, InertiaCheck::Required).map_err(|problem| match problem {
        Error::Request { .. } => at.wrap(key, &problem),
        other => other,
    })?;
    if let Some(joints) = joints.as_ref().filter(|joints| **joints != robot.joint_names()) {
        let (given, own) = (joints.join(", "), robot.joint_names().join(", "));
        let problem = format!("{given}: the joints that move on their own, base to flange, are {own}; name them so");
        return Err(at.error("robot.joints", problem));
    }
    for (name, position) in hold {
        if !robot.held.iter().any(|(held, _)| held == name) {
            let names: Vec<&str> = robot.held.iter().map(|(name, _)| name.as_str()).collect();
            let names = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
            return Err(at.error("robot.hold", format!("`{name}` is no joint that is held; those are {names}")));
        }
        if !(-LARGEST..=LARGEST).contains(position) {
            return Err(at.error("robot.hold", format!("{name} = {position}: give a position in rad or m")));
        }
    }
    Ok(robot)
}

/// Refuses lists whose length is not the number of joints.
fn check_lengths(scenario: &Scenario, dof: usize, at: &Located) -> Result<()> {
    let wrong = scenario.per_joint().into_iter().find_map(|(key, value)| match value {
        PerJoint::Each(values) if values.len() != dof => Some((key, values.len())),
        _ => None,
    });
    match wrong {
        Some((key, length)) => {
            Err(at.error(key, format!("{length} values for {dof} joints; give one value, or one per joint")))
        }
        None => Ok(()),
    }
}

fn override_drives(scenario: &Scenario, plant: &mut Robot) {
    let dof = plant.dof();
    let values = |spec: &Option<PerJoint>| spec.as_ref().map(|per_joint| per_joint.values(dof));
    let (viscous, coulomb, armature) = (
        values(&scenario.plant.viscous_nms_rad),
        values(&scenario.plant.coulomb_nm),
        values(&scenario.plant.armature_kg_m2),
    );
    for (index, joint) in plant.joints.iter_mut().enumerate() {
        let drive = &mut joint.drive;
        for (target, given) in
            [(&mut drive.viscous, &viscous), (&mut drive.coulomb, &coulomb), (&mut drive.armature, &armature)]
        {
            if let Some(values) = given {
                *target = values[index];
            }
        }
    }
}

fn sensors(scenario: &Scenario, dof: usize) -> Vec<JointSensors> {
    let spec = &scenario.sensors;
    let resolution = spec.encoder_resolution_rad.values(dof);
    let encoder = spec.encoder_noise_rad.values(dof);
    let tachometer = spec.tachometer_noise_rad_s.as_ref().map(|noise| noise.values(dof));
    let torque = spec.torque_noise_nm.values(dof);
    let correlation = spec.torque_noise_correlation_s.values(dof);
    (0..dof)
        .map(|joint| JointSensors {
            encoder_resolution: resolution[joint],
            encoder_noise: encoder[joint],
            tachometer_noise: tachometer.as_ref().map(|noise| noise[joint]),
            torque_noise: torque[joint],
            torque_correlation_s: correlation[joint],
        })
        .collect()
}
