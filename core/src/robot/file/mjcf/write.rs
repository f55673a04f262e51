//! A robot as a MuJoCo model: bodies, joints, drives and couplings as they are known, without looks.

use super::super::xml::escaped;
use crate::robot::model::{Inertia, Joint, JointKind, Pose, Robot};
use nalgebra::{Rotation3, UnitQuaternion};

/// Mass, kg, and moments of inertia, kg m2, that bodies without any are given: MuJoCo moves none that have none.
const LEAST: f64 = 1e-9;

/// An MJCF model with the joints, limits, bodies, drives and gravity of `robot`: rotors as `armature`, viscous friction as `damping`,
/// Coulomb friction as `frictionloss`, joints that follow others by equalities, the flange as a site. The drive's effort limit is
/// the joint's `actuatorfrcrange`; there are no actuators.
pub fn to_mjcf(robot: &Robot) -> String {
    let [x, y, z]: [f64; 3] = robot.gravity.into();
    let mut text = format!(
        "<mujoco model=\"{}\">\n  <compiler angle=\"radian\" autolimits=\"true\" boundmass=\"{LEAST:?}\" \
         boundinertia=\"{LEAST:?}\"/>\n  <option gravity=\"{x:?} {y:?} {z:?}\"/>\n  <worldbody>\n",
        escaped(&robot.name)
    );
    for body in (0..robot.bodies()).filter(|&body| robot.parent(body).is_none()) {
        text += &subtree(robot, body, 2);
    }
    text += "  </worldbody>\n";
    let followers: String = (robot.dof()..robot.bodies()).map(|body| equality(robot, body)).collect();
    if !followers.is_empty() {
        text += &format!("  <equality>\n{followers}  </equality>\n");
    }
    text + "</mujoco>\n"
}

/// A body with all that it carries, indented by so many steps.
fn subtree(robot: &Robot, body: usize, depth: usize) -> String {
    let (indent, joint) = ("  ".repeat(depth), robot.body(body));
    let mut text = format!(
        "{indent}<body name=\"{}\" {}>\n{indent}  {}\n{indent}  {}\n",
        escaped(&joint.link),
        placed(&joint.origin),
        hinge(joint),
        inertial(&joint.inertia)
    );
    if body == robot.tip() {
        text += &format!("{indent}  <site name=\"flange\" {}/>\n", placed(&robot.flange));
    }
    for carried in (0..robot.bodies()).filter(|&other| robot.parent(other) == Some(body)) {
        text += &subtree(robot, carried, depth + 1);
    }
    text + &format!("{indent}</body>\n")
}

fn hinge(joint: &Joint) -> String {
    let Joint { axis, limits, drive, .. } = joint;
    let kind = match joint.kind {
        JointKind::Revolute => "hinge",
        JointKind::Prismatic => "slide",
    };
    let mut text = format!(
        "<joint name=\"{}\" type=\"{kind}\" axis=\"{:?} {:?} {:?}\" armature=\"{:?}\" damping=\"{:?}\" frictionloss=\"{:?}\"",
        escaped(&joint.name),
        axis.x,
        axis.y,
        axis.z,
        drive.armature,
        drive.viscous,
        drive.coulomb
    );
    if limits.lower.is_finite() && limits.upper.is_finite() {
        text += &format!(" range=\"{:?} {:?}\"", limits.lower, limits.upper);
    }
    if limits.effort.is_finite() {
        text += &format!(" actuatorfrcrange=\"{:?} {:?}\"", -limits.effort, limits.effort);
    }
    text + "/>"
}

/// The body, about its centre of mass.
fn inertial(body: &Inertia) -> String {
    let (center, tensor) = (body.center_of_mass(), body.tensor_about_center());
    format!(
        "<inertial pos=\"{:?} {:?} {:?}\" mass=\"{:?}\" fullinertia=\"{:?} {:?} {:?} {:?} {:?} {:?}\"/>",
        center.x,
        center.y,
        center.z,
        body.mass(),
        tensor[(0, 0)],
        tensor[(1, 1)],
        tensor[(2, 2)],
        tensor[(0, 1)],
        tensor[(0, 2)],
        tensor[(1, 2)]
    )
}

fn placed(pose: &Pose) -> String {
    let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(pose.rotation));
    let ([x, y, z], q): ([f64; 3], _) = (pose.translation.into(), rotation.quaternion());
    format!("pos=\"{x:?} {y:?} {z:?}\" quat=\"{:?} {:?} {:?} {:?}\"", q.w, q.i, q.j, q.k)
}

/// The equality that lets a body's joint follow its coordinate.
fn equality(robot: &Robot, body: usize) -> String {
    let coupling = robot.coupling(body);
    format!(
        "    <joint joint1=\"{}\" joint2=\"{}\" polycoef=\"{:?} {:?} 0 0 0\"/>\n",
        escaped(&robot.body(body).name),
        escaped(&robot.joints[coupling.coordinate].name),
        coupling.offset,
        coupling.multiplier
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::{InertiaCheck, load};

    #[test]
    fn a_robot_comes_back_from_its_model() {
        for file in ["urdf/irb1600_6_120.urdf", "tests/reference/skew7.urdf", "tests/reference/trees/palletiser.xml"] {
            let robot = load(format!("{}/../{file}", env!("CARGO_MANIFEST_DIR")), InertiaCheck::Required).unwrap();
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join("new.xml");
            std::fs::write(&path, to_mjcf(&robot)).unwrap();
            let read = load(&path, InertiaCheck::Required).unwrap();
            assert_eq!((read.joint_names(), read.bodies()), (robot.joint_names(), robot.bodies()), "{file}");
            assert!((read.gravity - robot.gravity).norm() < 1e-12, "{file}");
            let x: Vec<f64> = (0..robot.dof()).map(|k| 0.3 - 0.2 * k as f64).collect();
            // The reader takes no site for a flange.
            for (new, old) in read.frames(&x).iter().zip(robot.frames(&x)).take(robot.bodies()) {
                assert!((new.rotation - old.rotation).norm() < 1e-12, "{file}");
                assert!((new.translation - old.translation).norm() < 1e-12, "{file}");
            }
            for body in 0..robot.bodies() {
                let (new, old) = (read.body(body), robot.body(body));
                assert_eq!((new.kind, new.drive, read.coupling(body)), (old.kind, old.drive, robot.coupling(body)));
                assert_eq!((new.limits.lower, new.limits.upper), (old.limits.lower, old.limits.upper), "{file}");
                let size = old.inertia.0.iter().fold(1.0f64, |most, value| most.max(value.abs()));
                assert!(new.inertia.0.iter().zip(old.inertia.0).all(|(a, b)| (a - b).abs() < 1e-12 * size), "{file}");
            }
        }
    }
}
