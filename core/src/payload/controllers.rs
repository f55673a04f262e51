//! A load in the formats of robots' controllers. Each takes it relative to its flange: the numbers fit where the frame of the
//! load is the flange as that controller has it.

use crate::robot::Inertia;
use nalgebra::{Matrix3, Rotation3, SymmetricEigen, UnitQuaternion, Vector3};
use serde::Serialize;
use serde_json::{Value, json};

/// The load for four makes of controllers.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use nalgebra::Vector3;
/// use tauscope::payload::Controllers;
///
/// // 1.5 kg, 90 mm in front of the flange, as a point.
/// let load = Controllers::new(1.5, Vector3::new(0.0, 0.0, 0.09), None);
/// assert_eq!(load.ur_set_payload, "set_payload(1.5, [0, 0, 0.09])");
/// assert_eq!(load.franka_desk["mass"], 1.5);
/// assert!(load.abb_loaddata.starts_with("PERS loaddata load1 := [1.5,"));
/// ```
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Controllers {
    /// Franka Desk, Settings, End Effector, upload: kg, m, kg m2; matrices column by column; inertia about the centre of mass.
    pub franka_desk: Value,
    /// Universal Robots: kg, m.
    pub ur_set_payload: String,
    /// Universal Robots: kg, m, kg m2 (xx, yy, zz, xy, xz, yz about the centre of mass).
    pub ur_set_target_payload: String,
    /// KUKA: kg, mm, deg (Z Y X of the principal axes), kg m2 about the principal axes.
    pub kuka_load: String,
    /// ABB: kg, mm, quaternion of the principal axes, kg m2 about them.
    pub abb_loaddata: String,
}

/// Digits of a number: more than the torque constants are worth.
const DIGITS: i32 = 5;

impl Controllers {
    /// The texts for a load of a mass, kg, its centre, m, and its inertia about the centre, kg m2; without, a point mass.
    pub fn new(mass: f64, center: Vector3<f64>, inertia: Option<Matrix3<f64>>) -> Self {
        let tensor = inertia.unwrap_or_else(Matrix3::zeros);
        let (moments, axes) = principal(&tensor);
        let round = rounded;
        let list = |values: &[f64]| values.iter().map(|x| text(*x)).collect::<Vec<_>>().join(", ");
        let identity: Vec<f64> = nalgebra::Matrix4::<f64>::identity().as_slice().to_vec();
        let franka_desk = json!({
            "mass": round(mass),
            "centerOfMass": center.iter().map(|x| round(*x)).collect::<Vec<f64>>(),
            "transformation": identity,
            "inertia": tensor.iter().map(|x| round(*x)).collect::<Vec<f64>>(),
        });
        let cog = list(center.as_slice());
        let six = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)].map(|place| tensor[place]);
        let ur_set_target_payload = match inertia {
            Some(_) => format!("set_target_payload({}, [{cog}], [{}])", text(mass), list(&six)),
            None => format!("set_target_payload({}, [{cog}])", text(mass)),
        };
        // R = Rz(A) Ry(B) Rx(C).
        let (c, b, a) = axes.euler_angles();
        let degrees = [a, b, c].map(f64::to_degrees);
        let [x, y, z] = [0, 1, 2].map(|k| text(1e3 * center[k]));
        let [ix, iy, iz] = [0, 1, 2].map(|k| text(moments[k]));
        let kuka_load = format!(
            "$LOAD = {{M {}, CM {{X {x}, Y {y}, Z {z}, A {}, B {}, C {}}}, J {{X {ix}, Y {iy}, Z {iz}}}}}",
            text(mass),
            text(degrees[0]),
            text(degrees[1]),
            text(degrees[2])
        );
        let turn = UnitQuaternion::from_rotation_matrix(&axes);
        let [w, i, j, k] = [turn.w, turn.i, turn.j, turn.k].map(|value| if turn.w < 0.0 { -value } else { value });
        let abb_loaddata = format!(
            "PERS loaddata load1 := [{}, [{x}, {y}, {z}], [{}], {ix}, {iy}, {iz}];",
            text(mass),
            list(&[w, i, j, k])
        );
        let ur_set_payload = format!("set_payload({}, [{cog}])", text(mass));
        Controllers { franka_desk, ur_set_payload, ur_set_target_payload, kuka_load, abb_loaddata }
    }

    /// The texts for a body in its frame.
    pub fn of(body: &Inertia) -> Self {
        Controllers::new(body.mass(), body.center_of_mass(), Some(body.tensor_about_center()))
    }
}

/// Principal moments and axes; axes as near to those of the frame as may be, a right-handed set.
fn principal(tensor: &Matrix3<f64>) -> (Vector3<f64>, Rotation3<f64>) {
    let off = [(0, 1), (0, 2), (1, 2)].iter().map(|&place| tensor[place].abs()).fold(0.0, f64::max);
    if off <= 1e-12 * tensor.diagonal().abs().max() {
        return (tensor.diagonal(), Rotation3::identity());
    }
    let eigen = SymmetricEigen::new(*tensor);
    const ORDERS: [[usize; 3]; 6] = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
    let along = |order: &[usize; 3]| (0..3).map(|k| eigen.eigenvectors[(k, order[k])].abs()).sum::<f64>();
    let order = ORDERS.into_iter().max_by(|a, b| along(a).total_cmp(&along(b))).unwrap_or(ORDERS[0]);
    let mut axes = Matrix3::zeros();
    for (k, &own) in order.iter().enumerate() {
        let axis = eigen.eigenvectors.column(own);
        axes.set_column(k, &(axis * if axis[k] < 0.0 { -1.0 } else { 1.0 }));
    }
    if axes.determinant() < 0.0 {
        let flipped = -axes.column(2);
        axes.set_column(2, &flipped);
    }
    (Vector3::from(order.map(|k| eigen.eigenvalues[k])), Rotation3::from_matrix_unchecked(axes))
}

/// A number in [`DIGITS`] digits; what is nearer to zero than any load's number is zero, without a minus.
fn rounded(value: f64) -> f64 {
    if value.abs() < 1e-9 || !value.is_finite() {
        return 0.0;
    }
    let unit = 10f64.powi(DIGITS - 1 - value.abs().log10().floor() as i32);
    (value * unit).round() / unit
}

/// The same as a text, without an exponent that a controller would not read.
fn text(value: f64) -> String {
    format!("{}", rounded(value))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_in_the_units_of_each_controller() {
        let tensor = Matrix3::from_diagonal(&Vector3::new(0.01, 0.02, 0.03));
        let found = Controllers::new(2.5, Vector3::new(0.01, -0.02, 0.1), Some(tensor));
        assert_eq!(found.ur_set_payload, "set_payload(2.5, [0.01, -0.02, 0.1])");
        assert_eq!(
            found.ur_set_target_payload,
            "set_target_payload(2.5, [0.01, -0.02, 0.1], [0.01, 0.02, 0.03, 0, 0, 0])"
        );
        assert_eq!(
            found.kuka_load,
            "$LOAD = {M 2.5, CM {X 10, Y -20, Z 100, A 0, B 0, C 0}, J {X 0.01, Y 0.02, Z 0.03}}"
        );
        assert_eq!(found.abb_loaddata, "PERS loaddata load1 := [2.5, [10, -20, 100], [1, 0, 0, 0], 0.01, 0.02, 0.03];");
        assert_eq!(found.franka_desk["mass"], 2.5);
        assert_eq!(found.franka_desk["inertia"][4], 0.02);
        assert_eq!(found.franka_desk["transformation"].as_array().unwrap().len(), 16);
    }

    #[test]
    fn principal_axes_give_the_tensor_back() {
        // Turned by 30 degrees about z: the principal x axis is at A = 30.
        let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), 30f64.to_radians());
        let diagonal = Matrix3::from_diagonal(&Vector3::new(0.01, 0.02, 0.03));
        let tensor = turn.matrix() * diagonal * turn.matrix().transpose();
        let (moments, axes) = principal(&tensor);
        let made = axes.matrix() * Matrix3::from_diagonal(&moments) * axes.matrix().transpose();
        assert!((made - tensor).norm() < 1e-15 && axes.matrix().determinant() > 0.0);
        let found = Controllers::new(1.0, Vector3::zeros(), Some(tensor));
        assert!(found.kuka_load.contains("A 30, B 0, C 0}, J {X 0.01, Y 0.02, Z 0.03}"), "{}", found.kuka_load);
        assert!(found.abb_loaddata.contains("[0.96593, 0, 0, 0.25882]"), "{}", found.abb_loaddata);
    }

    #[test]
    fn a_load_without_inertia_is_a_point() {
        let found = Controllers::new(1.0, Vector3::zeros(), None);
        assert_eq!(found.ur_set_target_payload, "set_target_payload(1, [0, 0, 0])");
        assert!(found.abb_loaddata.ends_with("0, 0, 0];") && found.kuka_load.ends_with("J {X 0, Y 0, Z 0}}"));
    }
}
