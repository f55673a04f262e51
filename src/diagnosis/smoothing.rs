//! How smooth the positions of each joint should be: what serves a base joint of much inertia, whose accelerations let the encoder's
//! noise into its torque, bends the starts and stops of a wrist that friction holds.

use super::arm::over_rows;
use super::column::Column;
use super::cutoffs::{CUTOFFS_HZ, ORDER};
use super::rows::Log;
use super::session::{Noise, Session};
use crate::channels::Channels;
use crate::error::Result;
use crate::recording::Recording;
use crate::signal::ZeroPhaseLowPass;
use rayon::prelude::*;

/// Factor within which the cut-off of one joint lies about that of all.
const APART: f64 = 2.2;

/// By how much more likely, in its logarithm, the training torque must be with another cut-off of a joint.
const LIKELIER: f64 = 5.0;

/// Cut-off of the positions of every joint, Hz, up to `highest_hz`: where the torque of the arm, fitted with all joints at the
/// `common` cut-off, is likeliest once that joint alone goes to another. `recordings` are the training logs.
///
/// # Errors
/// If a log is too short to differentiate.
pub fn of_joints(session: &Session, recordings: &[&Recording], [common, highest_hz]: [f64; 2]) -> Result<Vec<f64>> {
    let near = (common / APART)..=(common * APART).min(highest_hz);
    let others: Vec<f64> = CUTOFFS_HZ.into_iter().filter(|hz| *hz != common && near.contains(hz)).collect();
    let Noise { whitener, fit } = session.noise_under(&session.train.baseline);
    let likelihood = |residual: &Column| -> f64 {
        let of_joint = |(joint, left): &(usize, Vec<f64>)| {
            let rows = whitener.rows()[*joint] as f64;
            -0.5 * rows * (left.iter().map(|r| r * r).sum::<f64>() / rows.max(1.0)).ln()
        };
        residual.parts.iter().map(of_joint).sum()
    };
    let rows = &session.train.rows;
    let plain: Vec<Channels> = rows.logs.par_iter().map(|log| session.arm.torque(&log.motion, &log.motion)).collect();
    let moved = |joint: usize, hz: f64| -> Result<f64> {
        let each = rows.logs.iter().zip(recordings).zip(&plain).map(|((log, recording), plain)| {
            let mut q = log.motion.q.clone();
            let low_pass = ZeroPhaseLowPass::new(ORDER, hz, recording.rate_hz())?;
            low_pass.apply(recording.q.channel(joint), q.channel_mut(joint))?;
            let motion = Log::motion_of(q, log.period)?;
            let mut torque = session.arm.torque(&motion, &motion);
            torque.as_mut_slice().iter_mut().zip(plain.as_slice()).for_each(|(value, plain)| *value -= plain);
            Ok(torque)
        });
        let change = over_rows(rows, &each.collect::<Result<Vec<Channels>>>()?);
        let mut residual = fit.residual.clone();
        residual.add(-1.0, &whitener.apply(&change));
        Ok(likelihood(&residual))
    };
    let before = likelihood(&fit.residual);
    (0..rows.dof())
        .into_par_iter()
        .map(|joint| {
            let mut best = (before + LIKELIER, common);
            for &hz in &others {
                let likelihood = moved(joint, hz)?;
                tracing::debug!(joint, hz, gain = likelihood - before, "cut-off of one joint");
                if likelihood > best.0 {
                    best = (likelihood, hz);
                }
            }
            Ok(best.1)
        })
        .collect()
}
