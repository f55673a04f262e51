//! Poses of frames.

use nalgebra::{Matrix3, Vector3};

/// A fixed pose of a child frame in its parent: x_parent = rotation x_child + translation.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use nalgebra::Vector3;
/// use tauscope::robot::{JointKind, Pose};
///
/// // 1 m up, then a quarter turn about z: x of the child frame is y of the base.
/// let up = Pose { translation: Vector3::z(), ..Pose::identity() };
/// let pose = up.then(&JointKind::Revolute.motion(&Vector3::z(), std::f64::consts::FRAC_PI_2));
/// let point = pose.rotation * Vector3::x() + pose.translation;
/// assert!((point - Vector3::new(0.0, 1.0, 1.0)).norm() < 1e-12);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// Rotation matrix, child axes in parent coordinates.
    pub rotation: Matrix3<f64>,
    /// Origin of the child in the parent, m.
    pub translation: Vector3<f64>,
}

impl Pose {
    /// The pose that changes nothing.
    pub fn identity() -> Self {
        Pose { rotation: Matrix3::identity(), translation: Vector3::zeros() }
    }

    /// Whether no entry of another pose is farther from this one's.
    pub(crate) fn is_near(&self, other: &Pose, far: f64) -> bool {
        (self.rotation - other.rotation).amax() <= far && (self.translation - other.translation).amax() <= far
    }

    /// This pose followed by `inner`, which is given in this pose's child frame.
    pub fn then(&self, inner: &Pose) -> Pose {
        Pose {
            rotation: self.rotation * inner.rotation,
            translation: self.rotation * inner.translation + self.translation,
        }
    }
}
