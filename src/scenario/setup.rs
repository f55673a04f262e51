//! A scenario brought to life: the arm, the plant, the controller's belief, motions and sensors.

use super::locate::Located;
use super::{Arm, Scenario, load, motions};
use crate::effects::{Placed, Site, drive_friction};
use crate::error::{Error, Result};
use crate::excitation::{JointLimits, Motion};
use crate::random;
use crate::robot::Robot;
use crate::simulation::integrator::Integrator;
use crate::simulation::sensors::JointSensors;
use chacha20::ChaCha8Rng;
use rand::RngExt;
use std::path::Path;

/// Names of the copies of a scenario's inputs among its results.
const ROBOT_COPY: &str = "robot.urdf";
const MOTION_COPY: &str = "motion.toml";
const HELD_OUT_COPY: &str = "held_out.toml";

/// Everything a run needs, checked against each other.
///
/// ```
/// use tauscope::excitation::Reference;
/// use tauscope::scenario::Setup;
///
/// // A scenario with its arm and two motions, drawn from its seed or from another one.
/// let setup = Setup::load("tests/scenarios/pendulum.toml", None)?;
/// assert_eq!((setup.motion.duration_s(), setup.held_out.duration_s()), (6.0, 4.0));
/// assert_ne!(setup.motion, Setup::load("tests/scenarios/pendulum.toml", Some(8))?.motion);
///
/// // Friction of the drive is at work in the plant.
/// let names: Vec<&str> = setup.effects.iter().map(|placed| placed.effect.about().name).collect();
/// assert_eq!(names, ["viscous_friction", "coulomb_friction"]);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
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
        load::with_seed(path.as_ref(), seed, Self::new)
    }

    /// The files the scenario refers to, under the names by which [`Setup::merged`] calls them.
    pub fn inputs(&self) -> Vec<(&'static str, &Path)> {
        let Scenario { robot, motion, held_out, .. } = &self.scenario;
        let motions = [(MOTION_COPY, &motion.file), (HELD_OUT_COPY, &held_out.file)];
        let motions = motions.into_iter().filter_map(|(name, file)| Some((name, file.as_deref()?)));
        std::iter::once((ROBOT_COPY, robot.urdf.as_path())).chain(motions).collect()
    }

    /// The scenario as it was run, with the versions that ran it, as TOML. It refers to copies of [`Setup::inputs`] in its
    /// own folder, so that the run can be repeated from there.
    ///
    /// # Errors
    /// If a number has no TOML form.
    pub fn merged(&self) -> Result<String> {
        let mut scenario = self.scenario.clone();
        scenario.robot.urdf = ROBOT_COPY.into();
        for (motion, name) in [(&mut scenario.motion, MOTION_COPY), (&mut scenario.held_out, HELD_OUT_COPY)] {
            motion.file.iter_mut().for_each(|file| *file = name.into());
        }
        let scenario = toml::to_string_pretty(&scenario)
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

    /// The same with another arm in place of the known one in the plant; the scenario's effects act on it as before.
    pub fn with_plant(&self, mut robot: Robot) -> Setup {
        let drives = drive_friction(&self.known).len();
        let mut effects = drive_friction(&robot);
        for placed in &self.effects[drives..] {
            placed.effect.alter(&placed.parameters, placed.joint, &mut robot);
            effects.push(placed.clone());
        }
        Setup { plant: robot, effects, ..self.clone() }
    }

    fn new(scenario: Scenario, at: &Located) -> Result<Self> {
        let Arm { mut scenario, known, sensors, limits } = Arm::new(scenario, at)?;
        let motion = motions::motion(&scenario, "motion", &known, &limits, at)?;
        let held_out = motions::motion(&scenario, "held_out", &known, &limits, at)?;
        let mut effects = drive_friction(&known);
        let mut native_step = None;
        let mut plant = known.clone();
        for (index, spec) in scenario.effects.iter().enumerate() {
            let placed = spec.place(&known).map_err(|problem| at.item_error("effect", index, problem))?;
            placed.effect.alter(&placed.parameters, placed.joint, &mut plant);
            if placed.effect.about().site == Site::Integrator && placed.parameters[0] > 0.0 {
                // The law says what rapier's own step does, so the plant takes that step.
                native_step = Some(placed.parameters[0]);
            }
            effects.push(placed);
        }
        if let Some(step) = native_step {
            scenario.plant.integrator = Integrator::RapierNative;
            scenario.plant.step_s = step;
            super::validate::check_step(&scenario, at)?;
        }
        let geared = effects.iter().find(|placed| placed.effect.gear(&placed.parameters).is_some());
        if let (Integrator::RapierNative, Some(placed)) = (scenario.plant.integrator, geared) {
            let name = placed.effect.about().name;
            return Err(at.error("plant.integrator", format!("rapier_native cannot carry `{name}`; use rk4")));
        }
        Ok(Setup {
            nominal: misjudged(
                &known,
                scenario.controller.model_error,
                &mut random::stream(scenario.seed, "controller model", 0),
            ),
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

/// A copy of `robot` in which every body, friction and rotor is wrong by a factor drawn from 1 - error .. 1 + error.
/// A body is scaled as a whole, so that it stays one that can exist.
pub(crate) fn misjudged(robot: &Robot, error: f64, source: &mut ChaCha8Rng) -> Robot {
    let mut factor = || if error > 0.0 { source.random_range(1.0 - error..=1.0 + error) } else { 1.0 };
    let mut wrong = robot.clone();
    for joint in &mut wrong.joints {
        let body = factor();
        joint.inertia.0.iter_mut().for_each(|value| *value *= body);
        for value in [&mut joint.drive.viscous, &mut joint.drive.coulomb, &mut joint.drive.armature] {
            *value *= factor();
        }
    }
    for follower in wrong.tree.iter_mut().flat_map(|tree| &mut tree.followers) {
        let body = factor();
        follower.joint.inertia.0.iter_mut().for_each(|value| *value *= body);
    }
    wrong
}
