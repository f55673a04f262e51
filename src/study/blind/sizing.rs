//! Hidden effects at the size that is asked for.

use super::case::Case;
use super::motion::{TRAIN, reference_log};
use crate::diagnosis::column::{Column, rms};
use crate::diagnosis::roles;
use crate::diagnosis::score::Projection;
use crate::diagnosis::session::Session;
use crate::effects::{Placed, Role, Site};
use crate::error::{Error, Result};
use crate::excitation::Motion;
use crate::identification::model::Model;
use crate::recording::Recording;
use crate::scenario::Setup;

/// Corrections of an effect's size towards the wanted severity.
const SIZINGS: usize = 4;

/// Halvings of the range of a level.
const HALVINGS: usize = 20;

/// The effect at the size at which what it adds beyond the baseline along the training references, root mean square on its
/// worst joint, is the case's severity times the torque noise.
///
/// # Errors
/// If it does not show on this arm at all.
pub fn sized(setup: &Setup, placed: &Placed, case: &Case, motions: &[Motion]) -> Result<Placed> {
    if placed.effect.about().site == Site::Integrator {
        // The step must divide the time between samples, so it cannot be sized.
        return Ok(placed.clone());
    }
    let logs: Vec<Recording> = motions[..TRAIN].iter().map(|motion| reference_log(case, setup, motion)).collect();
    let logs: Vec<&Recording> = logs.iter().collect();
    let model = Model::new(&setup.known);
    let mut session = Session::new(&model, case.trust, &logs, &logs)?;
    session.believe(&setup.known);
    let severity = |placed: &Placed| -> Result<f64> {
        let added = session.arm.added(std::slice::from_ref(placed), &session.train.rows)?.swap_remove(0);
        // Parameters that joints share must not carry what is little on a strong joint to a weak one, where it is much.
        let in_noise = |column: &Column| {
            let mut column = column.masked(&session.train.rows.valid);
            for (joint, values) in &mut column.parts {
                values.iter_mut().for_each(|value| *value /= setup.sensors[*joint].torque_noise);
            }
            column
        };
        let baseline: Vec<_> = session.train.baseline.iter().map(in_noise).collect();
        let left = Projection::new(&baseline, &in_noise(&added)).residual;
        Ok(rms(&session.train.rows.valid, &left).into_iter().fold(0.0, f64::max))
    };
    let mut placed = placed.clone();
    if roles::is_level(placed.effect) {
        let largest = session.largest_torque(placed.joint);
        let (mut low, mut high) = (0.1 * largest, largest);
        for _ in 0..HALVINGS {
            placed.parameters[0] = 0.5 * (low + high);
            if severity(&placed)? > case.severity { low = placed.parameters[0] } else { high = placed.parameters[0] }
        }
        return Ok(placed);
    }
    for _ in 0..SIZINGS {
        let now = severity(&placed)?;
        if !(now > 0.0 && now.is_finite()) {
            let problem = format!("`{}` does not show on this arm beyond the baseline", placed.effect.about().name);
            return Err(Error::request("blind run", problem));
        }
        let factor = case.severity / now;
        for (parameter, value) in placed.effect.parameters().iter().zip(&mut placed.parameters) {
            if matches!(parameter.role, Role::Amplitude | Role::Departure) {
                *value = (*value * factor).clamp(parameter.lower, parameter.upper);
            }
        }
    }
    Ok(placed)
}
