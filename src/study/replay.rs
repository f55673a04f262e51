//! Measured motions in the simulator: an identified arm follows what the real one did.

use crate::diagnosis::Followed;
use crate::error::Result;
use crate::identification::effect_model::Preparation;
use crate::identification::prepare;
use crate::recording::Recording;
use crate::robot::Robot;
use crate::simulation::engine::EngineKind;
use crate::simulation::following::follow;
use rayon::prelude::*;

/// Longest motions together that are simulated, s: longer ones take longer than anybody waits for a picture.
pub const LONGEST_S: f64 = 120.0;

/// Whether the motions of `logs` are short enough to simulate.
pub fn is_short(logs: &[&Recording]) -> bool {
    logs.iter().map(|log| log.duration()).sum::<f64>() <= LONGEST_S
}

/// Lets `robot`, with the friction of its drives, follow the smoothed motion of every log; one result per log, at its
/// times.
///
/// # Errors
/// If a log is too short for its preparation, or the simulation runs away.
pub fn replay(robot: &Robot, logs: &[&Recording], preparation: Preparation) -> Result<Vec<Followed>> {
    let one = |log: &&Recording| {
        let motion = prepare::measured(log, &preparation.smoothing, preparation.band)?.motion;
        follow(EngineKind::Rapier, robot, &[], &motion, log.time[0], 1.0 / log.rate_hz())
    };
    logs.par_iter().map(one).collect()
}
