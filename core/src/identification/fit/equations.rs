//! Which joints have an equation: those whose torque is logged, and that surely move for long enough to determine their friction.
//!
//! A joint without one moves like the others in theirs; what only its own equation would show is no parameter.

use super::fitted::Logs;
use crate::dynamics::Motion;
use crate::error::Result;
use crate::identification::effect_model::{Preparation, Trust};
use crate::identification::model::Model;
use crate::identification::preparation::prepare;
use crate::recording::Recording;
use crate::robot::{Robot, shortened};

/// The model of the joints that have an equation.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::identification::effect_model::{Preparation, Trust};
/// use tauscope::identification::equations;
/// use tauscope::identification::fit::Logs;
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/payload/arm.urdf", InertiaCheck::Ignored)?;
/// # let log = recording::load("../tests/reference/payload/before.csv", None)?;
///
/// // A log without the torque of the last joint: it moves like the others, and has no equation.
/// let mut log = log;
/// log.tau.channel_mut(4).fill(f64::NAN);
/// let logs = Logs { train: &[&log], test: &[] };
/// let observed = equations::observed(&robot, logs, Preparation::usual(&log), Trust::Structure)?;
/// assert!(observed.model.has_equation(0) && !observed.model.has_equation(4));
/// assert!(observed.notes[0].contains("j5"));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug)]
pub struct Observed {
    /// The model.
    pub model: Model,
    /// A line for every joint that has none.
    pub notes: Vec<String>,
}

/// Whether all logs hold torque of each joint. A log that holds it only in part still does; torque that never changes was not
/// measured.
pub(crate) fn with_torque<'a>(joints: usize, logs: impl Iterator<Item = &'a Recording> + Clone) -> Vec<bool> {
    let is_logged = |log: &Recording, joint: usize| {
        let mut measured = log.tau.channel(joint).iter().filter(|torque| torque.is_finite());
        measured.next().is_some_and(|first| measured.any(|other| other != first))
    };
    (0..joints).map(|joint| logs.clone().all(|log| is_logged(log, joint))).collect()
}

/// The note on a joint whose torque some log does not hold.
pub(crate) fn no_torque() -> String {
    "its torque is not logged; it moves with the others, and its own friction and rotor stay as described".to_owned()
}

/// The joints of `robot` with an equation in the logs. Where no joint has one all keep theirs, and the fit reports what is wrong.
///
/// # Errors
/// If a log is too short for its preparation.
pub fn observed(robot: &Robot, logs: Logs, preparation: Preparation, trust: Trust) -> Result<Observed> {
    let all = logs.train.iter().chain(logs.test).copied();
    let mut equations = with_torque(robot.dof(), all);
    let unlogged = robot.joints.iter().zip(&equations).filter(|(_, logged)| !**logged);
    let mut notes: Vec<String> = unlogged.map(|(spec, _)| format!("joint `{}`: {}", spec.name, no_torque())).collect();
    let (mut rows, mut forward) = (vec![0usize; robot.dof()], vec![0usize; robot.dof()]);
    for log in logs.train {
        let prepared = prepare::measured(log, &preparation.smoothing, preparation.band)?;
        let mut own = Vec::with_capacity(robot.dof());
        for (joint, forward) in forward.iter_mut().enumerate() {
            let (used, [_, speed]) = (prepared.rows_to_use(joint), prepared.row_motion(joint)?);
            own.push(used.iter().filter(|&&ok| ok).count());
            *forward += used.iter().zip(speed).filter(|&(&used, speed)| used && speed > 0.0).count();
        }
        notes.extend(too_fast(log, &prepared.motion, &own));
        rows.iter_mut().zip(own).for_each(|(rows, own)| *rows += own);
    }
    let model = Model::with_equations(robot, &equations);
    let mut too_few = Vec::new();
    for (joint, spec) in robot.joints.iter().enumerate().filter(|(joint, _)| model.has_equation(*joint)) {
        // The least that a fit takes: two rows for every parameter of the joint.
        let parameters = match trust {
            Trust::Structure => model.active(joint).len(),
            Trust::Nominal => DRIVE,
        };
        if rows[joint] < FEWEST.max(2 * parameters) {
            equations[joint] = false;
            too_few.push((&*spec.name, rows[joint], parameters));
        } else if let Some(way) = one_way(forward[joint], rows[joint]) {
            notes.push(format!(
                "joint `{}` surely moves {way} only: Coulomb friction is a constant torque then, which gravity and offsets hold too, and \
                 errors of the model are in it; move it both ways",
                spec.name
            ));
        }
    }
    notes.extend(left_out(&too_few));
    let none = equations.iter().all(|has| !has);
    match none || (0..robot.dof()).all(|joint| equations[joint] == model.has_equation(joint)) {
        true => Ok(Observed { model, notes: if none { Vec::new() } else { notes } }),
        false => Ok(Observed { model: Model::with_equations(robot, &equations), notes }),
    }
}

/// A line about joints that surely move in so many samples, too few for so many parameters each; none where there are no such joints.
fn left_out(joints: &[(&str, usize, usize)]) -> Option<String> {
    Some(match joints {
        [] => return None,
        [(name, rows, parameters)] => format!(
            "joint `{name}`: it surely moves in {rows} samples only, too few for the {parameters} parameters that act on it; its own torque is \
             left out, and its friction and rotor stay as described"
        ),
        several => {
            let names: Vec<String> = several.iter().map(|(name, ..)| name.to_string()).collect();
            let most = several.iter().map(|(_, rows, _)| *rows).max().unwrap_or(0);
            let samples = if most == 0 { "no sample".to_owned() } else { format!("{most} samples at most") };
            format!(
                "joints {}: each surely moves in {samples}, too few for the parameters that act on it; their own torques are left out, and their \
                 friction and rotors stay as described",
                shortened(&names)
            )
        }
    })
}

/// The way in which a joint moves in nearly all of its `rows`, of which so many are `forward`.
fn one_way(forward: usize, rows: usize) -> Option<&'static str> {
    let other = ONE_WAY * rows as f64;
    match ((forward as f64) < other, ((rows - forward) as f64) < other) {
        (true, _) => Some("backward"),
        (_, true) => Some("forward"),
        _ => None,
    }
}

/// A line about a motion that is too fast for the rate of its log, on joints with some `rows` in which they move.
fn too_fast(log: &Recording, motion: &Motion, rows: &[usize]) -> Option<String> {
    let rate_hz = log.rate_hz();
    let rms = |signal: &[f64]| (signal.iter().map(|x| x * x).sum::<f64>() / signal.len().max(1) as f64).sqrt();
    // What a swing of one frequency has.
    let swings_hz =
        |joint: usize| rms(motion.qdd.channel(joint)) / rms(motion.qd.channel(joint)) / std::f64::consts::TAU;
    let moving = (0..motion.joints()).filter(|&joint| rows[joint] >= FEWEST);
    let fastest = moving.max_by(|&a, &b| swings_hz(a).total_cmp(&swings_hz(b)))?;
    let hz = swings_hz(fastest);
    (rate_hz < SLOW_HZ && rate_hz < SAMPLES_IN_A_SWING * hz).then(|| {
        format!(
            "the log has {rate_hz:.1} samples a second, and joint `{}` swings at about {hz:.1} Hz: accelerations are worked out from \
             too few samples in a swing and come out too small; log faster or move slower",
            log.joints[fastest]
        )
    })
}

/// Rate below which a log is looked at for that, Hz: above it encoders' noise makes more of the acceleration than the motion of
/// an arm does.
const SLOW_HZ: f64 = 50.0;

/// Fewest samples in a swing: the second difference of twelve samples to a turn is two per cent too small, the smoothing not yet
/// counted.
const SAMPLES_IN_A_SWING: f64 = 12.0;

/// Fewest rows of a joint that determine its friction, a moment's motion.
pub(crate) const FEWEST: usize = 30;

/// Share of a joint's rows below which a direction has no information.
const ONE_WAY: f64 = 0.02;

/// Parameters of a drive: rotor inertia, viscous and Coulomb friction.
const DRIVE: usize = 3;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_joint_that_moves_one_way_only() {
        assert_eq!((one_way(0, 100), one_way(99, 100)), (Some("backward"), Some("forward")));
        assert_eq!((one_way(2, 100), one_way(98, 100)), (None, None));
    }
}
