//! Hidden effects at the size that is asked for.

use super::case::Case;
use super::motion::{TRAIN, reference_log};
use crate::effects::{Nature, Placed, Role, Site};
use crate::error::{Error, Result};
use crate::excitation::Motion;
use crate::identification::model::Model;
use crate::internal::diagnosis::{Column, Projection, Session, is_level, rms};
use crate::recording::Recording;
use crate::scenario::Setup;

/// Corrections of an effect's size towards the wanted severity.
const SIZINGS: usize = 4;

/// Halvings of the range of a level.
const HALVINGS: usize = 20;

/// Share of the wanted severity that an effect must reach within the bounds of its parameters.
const REACHED: f64 = 0.8;

/// The effect at the size at which what it adds beyond the baseline along the training references, root mean square on its
/// worst joint, is the case's severity times the torque noise. An effect of the integrator stays as it is: its step must
/// divide the time between samples.
///
/// # Errors
/// If it cannot be as large as that on this arm: not within the bounds of its parameters, or not at all.
pub(crate) fn sized(setup: &Setup, placed: &Placed, case: &Case, motions: &[Motion]) -> Result<Placed> {
    if placed.effect.about().site == Site::Integrator {
        return Ok(placed.clone());
    }
    let model = Model::new(&setup.known);
    let logs = references(setup, case, &motions[..TRAIN]);
    let session = session(setup, &model, &logs, case)?;
    let mut placed = placed.clone();
    if is_level(placed.effect) {
        let largest = session.model.largest_torque(&session.logs.train.rows, placed.joint);
        let (mut low, mut high) = (0.1 * largest, largest);
        for _ in 0..HALVINGS {
            placed.parameters[0] = 0.5 * (low + high);
            match severity(setup, &session, &placed)? > case.severity {
                true => low = placed.parameters[0],
                false => high = placed.parameters[0],
            }
        }
        return reached(setup, &session, placed, case);
    }
    for _ in 0..SIZINGS {
        let factor = case.severity / shown(setup, &session, &placed)?;
        for (parameter, value) in placed.effect.parameters().iter().zip(&mut placed.parameters) {
            if matches!(parameter.role, Role::Amplitude | Role::Departure) {
                *value = (*value * factor).clamp(parameter.lower, parameter.upper);
            }
        }
    }
    reached(setup, &session, placed, case)
}

/// The effect if it is as large as is wanted.
fn reached(setup: &Setup, session: &Session, placed: Placed, case: &Case) -> Result<Placed> {
    let severity = severity(setup, session, &placed)?;
    if severity < REACHED * case.severity {
        let problem = format!(
            "`{}` reaches {severity:.2} of the noise within the bounds of its parameters, not {}",
            placed.effect.about().name,
            case.severity
        );
        return Err(Error::request("blind run", problem));
    }
    Ok(placed)
}

/// Factor on the torque noise at which an effect that cannot be as small as the case asks has the case's severity: one of the integrator,
/// whose step stays as it is, and a delay of less than a sample, since sampling alone brings half of one. One for all others.
///
/// # Errors
/// If it does not show on this arm at all.
pub(crate) fn noise_at_size(setup: &Setup, placed: &Placed, case: &Case, motions: &[Motion]) -> Result<f64> {
    let about = placed.effect.about();
    if about.site != Site::Integrator && about.nature != Nature::Delay {
        return Ok(1.0);
    }
    let model = Model::new(&setup.known);
    let logs = references(setup, case, &motions[..TRAIN]);
    let session = session(setup, &model, &logs, case)?;
    if about.nature != Nature::Delay {
        return Ok(shown(setup, &session, placed)? / case.severity);
    }
    let period = session.logs.train.rows.logs[0].period;
    let a_sample = Placed { parameters: vec![period.copysign(placed.parameters[0])], ..placed.clone() };
    Ok((shown(setup, &session, &a_sample)? / case.severity).max(1.0))
}

/// Logs of the motions themselves.
pub(super) fn references(setup: &Setup, case: &Case, motions: &[Motion]) -> Vec<Recording> {
    motions.iter().map(|motion| reference_log(case, setup, motion)).collect()
}

/// The arm as it is known along such logs.
pub(super) fn session<'a>(setup: &Setup, model: &'a Model, logs: &[Recording], case: &Case) -> Result<Session<'a>> {
    let logs: Vec<&Recording> = logs.iter().collect();
    let mut session = Session::new(model, case.trust, &logs, &logs)?;
    session.take_parameters_of(&setup.known);
    Ok(session)
}

/// What an effect adds beyond the baseline on its worst joint over the torque noise, root mean squares.
fn severity(setup: &Setup, session: &Session, placed: &Placed) -> Result<f64> {
    let added = session.model.arm.added(std::slice::from_ref(placed), &session.logs.train.rows)?.swap_remove(0);
    // Parameters that joints share must not carry what is little on a strong joint to a weak one, where it is much.
    let in_noise = |column: &Column| {
        let mut column = column.masked(&session.logs.train.rows.valid);
        for (joint, values) in &mut column.parts {
            values.iter_mut().for_each(|value| *value /= setup.sensors[*joint].torque_noise);
        }
        column
    };
    let baseline: Vec<_> = session.logs.train.baseline.iter().map(in_noise).collect();
    let left = Projection::new(&baseline, &in_noise(&added)).residual;
    Ok(rms(&session.logs.train.rows.valid, &left).into_iter().fold(0.0, f64::max))
}

fn shown(setup: &Setup, session: &Session, placed: &Placed) -> Result<f64> {
    let now = severity(setup, session, placed)?;
    if !(now > 0.0 && now.is_finite()) {
        let problem = format!("`{}` does not show on this arm beyond the baseline", placed.effect.about().name);
        return Err(Error::request("blind run", problem));
    }
    Ok(now)
}
