//! Constants that the residuals of a fit hold: an amplifier whose current does not read zero at zero torque.
//!
//! A model without a constant gives it to gravity and friction as far as it can, and both come out wrong.

use crate::identification::regression::joint_regression::JointRegression;
use crate::identification::regression::least_squares::sums;
use crate::identification::regression::linear_problem::LinearProblem;

/// Rows of a joint that are looked at: a constant needs few.
const ROWS: usize = 4000;

/// Least share of a constant column orthogonal to the columns of the arm: that of a weight that slides up and down has none.
const SEPARATE: f64 = 1e-3;

/// Share of a joint's mean squared residual that a constant must make, and its least size over the root mean square torque: smaller ones
/// are slow noise, or bias nothing that matters.
const SHARE: f64 = 0.25;
const SIZE: f64 = 0.005;

/// A constant that a residual holds.
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
/// // The torque sensor of joint j1, whose axis is vertical, has an offset of 3 N m.
/// let mut log = log;
/// log.tau.channel_mut(0).iter_mut().for_each(|torque| *torque += 3.0);
/// let (logs, preparation) = (Logs { train: &[&log], test: &[] }, Preparation::usual(&log));
/// let fitted = fit_effects(&Model::new(&robot), Trust::Structure, logs, preparation, Vec::new())?;
/// let constant = fitted.fit.constants[0].as_ref().expect("it matters");
/// assert!((constant.value - 3.0).abs() < 0.2 && constant.share > 0.5);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Constant {
    /// Its least-squares estimate with all parameters of the arm free, N m (N).
    pub value: f64,
    /// Share of the mean squared residual that it makes.
    pub share: f64,
}

/// The constant of each joint by itself, where it matters: that of the residual of a weighted fit with the standard deviations
/// `sigma`.
pub(super) fn constants(joints: &[JointRegression], sigma: &[f64], names: &[String]) -> Vec<Option<Constant>> {
    let rows = joints.iter().map(|joint| joint.torque.len()).max().unwrap_or(0);
    let thinned: Vec<JointRegression> =
        joints.iter().map(|joint| joint.part(0..joint.torque.len(), rows.div_ceil(ROWS).max(1))).collect();
    let sums = sums(&thinned);
    let Ok((beta, normal)) = sums.solve(sigma, names) else { return vec![None; joints.len()] };
    let problem = LinearProblem::with_normal(&thinned, sigma, sums.normal(sigma, names.len()));
    let of = |joint: usize| {
        let own = &thinned[joint];
        let ones = vec![1.0; own.torque.len()];
        let residual = own.residual(beta.as_slice());
        let weight = 1.0 / (sigma[joint] * sigma[joint]);
        let mut columns: Vec<Vec<f64>> = thinned.iter().map(|other| vec![0.0; other.torque.len()]).collect();
        columns[joint].clone_from(&ones);
        let cross = problem.right(&columns);
        let all = weight * own.rows() as f64;
        let left = all - cross.dot(&normal.solve(&cross));
        if left.is_nan() || left <= SEPARATE * all {
            return None;
        }
        let value = weight * own.dot(&ones, &residual) / left;
        let share = value * value * left / weight / own.dot(&residual, &residual);
        let torque = (own.dot(&own.torque, &own.torque) / own.rows() as f64).sqrt();
        (share > SHARE && value.abs() > SIZE * torque).then_some(Constant { value, share: share.min(1.0) })
    };
    (0..joints.len()).map(|joint| if thinned[joint].rows() > 0 { of(joint) } else { None }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::channels::Channels;

    /// Friction in the direction of motion, a wave as another column, and an offset.
    fn joint(offset: f64, with_constant: bool, noise: f64) -> JointRegression {
        let rows = 9000;
        let wave = |rate: f64| move |k: usize| (rate * k as f64).sin();
        let friction: Vec<f64> = (0..rows).map(|k| (0.01 * k as f64).cos().signum()).collect();
        let gravity: Vec<f64> = (0..rows).map(wave(0.013)).collect();
        let torque = (0..rows).map(|k| 2.0 * friction[k] - 5.0 * gravity[k] + offset + noise * wave(1.7)(k)).collect();
        let mut columns = vec![friction, gravity];
        columns.extend(with_constant.then(|| vec![1.0; rows]));
        JointRegression {
            joint: "a".into(),
            parameters: (0..columns.len()).collect(),
            columns: Channels::from_vectors(&columns),
            torque,
            valid: (0..rows).map(|k| k % 10 != 3).collect(),
        }
    }

    #[test]
    fn a_constant_in_a_residual_is_told_with_its_size() {
        let names = ["friction", "gravity", "constant"].map(str::to_owned);
        let found = |offset: f64, noise: f64| constants(&[joint(offset, false, noise)], &[1.0], &names[..2])[0];
        let Constant { value, share } = found(0.4, 0.1).unwrap();
        assert!((value - 0.4).abs() < 0.01 && share > 0.95, "{value} {share}");
        // A quarter of the mean squared residual: noise of a sine, 0.4 = 0.49 / sqrt(2) / sqrt(3) times its size.
        assert!(found(0.042, 0.1).is_some() && found(0.039, 0.1).is_none());
        // Small against the torque.
        assert!(found(0.01, 0.001).is_none());
        assert_eq!(constants(&[joint(0.4, true, 0.1)], &[1.0], &names)[0], None);
    }
}
