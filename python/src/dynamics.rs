//! Inverse dynamics and regressors of many states, without the interpreter's lock.

use crate::error::wrong;
use pyo3::PyResult;
use rayon::prelude::*;
use tauscope::channels::Channels;
use tauscope::dynamics::{Chain, Entries, Lanes, Motion, block_row, inverse_dynamics};
use tauscope::robot::{PARAMETERS, Robot};

/// Samples from which a table is worth a second processor.
const PARALLEL: usize = 2_000;

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

/// Writes the regressor of a motion, `[link][parameter][joint][sample]`, into a table of zeros. Every processor takes some links.
pub(crate) fn regressor(chain: &Chain, motion: &Motion, table: &mut [f64]) {
    let (dof, bodies, samples) = (chain.dof(), chain.bodies(), motion.samples());
    let link_size = PARAMETERS * dof * samples;
    let entries = |first: usize, end: usize| {
        Entries::new(chain, |link, joint| {
            let wanted = (first..end).contains(&link) && chain.moves(joint, link);
            std::array::from_fn(|parameter| {
                wanted.then(|| block_row(dof, link, parameter, joint) - block_row(dof, first, 0, 0))
            })
        })
    };
    let work = |(first, end): (usize, usize), table: &mut [f64]| {
        entries(first, end).write(Lanes::best(), chain, motion, 0..samples, table);
    };
    let processors = rayon::current_num_threads();
    if processors == 1 || samples < PARALLEL {
        return work((0, bodies), table);
    }
    let mut rest = table;
    let mut parts = Vec::new();
    for (first, end) in shared(chain, processors) {
        let (part, behind) = rest.split_at_mut((end - first) * link_size);
        parts.push(((first, end), part));
        rest = behind;
    }
    parts.into_par_iter().for_each(|(links, part)| work(links, part));
}

/// Links from and to for each of so many processors, so that each has about as many entries to write.
fn shared(chain: &Chain, processors: usize) -> Vec<(usize, usize)> {
    let load = |link: usize| (0..chain.dof()).filter(|&joint| chain.moves(joint, link)).count();
    let all: usize = (0..chain.bodies()).map(load).sum();
    let (mut parts, mut first, mut done) = (Vec::new(), 0, 0);
    for link in 0..chain.bodies() {
        done += load(link);
        if done * processors >= all * (parts.len() + 1) || link + 1 == chain.bodies() {
            parts.push((first, link + 1));
            first = link + 1;
        }
    }
    parts
}
