//! The pseudo-inertia of a body, [[tr(I)/2 - I, h], [h', m]], linear in its inertial parameters (Wensing, Kim and Slotine 2018).

use crate::robot::PARAMETERS;
use nalgebra::Matrix4;

/// The pseudo-inertia of a link from its first ten parameters.
pub(super) fn pseudo_inertia(values: &[f64]) -> Matrix4<f64> {
    (0..PARAMETERS).fold(Matrix4::zeros(), |sum, k| sum + values[k] * unit_pseudo_inertia(k))
}

/// Change of the pseudo-inertia per unit of an inertial parameter.
pub(super) fn unit_pseudo_inertia(k: usize) -> Matrix4<f64> {
    let mut matrix = Matrix4::zeros();
    match k {
        0 => matrix[(3, 3)] = 1.0,
        1..=3 => {
            matrix[(k - 1, 3)] = 1.0;
            matrix[(3, k - 1)] = 1.0;
        }
        // On the diagonal stand (Iyy + Izz - Ixx) / 2 and so on, off it the products with the other sign.
        4 | 6 | 9 => {
            let own = [4, 6, 9].iter().position(|&index| index == k).unwrap_or(0);
            (0..3).for_each(|axis| matrix[(axis, axis)] = if axis == own { -0.5 } else { 0.5 });
        }
        _ => {
            let (row, column) = [(0, 1), (0, 2), (1, 2)][[5, 7, 8].iter().position(|&i| i == k).unwrap_or(0)];
            matrix[(row, column)] = -1.0;
            matrix[(column, row)] = -1.0;
        }
    }
    matrix
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pseudo_inertia_by_hand() {
        let p = pseudo_inertia(&[2.0, 3.0, 4.0, 5.0, 10.0, 0.5, 11.0, 0.6, 0.7, 13.0]);
        let expected =
            Matrix4::new(7.0, -0.5, -0.6, 3.0, -0.5, 6.0, -0.7, 4.0, -0.6, -0.7, 4.0, 5.0, 3.0, 4.0, 5.0, 2.0);
        assert_eq!(p, expected);
    }
}
