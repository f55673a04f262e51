//! Separable nonlinear least squares (variable projection, Golub and Pereyra 1973): linear parameters are solved for at
//! every step, Levenberg-Marquardt searches the few nonlinear ones.

use super::effect_model::{EffectModel, Place};
use super::least_squares::{Estimate, JointRegression, weighted_least_squares, weighted_solution};
use super::levenberg_marquardt::{Bounds, LeastSquaresProblem, NormalEquations, Options, minimize};
use super::linear_problem::LinearProblem;
use crate::effects::{Parameter, Role};
use crate::error::Result;
use nalgebra::{DMatrix, DVector};

/// Rounds of search between which the weights are taken anew from the residual.
const ROUNDS: usize = 3;

/// Starting points tried for a shape, spread over its bounds.
const SHAPE_STARTS: usize = 24;

/// Starting points tried for a departure, as shares of its typical size.
const DEPARTURE_STARTS: [f64; 7] = [0.0, 0.25, 1.0, 2.0, -0.25, -1.0, -2.0];

/// Step of differences, as a share of a parameter's typical size.
const DIFFERENCE: f64 = 1e-3;

/// Solutions of the linear problem in which gears and clipping sensors settle.
const SETTLING: usize = 3;

/// What a fit with effects found.
#[derive(Debug, Clone)]
pub struct EffectFit {
    /// Linear parameters (arm, amplitudes), then nonlinear ones, with their joint covariance.
    pub estimate: Estimate,
    /// Names, in the same order.
    pub names: Vec<String>,
    /// Units of the arm's linear parameters, which come first.
    pub arm_units: Vec<&'static str>,
    /// Where each parameter that belongs to an effect is; None for the arm's.
    pub places: Vec<Option<Place>>,
    /// Residual root mean square of each joint, N m.
    pub residual_rms: Vec<f64>,
}

/// Fits all parameters of a model with effects; the effects in `model` hold the result afterwards.
///
/// # Errors
/// If the logs cannot tell the parameters apart or are too short.
pub fn fit(model: &mut EffectModel) -> Result<EffectFit> {
    let nonlinear = model.nonlinear();
    let (regression, linear) = solve_linear(model, &vec![1.0; model.joints()])?;
    let mut sigma = sigmas(&regression, &linear);
    let mut rows = regression.iter().map(JointRegression::rows).sum();
    if !nonlinear.is_empty() {
        choose_starts(model, &nonlinear, &sigma)?;
        for _ in 0..ROUNDS {
            let start = model.get(&nonlinear);
            let bounds = bounds(model, &nonlinear);
            let mut problem = Projected { model, places: &nonlinear, sigma: &sigma, rows };
            let found = minimize(&mut problem, &start, &Options { bounds: Some(bounds), ..search() })?;
            model.set(&nonlinear, &found.parameters);
            let (regression, linear) = solve_linear(model, &sigma)?;
            sigma = sigmas(&regression, &linear);
            rows = regression.iter().map(JointRegression::rows).sum();
        }
    }
    finish(model, &nonlinear, &sigma)
}

/// Limits of the search: the models are smooth to about the step of their differences, not to rounding.
fn search() -> Options {
    Options { gradient_tolerance: 1e-7, step_tolerance: 1e-8, max_iterations: 60, ..Options::default() }
}

fn sigmas(regression: &[JointRegression], linear: &[f64]) -> Vec<f64> {
    regression.iter().map(|joint| joint.residual_rms(linear).max(f64::MIN_POSITIVE)).collect()
}

/// Solves for the linear parameters at the present nonlinear ones and stores them in the model.
fn solve_linear(model: &mut EffectModel, sigma: &[f64]) -> Result<(Vec<JointRegression>, Vec<f64>)> {
    let names = model.linear_names();
    let amplitudes = model.amplitudes();
    let mut turn = 0;
    loop {
        let regression = model.regression()?;
        let linear = weighted_solution(&regression, sigma, &names)?;
        let before = model.get(&amplitudes);
        model.set_baseline(&linear);
        model.set(&amplitudes, &linear[model.baseline_len()..]);
        turn += 1;
        if turn == SETTLING || !model.settles() || (turn > 1 && before == model.get(&amplitudes)) {
            return Ok((regression, linear));
        }
    }
}

/// Tries shapes and departures one after the other on a grid and keeps the best of each. Departures are absent until it
/// is their turn.
fn choose_starts(model: &mut EffectModel, nonlinear: &[Place], sigma: &[f64]) -> Result<()> {
    for &place in nonlinear {
        let parameter = parameter(model, place);
        if parameter.role == Role::Departure {
            model.set(&[place], &[0.0f64.clamp(parameter.lower, parameter.upper)]);
        }
    }
    for &place in nonlinear {
        let parameter = parameter(model, place);
        // Each candidate starts from the same arm: what one of them made of it must not lead the next astray.
        let arm = model.baseline().to_vec();
        let mut best = (f64::INFINITY, model.get(&[place])[0]);
        for candidate in grid(&parameter) {
            model.set(&[place], &[candidate]);
            model.set_baseline(&arm);
            // A shape at which the data cannot tell the amplitudes apart is no start.
            let Ok((regression, linear)) = solve_linear(model, sigma) else { continue };
            let chi2 = weighted_sum(&regression, &linear, sigma);
            if chi2 < best.0 {
                best = (chi2, candidate);
            }
        }
        model.set(&[place], &[best.1]);
        model.set_baseline(&arm);
        solve_linear(model, sigma)?;
    }
    Ok(())
}

/// Starting points: absence and sizes around the typical one for a departure; for a shape its whole range, evenly in its
/// logarithm where it is positive and wide.
fn grid(parameter: &Parameter) -> Vec<f64> {
    let (low, high) = (parameter.lower, parameter.upper.min(1e3 * parameter.typical.abs()));
    let at = |k: usize| k as f64 / (SHAPE_STARTS - 1) as f64;
    match parameter.role {
        Role::Departure => DEPARTURE_STARTS.iter().map(|share| (share * parameter.typical).clamp(low, high)).collect(),
        _ => (0..SHAPE_STARTS)
            .map(|k| match low > 0.0 && high / low > 10.0 {
                true => low * (high / low).powf(at(k)),
                false => low + (high - low) * at(k),
            })
            .chain([parameter.typical])
            .collect(),
    }
}

fn parameter(model: &EffectModel, (effect, k): Place) -> Parameter {
    model.placed()[effect].effect.parameters()[k].clone()
}

fn bounds(model: &EffectModel, places: &[Place]) -> Bounds {
    let parameters: Vec<Parameter> = places.iter().map(|&place| parameter(model, place)).collect();
    Bounds { lower: parameters.iter().map(|p| p.lower).collect(), upper: parameters.iter().map(|p| p.upper).collect() }
}

fn weighted_sum(regression: &[JointRegression], linear: &[f64], sigma: &[f64]) -> f64 {
    regression.iter().zip(sigma).map(|(joint, s)| joint.rows() as f64 * (joint.residual_rms(linear) / s).powi(2)).sum()
}

/// The weighted sum of squares as a function of the nonlinear parameters alone.
struct Projected<'m, 'a> {
    model: &'m mut EffectModel<'a>,
    places: &'m [Place],
    sigma: &'m [f64],
    /// Rows that count at the start of the search.
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
        let (regression, linear) = solve_linear(self.model, self.sigma)?;
        let derivatives = derivatives(self.model, self.places, &regression, &linear)?;
        let problem = LinearProblem::new(&regression, self.sigma, linear.len());
        let residuals: Vec<Vec<f64>> = regression.iter().map(|joint| joint.residual(&linear)).collect();
        let inner = |a: &[Vec<f64>], b: &[Vec<f64>]| -> f64 {
            let joints = regression.iter().zip(self.sigma).zip(a.iter().zip(b));
            joints.map(|((joint, s), (x, y))| joint.dot(x, y) / (s * s)).sum()
        };
        let n = self.places.len();
        let cross: Vec<DVector<f64>> = derivatives.iter().map(|d| problem.right(d)).collect();
        let solved: Vec<DVector<f64>> =
            cross.iter().map(|c| problem.solve(c, &self.model.linear_names())).collect::<Result<_>>()?;
        let jtwj = DMatrix::from_fn(n, n, |r, c| inner(&derivatives[r], &derivatives[c]) - cross[r].dot(&solved[c]));
        let jtwr = DVector::from_fn(n, |r, _| inner(&derivatives[r], &residuals));
        Ok(NormalEquations { jtwj, jtwr, chi2: weighted_sum(&regression, &linear, self.sigma) })
    }

    fn chi2(&mut self, p: &[f64]) -> Result<f64> {
        self.model.set(self.places, p);
        match solve_linear(self.model, self.sigma) {
            Ok((regression, linear)) => Ok(weighted_sum(&regression, &linear, self.sigma)),
            Err(_) => Ok(f64::INFINITY),
        }
    }
}

/// Derivatives of the predicted torque with respect to the nonlinear parameters, `[parameter][joint][row]`, by differences.
fn derivatives(
    model: &mut EffectModel,
    places: &[Place],
    regression: &[JointRegression],
    linear: &[f64],
) -> Result<Vec<Vec<Vec<f64>>>> {
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

/// Standard deviations of everything together: the nonlinear parameters enter as one more column each.
fn finish(model: &mut EffectModel, nonlinear: &[Place], sigma: &[f64]) -> Result<EffectFit> {
    let (mut regression, linear) = solve_linear(model, sigma)?;
    let derivatives = derivatives(model, nonlinear, &regression, &linear)?;
    let values = model.get(nonlinear);
    for (k, (columns, value)) in derivatives.iter().zip(&values).enumerate() {
        for (joint, column) in regression.iter_mut().zip(columns) {
            if column.iter().any(|&v| v != 0.0) {
                joint.append(linear.len() + k, column, *value);
            }
        }
    }
    let mut names = model.linear_names();
    names.extend(nonlinear.iter().map(|&place| model.parameter_name(place)));
    let mut places: Vec<Option<Place>> = vec![None; model.baseline_len()];
    places.extend(model.amplitudes().into_iter().chain(nonlinear.iter().copied()).map(Some));
    let estimate = weighted_least_squares(&regression, &names)?;
    let residual_rms = regression.iter().map(|joint| joint.residual_rms(&estimate.beta)).collect();
    Ok(EffectFit { arm_units: model.baseline_units(), estimate, names, places, residual_rms })
}
