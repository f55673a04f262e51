//! The geometry of an arm as the kernels read it, and the forward recursion they share.

use super::spatial::{Mat3, Vec3, add, add_cross, cross, scale, splat3, transpose_times};
use crate::lane::Lane;
use crate::robot::{JointKind, Robot};
use nalgebra::Matrix3;

/// Geometry of one joint: rotation to the parent frame = constant + sin q * with_sine + cos q * with_cosine.
#[derive(Debug, Clone)]
struct JointGeometry {
    kind: JointKind,
    constant: [[f64; 3]; 3],
    with_sine: [[f64; 3]; 3],
    with_cosine: [[f64; 3]; 3],
    translation: [f64; 3],
    /// For a prismatic joint: the axis in parent coordinates.
    slide: [f64; 3],
    axis: [f64; 3],
}

/// Geometry and gravity of a serial chain, prepared for the batched kernels.
#[derive(Debug, Clone)]
pub struct Chain {
    joints: Vec<JointGeometry>,
    gravity: [f64; 3],
}

/// What the forward recursion knows of one link, in the link's own frame.
#[derive(Debug, Clone)]
pub(super) struct LinkState<L> {
    /// Rotation from the link frame to the frame before it.
    pub rotation: Mat3<L>,
    /// Origin of the link frame in the frame before it.
    pub translation: Vec3<L>,
    /// Angular velocity.
    pub omega: Vec3<L>,
    /// Angular acceleration.
    pub alpha: Vec3<L>,
    /// Acceleration of the frame origin, gravity taken as an upward acceleration of the base.
    pub acceleration: Vec3<L>,
}

impl Chain {
    /// Prepares the geometry of `robot`.
    pub fn new(robot: &Robot) -> Self {
        let joints = robot
            .joints
            .iter()
            .map(|joint| {
                let origin = joint.origin.rotation;
                // Rodrigues: R(q) = 1 + sin q K + (1 - cos q) K^2, behind the fixed rotation of the joint origin.
                let skew = joint.axis.cross_matrix();
                let (constant, sine, cosine) = match joint.kind {
                    JointKind::Revolute => {
                        (origin * (Matrix3::identity() + skew * skew), origin * skew, -origin * skew * skew)
                    }
                    JointKind::Prismatic => (origin, Matrix3::zeros(), Matrix3::zeros()),
                };
                let slide = match joint.kind {
                    JointKind::Revolute => nalgebra::Vector3::zeros(),
                    JointKind::Prismatic => origin * joint.axis,
                };
                JointGeometry {
                    kind: joint.kind,
                    constant: rows(&constant),
                    with_sine: rows(&sine),
                    with_cosine: rows(&cosine),
                    translation: joint.origin.translation.into(),
                    slide: slide.into(),
                    axis: joint.axis.into(),
                }
            })
            .collect();
        Chain { joints, gravity: robot.gravity.into() }
    }

    /// Number of joints.
    pub fn dof(&self) -> usize {
        self.joints.len()
    }

    /// The same chain under another gravity vector (base frame, m/s2).
    pub fn with_gravity(mut self, gravity: [f64; 3]) -> Self {
        self.gravity = gravity;
        self
    }

    #[inline(always)]
    pub(super) fn is_revolute(&self, joint: usize) -> bool {
        self.joints[joint].kind == JointKind::Revolute
    }

    #[inline(always)]
    pub(super) fn axis<L: Lane>(&self, joint: usize) -> Vec3<L> {
        splat3(&self.joints[joint].axis)
    }

    /// State of the base: at rest, accelerated against gravity.
    #[inline(always)]
    pub(super) fn base<L: Lane>(&self) -> LinkState<L> {
        let zero = [L::splat(0.0); 3];
        let [x, y, z] = self.gravity;
        LinkState {
            rotation: [zero; 3],
            translation: zero,
            omega: zero,
            alpha: zero,
            acceleration: splat3(&[-x, -y, -z]),
        }
    }

    /// Rotation from the frame of link `joint` to the frame before it, and its origin there.
    #[inline(always)]
    pub(super) fn placement<L: Lane>(&self, joint: usize, q: L) -> (Mat3<L>, Vec3<L>) {
        let turn = if self.is_revolute(joint) { q.sin_cos() } else { (q, q) };
        self.placement_turned(joint, q, turn)
    }

    /// [`Chain::placement`] of a position whose sine and cosine are known; those of a prismatic joint are not read.
    #[inline(always)]
    fn placement_turned<L: Lane>(&self, joint: usize, q: L, (sine, cosine): (L, L)) -> (Mat3<L>, Vec3<L>) {
        let geometry = &self.joints[joint];
        let mut translation: Vec3<L> = splat3(&geometry.translation);
        let mut rotation: Mat3<L> =
            [splat3(&geometry.constant[0]), splat3(&geometry.constant[1]), splat3(&geometry.constant[2])];
        if geometry.kind == JointKind::Revolute {
            for (row, (s, c)) in rotation.iter_mut().zip(geometry.with_sine.iter().zip(&geometry.with_cosine)) {
                *row = std::array::from_fn(|k| L::splat(c[k]).mul_add(cosine, L::splat(s[k]).mul_add(sine, row[k])));
            }
        } else {
            translation = add(translation, scale(splat3(&geometry.slide), q));
        }
        (rotation, translation)
    }

    /// State of link `joint` from that of the link before it.
    #[inline(always)]
    pub(super) fn next<L: Lane>(&self, joint: usize, before: &LinkState<L>, q: L, qd: L, qdd: L) -> LinkState<L> {
        let turn = if self.is_revolute(joint) { q.sin_cos() } else { (q, q) };
        self.next_turned(joint, before, [q, qd, qdd], turn)
    }

    /// [`Chain::next`] at a position whose sine and cosine are known; those of a prismatic joint are not read.
    #[inline(always)]
    pub(super) fn next_turned<L: Lane>(
        &self,
        joint: usize,
        before: &LinkState<L>,
        [q, qd, qdd]: [L; 3],
        turn: (L, L),
    ) -> LinkState<L> {
        let (rotation, translation) = self.placement_turned(joint, q, turn);
        let axis: Vec3<L> = self.axis(joint);
        let revolute = self.is_revolute(joint);
        let mut omega = transpose_times(&rotation, before.omega);
        let mut alpha = transpose_times(&rotation, before.alpha);
        let tangential = add_cross(before.acceleration, before.alpha, translation);
        let origin = add_cross(tangential, before.omega, cross(before.omega, translation));
        let mut acceleration = transpose_times(&rotation, origin);
        let turn = scale(axis, qd);
        if revolute {
            alpha = add(alpha, add(scale(axis, qdd), cross(omega, turn)));
            omega = add(omega, turn);
        } else {
            let coriolis = cross(omega, turn);
            acceleration = add(acceleration, add(scale(axis, qdd), add(coriolis, coriolis)));
        }
        LinkState { rotation, translation, omega, alpha, acceleration }
    }
}

fn rows(m: &Matrix3<f64>) -> [[f64; 3]; 3] {
    std::array::from_fn(|i| std::array::from_fn(|j| m[(i, j)]))
}
