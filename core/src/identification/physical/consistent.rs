//! Physically consistent standard parameters: every link a body that can exist, as close to the fitted base parameters as
//! that allows.
//!
//! A body can exist when its pseudo-inertia [[tr(I)/2 - I, h], [h', m]] is positive definite (Wensing, Kim and Slotine
//! 2018); friction and rotor inertia must be positive. With the weighted normal matrix H of the fit, the cost
//! 1/2 (beta - fitted)' H (beta - fitted) under these conditions is a semidefinite program (Sousa and Cortesao 2014). It
//! is solved by a primal barrier method (Boyd and Vandenberghe 2004, chapter 11) on the fitted parameters in units of
//! their uncertainty and the standard parameters that torque does not see.

use super::plausible::Plausible;
use super::pseudo_inertia::{pseudo_inertia, unit_pseudo_inertia};
use crate::error::{Error, Result};
use crate::identification::effect_model::{EffectModel, Preparation, Trust};
use crate::identification::fit::{Fitted, Logs};
use crate::identification::model::Model;
use crate::identification::model::standard::{ROTOR, STANDARD};
use crate::identification::numerics::scaled_normal::unit_cholesky;
use crate::identification::regression::joint_regression::JointRegression;
use crate::identification::regression::linear_problem::LinearProblem;
use crate::robot::{PARAMETERS, Robot};
use nalgebra::{DMatrix, DVector, Matrix4};

/// Weight of the distance from the URDF's parameters, in their own size. It settles what torque does not see; where
/// torque sees anything, it counts for less than a thousandth of a standard deviation.
const CLOSENESS: f64 = 1e-3;

/// Weight of the barrier at the end: the cost is within this times the number of conditions of the best.
const BARRIER: f64 = 1e-5;

/// Factor from one barrier weight to the next.
const DECREASE: f64 = 0.2;

/// Newton steps for one barrier weight.
const STEPS: usize = 60;

/// Conditions per joint that the barrier guards: four eigenvalues, rotor inertia, two kinds of friction.
const CONDITIONS: usize = 7;

/// Consistent parameters and what consistency costs.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::identification::effect_model::{Preparation, Trust};
/// use tauscope::identification::fit::{Logs, fit_effects};
/// use tauscope::identification::model::Model;
/// use tauscope::identification::consistent;
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/payload/arm.urdf", InertiaCheck::Ignored)?;
/// # let log = recording::load("../tests/reference/payload/before.csv", None)?;
/// # let other = recording::load("../tests/reference/payload/nothing.csv", None)?;
///
/// // Base parameters from a log, and bodies that can exist and have them.
/// let (model, preparation) = (Model::new(&robot), Preparation::usual(&log));
/// let logs = Logs { train: &[&log], test: &[&other] };
/// let fitted = fit_effects(&model, Trust::Structure, logs, preparation.clone(), Vec::new())?;
/// let bodies = consistent::consistent(&model, logs, preparation, &fitted)?;
/// let identified = bodies.robot(&robot);
/// assert!(identified.joints.iter().all(|joint| joint.inertia.physical_fault(1e-9).is_none()));
///
/// // They predict the held-out torque as well.
/// assert!(bodies.test_rms[1] < 1.2 * fitted.test_rms[1]);
///
/// let json = serde_json::to_value(&bodies).expect("it has a JSON form");
/// assert_eq!(json["test_rms"].as_array().map(Vec::len), Some(5));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Consistent {
    /// Standard parameters, 13 per joint in the order of [`Model::names`].
    pub standard: Vec<f64>,
    /// The base parameters they make.
    pub beta: Vec<f64>,
    /// Whether these are the fitted base parameters themselves: consistency costs nothing.
    pub exact: bool,
    /// Rise of the weighted sum of squared residuals: (beta - fitted)' H (beta - fitted).
    pub cost: f64,
    /// The best possible cost is lower by at most this.
    pub gap: f64,
    /// Root mean square torque per joint on the training logs, N m.
    pub torque_rms: Vec<f64>,
    /// Residual root mean square per joint on the training logs, N m.
    pub train_rms: Vec<f64>,
    /// The same on the held-out logs; empty where there are none.
    pub test_rms: Vec<f64>,
}

impl Consistent {
    /// The arm with these bodies and drives.
    pub fn robot(&self, known: &Robot) -> Robot {
        Model::with_standard_values(known, &self.standard)
    }
}

/// Makes the base parameters of a fit without effects consistent. `logs` and `preparation` are those of the fit.
///
/// # Errors
/// If a log is too short for its preparation, or the search fails (which needs parameters that are not finite).
pub fn consistent(model: &Model, logs: Logs, preparation: Preparation, fitted: &Fitted) -> Result<Consistent> {
    let estimate = &fitted.fit.estimate;
    let regression = |recordings| {
        let rows = EffectModel::new(model, Trust::Structure, recordings, preparation.clone(), Vec::new())?;
        rows.with_reversals(&fitted.reversals).regression()
    };
    let training = regression(logs.train)?;
    let mut normal = LinearProblem::new(&training, &estimate.sigma, estimate.beta.len()).normal().clone();
    // What the logs do not determine is as large as in any body of the arm's size.
    let sizes = Plausible::new(model, &normal, &estimate.beta).scale;
    for k in (0..estimate.beta.len()).filter(|&k| fitted.fit.undetermined[k]) {
        normal[(k, k)] += sizes[model.base().kept()[k]].powi(-2);
    }
    let solution = solve(model, &normal, &estimate.beta)?;
    let rms = |joints: &[JointRegression]| {
        joints.iter().map(|joint| joint.residual_rms(&solution.beta)).collect::<Vec<f64>>()
    };
    let test_rms = if logs.test.is_empty() { Vec::new() } else { rms(&regression(logs.test)?) };
    let zero = vec![0.0; solution.beta.len()];
    let torque_rms = training.iter().map(|joint| joint.residual_rms(&zero)).collect();
    Ok(Consistent { torque_rms, train_rms: rms(&training), test_rms, ..solution })
}

/// The parameters nearest to the base parameters `fitted` in the metric of `normal`, their inverse covariance; residuals stay
/// empty.
///
/// # Errors
/// If `normal` is not positive definite.
pub fn solve(model: &Model, normal: &DMatrix<f64>, fitted: &[f64]) -> Result<Consistent> {
    let failed = || Error::request("consistent inertias", "the normal matrix of the fit is not positive definite");
    let program = Program::new(model, normal, fitted).ok_or_else(failed)?;
    let point = program.minimize();
    let unchanged = program.unchanged(&point);
    let exact = program.is_feasible(&program.parameters(&unchanged));
    let point = if exact { unchanged } else { point };
    let mut standard: Vec<f64> = program.parameters(&point).component_mul(&program.scale).as_slice().to_vec();
    with_described_drives(model, &mut standard);
    let beta = model.base().values(&standard);
    let cost = point.rows(0, program.fitted).norm_squared();
    let gap = 2.0 * BARRIER * (CONDITIONS * model.dof()) as f64;
    Ok(Consistent {
        standard,
        beta,
        exact,
        cost,
        gap,
        torque_rms: Vec::new(),
        train_rms: Vec::new(),
        test_rms: Vec::new(),
    })
}

/// Leaves frictions and rotor inertias that torque does not show as described: those of a joint without an equation, and those of a joint
/// that follows another, of which only the sum with the other's is determined. The joint whose parameter is kept takes the difference where
/// its own stays positive.
fn with_described_drives(model: &Model, standard: &mut [f64]) {
    let (base, described) = (model.base(), Model::standard_values(model.robot()));
    let is_friction = |k: usize| k % STANDARD > ROTOR;
    for k in (0..standard.len()).filter(|&k| k % STANDARD >= PARAMETERS && !base.kept().contains(&k)) {
        let shares = base.regrouping().column(k);
        // A rotor's inertia is in sums with those of bodies, which must stay bodies.
        if !is_friction(k) && shares.iter().any(|share| *share != 0.0) {
            continue;
        }
        let more = standard[k] - described[k];
        let moved: Vec<(usize, f64)> = base
            .kept()
            .iter()
            .zip(base.carried(shares.as_slice()))
            .map(|(&kept, share)| (kept, share * more))
            .collect();
        if moved.iter().all(|&(kept, by)| by == 0.0 || standard[kept] + by > 0.0) {
            moved.into_iter().for_each(|(kept, by)| standard[kept] += by);
            standard[k] = described[k];
        }
    }
}

/// The program in the coordinates u: deviation of the base parameters in units of their uncertainty, then the standard
/// parameters that are not kept. x = map u + offset are the standard parameters in units of `scale`.
pub(super) struct Program {
    pub(super) fitted: usize,
    pub(super) map: DMatrix<f64>,
    pub(super) offset: DVector<f64>,
    pub(super) scale: DVector<f64>,
    /// Parameters from which the search starts and to which what torque does not see stays close.
    pub(super) nominal: DVector<f64>,
    /// Parameters of a body and what it hangs on: ten inertial ones, then those that must be positive.
    pub(super) stride: usize,
}

impl Program {
    fn new(model: &Model, normal: &DMatrix<f64>, fitted: &[f64]) -> Option<Program> {
        let (base, total) = (model.base(), model.names().len());
        let Plausible { scale, start } = Plausible::new(model, normal, fitted);
        let scale = DVector::from_vec(scale);
        let nominal = DVector::from_vec(start).component_div(&scale);
        let rest: Vec<usize> = (0..total).filter(|k| !base.kept().contains(k)).collect();
        let root = unit_cholesky(normal)?;
        let spread = root.transpose().try_inverse()?;
        let mut map = DMatrix::zeros(total, total);
        let mut offset = DVector::zeros(total);
        // Columns of base parameters, and what the standard parameters that carry them hold of each.
        let put = |column: &mut nalgebra::DVectorViewMut<f64>, sums: &[f64], factor: f64| {
            for (&kept, value) in base.kept().iter().zip(base.carried(sums)) {
                column[kept] = factor * value / scale[kept];
            }
        };
        put(&mut offset.column_mut(0), fitted, 1.0);
        for column in 0..base.len() {
            put(&mut map.column_mut(column), spread.column(column).as_slice(), 1.0);
        }
        for (place, &other) in rest.iter().enumerate() {
            let column = &mut map.column_mut(base.len() + place);
            put(column, base.regrouping().column(other).as_slice(), -scale[other]);
            column[other] = 1.0;
        }
        Some(Program { fitted: base.len(), map, offset, scale, nominal, stride: STANDARD })
    }

    pub(super) fn parameters(&self, point: &DVector<f64>) -> DVector<f64> {
        &self.map * point + &self.offset
    }

    /// The same unseen parameters with the fitted base parameters.
    pub(super) fn unchanged(&self, point: &DVector<f64>) -> DVector<f64> {
        let mut point = point.clone();
        point.rows_mut(0, self.fitted).fill(0.0);
        point
    }

    pub(super) fn is_feasible(&self, x: &DVector<f64>) -> bool {
        self.log_barrier(x).is_some()
    }

    /// Sum of the logarithms of what must be positive; None outside.
    fn log_barrier(&self, x: &DVector<f64>) -> Option<f64> {
        let mut sum = 0.0;
        for joint in x.as_slice().chunks(self.stride) {
            let factor = pseudo_inertia(joint).cholesky()?;
            sum += 2.0 * factor.l_dirty().diagonal().iter().map(|v| v.ln()).sum::<f64>();
            for &value in &joint[PARAMETERS..] {
                if value.is_nan() || value <= 0.0 {
                    return None;
                }
                sum += value.ln();
            }
        }
        sum.is_finite().then_some(sum)
    }

    fn value(&self, point: &DVector<f64>, weight: f64) -> Option<f64> {
        let x = self.parameters(point);
        let near = (&x - &self.nominal).norm_squared();
        let cost = point.rows(0, self.fitted).norm_squared();
        Some(0.5 * cost + 0.5 * CLOSENESS * near - weight * self.log_barrier(&x)?)
    }

    /// Follows the central path from the nominal parameters.
    pub(super) fn minimize(&self) -> DVector<f64> {
        let start = self.map.clone().lu().solve(&(&self.nominal - &self.offset));
        let mut point = start.unwrap_or_else(|| DVector::zeros(self.map.ncols()));
        let conditions = (CONDITIONS * self.scale.len() / self.stride) as f64;
        let mut weight = (point.rows(0, self.fitted).norm_squared() / conditions).max(1.0);
        loop {
            self.center(&mut point, weight);
            if weight <= BARRIER {
                return point;
            }
            weight = (DECREASE * weight).max(BARRIER);
        }
    }

    /// Newton's method with a step that stays inside.
    fn center(&self, point: &mut DVector<f64>, weight: f64) {
        for _ in 0..STEPS {
            let (gradient, curvature) = self.derivatives(point, weight);
            let Some(factor) = curvature.cholesky() else { return };
            let step = -factor.solve(&gradient);
            let decrement = -gradient.dot(&step);
            let Some(now) = self.value(point, weight) else { return };
            if decrement < 1e-3 * weight || decrement < 1e-13 * now.abs() {
                return;
            }
            let mut length = 1.0;
            while length > 1e-12 {
                let next = &*point + length * &step;
                if self.value(&next, weight).is_some_and(|value| value <= now - 0.1 * length * decrement) {
                    *point = next;
                    break;
                }
                length *= 0.5;
            }
            if length <= 1e-12 {
                return;
            }
        }
    }

    fn derivatives(&self, point: &DVector<f64>, weight: f64) -> (DVector<f64>, DMatrix<f64>) {
        let x = self.parameters(point);
        let mut slope = CLOSENESS * (&x - &self.nominal);
        let mut curvature = DMatrix::identity(x.len(), x.len()) * CLOSENESS;
        for (joint, values) in x.as_slice().chunks(self.stride).enumerate() {
            let first = joint * self.stride;
            let inverse = pseudo_inertia(values).try_inverse().unwrap_or_else(Matrix4::zeros);
            let parts: [Matrix4<f64>; PARAMETERS] = std::array::from_fn(|k| inverse * unit_pseudo_inertia(k));
            for (i, a) in parts.iter().enumerate() {
                slope[first + i] -= weight * a.trace();
                for (j, b) in parts.iter().enumerate() {
                    curvature[(first + i, first + j)] += weight * (a * b).trace();
                }
            }
            for (k, &value) in values.iter().enumerate().skip(PARAMETERS) {
                slope[first + k] -= weight / value;
                curvature[(first + k, first + k)] += weight / (value * value);
            }
        }
        let mut gradient = self.map.transpose() * slope;
        let mut matrix = self.map.transpose() * curvature * &self.map;
        for row in 0..self.fitted {
            gradient[row] += point[row];
            matrix[(row, row)] += 1.0;
        }
        (gradient, matrix)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::{self, InertiaCheck};
    use rand::RngExt;

    fn irb() -> Model {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../urdf/irb1600_6_120.urdf");
        Model::new(&robot::load(path, InertiaCheck::Required).unwrap())
    }

    /// A normal matrix as of a fit whose parameters have a hundredth of their own size as standard deviation.
    fn normal(fitted: &[f64]) -> DMatrix<f64> {
        let weights = fitted.iter().map(|b| (0.01 * b.abs().max(1e-3)).powi(-2));
        let mut matrix = DMatrix::from_diagonal(&DVector::from_iterator(fitted.len(), weights));
        for i in 1..fitted.len() {
            let correlation = 0.4 * (matrix[(i, i)] * matrix[(i - 1, i - 1)]).sqrt();
            matrix[(i, i - 1)] = correlation;
            matrix[(i - 1, i)] = correlation;
        }
        matrix
    }

    fn assert_physical(model: &Model, found: &Consistent) {
        for joint in &found.robot(model.robot()).joints {
            assert!(joint.inertia.mass() > 0.0 && joint.inertia.physical_fault(0.0).is_none(), "{joint:?}");
            assert!(pseudo_inertia(&joint.inertia.0).cholesky().is_some());
            assert!(joint.drive.viscous > 0.0 && joint.drive.coulomb > 0.0 && joint.drive.armature > 0.0);
        }
    }

    #[test]
    fn parameters_of_an_arm_that_exists_are_kept() {
        let model = irb();
        let fitted = model.base().values(&Model::standard_values(model.robot()));
        let found = solve(&model, &normal(&fitted), &fitted).unwrap();
        assert!(found.exact, "cost {}", found.cost);
        assert_physical(&model, &found);
        for (a, b) in model.base().values(&found.standard).iter().zip(&fitted) {
            assert!((a - b).abs() < 1e-10 * b.abs().max(1.0), "{a} {b}");
        }
    }

    #[test]
    fn the_drive_of_a_joint_without_torque_stays_as_described() {
        let described = irb().robot().clone();
        let model = Model::with_equations(&described, &[true, true, false, true, true, true]);
        let fitted = model.base().values(&Model::standard_values(&described));
        let found = solve(&model, &normal(&fitted), &fitted).unwrap().robot(&described);
        assert_eq!(found.joints[2].drive, described.joints[2].drive);
    }

    #[test]
    fn impossible_parameters_move_as_little_as_they_must() {
        let model = irb();
        let mut fitted = model.base().values(&Model::standard_values(model.robot()));
        let drive = |joint, which| (0..fitted.len()).find(|&b| model.drive_of(b) == Some((joint, which))).unwrap();
        let (rotor, friction) = (drive(4, 0), drive(2, 1));
        let inertia = model.base().groupings().iter().position(|g| g.name.starts_with("Iyy2")).unwrap();
        fitted[rotor] = -0.05;
        fitted[friction] = -2.0;
        fitted[inertia] = -20.0;
        let normal = normal(&fitted);
        let found = solve(&model, &normal, &fitted).unwrap();
        assert!(!found.exact && found.cost > 1.0, "{}", found.cost);
        assert_physical(&model, &found);

        // No other possible parameters cost less, beyond the gap: not on the way to any of many others.
        let program = Program::new(&model, &normal, &fitted).unwrap();
        let best = program.minimize();
        let own = program.value(&best, 0.0).unwrap();
        let start = program.map.clone().lu().solve(&(&program.nominal - &program.offset)).unwrap();
        let mut random = crate::random::stream(1, "consistent", 0);
        let mut tried = 0;
        for _ in 0..2000 {
            let other = start.map(|value| value * (1.0 + random.random_range(-0.01..0.01)));
            let share = 10f64.powf(random.random_range(-7.0..0.0));
            if let Some(value) = program.value(&(&best + share * (other - &best)), 0.0) {
                tried += 1;
                assert!(value > own - 0.5 * found.gap, "{value} {own}");
            }
        }
        assert!(tried > 100, "{tried}");
    }
}
