//! The body that can exist nearest to ten fitted parameters.

use super::consistent::Program;
use super::pseudo_inertia::pseudo_inertia;
use crate::identification::numerics::scaled_normal::unit_cholesky;
use crate::robot::{Inertia, PARAMETERS};
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

/// The body nearest to `fitted` in the metric of its inverse covariance `normal`, `size` m being about how far its parts are from
/// each other. Returned with its squared distance. None
/// where the metric is not positive definite or the fitted mass is zero.
pub(crate) fn nearest_body(normal: &DMatrix<f64>, fitted: &[f64; PARAMETERS], size: f64) -> Option<(Inertia, f64)> {
    let mass = fitted[0].abs();
    if !(mass > 0.0 && size > 0.0) {
        return None;
    }
    if pseudo_inertia(fitted).cholesky().is_some() {
        return Some((Inertia(*fitted), 0.0));
    }
    let (first, second) = (mass * size, mass * size * size);
    let scale =
        DVector::from_column_slice(&[mass, first, first, first, second, second, second, second, second, second]);
    let center = Vector3::new(fitted[1], fitted[2], fitted[3]) / mass;
    let start = Inertia::from_center_of_mass(mass, center, Matrix3::identity() * (0.4 * second));
    let mut map = unit_cholesky(normal)?.transpose().try_inverse()?;
    map.row_iter_mut().zip(scale.iter()).for_each(|(mut row, s)| row /= *s);
    let program = Program {
        fitted: PARAMETERS,
        map,
        offset: DVector::from_column_slice(fitted).component_div(&scale),
        nominal: DVector::from_column_slice(&start.0).component_div(&scale),
        scale,
        stride: PARAMETERS,
    };
    let point = program.minimize();
    let values = program.parameters(&point);
    if !program.is_feasible(&values) {
        return None;
    }
    let values = values.component_mul(&program.scale);
    Some((Inertia(std::array::from_fn(|k| values[k])), point.norm_squared()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn normal(deviations: [f64; PARAMETERS]) -> DMatrix<f64> {
        DMatrix::from_diagonal(&DVector::from_iterator(PARAMETERS, deviations.iter().map(|d| d.powi(-2))))
    }

    const DEVIATIONS: [f64; PARAMETERS] = [0.01, 0.001, 0.001, 0.001, 0.01, 0.01, 0.01, 0.01, 0.01, 0.01];

    #[test]
    fn a_body_that_can_exist_is_kept() {
        let body = Inertia::from_center_of_mass(2.0, Vector3::new(0.0, 0.0, 0.1), Matrix3::identity() * 0.01);
        let (found, cost) = nearest_body(&normal(DEVIATIONS), &body.0, 0.1).unwrap();
        assert_eq!((found, cost), (body, 0.0));
    }

    #[test]
    fn an_inertia_that_no_body_has_is_moved_within_its_error() {
        let mut fitted = Inertia::from_center_of_mass(2.0, Vector3::new(0.0, 0.0, 0.1), Matrix3::identity() * 0.002).0;
        fitted[6] -= 0.01;
        let (found, cost) = nearest_body(&normal(DEVIATIONS), &fitted, 0.1).unwrap();
        assert_eq!(found.physical_fault(0.0), None);
        let far: f64 = (0..PARAMETERS).map(|k| ((found.0[k] - fitted[k]) / DEVIATIONS[k]).powi(2)).sum();
        assert!(far > 0.1 && far < 2.0 && (cost - far).abs() < 1e-6, "{far} {cost}");
        // The exact mass stays, the inexact inertia moves.
        assert!((found.mass() - 2.0).abs() < 0.01, "{}", found.mass());
        let (found, _) = nearest_body(&normal(DEVIATIONS), &[-1.0; PARAMETERS], 0.1).unwrap();
        assert!(found.mass() > 0.0, "a negative mass becomes a positive one");
    }
}
