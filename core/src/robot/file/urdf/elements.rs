//! Elements of a URDF as they are read and written.

use super::super::xml::attribute;
use crate::robot::model::{Drive, Inertia, Pose};
use nalgebra::{Rotation3, Vector3};
use roxmltree::Node;

/// Type of a joint in lower case; empty where the file gives none.
pub(super) fn joint_type(joint: &Node) -> String {
    attribute(joint, "type").unwrap_or_default().to_ascii_lowercase()
}

/// URDF pose (fixed-axis roll, pitch, yaw) whose numbers are known to be finite, or do not matter.
pub(crate) fn pose_of(given: &urdf_rs::Pose) -> Pose {
    let ([x, y, z], [roll, pitch, yaw]) = (given.xyz.0, given.rpy.0);
    Pose { rotation: Rotation3::from_euler_angles(roll, pitch, yaw).into_inner(), translation: Vector3::new(x, y, z) }
}

/// A pose as fixed-axis roll, pitch and yaw, the URDF's convention.
pub(super) fn origin(pose: &Pose) -> String {
    let (roll, pitch, yaw) = Rotation3::from_matrix_unchecked(pose.rotation).euler_angles();
    let [x, y, z]: [f64; 3] = pose.translation.into();
    format!("<origin xyz=\"{x:?} {y:?} {z:?}\" rpy=\"{roll:?} {pitch:?} {yaw:?}\"/>")
}

/// The element of a body, about its centre of mass.
pub(super) fn inertial(body: &Inertia) -> String {
    let (center, tensor) = (body.center_of_mass(), body.tensor_about_center());
    format!(
        "<inertial><origin xyz=\"{:?} {:?} {:?}\" rpy=\"0 0 0\"/><mass value=\"{:?}\"/><inertia ixx=\"{:?}\" \
         ixy=\"{:?}\" ixz=\"{:?}\" iyy=\"{:?}\" iyz=\"{:?}\" izz=\"{:?}\"/></inertial>",
        center.x,
        center.y,
        center.z,
        body.mass(),
        tensor[(0, 0)],
        tensor[(0, 1)],
        tensor[(0, 2)],
        tensor[(1, 1)],
        tensor[(1, 2)],
        tensor[(2, 2)]
    )
}

/// The element of a drive.
pub(super) fn dynamics(drive: &Drive) -> String {
    let Drive { viscous, coulomb, armature } = drive;
    format!("<dynamics damping=\"{viscous:?}\" friction=\"{coulomb:?}\" armature=\"{armature:?}\"/>")
}
