//! The paper's 78-parameter model, fitted to a log by (11)-(12).

use super::equations::structure::{State, rank_structure};
use super::equations::tables::joint_angles;
use super::equations::{AbsoluteAngles, JOINTS, PARAMETER_COUNT, Variant};
use super::procedure::{Procedure, Stage};
use super::quality::{Quality, Seen};
use crate::channels::Channels;
use crate::error::{Error, Result};
use crate::identification::least_squares::{REWEIGHTINGS, residual_sigma};
use crate::identification::levenberg_marquardt::{Fit, Options, Scaling, minimize};
use crate::identification::linear_problem::LinearProblem;
use crate::internal::identification::{JointRegression, LinearModel};
use crate::random;
use crate::study::testbed;
use nalgebra::{DMatrix, DVector};
use rand::RngExt;

/// Every n-th sample of a log decides on the rank: neighbours are nearly the same.
const RANK_STRIDE: usize = 10;

/// Values of lambda at which the search is started again, in units of the largest entry of diag(J'WJ).
const START_LAMBDAS: [f64; 3] = [1e-6, 1.0, 1e2];

/// The search as (12) has it: lambda times the identity, Gavin's damping update.
pub(crate) fn options(initial_lambda: f64) -> Options {
    Options { scaling: Scaling::Identity, initial_lambda, ..Options::default() }
}

/// One variant fitted to one view of the log.
#[derive(Debug, Clone)]
pub(crate) struct PlanarFit {
    /// Raw or smoothed.
    pub signals: testbed::Variant,
    /// Standard deviation of each joint's residual that W was made of, N m.
    pub sigma: Vec<f64>,
    /// The last fit, with the final weights. Started at zero.
    pub fit: Fit,
    /// Share of X (as a length) that no torque of this log shows. With (12) every step from zero stays where the
    /// torques can see it, so this is rounding: the solution is the shortest X that fits best.
    pub unseen_share: f64,
    /// Residuals and errors of the torque.
    pub quality: Quality,
}

/// Fits `variant` to the training motion and judges it on both. The weights start equal and follow each joint's
/// residual, as in the weighted least squares of the spatial model. `rank` is that of the variant on the motion.
///
/// # Errors
/// A joint with fewer usable samples than parameters; errors of the search.
pub(crate) fn fit(variant: Variant, rank: usize, seen: &Seen, procedure: &mut Procedure) -> Result<PlanarFit> {
    let (regression, sigma, fit) = solve(&variant, seen, procedure)?;
    let quality = procedure.time(Stage::Validation, || Quality::new(&variant, &fit.parameters, seen, &regression))?;
    let unseen_share = unseen_share(&regression, &sigma, rank, &fit.parameters);
    Ok(PlanarFit { signals: seen.signals, sigma, fit, unseen_share, quality })
}

/// The other reading of the equations: [`Variant::EulerLagrange`], the one with the physics of a planar chain, in
/// [`AbsoluteAngles`].
///
/// # Errors
/// Those of [`fit`].
pub(crate) fn in_absolute_angles(seen: &Seen, procedure: &mut Procedure) -> Result<Quality> {
    let model = AbsoluteAngles(Variant::EulerLagrange);
    let (regression, _, fit) = solve(&model, seen, procedure)?;
    procedure.time(Stage::Validation, || Quality::new(&model, &fit.parameters, seen, &regression))
}

/// Rows of the training motion, final standard deviations of the joints, and the fit with them.
fn solve(
    model: &impl LinearModel,
    seen: &Seen,
    procedure: &mut Procedure,
) -> Result<(Vec<JointRegression>, Vec<f64>, Fit)> {
    let regression = procedure.time(Stage::Regression, || seen.training.1.regression(model))?;
    check_rows(&regression)?;
    let mut sigma = vec![1.0; JOINTS];
    let solve = |sigma: &[f64]| {
        let mut problem = LinearProblem::new(&regression, sigma, PARAMETER_COUNT);
        minimize(&mut problem, &[0.0; PARAMETER_COUNT], &options(Options::default().initial_lambda))
    };
    let fit = procedure.time(Stage::LevenbergMarquardt, || -> Result<Fit> {
        for _ in 0..REWEIGHTINGS {
            sigma = residual_sigma(&regression, &solve(&sigma)?.parameters);
        }
        solve(&sigma)
    })?;
    Ok((regression, sigma, fit))
}

fn check_rows(regression: &[JointRegression]) -> Result<()> {
    match regression.iter().position(|joint| joint.rows() < 2 * joint.parameters.len()) {
        Some(joint) => {
            let problem = format!(
                "{} usable samples for {} of the paper's parameters; use a longer motion",
                regression[joint].rows(),
                regression[joint].parameters.len()
            );
            Err(Error::request(format!("joint {}", joint + 1), problem))
        }
        None => Ok(()),
    }
}

/// Rank of a variant's regressor along the training motion.
///
/// # Errors
/// A motion of fewer than 130 samples.
pub(crate) fn rank_on_motion(variant: Variant, seen: &Seen) -> Result<usize> {
    let motion = &seen.training.1.motion;
    let at = |signals: &Channels, sample: usize| std::array::from_fn(|joint| signals.channel(joint)[sample]);
    let states: Vec<State> = (0..motion.samples())
        .step_by(RANK_STRIDE)
        .map(|sample| [joint_angles(at(&motion.q, sample)), at(&motion.qd, sample), at(&motion.qdd, sample)])
        .collect();
    Ok(rank_structure(variant, &states)?.rank)
}

/// Length of the part of `x` in the null space of the weighted regressor, over the length of `x`.
fn unseen_share(regression: &[JointRegression], sigma: &[f64], rank: usize, x: &[f64]) -> f64 {
    let rows: usize = regression.iter().map(JointRegression::rows).sum();
    let mut jacobian = DMatrix::zeros(rows, x.len());
    let mut first = 0;
    for (joint, s) in regression.iter().zip(sigma) {
        for (&parameter, column) in joint.parameters.iter().zip(joint.columns.iter()) {
            let kept = column.iter().zip(&joint.valid).filter(|(_, ok)| **ok);
            for (row, (value, _)) in kept.enumerate() {
                jacobian[(first + row, parameter)] = value / s;
            }
        }
        first += joint.rows();
    }
    // The right singular vectors of J are those of its triangular factor.
    let svd = jacobian.qr().r().svd(false, true);
    let directions = svd.v_t.expect("asked for");
    let mut order: Vec<usize> = (0..svd.singular_values.len()).collect();
    order.sort_by(|&a, &b| svd.singular_values[b].total_cmp(&svd.singular_values[a]));
    let x = DVector::from_column_slice(x);
    let unseen: f64 = order[rank..].iter().map(|&i| directions.row(i).transpose().dot(&x).powi(2)).sum();
    unseen.sqrt() / x.norm()
}

/// Another way to the minimum, compared with the fit from zero.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub(crate) struct OtherStart {
    /// lambda at the start, in units of the largest entry of diag(J'WJ).
    pub initial_lambda: f64,
    /// "zero", or how X was drawn.
    pub start: &'static str,
    /// Trial steps.
    pub iterations: usize,
    /// Why the search ended.
    pub stop: String,
    /// chi2 relative to that of the reference fit, less 1.
    pub chi2_change: f64,
    /// Largest change of an X.
    pub largest_x_change: f64,
    /// Largest change of a predicted torque of any joint at any sample of the training motion, N m.
    pub largest_torque_change_nm: f64,
}

/// Fits again from other values of lambda and from a random start.
///
/// # Errors
/// Those of the search.
pub(crate) fn other_starts(
    variant: Variant,
    reference: &PlanarFit,
    seen: &Seen,
    seed: u64,
    procedure: &mut Procedure,
) -> Result<Vec<OtherStart>> {
    let regression = procedure.time(Stage::Regression, || seen.training.1.regression(&variant))?;
    let expected = seen.training.1.predict(&variant, &reference.fit.parameters);
    let mut source = random::stream(seed, "start of the 78-parameter fit", 0);
    let drawn: Vec<f64> = (0..PARAMETER_COUNT).map(|_| source.random_range(-100.0..100.0)).collect();
    let zero = vec![0.0; PARAMETER_COUNT];
    let starts = START_LAMBDAS.map(|lambda| (lambda, "zero", &zero));
    starts
        .into_iter()
        .chain([(START_LAMBDAS[1], "every X drawn between -100 and 100", &drawn)])
        .map(|(initial_lambda, start, x)| {
            let fit = procedure.time(Stage::LevenbergMarquardt, || {
                let mut problem = LinearProblem::new(&regression, &reference.sigma, PARAMETER_COUNT);
                minimize(&mut problem, x, &options(initial_lambda))
            })?;
            let predicted = seen.training.1.predict(&variant, &fit.parameters);
            Ok(OtherStart {
                initial_lambda,
                start,
                iterations: fit.iterations,
                stop: format!("{:?}", fit.stop).to_lowercase(),
                chi2_change: fit.chi2() / reference.fit.chi2() - 1.0,
                largest_x_change: largest_difference(&fit.parameters, &reference.fit.parameters),
                largest_torque_change_nm: largest_difference(predicted.as_slice(), expected.as_slice()),
            })
        })
        .collect()
}

pub(super) fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |most: f64, (x, y)| most.max((x - y).abs()))
}
