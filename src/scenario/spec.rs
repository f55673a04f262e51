//! What a scenario file can say.

use super::effects::EffectSpec;
use super::montecarlo::MonteCarloSpec;
use super::values::{PerJoint, RandomMotion};
use crate::design::Workspace;
use crate::identification::smoothing_choice::usual_window;
use crate::simulation::integrator::Integrator;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Value of the `schema` key of a scenario file.
pub const SCHEMA: &str = "tauscope.scenario/1";

/// Everything a run depends on.
///
/// ```
/// use tauscope::scenario::Scenario;
///
/// let scenario = Scenario::load("tests/scenarios/pendulum.toml")?;
/// assert_eq!((&scenario.name[..], scenario.seed), ("pendulum", 7));
///
/// // A step of 1 ms, a log of 500 Hz: 6 s are 3001 samples of two steps each.
/// assert_eq!((scenario.steps_per_sample(), scenario.samples(6.0)), (2, 3001));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
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
///
/// ```
/// use tauscope::scenario::Scenario;
///
/// let scenario = Scenario::load("tests/scenarios/pendulum.toml")?;
/// // The name guards against running a scenario on another arm.
/// assert_eq!(scenario.robot.name, "pendulum");
/// assert!(scenario.robot.urdf.ends_with("reference/pendulum.urdf") && scenario.robot.joints.is_none());
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RobotSpec {
    /// URDF file, relative to the scenario file.
    pub urdf: PathBuf,
    /// Name the URDF must carry: guards against running a scenario on another arm.
    pub name: String,
    /// Gravity in the base frame, m/s2; standard gravity along -z where absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gravity_m_s2: Option<[f64; 3]>,
    /// Joints that move, in the arm's order, base to flange, which is that of the lists of this file; all that move by
    /// themselves where absent. All others are held.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub joints: Option<Vec<String>>,
    /// In the place of `joints`: the link at the end of the arm. The joints between the base and it move.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tip: Option<String>,
    /// Where held joints stand, rad or m, by name; in the middle of their range where absent.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub hold: BTreeMap<String, f64>,
}

/// The simulated arm.
///
/// ```
/// use tauscope::scenario::{PerJoint, Scenario, Setup};
/// use tauscope::simulation::integrator::Integrator;
///
/// let scenario = Scenario::load("tests/scenarios/pendulum.toml")?;
/// assert_eq!((scenario.plant.integrator, scenario.plant.step_s), (Integrator::Rk4, 1e-3));
///
/// // Friction that a scenario does not give is that of the robot's file.
/// assert_eq!(scenario.plant.viscous_nms_rad, None::<PerJoint>);
/// let setup = Setup::load("tests/scenarios/pendulum.toml", None)?;
/// assert_eq!(setup.plant.joints[0].drive.viscous, 0.4);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
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
///
/// ```
/// use tauscope::scenario::Scenario;
///
/// let scenario = Scenario::load("tests/scenarios/pendulum.toml")?;
/// // Computed torque on a model that is wrong by up to 10 %.
/// assert_eq!((scenario.controller.bandwidth_hz, scenario.controller.model_error), (5.0, 0.1));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
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
///
/// ```
/// use tauscope::scenario::Scenario;
///
/// let scenario = Scenario::load("tests/scenarios/pendulum.toml")?;
/// // Motions keep to this; limits of position and speed are in the robot's file.
/// assert_eq!(scenario.limits.acceleration_rad_s2.values(1), [20.0]);
/// assert!(scenario.limits.workspace.is_none());
/// # Ok::<(), tauscope::error::Error>(())
/// ```
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
///
/// ```
/// use tauscope::scenario::Scenario;
///
/// let scenario = Scenario::load("tests/scenarios/pendulum.toml")?;
/// // Drawn from the seed, not from a file: six moves in 6 s.
/// let motion = scenario.motion.random.as_ref().expect("it is drawn");
/// assert_eq!((motion.moves, motion.duration_s, &scenario.motion.file), (6, 6.0, &None));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
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

/// Sensors of all joints.
///
/// ```
/// use tauscope::scenario::Scenario;
///
/// let scenario = Scenario::load("tests/scenarios/pendulum.toml")?;
/// // An encoder and a torque sensor at 500 Hz, and no tachometer.
/// assert_eq!((scenario.sensors.rate_hz, scenario.sensors.torque_noise_nm.values(1)), (500.0, vec![0.05]));
/// assert!(scenario.sensors.tachometer_noise_rad_s.is_none());
/// # Ok::<(), tauscope::error::Error>(())
/// ```
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
///
/// ```
/// use tauscope::scenario::{IdentificationSpec, Scenario};
///
/// let scenario = Scenario::load("tests/scenarios/pendulum.toml")?;
/// assert_eq!(scenario.identification.fixed_window(500.0), 61);
///
/// // Left out, the window is 0.12 s at any rate.
/// let open = IdentificationSpec { smoothing_window: None, ..scenario.identification };
/// assert_eq!((open.fixed_window(500.0), open.fixed_window(1000.0)), (61, 121));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct IdentificationSpec {
    /// Savitzky-Golay window, samples, odd. Where it is left out, `tauscope run` chooses it by the noise of the measured positions, and
    /// what compares studies takes [`IdentificationSpec::fixed_window`].
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
    /// Plant steps in one sample of the log.
    pub fn steps_per_sample(&self) -> usize {
        (1.0 / (self.sensors.rate_hz * self.plant.step_s)).round() as usize
    }

    /// Samples that a motion of `duration_s` seconds leaves in the log, both ends included.
    pub fn samples(&self, duration_s: f64) -> usize {
        ((duration_s * self.sensors.rate_hz + 1e-9).floor() as usize).saturating_add(1)
    }

    /// All values that may be given per joint and are given, with their keys.
    pub(super) fn per_joint(&self) -> Vec<(&'static str, &PerJoint)> {
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
