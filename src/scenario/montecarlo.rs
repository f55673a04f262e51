//! The `[montecarlo]` table: what a study draws, and what it compares.

use super::values::RandomMotion;
use crate::simulation::engine::EngineKind;
use serde::{Deserialize, Serialize};

/// A Monte Carlo study of a scenario. Every key has a default, and the table may be left out.
///
/// ```
/// use tauscope::scenario::{MonteCarloSpec, Scenario};
///
/// // The table [montecarlo]; what it leaves out is as in the default.
/// let scenario = Scenario::load("tests/scenarios/montecarlo.toml")?;
/// let study = scenario.montecarlo.expect("it has the table");
/// assert_eq!((study.trials, &study.sg_windows[..]), (12, &[31][..]));
/// assert_eq!(study.plant_error, MonteCarloSpec::default().plant_error);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct MonteCarloSpec {
    /// Trials.
    pub trials: usize,
    /// Estimators by name: `ols`, `wls`, `irls`, `lm`, `tls`, `iv`, `didim`.
    pub estimators: Vec<String>,
    /// Savitzky-Golay windows in samples, 0 for no smoothing; empty for 0 and that of `[identification]`.
    pub sg_windows: Vec<usize>,
    /// Whether signals are also smoothed by common practice: zero-phase Butterworth on positions, central differences, parallel
    /// filter and decimation.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub butterworth: bool,
    /// Noise levels; empty for the scenario's own sensors.
    pub noise: Vec<NoiseLevel>,
    /// Without smoothing, every n-th row is used.
    pub raw_decimation: usize,
    /// Relative error of every body, friction and rotor of the plant from the known arm, drawn anew for each trial between
    /// plus and minus this; 0 for the same plant in all trials.
    pub plant_error: f64,
    /// The same for the parameters that iterating estimators start from; 0 to start from the controller's model.
    pub start_error: f64,
    /// A training motion drawn anew for each trial, instead of the scenario's.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub random_motion: Option<RandomMotion>,
    /// Forward dynamics of trials that are simulated anew: `recursive` (fast) or `rapier`. What all trials share is
    /// simulated in rapier.
    pub engine: EngineKind,
}

impl Default for MonteCarloSpec {
    fn default() -> Self {
        MonteCarloSpec {
            trials: 1000,
            estimators: vec!["wls".to_owned()],
            sg_windows: Vec::new(),
            butterworth: false,
            noise: Vec::new(),
            raw_decimation: 1,
            plant_error: 0.0,
            start_error: 0.0,
            random_motion: None,
            engine: EngineKind::Recursive,
        }
    }
}

/// Sensors of one noise level; what is left out stays as in `[sensors]`.
///
/// ```
/// use tauscope::scenario::NoiseLevel;
///
/// // Better encoders, the torque noise of the scenario.
/// let level = NoiseLevel { encoder_rad: Some(1e-6), torque_nm: None };
/// assert!(level.is_possible());
/// assert!(!NoiseLevel { torque_nm: Some(-1.0), ..level }.is_possible());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NoiseLevel {
    /// White noise on every position, rad.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub encoder_rad: Option<f64>,
    /// Noise on every torque, N m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub torque_nm: Option<f64>,
}

impl NoiseLevel {
    /// Whether the numbers are standard deviations.
    pub fn is_possible(&self) -> bool {
        [self.encoder_rad, self.torque_nm].into_iter().flatten().all(|std| std.is_finite() && (0.0..1e9).contains(&std))
    }
}
