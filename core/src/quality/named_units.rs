//! Doubtful units in the names of columns: a name stays unless the torques deny it.

use super::descriptions;
use super::view::View;
use crate::dynamics::{Chain, Motion, inverse_dynamics};
use crate::error::Result;
use crate::linear::root_mean_square;
use crate::recording::lenient::{DoubtfulUnit, Sieved};
use crate::recording::{Recording, VELOCITY, resample, unwrap};
use crate::robot::Robot;

/// Fewest rows from which a log denies the unit of its names.
const FEWEST: usize = 100;

/// Puts back what was converted from a doubtful unit of the names that the torques deny, with a note; the joints are those of the robot.
///
/// # Errors
/// Those of the filters.
pub(crate) fn settle(sieved: &mut Sieved, robot: &Robot) -> Result<()> {
    let doubts = std::mem::take(&mut sieved.doubts);
    if sieved.spoilt.is_some() || sieved.recording.joints() != robot.dof() {
        return Ok(());
    }
    for doubt in doubts {
        let mut log = sieved.recording.clone();
        put_back(&mut log, &doubt);
        let is_torque = doubt.is_of_torque();
        let (unwrapped, unwrap_note) = if is_torque { (Vec::new(), None) } else { unwrap(&mut log) };
        let Some(even) = even(&log) else { continue };
        let denied = match is_torque {
            true => are_of_bodies(&even, robot, doubt.factor)?,
            false => descriptions::are_radians(&even, robot)?,
        };
        if !denied {
            continue;
        }
        sieved.recording = log;
        sieved.corrections.retain(|note| !doubt.notes.contains(note));
        let DoubtfulUnit { symbol, quantities, .. } = doubt;
        sieved.corrections.push(match is_torque {
            true => format!(
                "the names of the torques say {symbol}, in which they are far too small for the bodies of the robot's file: they are taken in N m; if \
                 they are in {symbol}, say so with [units] torque = \"mNm\" in a dataset"
            ),
            false => format!(
                "the names of the positions say {symbol}, but the torques are explained much better in rad: they{} are taken in rad; if they are in \
                 {symbol}, say so with [units] position = \"deg\" in a dataset",
                if quantities[VELOCITY] { " and the velocities" } else { "" }
            ),
        });
        if !is_torque {
            sieved.unwrapped = unwrapped;
            sieved.corrections.extend(unwrap_note);
        }
    }
    Ok(())
}

/// Undoes the conversion.
fn put_back(log: &mut Recording, doubt: &DoubtfulUnit) {
    let Recording { q, qd, qdd, tau, .. } = log;
    let tables = [Some(q), qd.as_mut(), qdd.as_mut(), Some(tau)];
    for table in tables.into_iter().zip(doubt.quantities).filter_map(|(table, own)| table.filter(|_| own)) {
        *table = table.map(|_, values| values.iter().map(|value| value / doubt.factor).collect());
    }
}

/// The longest part of a log without a gap, at even steps, where it is long enough.
fn even(log: &Recording) -> Option<Recording> {
    let rows = resample::longest_stretch(log).unwrap_or(0..log.samples());
    (rows.len() >= FEWEST).then(|| resample::evenly(&log.slice(rows)))
}

/// Whether the torques are nearer to those of the described bodies than the same in a unit of `factor` SI units. There is no telling
/// without bodies.
fn are_of_bodies(log: &Recording, robot: &Robot, factor: f64) -> Result<bool> {
    if !descriptions::has_bodies(robot) {
        return Ok(false);
    }
    let view = View::new(log, Some(robot))?;
    let motion = Motion { q: view.q, qd: view.qd, qdd: view.qdd };
    let bodies = inverse_dynamics(&Chain::new(robot), &robot.inertial_parameters(), &motion);
    let ratios = bodies.iter().zip(view.tau.iter()).map(|(own, tau)| root_mean_square(tau) / root_mean_square(own));
    let mut ratios: Vec<f64> = ratios.filter(|ratio| ratio.is_finite() && *ratio > 0.0).collect();
    // A load, friction and an axis that gravity does not turn make some joints others.
    ratios.sort_by(f64::total_cmp);
    Ok(ratios.get(ratios.len() / 2).is_some_and(|median| *median < 1.0 / factor.sqrt()))
}
