//! The URDF of an arm that did not come from one.

use super::super::{Joint, JointKind, Pose, Robot};
use super::edit::{dynamics, inertial};
use nalgebra::Rotation3;

/// Names of the link that the first joint is mounted on, and of the link at the flange.
const BASE: &str = "base_link";
const FLANGE: &str = "flange";

/// A URDF with the joints, limits, bodies and drives of `robot`, and its flange as a link behind a fixed joint; joints that
/// follow others mimic them. Gravity is not part of a URDF; names must not need escaping.
pub fn to_urdf(robot: &Robot) -> String {
    let mut text = format!("<?xml version=\"1.0\"?>\n<robot name=\"{}\">\n  <link name=\"{BASE}\"/>\n", robot.name);
    for body in robot.outwards() {
        let parent = robot.parent(body).map_or(BASE, |parent| &robot.body(parent).link);
        let coupling = robot.coupling(body);
        let follows = (body >= robot.dof()).then(|| {
            format!(
                "    <mimic joint=\"{}\" multiplier=\"{:?}\" offset=\"{:?}\"/>\n",
                robot.joints[coupling.coordinate].name, coupling.multiplier, coupling.offset
            )
        });
        text += &moving(robot.body(body), parent, &follows.unwrap_or_default());
    }
    text += &format!(
        "  <joint name=\"{FLANGE}_fixed\" type=\"fixed\">\n    <parent link=\"{}\"/><child link=\"{FLANGE}\"/>\n    \
         {}\n  </joint>\n  <link name=\"{FLANGE}\"/>\n</robot>\n",
        robot.body(robot.tip()).link,
        origin(&robot.flange)
    );
    text
}

/// A moving joint and the link it carries.
fn moving(joint: &Joint, parent: &str, follows: &str) -> String {
    let Joint { name, link, axis, limits, .. } = joint;
    let kind = match joint.kind {
        JointKind::Revolute => "revolute",
        JointKind::Prismatic => "prismatic",
    };
    // A URDF says zero where there is no limit.
    let or_zero = |value: f64| if value.is_finite() { value } else { 0.0 };
    let (velocity, effort) = (or_zero(limits.velocity), or_zero(limits.effort));
    let (kind, range) = match limits.lower.is_finite() && limits.upper.is_finite() {
        true => (kind, format!("lower=\"{:?}\" upper=\"{:?}\" ", limits.lower, limits.upper)),
        false => (if kind == "revolute" { "continuous" } else { kind }, String::new()),
    };
    format!(
        "  <joint name=\"{name}\" type=\"{kind}\">\n    <parent link=\"{parent}\"/><child link=\"{link}\"/>\n    {}\n    \
         <axis xyz=\"{:?} {:?} {:?}\"/>\n    <limit {range}velocity=\"{velocity:?}\" effort=\"{effort:?}\"/>\n    {}\n{follows}  \
         </joint>\n  <link name=\"{link}\">\n    {}\n  </link>\n",
        origin(&joint.origin),
        axis.x,
        axis.y,
        axis.z,
        dynamics(&joint.drive),
        inertial(&joint.inertia),
    )
}

/// A pose as fixed-axis roll, pitch and yaw, the URDF's convention.
pub(super) fn origin(pose: &Pose) -> String {
    let (roll, pitch, yaw) = Rotation3::from_matrix_unchecked(pose.rotation).euler_angles();
    let [x, y, z]: [f64; 3] = pose.translation.into();
    format!("<origin xyz=\"{x:?} {y:?} {z:?}\" rpy=\"{roll:?} {pitch:?} {yaw:?}\"/>")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::{InertiaCheck, load};

    #[test]
    fn an_arm_comes_back_from_its_text() {
        for file in ["urdf/irb1600_6_120.urdf", "tests/reference/skew7.urdf", "tests/reference/fixed_links.urdf"] {
            let robot = load(format!("{}/{file}", env!("CARGO_MANIFEST_DIR")), InertiaCheck::Required).unwrap();
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join("new.urdf");
            std::fs::write(&path, to_urdf(&robot)).unwrap();
            let read = load(&path, InertiaCheck::Required).unwrap();
            assert_eq!(read.joint_names(), robot.joint_names(), "{file}");
            for (new, old) in read.joints.iter().zip(&robot.joints) {
                assert_eq!((new.kind, new.drive, new.limits), (old.kind, old.drive, old.limits), "{file} {}", old.name);
                assert!((new.axis - old.axis).norm() < 1e-14, "{file} {}", old.name);
                let size = old.inertia.0.iter().fold(1.0f64, |most, value| most.max(value.abs()));
                assert!(new.inertia.0.iter().zip(old.inertia.0).all(|(a, b)| (a - b).abs() < 1e-13 * size));
            }
            let poses = |robot: &Robot| robot.joints.iter().map(|joint| joint.origin).chain([robot.flange]).collect();
            let (new, old): (Vec<Pose>, Vec<Pose>) = (poses(&read), poses(&robot));
            for (new, old) in new.iter().zip(&old) {
                assert!((new.rotation - old.rotation).norm() < 1e-13, "{file}");
                assert!((new.translation - old.translation).norm() < 1e-13, "{file}");
            }
        }
    }
}
