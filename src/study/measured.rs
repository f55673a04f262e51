//! A measured data set in place of a simulation: identify with and without smoothing, and with the usual one, judge by the torque on
//! held-out logs.

use super::score::standard_deviation;
use super::testbed::Variant;
use crate::error::Result;
use crate::identification::effect_model::{Preparation, Trust};
use crate::identification::fit::{Fitted, Logs, fit_effects};
use crate::identification::model::Model;
use crate::identification::prepare::{self, Smoothing};
use crate::identification::smoothing_choice::{self, Described};
use crate::recording::Recording;

/// An identification from measured logs and how well it predicts their torque.
#[derive(Debug, Clone)]
pub(crate) struct Scored {
    /// Which signals it saw; never the exact ones.
    pub variant: Variant,
    /// How they were smoothed; None where they were not.
    pub smoothing: Option<Described>,
    /// What it found.
    pub fitted: Fitted,
    /// Standard deviation of predicted minus measured torque, sensor noise and all, on the training logs, per joint, N m, at
    /// samples at which the joint moves.
    pub torque_std_training_nm: Vec<f64>,
    /// The same on the held-out logs; empty where there are none.
    pub torque_std_held_out_nm: Vec<f64>,
}

/// Identifies from the training logs as `variant` sees them and scores on both kinds. `smoothing` is that of Savitzky-Golay; `judge` shows
/// at which samples a joint moves, for all variants alike.
///
/// # Errors
/// If a log is too short, or the motion does not separate the parameters (named).
pub(crate) fn identify(
    model: &Model,
    logs: Logs,
    variant: Variant,
    [smoothing, judge]: [Preparation; 2],
) -> Result<Scored> {
    let seen = match variant {
        Variant::Raw => Preparation { smoothing: Smoothing::None, ..smoothing },
        Variant::Butterworth => Preparation { smoothing: smoothing_choice::usual_low_pass(logs.train)?, ..smoothing },
        Variant::Exact | Variant::SavitzkyGolay => smoothing,
    };
    let fitted = fit_effects(model, Trust::Structure, logs, seen.clone(), Vec::new())?;
    let beta = &fitted.fit.estimate.beta;
    let error = |recordings: &[&Recording]| torque_error(model, beta, recordings, [&seen, &judge]);
    let (training, held_out) = (error(logs.train)?, error(logs.test)?);
    let rate_hz = logs.train.first().map_or(f64::NAN, |log| log.rate_hz());
    let described = smoothing_choice::described(&seen.smoothing, rate_hz)?;
    Ok(Scored {
        variant,
        smoothing: described,
        fitted,
        torque_std_training_nm: training,
        torque_std_held_out_nm: held_out,
    })
}

fn torque_error(
    model: &Model,
    beta: &[f64],
    logs: &[&Recording],
    [seen, judge]: [&Preparation; 2],
) -> Result<Vec<f64>> {
    let mut errors: Vec<Vec<f64>> = vec![Vec::new(); model.dof()];
    for log in logs {
        let prepared = prepare::measured(log, &seen.smoothing, seen.band)?;
        let judged = prepare::measured(log, &judge.smoothing, judge.band)?;
        let predicted = prepared.predict(model, beta);
        for (joint, errors) in errors.iter_mut().enumerate() {
            let both = predicted.channel(joint).iter().zip(log.tau.channel(joint));
            errors.extend(both.zip(judged.moving(joint)).filter(|(_, ok)| *ok).map(|((p, t), _)| p - t));
        }
    }
    Ok(match logs {
        [] => Vec::new(),
        _ => errors.iter().map(|errors| standard_deviation(errors)).collect(),
    })
}
