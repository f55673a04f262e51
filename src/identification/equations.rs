//! Which joints have an equation: those whose torque is logged, and that surely move for long enough to tell their friction.
//!
//! A joint without one moves like the others in theirs; what only its own equation would show is no parameter.

use super::effect_model::{Preparation, Trust};
use super::fit::Logs;
use super::model::Model;
use super::prepare;
use crate::error::Result;
use crate::recording::Recording;
use crate::robot::Robot;

/// The model of the joints that have an equation.
#[derive(Debug)]
pub struct Observed {
    /// The model.
    pub model: Model,
    /// A line for every joint that has none.
    pub notes: Vec<String>,
}

/// Whether all logs hold torque of each joint. A log that holds it only in part still does; torque that never changes was not
/// measured.
pub fn with_torque<'a>(joints: usize, logs: impl Iterator<Item = &'a Recording> + Clone) -> Vec<bool> {
    let is_logged = |log: &Recording, joint: usize| {
        let mut measured = log.tau.channel(joint).iter().filter(|torque| torque.is_finite());
        measured.next().is_some_and(|first| measured.any(|other| other != first))
    };
    (0..joints).map(|joint| logs.clone().all(|log| is_logged(log, joint))).collect()
}

/// What is said of a joint whose torque some log does not hold.
pub fn no_torque() -> String {
    "its torque is not logged; it moves with the others, and its own friction and rotor stay as described".to_owned()
}

/// The joints of `robot` with an equation in the logs. Where no joint has one all keep theirs, and the fit says what is wrong.
///
/// # Errors
/// If a log is too short for its preparation.
pub fn observed(robot: &Robot, logs: Logs, preparation: Preparation, trust: Trust) -> Result<Observed> {
    let all = logs.train.iter().chain(logs.test).copied();
    let mut equations = with_torque(robot.dof(), all);
    let unlogged = robot.joints.iter().zip(&equations).filter(|(_, logged)| !**logged);
    let mut notes: Vec<String> = unlogged.map(|(spec, _)| format!("joint `{}`: {}", spec.name, no_torque())).collect();
    let mut rows = vec![0usize; robot.dof()];
    for log in logs.train {
        let prepared = prepare::measured(log, preparation.smoothing, preparation.band)?;
        for (joint, rows) in rows.iter_mut().enumerate() {
            *rows += prepared.rows_to_use(joint).into_iter().filter(|&ok| ok).count();
        }
    }
    let model = Model::with_equations(robot, &equations);
    for (joint, spec) in robot.joints.iter().enumerate().filter(|(joint, _)| model.has_equation(*joint)) {
        // The least that a fit takes: two rows for every parameter of the joint.
        let parameters = match trust {
            Trust::Structure => model.active(joint).len(),
            Trust::Nominal => DRIVE,
        };
        if rows[joint] < FEWEST.max(2 * parameters) {
            equations[joint] = false;
            notes.push(format!(
                "joint `{}`: it surely moves in {} samples only, too few for the {parameters} parameters that act on it; its \
                 own torque is left out, and its friction and rotor stay as described",
                spec.name, rows[joint]
            ));
        }
    }
    let none = equations.iter().all(|has| !has);
    match none || (0..robot.dof()).all(|joint| equations[joint] == model.has_equation(joint)) {
        true => Ok(Observed { model, notes: if none { Vec::new() } else { notes } }),
        false => Ok(Observed { model: Model::with_equations(robot, &equations), notes }),
    }
}

/// Fewest rows of a joint that tell anything of its friction, a moment's motion.
const FEWEST: usize = 30;

/// Parameters of a drive: rotor inertia, viscous and Coulomb friction.
const DRIVE: usize = 3;
