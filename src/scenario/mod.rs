//! Scenarios: one TOML file that says everything a run depends on. Unknown keys are refused, and everything is checked
//! before anything runs. Units are in the key names; inside the program all is SI.

mod arm;
mod effects;
mod load;
mod locate;
mod montecarlo;
mod motions;
mod run;
mod setup;
mod spec;
mod validate;
mod values;
mod written;

pub use crate::diagnosis::Measured;
pub use arm::Arm;
pub use effects::EffectSpec;
pub use montecarlo::{MonteCarloSpec, NoiseLevel};
pub(crate) use motions::drawable;
pub use run::{measure, sensed, simulate, simulate_with};
pub use setup::Setup;
pub(crate) use setup::misjudged;
pub use spec::{
    ControllerSpec, IdentificationSpec, LimitSpec, MotionSpec, PlantSpec, RobotSpec, SCHEMA, Scenario, SensorSpec,
};
pub use values::{PerJoint, RandomMotion};
