//! Fits on demand: the arm's parameters and named effects from training logs, judged on held-out logs.

use super::separable::{EffectFit, fit};
use crate::effects::{Placed, Site};
use crate::error::Result;
use crate::identification::effect_model::{Arm, EffectModel, Preparation, Trust};
use crate::identification::model::Model;
use crate::identification::regression::joint_regression::JointRegression;
use crate::recording::Recording;
use crate::robot::{Drive, Robot};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Logs to fit and logs to judge by.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::identification::effect_model::{Preparation, Trust};
/// use tauscope::identification::fit::{Logs, fit_effects};
/// use tauscope::identification::model::Model;
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/payload/arm.urdf", InertiaCheck::Ignored)?;
/// # let log = recording::load("../tests/reference/payload/before.csv", None)?;
/// # let other = recording::load("../tests/reference/payload/nothing.csv", None)?;
///
/// // Fit to one log, judge by another that the fit has not seen.
/// let logs = Logs { train: &[&log], test: &[&other] };
/// let fitted = fit_effects(&Model::new(&robot), Trust::Structure, logs, Preparation::usual(&log), Vec::new())?;
/// assert_eq!((fitted.train_rms.len(), fitted.test_rms.len()), (5, 5));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Logs<'a> {
    /// Logs that are identified from.
    pub train: &'a [&'a Recording],
    /// Logs of other motions, which the fit does not see.
    pub test: &'a [&'a Recording],
}

/// A fit with its residual on training and held-out logs, root mean square per joint in N m.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::identification::effect_model::{Preparation, Trust};
/// use tauscope::identification::fit::{Logs, fit_effects};
/// use tauscope::identification::model::Model;
/// use tauscope::effects::{Placed, TorqueRipple};
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/payload/arm.urdf", InertiaCheck::Ignored)?;
/// # let log = recording::load("../tests/reference/payload/before.csv", None)?;
/// # let other = recording::load("../tests/reference/payload/nothing.csv", None)?;
///
/// // Friction of joint j2 has a ripple of seven periods a turn. A law for it makes the held-out residual smaller.
/// let (model, preparation) = (Model::new(&robot), Preparation::usual(&log));
/// let logs = Logs { train: &[&log], test: &[&other] };
/// let ripple = Placed { effect: &TorqueRipple, joint: 1, parameters: vec![0.5, 0.5, 7.0] };
/// let fit = |placed| fit_effects(&model, Trust::Structure, logs, preparation.clone(), placed);
/// let (without, with) = (fit(Vec::new())?, fit(vec![ripple])?);
/// assert!(with.test_rms[1] < 0.6 * without.test_rms[1]);
/// assert!((with.placed[0].parameters[2] - 7.0).abs() < 0.1);
///
/// let json = serde_json::to_value(&with).expect("it has a JSON form");
/// assert_eq!(json["placed"][0]["effect"], "torque_ripple");
/// assert_eq!(json["fit"]["names"].as_array().map(Vec::len), json["fit"]["estimate"]["covariance"].as_array().map(Vec::len));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, serde::Serialize)]
pub struct Fitted {
    /// Parameters with their covariance.
    pub fit: EffectFit,
    /// The effects with the parameters found.
    pub placed: Vec<Placed>,
    /// Residual on the training logs.
    pub train_rms: Vec<f64>,
    /// Residual on the held-out logs; empty where there are none.
    pub test_rms: Vec<f64>,
    /// The held-out logs row by row; not serialised.
    #[serde(skip)]
    pub test: Rows,
    /// Joints whose rows near reversals are in the fit, if they have any; those of the others show more than noise.
    pub reversals: Vec<bool>,
}

/// The rows that a fit is judged by, `[joint][row]`; nothing where there are no held-out logs.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::identification::effect_model::{Preparation, Trust};
/// use tauscope::identification::fit::{Logs, fit_effects};
/// use tauscope::identification::model::Model;
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/payload/arm.urdf", InertiaCheck::Ignored)?;
/// # let log = recording::load("../tests/reference/payload/before.csv", None)?;
/// # let other = recording::load("../tests/reference/payload/nothing.csv", None)?;
///
/// let logs = Logs { train: &[&log], test: &[&other] };
/// let fitted = fit_effects(&Model::new(&robot), Trust::Structure, logs, Preparation::usual(&log), Vec::new())?;
///
/// // Root mean square of the held-out residual of joint j1 over the valid rows.
/// let rows: Vec<f64> = fitted.test.residual[0].iter().flatten().copied().collect();
/// let rms = (rows.iter().map(|value| value * value).sum::<f64>() / rows.len() as f64).sqrt();
/// assert!((rms / fitted.test_rms[0] - 1.0).abs() < 1e-9);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct Rows {
    /// Time, each log's own, s; NaN between two logs.
    pub time: Vec<f64>,
    /// Filtered torque, N m.
    pub torque: Vec<Vec<f64>>,
    /// Torque less that of the model; None where a row does not count.
    pub residual: Vec<Vec<Option<f64>>>,
    /// Smoothed positions, rad; NaN between two logs.
    pub q: Vec<Vec<f64>>,
    /// Their velocities, rad/s.
    pub qd: Vec<Vec<f64>>,
    /// Standard deviation of the white noise in the filtered torque, for each joint, N m.
    pub noise: Vec<f64>,
}

/// Fits the arm and `placed` effects to the training logs.
///
/// # Errors
/// If a log is too short, or the motion does not separate the parameters (named).
pub fn fit_effects(
    model: &Model,
    trust: Trust,
    logs: Logs,
    preparation: Preparation,
    placed: Vec<Placed>,
) -> Result<Fitted> {
    fit_effects_until(model, trust, logs, preparation, placed, &vec![true; model.dof()], None)
}

/// [`fit_effects`] in rows near reversals only of joints where they are to be `kept`, so that two fits are in the same rows; it ends once
/// `stop` is raised.
///
/// # Errors
/// Those of [`fit_effects`], and if it is stopped.
pub(in crate::identification) fn fit_effects_until(
    model: &Model,
    trust: Trust,
    logs: Logs,
    preparation: Preparation,
    placed: Vec<Placed>,
    kept: &[bool],
    stop: Option<&Arc<AtomicBool>>,
) -> Result<Fitted> {
    // Friction that goes with the load follows the bodies as estimated without it: they would chase each other.
    let bodies = match trust == Trust::Structure && placed.iter().any(goes_with_load) {
        true => {
            let plain = EffectModel::new(model, trust, logs.train, preparation.clone(), Vec::new())?;
            let mut plain = plain.with_reversals(kept).with_stop(stop);
            let found = fit(&mut plain)?;
            plain.set_baseline(&found.estimate.beta);
            plain.found_arm()
        }
        false => Arm::new(model.robot(), trust),
    };
    let along = |logs, placed, kept: &[bool]| -> Result<EffectModel> {
        let model = EffectModel::new(model, trust, logs, preparation.clone(), placed)?;
        Ok(model.with_reversals(kept).with_bodies(bodies.clone()).with_stop(stop))
    };
    let mut reversals = kept.to_vec();
    let mut training = along(logs.train, placed, &reversals)?;
    let mut found = fit(&mut training)?;
    // Rows near reversals decide the shapes of laws of low speed; what is linear takes part in all of the motion.
    if !training.nonlinear().is_empty() && found.good_reversals.contains(&false) {
        reversals.iter_mut().zip(&found.good_reversals).for_each(|(kept, good)| *kept &= good);
        training = along(logs.train, training.placed().to_vec(), &reversals)?;
        found = fit(&mut training)?;
    }
    let placed = training.placed().to_vec();
    let (test_rms, test) = match logs.test {
        [] => (Vec::new(), Rows::default()),
        test => judged(along(test, placed.clone(), &reversals)?, &found)?,
    };
    Ok(Fitted { train_rms: found.residual_rms.clone(), placed, test_rms, test, fit: found, reversals })
}

impl Fitted {
    /// The arm with rotor inertia, viscous and Coulomb friction of every joint as fitted with the bodies of the URDF; one that
    /// came out negative, which no drive has, is zero. What an effect stands for stays as it was.
    pub fn with_drives(&self, known: &Robot) -> Robot {
        let mut robot = known.clone();
        for (joint, spec) in robot.joints.iter_mut().enumerate() {
            let Drive { armature, viscous, coulomb } = &mut spec.drive;
            for (symbol, target) in [("Ia", armature), ("Fv", viscous), ("Fc", coulomb)] {
                let name = format!("{symbol}{}", joint + 1);
                if let Some(place) = self.fit.names.iter().position(|own| *own == name) {
                    *target = self.fit.estimate.beta[place].max(0.0);
                }
            }
        }
        robot
    }
}

/// Whether the law of an effect depends on the inertias of the arm.
fn goes_with_load(placed: &Placed) -> bool {
    let about = placed.effect.about();
    about.site == Site::Joint && about.uses_acceleration
}

/// The residual of a fit on the logs of `model`: root mean square per joint, and row by row.
fn judged(mut model: EffectModel, fit: &EffectFit) -> Result<(Vec<f64>, Rows)> {
    let linear = &fit.estimate.beta;
    model.set_baseline(linear);
    let joints = model.regression()?;
    let residual = |joint: &JointRegression| {
        joint.residual(linear).into_iter().zip(&joint.valid).map(|(r, ok)| ok.then_some(r)).collect()
    };
    let rms = joints.iter().map(|joint| joint.residual_rms(linear)).collect();
    let residual = joints.iter().map(residual).collect();
    let ([q, qd], time, noise) = (model.row_motion()?, model.row_times()?, model.torque_noise()?);
    let torque = joints.into_iter().map(|joint| joint.torque).collect();
    Ok((rms, Rows { time, torque, residual, q, qd, noise }))
}
