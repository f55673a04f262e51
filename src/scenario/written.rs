//! A scenario made for an arm that was identified, so that it can be simulated.

use super::{
    ControllerSpec, EffectSpec, IdentificationSpec, LimitSpec, MotionSpec, PerJoint, PlantSpec, RandomMotion,
    RobotSpec, SCHEMA, Scenario, SensorSpec,
};
use crate::diagnosis::Measured;
use crate::effects::{Placed, Role, Scope};
use crate::error::{Error, Result};
use crate::identification::smoothing_choice::usual_decimation;
use crate::robot::Robot;
use crate::simulation::integrator::Integrator;
use std::path::Path;

/// Longest step of the plant, s.
const LONGEST_STEP_S: f64 = 1e-3;

/// Length of the smoothing window, s.
const WINDOW_S: f64 = 0.12;

impl EffectSpec {
    /// The table of an effect with all its parameters.
    pub fn of(placed: &Placed, robot: &Robot) -> Self {
        let parameters = placed.effect.parameters().iter().zip(&placed.parameters);
        let about = placed.effect.about();
        EffectSpec {
            name: about.name.to_owned(),
            joint: (about.scope != Scope::Arm).then(|| robot.joints[placed.joint].name.clone()),
            parameters: parameters
                .filter(|(parameter, value)| parameter.role != Role::Held || **value != parameter.typical)
                .map(|(parameter, &value)| (parameter.name.to_owned(), value))
                .collect(),
        }
    }
}

impl Scenario {
    /// A scenario of `robot`, whose bodies and drives are in the file `urdf`, with `effects` at work: `like` another one
    /// where there is one, else with the sensors that were `measured` and motions drawn from the seed.
    pub fn of(
        robot: &Robot,
        urdf: &Path,
        effects: &[Placed],
        like: Option<&Scenario>,
        measured: &Measured,
        seed: u64,
    ) -> Self {
        let plain = |c: char| if c.is_ascii_alphanumeric() || "-_.".contains(c) { c } else { '_' };
        let mut scenario = match like {
            Some(scenario) => scenario.clone(),
            None => with_sensors(measured, seed),
        };
        scenario.name = format!("{}_extended", robot.name.chars().map(plain).collect::<String>());
        // Joints that are held in `robot` are fixed in its file.
        scenario.robot = RobotSpec {
            urdf: urdf.to_owned(),
            name: robot.name.clone(),
            gravity_m_s2: Some(robot.gravity.into()),
            ..RobotSpec::default()
        };
        let plant = &mut scenario.plant;
        (plant.viscous_nms_rad, plant.coulomb_nm, plant.armature_kg_m2) = (None, None, None);
        for motion in [&mut scenario.motion, &mut scenario.held_out] {
            motion.file = motion.file.take().map(|file| std::path::absolute(&file).unwrap_or(file));
        }
        scenario.effects = effects.iter().map(|placed| EffectSpec::of(placed, robot)).collect();
        scenario
    }

    /// The scenario as TOML.
    ///
    /// # Errors
    /// If a number has no TOML form.
    pub fn to_toml(&self) -> Result<String> {
        toml::to_string_pretty(self)
            .map_err(|problem| Error::request("scenario", format!("cannot be written: {problem}")))
    }
}

/// A scenario with the sensors that were `measured` and motions drawn from the seed, of no arm yet.
fn with_sensors(measured: &Measured, seed: u64) -> Scenario {
    let period = 1.0 / measured.rate_hz;
    let window = ((WINDOW_S * measured.rate_hz).round() as usize | 1).max(9);
    let motion = || MotionSpec { file: None, random: Some(RandomMotion { moves: 12, duration_s: 20.0 }) };
    Scenario {
        schema: SCHEMA.to_owned(),
        name: String::new(),
        seed,
        robot: RobotSpec::default(),
        plant: PlantSpec {
            integrator: Integrator::Rk4,
            step_s: period / (period / LONGEST_STEP_S - 1e-9).ceil().max(1.0),
            viscous_nms_rad: None,
            coulomb_nm: None,
            armature_kg_m2: None,
        },
        controller: ControllerSpec { bandwidth_hz: 5.0, damping_ratio: 1.0, model_error: 0.0 },
        limits: LimitSpec { acceleration_rad_s2: PerJoint::Each(measured.acceleration.clone()), workspace: None },
        motion: motion(),
        held_out: motion(),
        sensors: SensorSpec {
            rate_hz: measured.rate_hz,
            encoder_resolution_rad: PerJoint::All(0.0),
            encoder_noise_rad: PerJoint::Each(measured.position_noise.clone()),
            tachometer_noise_rad_s: None,
            torque_noise_nm: PerJoint::Each(measured.torque_noise.clone()),
            torque_noise_correlation_s: PerJoint::All(0.0),
        },
        identification: IdentificationSpec {
            smoothing_window: Some(window),
            smoothing_order: 6,
            decimation: usual_decimation(window),
            low_pass_hz: None,
            reversal_band_rad_s: 0.03,
        },
        montecarlo: None,
        effects: Vec::new(),
    }
}
