//! Inverse dynamics and regressors of many states, without the interpreter's lock.

use crate::error::wrong;
use pyo3::PyResult;
use tauscope::channels::Channels;
use tauscope::dynamics::{Chain, Entries, Lanes, Motion, block_row, inverse_dynamics};
use tauscope::robot::{PARAMETERS, Robot};

/// Joint torques of the rigid bodies; with `drives` those of rotors and friction as the robot's file gives them too.
pub(crate) fn torques(robot: &Robot, chain: &Chain, inertial: &[f64], motion: &Motion, drives: bool) -> Channels {
    let mut torque = inverse_dynamics(chain, inertial, motion);
    if drives {
        for (joint, spec) in robot.joints.iter().enumerate() {
            let drive = spec.drive;
            let states = motion.qd.channel(joint).iter().zip(motion.qdd.channel(joint));
            for (tau, (&qd, &qdd)) in torque.channel_mut(joint).iter_mut().zip(states) {
                let direction = if qd == 0.0 { 0.0 } else { qd.signum() };
                *tau += drive.armature * qdd + drive.viscous * qd + drive.coulomb * direction;
            }
        }
    }
    torque
}

/// Numbers of a regressor: parameters x joints x samples.
///
/// # Errors
/// If there are more than memory can hold.
pub(crate) fn size(chain: &Chain, samples: usize) -> PyResult<usize> {
    let rows = chain.bodies() * PARAMETERS * chain.dof();
    rows.checked_mul(samples).ok_or_else(|| wrong("q", "has too many samples for a regressor"))
}

/// Writes the regressor of a motion, `[link][parameter][joint][sample]`, into a table of zeros.
pub(crate) fn regressor(chain: &Chain, motion: &Motion, table: &mut [f64]) {
    let dof = chain.dof();
    let places = |link, joint| {
        std::array::from_fn(|parameter| {
            Some(block_row(dof, link, parameter, joint)).filter(|_| chain.moves(joint, link))
        })
    };
    Entries::new(chain, places).write(Lanes::best(), chain, motion, 0..motion.samples(), table);
}
