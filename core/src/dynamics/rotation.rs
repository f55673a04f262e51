//! Rotations between the frames of neighbouring links.

use super::spatial::{Vec3, splat3, times, transpose_times};
use crate::lane::Lane;
use nalgebra::{Matrix3, Vector3};

/// A rotation that does not depend on where the joints are.
#[derive(Debug, Clone)]
enum Fixed {
    /// None: the frames are parallel.
    None,
    /// About a coordinate axis: its index, sine and cosine of the angle.
    About(usize, f64, f64),
    /// Any other, row by row.
    Matrix([[f64; 3]; 3]),
}

/// Rotation from a link frame to the frame before it: a fixed part, the turn of the joint about a coordinate axis, and for
/// a joint with a slanting axis another fixed part. Where there is no fixed part, as between most links of most arms, a
/// vector takes four products instead of the nine of a matrix, and no matrix is made.
#[derive(Debug, Clone)]
pub(super) struct Rotation {
    before: Fixed,
    /// Index of the axis of the joint's turn, none for a prismatic joint.
    turn: Option<usize>,
    /// Whether it turns the other way about that axis.
    reversed: bool,
    after: Fixed,
}

/// Sine and cosine of a turn.
pub(super) type Turn<L> = (L, L);

/// What differs from a whole number by less belongs to the rounding of an angle such as pi/2.
const ROUNDING: f64 = 1e-15;

impl Fixed {
    fn new(rotation: Matrix3<f64>) -> Self {
        let clean = rotation.map(|entry| if (entry - entry.round()).abs() < ROUNDING { entry.round() } else { entry });
        if clean == Matrix3::identity() {
            return Fixed::None;
        }
        // The cosine of a small angle is one to rounding, about whatever axis: only the elements off the axis show it.
        let apart = |axis: usize, k: usize| k != axis && (clean[(axis, k)] != 0.0 || clean[(k, axis)] != 0.0);
        match (0..3).find(|&axis| clean[(axis, axis)] == 1.0 && !(0..3).any(|k| apart(axis, k))) {
            Some(axis) => {
                let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
                Fixed::About(axis, clean[(j, i)], clean[(i, i)])
            }
            None => Fixed::Matrix(std::array::from_fn(|i| std::array::from_fn(|j| clean[(i, j)]))),
        }
    }

    #[inline(always)]
    fn apply<L: Lane, const N: usize>(&self, vectors: &mut [Vec3<L>; N]) {
        match self {
            Fixed::None => {}
            Fixed::About(axis, s, c) => turn(*axis, vectors, L::splat(*s), L::splat(*c)),
            Fixed::Matrix(m) => {
                let m = [splat3(&m[0]), splat3(&m[1]), splat3(&m[2])];
                for v in vectors {
                    *v = times(&m, *v);
                }
            }
        }
    }

    #[inline(always)]
    fn undo<L: Lane, const N: usize>(&self, vectors: &mut [Vec3<L>; N]) {
        match self {
            Fixed::None => {}
            Fixed::About(axis, s, c) => turn(*axis, vectors, L::splat(-*s), L::splat(*c)),
            Fixed::Matrix(m) => {
                let m = [splat3(&m[0]), splat3(&m[1]), splat3(&m[2])];
                for v in vectors {
                    *v = transpose_times(&m, *v);
                }
            }
        }
    }
}

impl Rotation {
    /// The rotation of a prismatic joint.
    pub(super) fn fixed(origin: Matrix3<f64>) -> Self {
        Rotation { before: Fixed::new(origin), turn: None, reversed: false, after: Fixed::None }
    }

    /// The rotation of a joint that turns about the unit vector `axis`, behind a fixed rotation.
    pub(super) fn about(axis: Vector3<f64>, origin: Matrix3<f64>) -> Self {
        let turn = axis.iamax();
        let reversed = axis[turn] < 0.0;
        let mut nearest = Vector3::zeros();
        nearest[turn] = axis[turn].signum();
        // Less than a right angle apart, so that the sum is never zero. Rodrigues' formula by sine and cosine: an angle by its cosine has
        // but half of the digits where the two are nearly one.
        let sines = nearest.cross(&axis).cross_matrix();
        let slant = Matrix3::identity() + sines + sines * sines / (1.0 + nearest.dot(&axis));
        Rotation {
            before: Fixed::new(origin * slant),
            turn: Some(turn),
            reversed,
            after: Fixed::new(slant.transpose()),
        }
    }

    /// Sine and cosine of the joint's turn about the coordinate axis.
    #[inline(always)]
    pub(super) fn turn<L: Lane>(&self, q: L) -> Turn<L> {
        if self.turn.is_none() {
            return (q, q);
        }
        let (sine, cosine) = q.sin_cos();
        (if self.reversed { -sine } else { sine }, cosine)
    }

    /// Coordinates in the frame before, of vectors given in the link frame.
    #[inline(always)]
    pub(super) fn to_parent<L: Lane, const N: usize>(
        &self,
        (sine, cosine): Turn<L>,
        mut vectors: [Vec3<L>; N],
    ) -> [Vec3<L>; N] {
        self.after.apply(&mut vectors);
        if let Some(axis) = self.turn {
            turn(axis, &mut vectors, sine, cosine);
        }
        self.before.apply(&mut vectors);
        vectors
    }

    /// Coordinates in the link frame, of vectors given in the frame before.
    #[inline(always)]
    pub(super) fn to_link<L: Lane, const N: usize>(
        &self,
        (sine, cosine): Turn<L>,
        mut vectors: [Vec3<L>; N],
    ) -> [Vec3<L>; N] {
        self.before.undo(&mut vectors);
        if let Some(axis) = self.turn {
            turn(axis, &mut vectors, -sine, cosine);
        }
        self.after.undo(&mut vectors);
        vectors
    }
}

/// Turns vectors about a coordinate axis.
#[inline(always)]
fn turn<L: Lane, const N: usize>(axis: usize, vectors: &mut [Vec3<L>; N], sine: L, cosine: L) {
    // No closures: left out of line, they would be compiled for the oldest machines.
    for [x, y, z] in vectors {
        match axis {
            0 => (*y, *z) = plane((*y, *z), sine, cosine),
            1 => (*z, *x) = plane((*z, *x), sine, cosine),
            _ => (*x, *y) = plane((*x, *y), sine, cosine),
        }
    }
}

/// A vector of a plane turned from its first axis towards its second.
#[inline(always)]
fn plane<L: Lane>((u, v): (L, L), sine: L, cosine: L) -> (L, L) {
    (sine.mul_sub_from(v, cosine * u), sine.mul_add(u, cosine * v))
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Rotation3;
    use proptest::prelude::*;

    /// The rotation by Rodrigues' formula.
    fn matrix(origin: Matrix3<f64>, axis: Vector3<f64>, q: f64) -> Matrix3<f64> {
        origin * Rotation3::from_axis_angle(&nalgebra::Unit::new_normalize(axis), q).matrix()
    }

    fn check(origin: Matrix3<f64>, axis: Vector3<f64>, q: f64, v: [f64; 3]) {
        let rotation = Rotation::about(axis, origin);
        let expected = matrix(origin, axis, q) * Vector3::from(v);
        let [turned] = rotation.to_parent(rotation.turn(q), [v]);
        let [back] = rotation.to_link(rotation.turn(q), [turned]);
        for k in 0..3 {
            assert!((turned[k] - expected[k]).abs() < 1e-14, "{axis} {origin}: {turned:?}, {expected}");
            assert!((back[k] - v[k]).abs() < 1e-14, "{axis} {origin}: {back:?}, {v:?}");
        }
    }

    #[test]
    fn frames_at_right_angles_take_no_matrix() {
        let right = std::f64::consts::FRAC_PI_2;
        for [roll, pitch, yaw] in
            [[0.0; 3], [right, 0.0, 0.0], [0.0, -right, 0.0], [0.0, 0.0, 2.0 * right], [0.3, 0.0, 0.0]]
        {
            let origin = *Rotation3::from_euler_angles(roll, pitch, yaw).matrix();
            for k in 0..3 {
                for sign in [1.0, -1.0] {
                    let axis = Vector3::ith(k, sign);
                    let rotation = Rotation::about(axis, origin);
                    assert!(!matches!(rotation.before, Fixed::Matrix(_)) && matches!(rotation.after, Fixed::None));
                    check(origin, axis, 0.7, [0.3, -1.0, 0.5]);
                }
            }
        }
    }

    #[test]
    fn a_small_slope_of_a_frame_is_kept() {
        for k in 0..3 {
            let origin = *Rotation3::new(Vector3::ith(k, 1e-9)).matrix();
            for axis in 0..3 {
                let rotation = Rotation::about(Vector3::ith(axis, 1.0), origin);
                let [turned] = rotation.to_parent(rotation.turn(0.0), [[1.0, 2.0, 3.0]]);
                let expected = origin * Vector3::new(1.0, 2.0, 3.0);
                assert_eq!(turned, [expected[0], expected[1], expected[2]]);
            }
        }
    }

    #[test]
    fn an_axis_that_is_nearly_a_coordinate_axis_keeps_all_digits() {
        for slope in [5.35e-6, 1e-8, 1e-3] {
            for axis in
                [Vector3::new(-1.0, 0.0, slope), Vector3::new(slope, 1.0, -slope), Vector3::new(0.0, slope, -1.0)]
            {
                check(Matrix3::identity(), axis.normalize(), -1.509, [0.3, -1.0, -0.537]);
            }
        }
    }

    proptest! {
        #[test]
        fn any_axis_behind_any_rotation(
            angles in prop::array::uniform3(-3.0..3.0f64),
            axis in prop::array::uniform3(-1.0..1.0f64),
            q in -7.0..7.0f64,
            v in prop::array::uniform3(-1.0..1.0f64),
        ) {
            let [roll, pitch, yaw] = angles;
            let axis = Vector3::from(axis);
            prop_assume!(axis.norm() > 0.01);
            check(*Rotation3::from_euler_angles(roll, pitch, yaw).matrix(), axis.normalize(), q, v);
        }
    }
}
