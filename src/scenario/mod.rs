//! Scenarios: one TOML file that says everything a run depends on. Unknown keys are refused, and everything is checked
//! before anything runs. Units are in the key names; inside the program all is SI.

mod arm;
mod effects;
mod locate;
mod montecarlo;
mod motions;
mod setup;
mod validate;
mod written;

pub use arm::Arm;
pub use effects::{EffectSpec, joint as effect_joint};
pub use montecarlo::{MonteCarloSpec, NoiseLevel};
pub(crate) use motions::drawable;
pub(crate) use setup::misjudged;
pub use setup::{Setup, drive_friction};
pub use written::Measured;

use crate::design::Workspace;
use crate::error::{Error, Result};
use crate::identification::smoothing_choice::usual_window;
use crate::simulation::integrator::Integrator;
use locate::Located;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Value of the `schema` key of a scenario file.
pub const SCHEMA: &str = "tauscope.scenario/1";

/// Everything a run depends on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scenario {
    /// `tauscope.scenario/1`.
    pub schema: String,
    /// Name of the run; results go to `results/<name>`.
    pub name: String,
    /// Seed of every random number.
    pub seed: u64,
    /// The arm.
    pub robot: RobotSpec,
    /// How the arm is simulated.
    pub plant: PlantSpec,
    /// What drives the arm.
    pub controller: ControllerSpec,
    /// Limits of the motions beyond those in the URDF.
    pub limits: LimitSpec,
    /// The motion that is identified from.
    pub motion: MotionSpec,
    /// A second motion, on which the identified model is judged.
    pub held_out: MotionSpec,
    /// What measures the arm.
    pub sensors: SensorSpec,
    /// How the measurements are turned into parameters.
    pub identification: IdentificationSpec,
    /// What a Monte Carlo study of it draws and compares.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub montecarlo: Option<MonteCarloSpec>,
    /// Effects at work in the plant and its sensors, beyond the friction and rotor inertia of its drives.
    #[serde(default, rename = "effect", skip_serializing_if = "Vec::is_empty")]
    pub effects: Vec<EffectSpec>,
}

/// The arm a scenario is for.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RobotSpec {
    /// URDF file, relative to the scenario file.
    pub urdf: PathBuf,
    /// Name the URDF must carry: guards against running a scenario on another arm.
    pub name: String,
    /// Gravity in the base frame, m/s2; standard gravity along -z where absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gravity_m_s2: Option<[f64; 3]>,
}

/// One value for all joints, or one per joint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged, expecting = "give a number, or a list with one number per joint")]
pub enum PerJoint {
    /// The same for every joint.
    All(f64),
    /// Base to flange.
    Each(Vec<f64>),
}

impl PerJoint {
    /// The value of every joint of an arm of `dof` joints; a list of another length was refused on loading.
    pub fn values(&self, dof: usize) -> Vec<f64> {
        match self {
            PerJoint::All(value) => vec![*value; dof],
            PerJoint::Each(values) => values.clone(),
        }
    }
}

/// The simulated arm.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlantSpec {
    /// `rk4` (exact to integration error) or `rapier_native` (rapier's own first-order step).
    pub integrator: Integrator,
    /// Time step, s.
    pub step_s: f64,
    /// Viscous friction, N m s/rad; that of the URDF where absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub viscous_nms_rad: Option<PerJoint>,
    /// Coulomb friction, N m; that of the URDF where absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub coulomb_nm: Option<PerJoint>,
    /// Reflected rotor inertia, kg m2; that of the URDF where absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub armature_kg_m2: Option<PerJoint>,
}

/// Computed torque with PD feedback on an imperfect model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ControllerSpec {
    /// Natural frequency of the closed loop, Hz.
    pub bandwidth_hz: f64,
    /// Damping ratio of the closed loop.
    pub damping_ratio: f64,
    /// Relative error of every inertial, friction and rotor parameter of the controller's model (drawn uniformly
    /// between plus and minus this).
    pub model_error: f64,
}

/// Limits of the motions. Position and velocity limits come from the URDF.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LimitSpec {
    /// Largest acceleration, rad/s2 (m/s2 for a prismatic joint).
    pub acceleration_rad_s2: PerJoint,
    /// The space that excitation motions may use; all of it where absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub workspace: Option<Workspace>,
}

/// Where a motion comes from: exactly one of the keys.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MotionSpec {
    /// A motion file, relative to the scenario file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub file: Option<PathBuf>,
    /// A sequence of Freudenstein 1-3-5 moves drawn from the seed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub random: Option<RandomMotion>,
}

/// A random sequence of rest-to-rest moves inside the limits.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RandomMotion {
    /// Moves of each joint.
    pub moves: usize,
    /// Length, s.
    pub duration_s: f64,
}

/// Sensors of all joints.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SensorSpec {
    /// Rate of the log, Hz; its period must be a whole number of plant steps.
    pub rate_hz: f64,
    /// Encoder step at the joint, rad; 0 for none.
    pub encoder_resolution_rad: PerJoint,
    /// White noise on the position, rad.
    pub encoder_noise_rad: PerJoint,
    /// White noise on the velocity, rad/s; without this key there are no tachometers.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tachometer_noise_rad_s: Option<PerJoint>,
    /// Noise on the torque, N m.
    pub torque_noise_nm: PerJoint,
    /// Correlation time of the torque noise, s; 0 for white noise.
    pub torque_noise_correlation_s: PerJoint,
}

/// From measurements to parameters.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct IdentificationSpec {
    /// Savitzky-Golay window, samples, odd. Where it is left out, `tauscope run` chooses it by the noise of the measured positions, and what
    /// compares studies takes [`IdentificationSpec::fixed_window`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub smoothing_window: Option<usize>,
    /// Savitzky-Golay polynomial order.
    pub smoothing_order: usize,
    /// After smoothing, every n-th sample is used.
    pub decimation: usize,
    /// Cut-off of the zero-phase low-pass that `tauscope identify` uses instead of Savitzky-Golay, Hz; where given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub low_pass_hz: Option<f64>,
    /// Samples of a joint slower than this are left out: the sign of its velocity is not certain there, rad/s.
    pub reversal_band_rad_s: f64,
}

impl IdentificationSpec {
    /// The window that is the same for all draws of noise: as given, or of 0.12 s.
    pub fn fixed_window(&self, rate_hz: f64) -> usize {
        self.smoothing_window.unwrap_or_else(|| usual_window(rate_hz))
    }
}

impl Scenario {
    /// Reads and checks a scenario file. Paths inside come back resolved against the file's folder.
    ///
    /// # Errors
    /// Names file, line and key for anything unreadable, unknown, missing or impossible.
    pub fn load(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        Self::parse(path, &read(path)?)
    }

    fn parse(path: &Path, text: &str) -> Result<Self> {
        let mut scenario: Scenario = toml::from_str(text).map_err(|e| Error::toml(path, text, &e))?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let resolve = |file: &mut PathBuf| *file = folder.join(&*file);
        resolve(&mut scenario.robot.urdf);
        for motion in [&mut scenario.motion, &mut scenario.held_out] {
            motion.file.iter_mut().for_each(resolve);
        }
        validate::validate(&scenario, &Located::new(path, text))?;
        Ok(scenario)
    }

    /// Plant steps in one sample of the log.
    pub fn steps_per_sample(&self) -> usize {
        (1.0 / (self.sensors.rate_hz * self.plant.step_s)).round() as usize
    }

    /// Samples that a motion of `duration_s` seconds leaves in the log, both ends included.
    pub fn samples(&self, duration_s: f64) -> usize {
        ((duration_s * self.sensors.rate_hz + 1e-9).floor() as usize).saturating_add(1)
    }

    /// All values that may be given per joint and are given, with their keys.
    fn per_joint(&self) -> Vec<(&'static str, &PerJoint)> {
        let (plant, sensors) = (&self.plant, &self.sensors);
        [
            ("plant.viscous_nms_rad", plant.viscous_nms_rad.as_ref()),
            ("plant.coulomb_nm", plant.coulomb_nm.as_ref()),
            ("plant.armature_kg_m2", plant.armature_kg_m2.as_ref()),
            ("limits.acceleration_rad_s2", Some(&self.limits.acceleration_rad_s2)),
            ("sensors.encoder_resolution_rad", Some(&sensors.encoder_resolution_rad)),
            ("sensors.encoder_noise_rad", Some(&sensors.encoder_noise_rad)),
            ("sensors.tachometer_noise_rad_s", sensors.tachometer_noise_rad_s.as_ref()),
            ("sensors.torque_noise_nm", Some(&sensors.torque_noise_nm)),
            ("sensors.torque_noise_correlation_s", Some(&sensors.torque_noise_correlation_s)),
        ]
        .into_iter()
        .filter_map(|(key, value)| Some((key, value?)))
        .collect()
    }
}

fn read(path: &Path) -> Result<String> {
    std::fs::read_to_string(path).map_err(|e| Error::io(path, "read the scenario", e))
}
