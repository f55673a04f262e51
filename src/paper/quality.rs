//! How well a torque model explains a log.

use super::procedure::{Procedure, Stage};
use crate::error::Result;
use crate::identification::prepare::Prepared;
use crate::internal::identification::{JointRegression, LinearModel};
use crate::scenario::Setup;
use crate::study::score::torque_std;
use crate::study::testbed::{self, Run, Runs};

/// Both motions of a scenario as an identification sees them.
pub(crate) struct Seen<'a> {
    /// Raw or smoothed.
    pub signals: testbed::Variant,
    /// The motion that is identified from.
    pub training: (&'a Run, Prepared<'a>),
    /// The motion on which the result is judged.
    pub held_out: (&'a Run, Prepared<'a>),
}

impl<'a> Seen<'a> {
    /// Prepares both runs.
    ///
    /// # Errors
    /// Those of [`testbed::prepared`].
    pub(crate) fn new(
        setup: &Setup,
        runs: &'a Runs,
        signals: testbed::Variant,
        procedure: &mut Procedure,
    ) -> Result<Self> {
        let mut prepare = |run| procedure.time(Stage::Smoothing, || testbed::prepared(setup, run, signals));
        Ok(Seen {
            signals,
            training: (&runs.training, prepare(&runs.training)?),
            held_out: (&runs.held_out, prepare(&runs.held_out)?),
        })
    }
}

/// Torque of one motion, measured against a model; one entry per joint, N m.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub(crate) struct TorqueQuality {
    /// Root mean square of measured minus predicted torque, both through the filter of the identification, over the
    /// samples it uses.
    pub residual_rms_nm: Vec<f64>,
    /// Root mean square of the measured torque over the same samples.
    pub torque_rms_nm: Vec<f64>,
    /// `residual_rms_nm` in percent of `torque_rms_nm`.
    pub residual_percent: Vec<f64>,
    /// Standard deviation of predicted minus noise-free torque over the samples at which the joint moves.
    pub torque_std_nm: Vec<f64>,
}

/// A model judged on both motions.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub(crate) struct Quality {
    /// On the motion that was identified from.
    pub training: TorqueQuality,
    /// On the other one.
    pub held_out: TorqueQuality,
}

impl Quality {
    /// Judges `parameters` of `model`; `regression` is that of the training motion.
    ///
    /// # Errors
    /// Those of [`Prepared::regression`].
    pub(crate) fn new(
        model: &impl LinearModel,
        parameters: &[f64],
        seen: &Seen,
        regression: &[JointRegression],
    ) -> Result<Self> {
        Ok(Quality {
            training: torque_quality(model, parameters, &seen.training, regression),
            held_out: torque_quality(model, parameters, &seen.held_out, &seen.held_out.1.regression(model)?),
        })
    }
}

fn torque_quality(
    model: &impl LinearModel,
    parameters: &[f64],
    (run, prepared): &(&Run, Prepared),
    regression: &[JointRegression],
) -> TorqueQuality {
    let nothing = vec![0.0; parameters.len()];
    let rms = |values: &[f64]| -> Vec<f64> { regression.iter().map(|joint| joint.residual_rms(values)).collect() };
    let (residual_rms_nm, torque_rms_nm) = (rms(parameters), rms(&nothing));
    let predicted = prepared.predict(model, parameters);
    TorqueQuality {
        residual_percent: residual_rms_nm.iter().zip(&torque_rms_nm).map(|(r, t)| 100.0 * r / t).collect(),
        residual_rms_nm,
        torque_rms_nm,
        torque_std_nm: torque_std(&predicted, &run.truth.signals.tau, |joint| prepared.moving(joint)),
    }
}
