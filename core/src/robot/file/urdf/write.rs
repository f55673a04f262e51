//! The URDF of a robot that did not come from one.

use super::super::xml::escaped;
use super::elements::{dynamics, inertial, origin};
use crate::robot::model::{Joint, JointKind, Robot};

/// Names of the link that the first joint is mounted on, and of the link at the flange, unless they are taken.
const BASE: &str = "base_link";
const FLANGE: &str = "flange";

/// A URDF with the joints, limits, bodies and drives of `robot`, and its flange as a link behind a fixed joint. Joints that
/// follow others mimic them. Gravity is not part of a URDF.
pub fn to_urdf(robot: &Robot) -> String {
    let taken = |name: &str| {
        (0..robot.bodies()).any(|body| [&robot.body(body).link, &robot.body(body).name].contains(&&name.to_owned()))
    };
    let free =
        |name: &str| (0..).map(|k| name.to_owned() + &"_".repeat(k)).find(|name| !taken(name)).unwrap_or_default();
    let (base, flange) = (free(BASE), free(FLANGE));
    let carrier = |body: Option<usize>| escaped(body.map_or(&base, |body| &robot.body(body).link));
    let name = escaped(&robot.name);
    let mut text = format!("<?xml version=\"1.0\"?>\n<robot name=\"{name}\">\n  <link name=\"{base}\"/>\n");
    for body in robot.outwards() {
        let coupling = robot.coupling(body);
        let mimic = match body < robot.dof() {
            true => String::new(),
            false => format!(
                "\n    <mimic joint=\"{}\" multiplier=\"{:?}\" offset=\"{:?}\"/>",
                escaped(&robot.joints[coupling.coordinate].name),
                coupling.multiplier,
                coupling.offset
            ),
        };
        text += &moving(robot.body(body), &carrier(robot.parent(body)), &mimic);
    }
    text += &format!(
        "  <joint name=\"{flange}_fixed\" type=\"fixed\">\n    <parent link=\"{}\"/><child link=\"{flange}\"/>\n    \
         {}\n  </joint>\n  <link name=\"{flange}\"/>\n</robot>\n",
        carrier(Some(robot.tip())),
        origin(&robot.flange)
    );
    text
}

/// A moving joint and the link it carries.
fn moving(joint: &Joint, parent: &str, mimic: &str) -> String {
    let Joint { axis, limits, .. } = joint;
    let (name, link) = (escaped(&joint.name), escaped(&joint.link));
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
         <axis xyz=\"{:?} {:?} {:?}\"/>\n    <limit {range}velocity=\"{velocity:?}\" effort=\"{effort:?}\"/>\n    {}{mimic}\n  \
         </joint>\n  <link name=\"{link}\">\n    {}\n  </link>\n",
        origin(&joint.origin),
        axis.x,
        axis.y,
        axis.z,
        dynamics(&joint.drive),
        inertial(&joint.inertia),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::{InertiaCheck, Pose, load};

    #[test]
    fn an_arm_comes_back_from_its_text() {
        for file in ["urdf/irb1600_6_120.urdf", "tests/reference/skew7.urdf", "tests/reference/fixed_links.urdf"] {
            let robot = load(format!("{}/../{file}", env!("CARGO_MANIFEST_DIR")), InertiaCheck::Required).unwrap();
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

    /// A tree with joints that follow others, read from a MuJoCo model, is the same robot when it comes back.
    #[test]
    fn a_tree_comes_back_from_its_text() {
        let path = format!("{}/../tests/reference/trees/palletiser.xml", env!("CARGO_MANIFEST_DIR"));
        let robot = load(path, InertiaCheck::Required).unwrap();
        assert!(!robot.followers().is_empty());
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("new.urdf");
        std::fs::write(&path, crate::robot::with_parameters(&robot).unwrap()).unwrap();
        let read = load(&path, InertiaCheck::Required).unwrap();
        assert_eq!((read.joint_names(), read.bodies()), (robot.joint_names(), robot.bodies()));
        let x: Vec<f64> = (0..robot.dof()).map(|k| 0.3 - 0.2 * k as f64).collect();
        for (new, old) in read.frames(&x).iter().zip(robot.frames(&x)) {
            assert!((new.rotation - old.rotation).norm() < 1e-12 && (new.translation - old.translation).norm() < 1e-12);
        }
        for body in 0..robot.bodies() {
            let (new, old) = (read.body(body), robot.body(body));
            assert_eq!((&new.name, new.drive, read.coupling(body)), (&old.name, old.drive, robot.coupling(body)));
            assert!(new.inertia.0.iter().zip(old.inertia.0).all(|(a, b)| (a - b).abs() < 1e-12 * (1.0 + b.abs())));
        }
    }

    #[test]
    fn names_of_the_file_keep_their_own() {
        let path = format!("{}/../tests/reference/pendulum.urdf", env!("CARGO_MANIFEST_DIR"));
        let mut robot = load(path, InertiaCheck::Required).unwrap();
        robot.joints[0].link = "base_link".to_owned();
        robot.joints[0].name = "a<&\"b".to_owned();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("new.urdf");
        std::fs::write(&path, to_urdf(&robot)).unwrap();
        let read = load(&path, InertiaCheck::Required).unwrap();
        assert_eq!((read.joints[0].name.as_str(), read.joints[0].link.as_str()), ("a<&\"b", "base_link"));
    }
}
