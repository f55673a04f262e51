//! Bodies of an arm's size: where the search for consistent parameters starts, and the units it takes them in.
//!
//! The URDF's bodies where it has some, balls where not. A URDF without inertials, or with placeholders, does not show how
//! heavy the arm is; the identified parameters do: all bodies are then scaled until they make as much torque.

use super::pseudo_inertia::pseudo_inertia;
use crate::identification::model::Model;
use crate::robot::Inertia;
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

/// Length that makes first moments and inertias comparable with masses, m.
const LENGTH: f64 = 0.3;

/// Least mass of a body in the units of the search, as a share of the heaviest.
const LIGHTEST: f64 = 0.05;

/// Factor up to which described bodies may make more or less torque than the identified ones and still count as described:
/// CAD models without cables, covers and motors are lighter by less than that.
const AS_DESCRIBED: f64 = 3.0;

/// Sizes and start of the standard parameters, 13 per moving body in the order of [`Model::names`].
#[derive(Debug, Clone)]
pub(super) struct Plausible {
    /// Size of every standard parameter.
    pub scale: Vec<f64>,
    /// Parameters of bodies and drives that can exist.
    pub start: Vec<f64>,
}

impl Plausible {
    /// For base parameters `fitted` with their inverse covariance `normal`.
    pub(super) fn new(model: &Model, normal: &DMatrix<f64>, fitted: &[f64]) -> Self {
        let (robot, bodies) = (model.robot(), model.robot().bodies());
        let described: Vec<f64> = (0..bodies).map(|body| robot.body(body).inertia.mass()).collect();
        let heaviest = described.iter().copied().fold(0.0, f64::max);
        let (masses, heaviest) = if heaviest > 0.0 { (described, heaviest) } else { (vec![1.0; bodies], 1.0) };
        let masses: Vec<f64> = masses.into_iter().map(|mass| mass.max(LIGHTEST * heaviest)).collect();
        let first = Self::of_size(model, fitted, &masses, 1.0);
        let factor = torque_of(model, normal, fitted) / torque_of(model, normal, &model.base().values(&first.start));
        match factor.is_finite() && factor > 0.0 && !(1.0 / AS_DESCRIBED..=AS_DESCRIBED).contains(&factor) {
            true => Self::of_size(model, fitted, &masses, factor),
            false => first,
        }
    }

    /// With bodies of so large `masses`, all times `factor`.
    fn of_size(model: &Model, fitted: &[f64], masses: &[f64], factor: f64) -> Self {
        let (mut scale, mut start) = (Vec::new(), Vec::new());
        for (joint, mass) in masses.iter().enumerate() {
            let spec = model.robot().body(joint);
            let moment = mass * LENGTH * LENGTH;
            let mut size = vec![*mass, mass * LENGTH, mass * LENGTH, mass * LENGTH];
            size.extend([moment; 6]);
            let unit: Vec<f64> = spec.inertia.0.iter().zip(&size).map(|(value, s)| value / s).collect();
            let solid = pseudo_inertia(&unit).symmetric_eigenvalues().min() > 1e-4;
            let body = if solid { spec.inertia } else { ball(*mass, spec.inertia.center_of_mass()) };
            start.extend(body.0.map(|value| factor * value));
            scale.extend(size.iter().map(|value| factor * value));
            let rotor = spec.drive.armature.max(factor * moment);
            scale.push(rotor);
            start.push(spec.drive.armature.max(0.01 * rotor));
            for which in 1..3 {
                let found = own_value(model, fitted, joint, which);
                let size = found.map_or(1.0, f64::abs).max(1e-3);
                scale.push(size);
                start.push(found.unwrap_or(0.0).max(0.01 * size));
            }
        }
        Plausible { scale, start }
    }
}

/// Size of the torque that base parameters make along the motion of the logs, friction and rotors left out.
fn torque_of(model: &Model, normal: &DMatrix<f64>, values: &[f64]) -> f64 {
    let bodies = values.iter().enumerate().map(|(b, &value)| if model.drive_of(b).is_none() { value } else { 0.0 });
    let bodies = DVector::from_iterator(values.len(), bodies);
    (normal * &bodies).dot(&bodies).max(0.0).sqrt()
}

/// A ball whose radius is a third of [`LENGTH`].
fn ball(mass: f64, center: Vector3<f64>) -> Inertia {
    let center = if center.norm() < 2.0 * LENGTH { center } else { Vector3::zeros() };
    let moment = 0.4 * mass * (LENGTH / 3.0).powi(2);
    Inertia::from_center_of_mass(mass, center, Matrix3::identity() * moment)
}

/// Fitted value of a drive's parameter that stands alone.
fn own_value(model: &Model, fitted: &[f64], joint: usize, which: usize) -> Option<f64> {
    (0..model.base().len()).find(|&b| model.drive_of(b) == Some((joint, which))).map(|b| fitted[b])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identification::model::standard::STANDARD;
    use crate::robot::{self, Drive, InertiaCheck, PARAMETERS};

    #[test]
    fn bodies_that_are_not_described_are_as_heavy_as_what_was_identified() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../urdf/irb1600_6_120.urdf");
        let real = robot::load(path, InertiaCheck::Required).unwrap();
        let mut described = real.clone();
        for joint in &mut described.joints {
            (joint.inertia, joint.drive) = (Inertia([0.0; PARAMETERS]), Drive::default());
        }
        let masses = |described: &robot::Robot, times: f64| -> Vec<f64> {
            let model = Model::new(described);
            let fitted: Vec<f64> =
                model.base().values(&Model::standard_values(&real)).iter().map(|value| times * value).collect();
            let normal = DMatrix::identity(fitted.len(), fitted.len());
            let found = Plausible::new(&model, &normal, &fitted);
            assert!(found.start.chunks(STANDARD).all(|joint| pseudo_inertia(joint).cholesky().is_some()));
            found.start.iter().step_by(STANDARD).copied().collect()
        };
        let (once, heavy) = (masses(&described, 1.0), masses(&described, 50.0));
        let real_mass: f64 = real.joints.iter().map(|joint| joint.inertia.mass()).sum();
        let sum: f64 = once.iter().sum();
        assert!(sum > 0.2 * real_mass && sum < 5.0 * real_mass, "{sum} of {real_mass}");
        assert!(once.iter().zip(&heavy).all(|(one, fifty)| (fifty / one - 50.0).abs() < 1e-9));
        let own: Vec<f64> = real.joints.iter().map(|joint| joint.inertia.mass()).collect();
        assert_eq!(masses(&real, 1.2), own, "bodies of about the right size stay as described");
    }
}
