//! Poses of frames.

use nalgebra::{Matrix3, Vector3};

/// A fixed pose of a child frame in its parent: x_parent = rotation x_child + translation.
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
    pub fn is_near(&self, other: &Pose, far: f64) -> bool {
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
