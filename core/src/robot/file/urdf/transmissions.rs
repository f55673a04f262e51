//! Motors that a URDF names: `<transmission>` of ROS, by itself or within `<ros2_control>`.

use super::super::xml::{attribute, child, children};
use crate::robot::model::Actuator;
use roxmltree::Node;

/// The motors of transmissions that move one joint each, of those `known`. Names are all that is needed: what else is malformed refuses no
/// robot.
pub(super) fn motors(root: &Node, known: impl Fn(&str) -> bool) -> Vec<Actuator> {
    let within =
        children(root, "ros2_control").flat_map(|section| children(&section, "transmission").collect::<Vec<_>>());
    let all = children(root, "transmission").chain(within);
    all.filter_map(|transmission| motor(&transmission)).filter(|motor| known(&motor.joint)).collect()
}

fn motor(transmission: &Node) -> Option<Actuator> {
    let only = |tag: &'static str| {
        let mut all = children(transmission, tag);
        all.next().filter(|_| all.next().is_none())
    };
    let (joint, actuator) = (only("joint")?, only("actuator")?);
    let named = |node: &Node| attribute(node, "name").map(str::to_owned);
    let reduction = |node: &Node| {
        let given = ["mechanicalReduction", "mechanical_reduction"].iter().find_map(|tag| child(node, tag))?;
        given.text()?.trim().parse::<f64>().ok().filter(|gear| gear.is_finite() && *gear != 0.0)
    };
    let gears = [&actuator, &joint, transmission].into_iter().filter_map(reduction);
    Some(Actuator { name: named(&actuator)?, joint: named(&joint)?, gear: gears.product() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use roxmltree::Document;

    #[test]
    fn motors_have_names_joints_and_gears() {
        let text = "<robot>
            <transmission name=\"a\"><joint name=\"elbow\"><hardwareInterface/></joint>
              <actuator name=\"m1\"><mechanicalReduction> 50 </mechanicalReduction></actuator></transmission>
            <transmission name=\"b\"><actuator name=\"m2\"/><joint name=\"wrist\"/><mechanicalReduction>-2</mechanicalReduction></transmission>
            <ros2_control><transmission name=\"c\"><actuator name=\"m3\" role=\"actuator1\"/>
              <joint name=\"hand\" role=\"joint1\"><mechanical_reduction>x</mechanical_reduction></joint></transmission></ros2_control>
            <transmission name=\"two joints\"><joint name=\"elbow\"/><joint name=\"wrist\"/><actuator name=\"m4\"/></transmission>
            <transmission name=\"no motor\"><joint name=\"elbow\"/></transmission>
            <transmission name=\"other\"><joint name=\"unknown\"/><actuator name=\"m5\"/></transmission></robot>";
        let document = Document::parse(text).unwrap();
        let found = motors(&document.root_element(), |joint| joint != "unknown");
        let of = |name: &str, joint: &str, gear: f64| Actuator { name: name.into(), joint: joint.into(), gear };
        assert_eq!(found, [of("m1", "elbow", 50.0), of("m2", "wrist", -2.0), of("m3", "hand", 1.0)]);
    }
}
