//! Diagnosis: what the model of an arm misses, named from measured logs with a controlled rate of false alarms.
//!
//! | room | in | out |
//! |---|---|---|
//! | `answer` | arm, logs, options | the diagnosis and the extended model |
//! | `lack_of_fit` | residual | structure that no effect explains |
//! | `search` | fits, candidates | effects found, by forward selection |
//! | `preparation` | logs, arm | filters and widths |
//! | `evidence` | a candidate | p-values and held-out gains |
//! | `backlash` | positions, torque | gears with play |
//! | `model` | rows, arm, effects | regressor, fits |
//! | `noise` | residual | whiteners |
//! | `logs` | recordings | rows |
//! | `regression` | columns | solutions, score tests |
//!
//! Each room imports only from rooms below it.

mod answer;
mod backlash;
mod evidence;
mod lack_of_fit;
mod logs;
mod model;
mod noise;
mod preparation;
mod regression;
mod search;
mod variance;

pub use answer::{
    Conclusion, Derived, Diagnosis, Gain, Observed, ResidualStructure, Resimulation, Share, conclude, diagnose, first_look,
    observed, predicts_worse, torque,
};
pub use backlash::Play;
pub use evidence::Ranked;
pub use lack_of_fit::LOGS_DISAGREE;
pub use logs::{
    Consequence, DataFault, Input, Screened, all_faults, check_length, correct, held_out, screen, screen_all,
    shared_verdict, still_joints,
};
pub use model::{Family, Session, Side, is_candidate, is_level, places};
pub use noise::Whitener;
pub use regression::{Column, Projection, rms};
pub use variance::{JointMap, Kind, Line, Part, ResidualMap};
pub use search::{Found, Verdict};

use crate::identification::effect_model::Trust;

/// What to look for, and how surely.
#[derive(Debug, Clone)]
pub struct Options {
    /// Which inertias are believed.
    pub trust: Trust,
    /// Probability of naming anything where there is nothing.
    pub alpha: f64,
    /// Most effects that are named.
    pub max_findings: usize,
    /// Seed of the draws behind the level.
    pub seed: u64,
    /// Names of the effects to look for; all where empty.
    pub candidates: Vec<String>,
}

impl Default for Options {
    fn default() -> Self {
        Options { trust: Trust::Structure, alpha: 0.05, max_findings: 12, seed: 0, candidates: Vec::new() }
    }
}
