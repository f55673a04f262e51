//! Separable nonlinear least squares (variable projection, Golub and Pereyra 1973): linear parameters are solved for at
//! every step, Levenberg-Marquardt searches the few nonlinear ones. All stay within the bounds that make sense for the
//! effect; one that ends at a bound is held there, and the others are as certain as they are with it held.

use super::between_blocks::between_blocks;
use super::between_logs::{BetweenLogs, between_logs};
use super::constants::{Constant, constants};
use super::reversals;
use crate::effects::{Parameter, Placed, Role, Search, varies_by_factors};
use crate::error::Result;
use crate::identification::effect_model::{EffectModel, Place};
use crate::identification::levenberg_marquardt::{Bounds, LeastSquaresProblem, NormalEquations, Options, minimize};
use crate::identification::numerics::bounded::{self, Bound};
use crate::identification::regression::joint_regression::JointRegression;
use crate::identification::regression::least_squares::{Estimate, weighted_least_squares};
use crate::identification::regression::linear_problem::LinearProblem;
use nalgebra::{DMatrix, DVector};
use std::borrow::Cow;

/// Rounds of search between which the weights are taken anew from the residual.
const ROUNDS: usize = 3;

/// Starting points tried for a shape, spread over its bounds; together for all shapes of an effect with several.
const SHAPE_STARTS: usize = 24;
const JOINT_STARTS: usize = 200;

/// Share of the width between its bounds within which a parameter is at one.
const AT_BOUND: f64 = 1e-6;

/// Starting points tried for a departure, as shares of its typical size.
const DEPARTURE_STARTS: [f64; 7] = [0.0, 0.25, 1.0, 2.0, -0.25, -1.0, -2.0];

/// Step of differences, as a share of a parameter's typical size.
const DIFFERENCE: f64 = 1e-3;

/// Solutions of the linear problem after which gears and clipping sensors have converged.
const SETTLING: usize = 3;

/// What a fit with effects found.
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
/// let (logs, preparation) = (Logs { train: &[&log], test: &[] }, Preparation::usual(&log));
/// let fit = fit_effects(&Model::new(&robot), Trust::Structure, logs, preparation, Vec::new())?.fit;
///
/// // Coulomb friction of joint 2, of which the log was made with 2.5 N m.
/// let place = fit.names.iter().position(|name| name == "Fc2").expect("friction is a base parameter");
/// let (value, std) = (fit.estimate.beta[place], fit.estimate.std()[place]);
/// assert!((value - 2.5).abs() < 0.3 && std < 0.2);
/// assert_eq!((fit.arm_units[place], fit.at_bound[place]), ("N m", false));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, serde::Serialize)]
pub struct EffectFit {
    /// Linear parameters (arm, amplitudes), then nonlinear ones, with their joint covariance.
    pub estimate: Estimate,
    /// Names, in the same order.
    pub names: Vec<String>,
    /// Units of the arm's linear parameters, which come first.
    pub arm_units: Vec<&'static str>,
    /// Where each parameter that belongs to an effect is; None for the arm's.
    pub places: Vec<Option<Place>>,
    /// Whether each parameter is at a bound of what makes sense for it; it then has no standard deviation.
    pub at_bound: Vec<bool>,
    /// Whether each parameter is held at the description's value because the logs do not determine it; it then has no
    /// standard deviation.
    pub undetermined: Vec<bool>,
    /// Residual root mean square of each joint, N m.
    pub residual_rms: Vec<f64>,
    /// The constant that each joint's residual holds, where it matters.
    pub constants: Vec<Option<Constant>>,
    /// Joints whose rows near reversals show no more than the others.
    pub good_reversals: Vec<bool>,
    /// Each parameter in each of several training logs; None where it is held or they do not separate it, and of a single log.
    pub between_logs: Vec<Option<BetweenLogs>>,
}

/// Fits all parameters of a model with effects; the effects in `model` hold the result afterwards.
///
/// # Errors
/// If the logs do not separate the parameters or are too short, or the fit is stopped.
pub(crate) fn fit(model: &mut EffectModel) -> Result<EffectFit> {
    model.goes_on()?;
    let nonlinear = model.nonlinear();
    for &place in &nonlinear {
        let Parameter { lower, upper, .. } = parameter(model, place);
        let [value] = model.get(&[place])[..] else { continue };
        // A law that bends where the joint never is has no torque.
        if !(lower..=upper).contains(&value) {
            model.set(&[place], &[0.5 * (lower + upper)]);
        }
    }
    if model.placed().is_empty() {
        // Weights are found on the way to the standard deviations, without a second pass over long logs.
        return finish(model, &nonlinear, &vec![1.0; model.joints()]);
    }
    let solved = solve_linear(model, &vec![1.0; model.joints()])?;
    let mut sigma = sigmas(&solved);
    let mut rows = solved.regression.iter().map(JointRegression::rows).sum();
    drop(solved);
    if !nonlinear.is_empty() {
        choose_starts(model, &nonlinear, &sigma)?;
        for _ in 0..ROUNDS {
            model.goes_on()?;
            let start = model.get(&nonlinear);
            let bounds = bounds(model, &nonlinear);
            let mut problem = Projected { model, places: &nonlinear, sigma: &sigma, rows };
            let found = minimize(&mut problem, &start, &Options { bounds: Some(bounds), ..search() })?;
            model.set(&nonlinear, &found.parameters);
            let solved = solve_linear(model, &sigma)?;
            sigma = sigmas(&solved);
            rows = solved.regression.iter().map(JointRegression::rows).sum();
        }
    }
    finish(model, &nonlinear, &sigma)
}

/// Limits of the search: the models are smooth to about the step of their differences, not to rounding.
fn search() -> Options {
    Options { gradient_tolerance: 1e-7, step_tolerance: 1e-8, max_iterations: 60, ..Options::default() }
}

fn sigmas(solved: &Solved) -> Vec<f64> {
    let of = |joint: &JointRegression| match joint.rows() {
        0 => 1.0,
        _ => joint.residual_rms(&solved.linear).max(f64::MIN_POSITIVE),
    };
    solved.regression.iter().map(of).collect()
}

/// The linear regression at the present nonlinear parameters, with its solution.
struct Solved {
    regression: Vec<JointRegression>,
    linear: Vec<f64>,
    /// Linear parameters that the logs do not determine or that are at a bound, with their values.
    held: Vec<(usize, f64)>,
}

/// Solves for the linear parameters at the present nonlinear ones and stores them in the model.
fn solve_linear(model: &mut EffectModel, sigma: &[f64]) -> Result<Solved> {
    let names = model.linear_names();
    let amplitudes = model.amplitudes();
    let bounds = linear_bounds(model, &amplitudes);
    let mut turn = 0;
    loop {
        let regression = model.regression()?;
        model.settle_undetermined(&regression)?;
        let problem = LinearProblem::new(&regression, sigma, names.len());
        let torques: Vec<Vec<f64>> = regression.iter().map(|joint| joint.torque.clone()).collect();
        let (linear, held) =
            bounded::solve(problem.normal(), &problem.right(&torques), &bounds, model.undetermined(), &names)?;
        let before = model.get(&amplitudes);
        model.set_baseline(&linear);
        model.set(&amplitudes, &linear[model.baseline_len()..]);
        turn += 1;
        if turn == SETTLING || !model.settles() || (turn > 1 && before == model.get(&amplitudes)) {
            return Ok(Solved { regression, linear, held });
        }
    }
}

/// Bounds of amplitudes, and of the arm's own friction where effects could be played off against it: a power of speed or a
/// Stribeck rise less a negative friction of another law is any curve.
fn linear_bounds(model: &EffectModel, amplitudes: &[Place]) -> Vec<Bound> {
    let amplitude = |(k, &place): (usize, &Place)| {
        let Parameter { lower, upper, .. } = parameter(model, place);
        Bound { parameter: model.baseline_len() + k, lower, upper }
    };
    let frictions = if model.placed().is_empty() { Vec::new() } else { model.frictions() };
    let friction = |parameter| Bound { parameter, lower: 0.0, upper: f64::INFINITY };
    amplitudes.iter().enumerate().map(amplitude).chain(frictions.into_iter().map(friction)).collect()
}

/// Tries shapes and departures on a grid, all shapes of an effect together, and keeps the best of each. Departures are
/// absent until it is their turn.
fn choose_starts(model: &mut EffectModel, nonlinear: &[Place], sigma: &[f64]) -> Result<()> {
    for &place in nonlinear {
        let parameter = parameter(model, place);
        if parameter.role == Role::Departure {
            model.set(&[place], &[0.0f64.clamp(parameter.lower, parameter.upper)]);
        }
    }
    let shape = |place: Place| parameter(model, place).role == Role::Shape;
    let groups: Vec<Vec<Place>> =
        nonlinear.chunk_by(|&a, &b| a.0 == b.0 && shape(a) && shape(b)).map(<[Place]>::to_vec).collect();
    for group in groups {
        let starts = match group.len() {
            1 => SHAPE_STARTS,
            several => (JOINT_STARTS as f64).powf(1.0 / several as f64) as usize,
        };
        let grids: Vec<Vec<f64>> = group.iter().map(|&place| grid(&parameter(model, place), starts)).collect();
        // Each candidate starts from the same arm: what one of them made of it must not lead the next astray.
        let arm = model.baseline().to_vec();
        let mut best = (f64::INFINITY, model.get(&group));
        for candidate in combinations(&grids) {
            model.goes_on()?;
            model.set(&group, &candidate);
            model.set_baseline(&arm);
            // A shape at which the data do not separate the amplitudes is no start.
            let Ok(solved) = solve_linear(model, sigma) else { continue };
            let chi2 = weighted_sum(&solved, sigma);
            if chi2 < best.0 {
                best = (chi2, candidate);
            }
        }
        model.set(&group, &best.1);
        model.set_baseline(&arm);
        solve_linear(model, sigma)?;
    }
    Ok(())
}

/// One value out of every list, in all ways.
fn combinations(lists: &[Vec<f64>]) -> Vec<Vec<f64>> {
    lists.iter().fold(vec![Vec::new()], |all, list| {
        let longer = |one: &Vec<f64>| list.iter().map(|&value| [one.as_slice(), &[value]].concat()).collect::<Vec<_>>();
        all.iter().flat_map(longer).collect()
    })
}

/// Starting points: absence and sizes around the typical one for a departure; for a shape its whole range, evenly in its
/// logarithm where it is positive and wide.
fn grid(parameter: &Parameter, starts: usize) -> Vec<f64> {
    let (low, high) = (parameter.lower, parameter.upper.min(1e3 * parameter.typical.abs()));
    let at = |k: usize| k as f64 / (starts - 1) as f64;
    match parameter.role {
        Role::Departure => DEPARTURE_STARTS.iter().map(|share| (share * parameter.typical).clamp(low, high)).collect(),
        _ => (0..starts)
            .map(|k| match varies_by_factors(low, high) {
                true => low * (high / low).powf(at(k)),
                // The last is the bound itself, but for rounding.
                false => (low + (high - low) * at(k)).min(high),
            })
            .chain([parameter.typical.clamp(low, high)])
            .collect(),
    }
}

/// A parameter, between bounds that the logs give it where it is a position.
fn parameter(model: &EffectModel, (effect, k): Place) -> Parameter {
    let Placed { effect, joint, .. } = &model.placed()[effect];
    let own = effect.parameters()[k].clone();
    match (effect.search(k), model.bends_between(*joint)) {
        (Search::Position, Some([lower, upper])) => Parameter { lower, upper, ..own },
        _ => own,
    }
}

fn bounds(model: &EffectModel, places: &[Place]) -> Bounds {
    let parameters: Vec<Parameter> = places.iter().map(|&place| parameter(model, place)).collect();
    Bounds { lower: parameters.iter().map(|p| p.lower).collect(), upper: parameters.iter().map(|p| p.upper).collect() }
}

fn weighted_sum(solved: &Solved, sigma: &[f64]) -> f64 {
    let of =
        |(joint, s): (&JointRegression, &f64)| joint.rows() as f64 * (joint.residual_rms(&solved.linear) / s).powi(2);
    solved.regression.iter().zip(sigma).filter(|(joint, _)| joint.rows() > 0).map(of).sum()
}

/// The weighted sum of squares as a function of the nonlinear parameters alone.
struct Projected<'m, 'a> {
    model: &'m mut EffectModel<'a>,
    places: &'m [Place],
    sigma: &'m [f64],
    /// Valid rows at the start of the search.
    rows: usize,
}

impl LeastSquaresProblem for Projected<'_, '_> {
    fn parameters(&self) -> usize {
        self.places.len()
    }

    fn measurements(&self) -> usize {
        self.rows
    }

    /// Normal equations with the derivative columns freed of what the linear parameters can do (Kaufman 1975).
    fn normal_equations(&mut self, p: &[f64]) -> Result<NormalEquations> {
        self.model.set(self.places, p);
        let solved = solve_linear(self.model, self.sigma)?;
        let derivatives = derivatives(self.model, self.places, &solved)?;
        let Solved { regression, linear, held } = &solved;
        let residuals: Vec<Vec<f64>> = regression.iter().map(|joint| joint.residual(linear)).collect();
        // What is held at a bound cannot take part.
        let (free, names) = without(regression, held, &self.model.linear_names());
        let problem = LinearProblem::new(&free, self.sigma, names.len());
        let inner = |a: &[Vec<f64>], b: &[Vec<f64>]| -> f64 {
            let joints = regression.iter().zip(self.sigma).zip(a.iter().zip(b));
            joints.map(|((joint, s), (x, y))| joint.dot(x, y) / (s * s)).sum()
        };
        let n = self.places.len();
        let cross: Vec<DVector<f64>> = derivatives.iter().map(|d| problem.right(d)).collect();
        let solve = |c: &DVector<f64>| problem.solve(c, &names);
        let freed: Vec<DVector<f64>> = cross.iter().map(solve).collect::<Result<_>>()?;
        let jtwj = DMatrix::from_fn(n, n, |r, c| inner(&derivatives[r], &derivatives[c]) - cross[r].dot(&freed[c]));
        let jtwr = DVector::from_fn(n, |r, _| inner(&derivatives[r], &residuals));
        Ok(NormalEquations { jtwj, jtwr, chi2: weighted_sum(&solved, self.sigma) })
    }

    fn chi2(&mut self, p: &[f64]) -> Result<f64> {
        self.model.set(self.places, p);
        match solve_linear(self.model, self.sigma) {
            Ok(solved) => Ok(weighted_sum(&solved, self.sigma)),
            Err(_) => Ok(f64::INFINITY),
        }
    }
}

/// A regression without the parameters that are held, whose torque is taken off, and the names of the others. Nothing is
/// copied where none is held.
fn without<'a>(
    regression: &'a [JointRegression],
    held: &[(usize, f64)],
    names: &[String],
) -> (Cow<'a, [JointRegression]>, Vec<String>) {
    if held.is_empty() {
        return (Cow::Borrowed(regression), names.to_vec());
    }
    let kept = |k: &usize| held.iter().all(|(own, _)| own != k);
    let places: Vec<usize> = (0..names.len()).filter(kept).collect();
    let joints = regression.iter().map(|joint| joint.without(held, &places)).collect();
    (Cow::Owned(joints), places.iter().map(|&k| names[k].clone()).collect())
}

/// Derivatives of the predicted torque with respect to the nonlinear parameters, `[parameter][joint][row]`, by differences.
fn derivatives(model: &mut EffectModel, places: &[Place], solved: &Solved) -> Result<Vec<Vec<Vec<f64>>>> {
    let Solved { regression, linear, .. } = solved;
    let here: Vec<Vec<f64>> = regression.iter().map(|joint| joint.residual(linear)).collect();
    let mut columns = Vec::with_capacity(places.len());
    for &place in places {
        let Parameter { typical, upper, .. } = parameter(model, place);
        let value = model.get(&[place])[0];
        let size = DIFFERENCE * typical.abs().max(value.abs());
        let step = if value + size <= upper { size } else { -size };
        model.set(&[place], &[value + step]);
        let moved = model.regression()?;
        model.set(&[place], &[value]);
        let column = moved
            .iter()
            .zip(&here)
            .map(|(joint, before)| {
                joint.residual(linear).iter().zip(before).map(|(after, before)| (before - after) / step).collect()
            })
            .collect();
        columns.push(column);
    }
    Ok(columns)
}

/// Standard deviations of everything together: the nonlinear parameters enter as one more column each. Those at a bound are
/// known.
fn finish(model: &mut EffectModel, nonlinear: &[Place], sigma: &[f64]) -> Result<EffectFit> {
    let solved = solve_linear(model, sigma)?;
    let derivatives = derivatives(model, nonlinear, &solved)?;
    let Solved { mut regression, linear, mut held } = solved;
    let values = model.get(nonlinear);
    for (k, (columns, value)) in derivatives.iter().zip(&values).enumerate() {
        for (joint, column) in regression.iter_mut().zip(columns) {
            if column.iter().any(|&v| v != 0.0) {
                joint.append(linear.len() + k, column, *value);
            }
        }
        let Parameter { lower, upper, .. } = parameter(model, nonlinear[k]);
        let margin = AT_BOUND * (upper - lower).min(value.abs().max(1.0));
        if value - lower <= margin || upper - value <= margin {
            held.push((linear.len() + k, *value));
        }
    }
    let mut names = model.linear_names();
    names.extend(nonlinear.iter().map(|&place| model.parameter_name(place)));
    let mut places: Vec<Option<Place>> = vec![None; model.baseline_len()];
    places.extend(model.amplitudes().into_iter().chain(nonlinear.iter().copied()).map(Some));
    let (free, free_names) = without(&regression, &held, &names);
    let estimate = weighted_least_squares(&free, &free_names)?;
    let times = model.row_times()?;
    let scatter = between_blocks(&free, [&estimate.beta, &estimate.sigma], &times);
    let estimate = estimate.at_least(&scatter.unwrap_or_default());
    let mut each = between_logs(&free, [&estimate.beta, &estimate.sigma], &times, &free_names)?.into_iter();
    let estimate = estimate.with_held(&held, names.len());
    let residual_rms = regression.iter().map(|joint| joint.residual_rms(&estimate.beta)).collect();
    let good_reversals = reversals::kept(&regression, &model.rows_at_reversals(), &estimate.beta);
    let constants = constants(&free, &estimate.sigma, &free_names);
    let among = |all: &[(usize, f64)], k: usize| all.iter().any(|(own, _)| *own == k);
    let between_logs = (0..names.len()).map(|k| if among(&held, k) { None } else { each.next().flatten() }).collect();
    let undetermined: Vec<bool> = (0..names.len()).map(|k| among(model.undetermined(), k)).collect();
    let at_bound = (0..names.len()).map(|k| among(&held, k) && !undetermined[k]).collect();
    let arm_units = model.baseline_units();
    Ok(EffectFit {
        arm_units,
        estimate,
        names,
        places,
        at_bound,
        undetermined,
        residual_rms,
        constants,
        good_reversals,
        between_logs,
    })
}
