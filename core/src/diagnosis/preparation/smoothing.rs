//! How smooth the positions of each joint should be: what serves a base joint of much inertia, whose accelerations let the encoder's
//! noise into its torque, bends the starts and stops of a wrist that friction holds.

use crate::diagnosis::logs::{CUTOFFS_HZ, Rows, typical_power};
use crate::diagnosis::model::Moved;
use crate::diagnosis::noise::Whitener;
use crate::diagnosis::regression::Column;
use crate::effects::{self, Placed};
use crate::error::Result;
use crate::identification::effect_model::Arm;
use crate::identification::low_passed::{ORDER, differentiated};
use crate::recording::Recording;
use crate::signal::ZeroPhaseLowPass;
use rayon::prelude::*;

/// Factor within which the cut-off of one joint lies about that of all.
const APART: f64 = 2.2;

/// Rows of a block that is short against a log, and long against a start or a stop.
const SHORT_ROWS: usize = 20;

/// Time by which torque is moved to see how noisy it gets, s.
const MOVED_S: f64 = 1e-3;

/// Cut-off of the positions of every joint, Hz, up to `highest_hz`: where the torque of `arm`, fitted with all joints at the
/// `common` cut-off, is likelier by `log_odds`, in its logarithm, once that joint alone goes to another. `residual` is that of the fit, in
/// units of the noise;
/// `recordings` are the logs of `rows`.
///
/// # Errors
/// If a log is too short to differentiate.
pub(super) fn of_joints(
    (arm, rows): (&Arm, &Rows),
    (whitener, residual): (&Whitener, &Column),
    recordings: &[&Recording],
    [common, highest_hz]: [f64; 2],
    log_odds: f64,
) -> Result<Vec<f64>> {
    let near = (common / APART)..=(common * APART).min(highest_hz);
    let others: Vec<f64> = CUTOFFS_HZ.into_iter().filter(|hz| *hz != common && near.contains(hz)).collect();
    let likelihood = |residual: &Column| -> f64 {
        let of_joint = |(joint, left): &(usize, Vec<f64>)| {
            let rows = whitener.rows()[*joint] as f64;
            -0.5 * rows * (left.iter().map(|r| r * r).sum::<f64>() / rows.max(1.0)).ln()
        };
        residual.parts.iter().map(of_joint).sum()
    };
    let along = arm.along(rows);
    let moved = |joint: usize, hz: f64| -> Result<f64> {
        let change = arm.departure(rows, &along, |index, log| {
            let mut q = log.motion.q.clone();
            let low_pass = ZeroPhaseLowPass::new(ORDER, hz, recordings[index].rate_hz())?;
            low_pass.apply(recordings[index].q.channel(joint), q.channel_mut(joint))?;
            differentiated(q, log.period)
        })?;
        let mut residual = residual.clone();
        residual.add(-1.0, &whitener.apply(&change));
        Ok(likelihood(&residual))
    };
    let before = likelihood(residual);
    (0..rows.dof())
        .into_par_iter()
        .map(|joint| {
            let mut best = (before + log_odds, common);
            for &hz in &others {
                let likelihood = moved(joint, hz)?;
                if likelihood > best.0 {
                    best = (likelihood, hz);
                }
            }
            Ok(best.1)
        })
        .collect()
}

/// Joints whose torque, moved in time, holds more than a `minor` share of the encoders' noise, in power and in units of the noise of the
/// torque: that share attenuates the estimate of a shift (errors in variables). The noise is what lies outside the accelerations that stand
/// clear of it, most of the time: starts and stops, which lie outside too, are short.
///
/// # Errors
/// If a log is too short to differentiate.
pub(super) fn noisy_once_moved(arm: &Arm, rows: &Rows, whitener: &Whitener, minor: f64) -> Result<Vec<bool>> {
    let delay = Placed { effect: effects::delay(), joint: 0, parameters: vec![MOVED_S] };
    let column = |moved: Moved| -> Result<Column> {
        let added = arm.added_in(0..rows.logs.len(), std::slice::from_ref(&delay), rows, moved)?;
        Ok(whitener.apply(&added[0]))
    };
    let (mut outside, clear) = (column(Moved::Modelled)?, column(Moved::Tested)?);
    outside.add(-1.0, &clear);
    Ok((0..rows.dof())
        .map(|joint| {
            let [outside, clear] = [&outside, &clear].map(|column| column.part(joint).unwrap_or_default());
            attenuates(outside, clear, minor)
        })
        .collect())
}

/// Whether what lies `outside` the `clear` part of a column is, most of the time, more than a share of it in power.
fn attenuates(outside: &[f64], clear: &[f64], share: f64) -> bool {
    let power = clear.iter().map(|x| x * x).sum::<f64>() / clear.len().max(1) as f64;
    typical_power(outside, SHORT_ROWS) > share * power
}

/// The frequency above which the positions of each joint are mostly noise, in the log where it is highest, Hz.
///
/// # Errors
/// If a log is too short for the filters.
pub(super) fn noise_from_hz(rows: &Rows) -> Result<Vec<f64>> {
    let mut highest = vec![0.0; rows.dof()];
    for log in &rows.logs {
        highest.iter_mut().zip(log.noise_from_hz()?).for_each(|(most, hz)| *most = f64::max(*most, *hz));
    }
    Ok(highest)
}

/// What the motion of each joint between a cut-off and the one that the rows are smoothed with, Hz, does to the torque of each joint:
/// for every joint that moves one column on every joint.
///
/// # Errors
/// If a log is too short to differentiate.
pub(super) fn bands(arm: &Arm, rows: &Rows, above_hz: &[f64], smoothed_hz: &[f64]) -> Result<Vec<Column>> {
    let (along, dof) = (arm.along(rows), rows.dof());
    let band = |joint: usize| {
        let change = if above_hz[joint] < smoothed_hz[joint] {
            arm.departure(rows, &along, |_, log| {
                let mut q = log.motion.q.clone();
                let low_pass = ZeroPhaseLowPass::new(ORDER, above_hz[joint], 1.0 / log.period)?;
                low_pass.apply(log.motion.q.channel(joint), q.channel_mut(joint))?;
                differentiated(q, log.period)
            })?
        } else {
            Column::default()
        };
        Ok((0..dof).map(|on| change.only(&[on])).collect())
    };
    let each = (0..dof).into_par_iter().map(band).collect::<Result<Vec<Vec<Column>>>>()?;
    Ok(each.concat())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_attenuates_and_a_start_does_not() {
        let clear: Vec<f64> = (0..400).map(|row| 2.0 * (0.1 * f64::from(row)).sin()).collect();
        let power = clear.iter().map(|x| x * x).sum::<f64>() / 400.0;
        let noise = |share: f64| -> Vec<f64> {
            (0..400).map(|row| (share * power).sqrt() * if row % 2 == 0 { 1.0 } else { -1.0 }).collect()
        };
        assert!(attenuates(&noise(0.11), &clear, 0.1) && !attenuates(&noise(0.09), &clear, 0.1));
        let mut start = noise(0.01);
        start[100..110].fill(50.0);
        assert!(!attenuates(&start, &clear, 0.1));
    }
}
