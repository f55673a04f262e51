//! A scenario brought to life: the arm, the plant, the controller's belief, motions and sensors.

use super::locate::Located;
use super::{MotionSpec, PerJoint, Scenario};
use crate::effects::{CoulombFriction, Placed, ViscousFriction};
use crate::error::{Error, Result};
use crate::excitation::{self, JointLimits, Motion, MotionFile};
use crate::random;
use crate::robot::{self, InertiaCheck, Robot};
use crate::simulation::integrator::Integrator;
use crate::simulation::sensors::JointSensors;
use rand::RngExt;
use std::path::Path;

/// An arm with its sensors and limits: what a scenario says before any motion.
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
        let (scenario, text) = read(path.as_ref(), seed)?;
        Self::new(scenario, &Located::new(path.as_ref(), &text))
    }

    fn new(scenario: Scenario, at: &Located) -> Result<Self> {
        let mut known = robot::load(&scenario.robot.urdf, InertiaCheck::Required)?;
        if known.name != scenario.robot.name {
            let (wanted, file, found) = (&scenario.robot.name, known.source.display(), &known.name);
            return Err(at.error("robot.name", format!("the scenario is for `{wanted}`, but {file} is `{found}`")));
        }
        if let Some(gravity) = scenario.robot.gravity_m_s2 {
            known.gravity = gravity.into();
        }
        check_lengths(&scenario, known.dof(), at)?;
        override_drives(&scenario, &mut known);
        let (limits, sensors) = (limits(&scenario, &known), sensors(&scenario, known.dof()));
        Ok(Arm { scenario, known, sensors, limits })
    }
}

/// A scenario and its text, with the seed replaced where one is given.
fn read(path: &Path, seed: Option<u64>) -> Result<(Scenario, String)> {
    let mut scenario = Scenario::load(path)?;
    scenario.seed = seed.unwrap_or(scenario.seed);
    let text = std::fs::read_to_string(path).map_err(|e| Error::io(path, "read the scenario", e))?;
    Ok((scenario, text))
}

/// Everything a run needs, checked against each other.
#[derive(Clone)]
pub struct Setup {
    /// The scenario, with paths resolved.
    pub scenario: Scenario,
    /// The arm as it is known: the URDF with the scenario's friction, rotors and gravity.
    pub known: Robot,
    /// The arm as simulated, bodies altered by the effects: the plant's truth.
    pub plant: Robot,
    /// What the controller believes the arm to be.
    pub nominal: Robot,
    /// Friction and other effects at work in the plant.
    pub effects: Vec<Placed>,
    /// Sensors of every joint.
    pub sensors: Vec<JointSensors>,
    /// Limits of the motions.
    pub limits: Vec<JointLimits>,
    /// The motion that is identified from.
    pub motion: Motion,
    /// The motion on which the identified model is judged.
    pub held_out: Motion,
}

impl Setup {
    /// Reads a scenario with everything it refers to. `seed` replaces the scenario's seed where given.
    ///
    /// # Errors
    /// Names file, line and key or joint for anything that is missing, malformed, impossible or meant for another arm,
    /// and for motions outside the limits.
    pub fn load(path: impl AsRef<Path>, seed: Option<u64>) -> Result<Self> {
        let (scenario, text) = read(path.as_ref(), seed)?;
        Self::new(scenario, &Located::new(path.as_ref(), &text))
    }

    /// The scenario as it was run, with the versions that ran it, as TOML.
    ///
    /// # Errors
    /// If a number has no TOML form.
    pub fn merged(&self) -> Result<String> {
        let scenario = toml::to_string_pretty(&self.scenario)
            .map_err(|problem| Error::request("scenario", format!("cannot be written: {problem}")))?;
        let versions = [
            ("tauscope", env!("CARGO_PKG_VERSION")),
            ("rapier3d", rapier3d::VERSION),
            ("random_generator", random::GENERATOR),
        ];
        let mut text = String::from("# The scenario as it was run. Versions:\n");
        for (name, version) in versions {
            text += &format!("#   {name} {version}\n");
        }
        Ok(text + "\n" + &scenario)
    }

    fn new(scenario: Scenario, at: &Located) -> Result<Self> {
        let Arm { scenario, known, sensors, limits } = Arm::new(scenario, at)?;
        let motion = self::motion(&scenario, &scenario.motion, "motion", &known, &limits)?;
        let held_out = self::motion(&scenario, &scenario.held_out, "held_out", &known, &limits)?;
        let mut effects = drive_friction(&known);
        let mut plant = known.clone();
        for spec in &scenario.effects {
            let placed = spec.place(&known).map_err(|problem| at.error("effect", problem))?;
            placed.effect.alter(&placed.parameters, placed.joint, &mut plant);
            effects.push(placed);
        }
        let geared = effects.iter().find(|placed| placed.effect.gear(&placed.parameters).is_some());
        if let (Integrator::RapierNative, Some(placed)) = (scenario.plant.integrator, geared) {
            let name = placed.effect.about().name;
            return Err(at.error("plant.integrator", format!("rapier_native cannot carry `{name}`; use rk4")));
        }
        Ok(Setup {
            nominal: misjudged(&known, scenario.controller.model_error, scenario.seed),
            sensors,
            scenario,
            known,
            plant,
            effects,
            limits,
            motion,
            held_out,
        })
    }
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

fn limits(scenario: &Scenario, plant: &Robot) -> Vec<JointLimits> {
    plant
        .joints
        .iter()
        .zip(scenario.limits.acceleration_rad_s2.values(plant.dof()))
        .map(|(joint, acceleration)| JointLimits {
            lower: joint.limits.lower,
            upper: joint.limits.upper,
            velocity: joint.limits.velocity,
            acceleration,
        })
        .collect()
}

fn motion(
    scenario: &Scenario,
    spec: &MotionSpec,
    label: &str,
    plant: &Robot,
    limits: &[JointLimits],
) -> Result<Motion> {
    let names = plant.joint_names();
    let motion = match (&spec.file, &spec.random) {
        (Some(file), _) => MotionFile::read(file)?.for_arm(&plant.name, &names)?,
        (None, Some(random)) => Motion::Freudenstein(excitation::random_sequence::random_sequence(
            scenario.seed,
            label,
            0,
            random.moves,
            random.duration_s,
            limits,
        )?),
        (None, None) => return Err(Error::request(label, "give exactly one of `file` and `random`")),
    };
    excitation::limits::check(&motion, limits, 1.0 / scenario.plant.step_s, &names)?;
    Ok(motion)
}

/// The friction of the plant's drives as effects.
fn drive_friction(plant: &Robot) -> Vec<Placed> {
    plant
        .joints
        .iter()
        .enumerate()
        .flat_map(|(joint, spec)| {
            [
                Placed { effect: &ViscousFriction, joint, parameters: vec![spec.drive.viscous] },
                Placed { effect: &CoulombFriction, joint, parameters: vec![spec.drive.coulomb] },
            ]
        })
        .filter(|placed| placed.parameters[0] > 0.0)
        .collect()
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

/// A copy of `robot` in which every body, friction and rotor is wrong by a factor drawn from 1 - error .. 1 + error.
/// A body is scaled as a whole, so that it stays one that can exist.
fn misjudged(robot: &Robot, error: f64, seed: u64) -> Robot {
    let mut source = random::stream(seed, "controller model", 0);
    let mut factor = || if error > 0.0 { source.random_range(1.0 - error..=1.0 + error) } else { 1.0 };
    let mut wrong = robot.clone();
    for joint in &mut wrong.joints {
        let body = factor();
        joint.inertia.0.iter_mut().for_each(|value| *value *= body);
        for value in [&mut joint.drive.viscous, &mut joint.drive.coulomb, &mut joint.drive.armature] {
            *value *= factor();
        }
    }
    wrong
}
