//! Which joints have an equation in a diagnosis: those whose torque is logged and that move for long enough. The others
//! move with them and are left out, with a line each.

use crate::diagnosis::logs::{Consequence, DataFault, FEWEST_ROWS, FEWEST_TEST_ROWS, Input, Rows, cutoff, split};
use crate::error::Result;
use crate::identification::equations::{no_torque, with_torque};
use crate::identification::model::Model;
use crate::quality::Kind;
use crate::recording::Recording;
use crate::robot::Robot;

/// The model of the joints that have an equation.
#[derive(Debug)]
pub(super) struct Observed {
    /// The model.
    pub model: Model,
    /// The joints that have none, and why.
    pub left_out: Vec<DataFault>,
}

/// What is reported of a joint that is left out, and where.
const HARDLY_MOVES: &str =
    "the joint hardly moves: nothing is looked for in its drive, its torque is left out, and the others are diagnosed";
const MOVES_ONCE: &str = "the joint moves once, and what is held out of the logs to judge by has none of it: nothing is looked for in its drive, its \
                          torque is left out, and the others are diagnosed; move it again, or give a log of another motion as --test";
const NOT_HELD_OUT: &str = "the joint moves in the training logs, and hardly in the held-out ones: nothing is looked for in its drive, its torque is \
                            left out, and the others are diagnosed; give a held-out log in which it moves";
const ALL: &str = "all logs";

/// The joints of `robot` with an equation in the logs; those in `still` hardly move. Where no joint has one all keep theirs, and
/// the diagnosis reports the fault.
///
/// # Errors
/// If a log is too short.
pub(super) fn observed(robot: &Robot, input: &Input, still: &[usize], misfit: f64) -> Result<Observed> {
    let all: Vec<&Recording> = input.train.iter().chain(&input.test).chain(&input.reference).copied().collect();
    let mut equations = with_torque(robot.dof(), all.iter().copied());
    let without = |joint: usize, kind: Kind, text: String| DataFault {
        kind,
        log: ALL.to_owned(),
        place: format!("tau{} ({})", joint + 1, robot.joints[joint].name),
        text,
        consequence: Consequence::LeftOut,
    };
    let unlogged = (0..robot.dof()).filter(|&joint| !equations[joint]);
    let mut left_out: Vec<DataFault> = unlogged.map(|joint| without(joint, Kind::NoTorque, no_torque())).collect();
    let (early, late) = if input.test.is_empty() { split(&input.train) } else { Default::default() };
    let train = if input.test.is_empty() { early.iter().collect() } else { input.train.clone() };
    let train: Vec<&Recording> = input.reference.iter().copied().chain(train).collect();
    let cutoff_hz = cutoff(&all, misfit)?;
    let counts = |logs: &[&Recording]| -> Result<Vec<usize>> {
        let valid = Rows::new(logs, cutoff_hz, 0)?.valid;
        Ok(valid.iter().map(|valid| valid.iter().filter(|&&ok| ok).count()).collect())
    };
    let moving = counts(&train)?;
    let held_out = if input.test.is_empty() { late.iter().collect() } else { input.test.clone() };
    let judged = if held_out.is_empty() { None } else { Some(counts(&held_out)?) };
    for joint in 0..robot.dof() {
        let moves = moving[joint] >= FEWEST_ROWS;
        let is_judged = judged.as_ref().is_none_or(|judged| judged[joint] >= FEWEST_TEST_ROWS);
        if equations[joint] && (still.contains(&joint) || !moves || !is_judged) {
            equations[joint] = false;
            let text = match moves && !still.contains(&joint) {
                true if input.test.is_empty() => MOVES_ONCE,
                true => NOT_HELD_OUT,
                false => HARDLY_MOVES,
            };
            left_out.push(without(joint, Kind::HardlyMoves, text.to_owned()));
        }
    }
    let none = equations.iter().all(|has| !has);
    match none || equations.iter().all(|has| *has) {
        true => Ok(Observed { model: Model::new(robot), left_out: Vec::new() }),
        false => Ok(Observed { model: Model::with_equations(robot, &equations), left_out }),
    }
}
