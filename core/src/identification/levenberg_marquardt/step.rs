//! One damped step inside the box, and the measures by which it is judged.

use super::damping::Lambda;
use super::problem::{Bounds, NormalEquations};
use crate::error::{Error, Result};
use nalgebra::{Cholesky, DMatrix, DVector};

/// A candidate for the next point.
pub(super) struct Trial {
    /// The point, inside the bounds.
    pub p: Vec<f64>,
    /// The step that leads to it.
    pub h: DVector<f64>,
    /// What chi2 would fall by if the model were linear: 2 g'h - h'J'WJh.
    pub predicted: f64,
}

/// The bounds of `n` parameters, infinite where none are given.
///
/// # Errors
/// A length that differs from `n`, an empty interval, a start outside or not finite.
pub(super) fn checked_bounds(n: usize, p0: &[f64], bounds: Option<&Bounds>) -> Result<Bounds> {
    let wrong = |what: &str, length: usize| {
        Err(Error::request("Levenberg-Marquardt", format!("{length} {what} for {n} parameters; give {n}")))
    };
    if p0.len() != n {
        return wrong("start values", p0.len());
    }
    let bounds = match bounds {
        Some(bounds) => bounds.clone(),
        None => Bounds { lower: vec![f64::NEG_INFINITY; n], upper: vec![f64::INFINITY; n] },
    };
    if bounds.lower.len() != n {
        return wrong("lower bounds", bounds.lower.len());
    }
    if bounds.upper.len() != n {
        return wrong("upper bounds", bounds.upper.len());
    }
    for (k, &p) in p0.iter().enumerate() {
        let (lower, upper) = (bounds.lower[k], bounds.upper[k]);
        if !(p.is_finite() && lower <= p && p <= upper) {
            return Err(Error::request(
                format!("Levenberg-Marquardt, parameter {k}"),
                format!("the start {p} is not a number between its bounds {lower} and {upper}; choose one inside"),
            ));
        }
    }
    Ok(bounds)
}

/// The damped step from `p`: the minimiser of the damped quadratic model inside the box, by an active-set search
/// (Stark and Parker, "Bounded-variable least-squares", Computational Statistics 10, 1995). Without walls nearby it
/// is one linear solve.
pub(super) fn damped(normal: &NormalEquations, lambda: &Lambda, p: &[f64], bounds: &Bounds) -> Trial {
    let n = p.len();
    let mut damped = normal.jtwj.clone();
    let extra = lambda.diagonal(&normal.jtwj.diagonal());
    for k in 0..n {
        damped[(k, k)] += extra[k];
    }
    let wall = |k: usize, toward: f64| if toward < 0.0 { bounds.lower[k] - p[k] } else { bounds.upper[k] - p[k] };
    let mut h = DVector::zeros(n);
    let mut free: Vec<bool> = (0..n).map(|k| !held(k, normal.jtwr[k], p, bounds)).collect();
    // Every pass lowers the model, so no set of walls comes back; the limit only guards against rounding.
    for _ in 0..10 * (n + 1) {
        let descent = &normal.jtwr - &damped * &h;
        let index: Vec<usize> = (0..n).filter(|&k| free[k]).collect();
        let matrix = DMatrix::from_fn(index.len(), index.len(), |i, j| damped[(index[i], index[j])]);
        let change = solve(matrix, DVector::from_fn(index.len(), |i, _| descent[index[i]]));
        let reach = |i: usize| {
            let k = index[i];
            let room = wall(k, change[i]) - h[k];
            if change[i].abs() > room.abs() { room / change[i] } else { 1.0 }
        };
        let nearest = (0..index.len()).min_by(|&a, &b| reach(a).total_cmp(&reach(b))).filter(|&i| reach(i) < 1.0);
        let share = nearest.map_or(1.0, reach);
        let blocked = nearest.map(|i| (index[i], wall(index[i], change[i])));
        for (i, &k) in index.iter().enumerate() {
            h[k] += share * change[i];
        }
        if let Some((k, at)) = blocked {
            h[k] = at;
            free[k] = false;
            continue;
        }
        let descent = &normal.jtwr - &damped * &h;
        let at: Vec<f64> = (0..n).map(|k| p[k] + h[k]).collect();
        let inward = |k: &usize| !free[*k] && !held(*k, descent[*k], &at, bounds);
        let pull = |k: usize| descent[k].abs() / damped[(k, k)].sqrt();
        match (0..n).filter(inward).max_by(|&a, &b| pull(a).total_cmp(&pull(b))) {
            Some(k) => free[k] = true,
            None => break,
        }
    }
    along(normal, p, &h, bounds)
}

/// The trial point at `p` + `h`, pulled into the box.
pub(super) fn along(normal: &NormalEquations, p: &[f64], h: &DVector<f64>, bounds: &Bounds) -> Trial {
    let target: Vec<f64> = (0..p.len()).map(|k| (p[k] + h[k]).clamp(bounds.lower[k], bounds.upper[k])).collect();
    // The step as asked for, not the rounded difference, except where a wall shortens it.
    let h = DVector::from_fn(p.len(), |k, _| if target[k] == p[k] + h[k] { h[k] } else { target[k] - p[k] });
    let predicted = 2.0 * h.dot(&normal.jtwr) - h.dot(&(&normal.jtwj * &h));
    Trial { p: target, h, predicted }
}

/// Largest cosine between the residual and a column of J, over the parameters that are free to follow it.
pub(super) fn relative_gradient(normal: &NormalEquations, p: &[f64], bounds: &Bounds) -> f64 {
    (0..p.len())
        .filter(|&k| !held(k, normal.jtwr[k], p, bounds))
        .map(|k| {
            let scale = (normal.jtwj[(k, k)] * normal.chi2).sqrt();
            if scale > 0.0 { normal.jtwr[k].abs() / scale } else { 0.0 }
        })
        .fold(0.0, f64::max)
}

/// Largest change of a parameter, relative to its value or to what would change the fit by as much as the residual.
pub(super) fn relative_size(normal: &NormalEquations, p: &[f64], h: &DVector<f64>) -> f64 {
    (0..p.len())
        .filter(|&k| h[k] != 0.0)
        .map(|k| h[k].abs() / p[k].abs().max((normal.chi2 / normal.jtwj[(k, k)]).sqrt()))
        .fold(0.0, f64::max)
}

/// Whether parameter `k` stands on a wall that the descent direction points through.
fn held(k: usize, descent: f64, p: &[f64], bounds: &Bounds) -> bool {
    (p[k] <= bounds.lower[k] && descent <= 0.0) || (p[k] >= bounds.upper[k] && descent >= 0.0)
}

/// Solves a symmetric positive definite system after scaling it to a unit diagonal. Where rounding has made it
/// indefinite, the least that corrects it is added to the diagonal; a system beyond that (overflow) gives no step.
fn solve(a: DMatrix<f64>, b: DVector<f64>) -> DVector<f64> {
    let n = b.len();
    let scale = a.diagonal().map(|d| 1.0 / d.sqrt());
    let unit = DMatrix::from_fn(n, n, |i, j| a[(i, j)] * scale[i] * scale[j]);
    let right = b.component_mul(&scale);
    let mut shift = 0.0;
    loop {
        let shifted = DMatrix::from_fn(n, n, |i, j| unit[(i, j)] + if i == j { shift } else { 0.0 });
        if let Some(factor) = Cholesky::new(shifted) {
            return factor.solve(&right).component_mul(&scale);
        }
        if !shift.is_finite() {
            return DVector::zeros(n);
        }
        shift = f64::max(4.0 * n as f64 * f64::EPSILON, 10.0 * shift);
    }
}
