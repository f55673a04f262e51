//! A URDF with other inertias and drives, everything else as it was.

use super::super::xml::{attribute, child, children};
use super::edits::{Edit, applied};
use super::elements::{dynamics, inertial, joint_type, origin};
use super::settled::settled;
use super::write::to_urdf;
use crate::error::{Error, Result};
use crate::robot::model::{JointKind, Pose, Robot, TEXT};
use roxmltree::Node;
use std::collections::{HashMap, HashSet};
use std::path::Path;

/// The text of the robot's URDF with the bodies and drives of `robot`. Each body goes to the link that its joint carries;
/// links that move as one with that one lose theirs. `friction`, `damping` and `armature` go to `<dynamics>`; those of a joint
/// that follows another are in the other's. Joints that are held become fixed where they stand. A robot that did not come
/// from the file of a URDF is written as one.
///
/// # Errors
/// If the file `robot` came from cannot be read any longer or does not have its joints.
pub fn with_parameters(robot: &Robot) -> Result<String> {
    let path = &robot.source;
    if path == Path::new(TEXT) {
        return Ok(to_urdf(robot));
    }
    let (source, _) = settled(path)?;
    let (text, document) = (&source.text, source.parse()?);
    let root = document.root_element();
    if root.has_tag_name("mujoco") {
        return Ok(to_urdf(robot));
    }
    let elements = |tag: &'static str| {
        let named = children(&root, tag).filter_map(|node| Some((attribute(&node, "name")?.to_owned(), node)));
        named.collect::<HashMap<_, _>>()
    };
    let (links, joints) = (elements("link"), elements("joint"));
    let missing = |tag: &str, name: &str| Error::input(path, None, format!("{tag} `{name}`"), "is not there");
    let mut edits: Vec<Edit> = Vec::new();
    for body in 0..robot.bodies() {
        let joint = robot.body(body);
        let link = links.get(&joint.link).ok_or_else(|| missing("link", &joint.link))?;
        edits.push(with_child(text, *link, "inertial", &inertial(&joint.inertia)));
        let element = joints.get(&joint.name).ok_or_else(|| missing("joint", &joint.name))?;
        edits.push(with_child(text, *element, "dynamics", &dynamics(&joint.drive)));
        edits.extend(mimicry(text, *element, robot, body));
    }
    for name in welded_behind(robot, &joints) {
        let inertial = links.get(&name).and_then(|link| child(link, "inertial"));
        edits.extend(inertial.map(|inertial| (inertial.range(), String::new())));
    }
    for (name, position) in &robot.held {
        let element = joints.get(name).ok_or_else(|| missing("joint", name))?;
        edits.extend(fixed_at(text, *element, *position));
    }
    edits.sort_by_key(|(range, _)| (range.start, range.end));
    if edits.windows(2).any(|pair| pair[1].0.start < pair[0].0.end) {
        let problem = "one entity of its document type stands for parts of several links; write them out";
        return Err(Error::input(path, None, "<robot>", problem));
    }
    Ok(applied(text, edits))
}

/// The edits that let the joint of a body mimic what it follows, if that is not what the file says.
fn mimicry(text: &str, joint: Node, robot: &Robot, body: usize) -> Option<Edit> {
    let coupling = robot.coupling(body);
    let old = child(&joint, "mimic");
    if body < robot.dof() {
        return old.map(|old| (old.range(), String::new()));
    }
    let master = &robot.joints[coupling.coordinate].name;
    let new = format!(
        "<mimic joint=\"{master}\" multiplier=\"{:?}\" offset=\"{:?}\"/>",
        coupling.multiplier, coupling.offset
    );
    Some(with_child(text, joint, "mimic", &new))
}

/// The edits that fix a joint at a position.
fn fixed_at(text: &str, joint: Node, position: f64) -> Vec<Edit> {
    let mut edits = Vec::new();
    let kind = if joint_type(&joint) == "prismatic" { JointKind::Prismatic } else { JointKind::Revolute };
    edits.extend(joint.attribute_node("type").map(|kind| (kind.range_value(), "fixed".to_owned())));
    edits.extend(child(&joint, "mimic").map(|mimic| (mimic.range(), String::new())));
    if position != 0.0 {
        let numbers = |element: &Node, name: &str, otherwise: [f64; 3]| {
            let words = attribute(element, name).unwrap_or_default().split_whitespace();
            let values: Vec<f64> = words.filter_map(|word| word.parse().ok()).collect();
            <[f64; 3]>::try_from(values).unwrap_or(otherwise)
        };
        let given = child(&joint, "origin")
            .map_or([[0.0; 3]; 2], |origin| [numbers(&origin, "xyz", [0.0; 3]), numbers(&origin, "rpy", [0.0; 3])]);
        let axis = child(&joint, "axis").map_or([1.0, 0.0, 0.0], |axis| numbers(&axis, "xyz", [1.0, 0.0, 0.0]));
        let axis = nalgebra::Unit::new_normalize(nalgebra::Vector3::from(axis));
        let [xyz, [roll, pitch, yaw]] = given;
        let rotation = nalgebra::Rotation3::from_euler_angles(roll, pitch, yaw).into_inner();
        let place = Pose { rotation, translation: xyz.into() }.then(&kind.motion(&axis, position));
        edits.push(with_child(text, joint, "origin", &origin(&place)));
    }
    edits
}

/// Links that move as one with a moving one, not being its joint's own.
fn welded_behind(robot: &Robot, joints: &HashMap<String, Node>) -> Vec<String> {
    let end =
        |joint: &Node, tag: &str| child(joint, tag).and_then(|end| attribute(&end, "link")).unwrap_or("").to_owned();
    let moving: HashSet<&str> = (0..robot.bodies()).map(|body| robot.body(body).name.as_str()).collect();
    let mut welded: HashMap<String, Vec<String>> = HashMap::new();
    for (_, joint) in joints.iter().filter(|(name, _)| !moving.contains(name.as_str())) {
        welded.entry(end(joint, "parent")).or_default().push(end(joint, "child"));
    }
    let mut open: Vec<String> = (0..robot.bodies()).map(|body| robot.body(body).link.clone()).collect();
    let mut found = Vec::new();
    while let Some(link) = open.pop() {
        for child in welded.remove(&link).unwrap_or_default() {
            open.push(child.clone());
            found.push(child);
        }
    }
    found
}

/// The edit that gives an element a child, in place of one with the same tag.
fn with_child(text: &str, node: Node, tag: &str, new: &str) -> Edit {
    if let Some(old) = child(&node, tag) {
        return (old.range(), new.to_owned());
    }
    let range = node.range();
    if let Some(first) = node.first_element_child() {
        let start = first.range().start;
        return (start..start, format!("{new}\n    "));
    }
    let own = &text[range.clone()];
    match own.strip_suffix("/>") {
        Some(open) => (range, format!("{}>{new}</{}>", open.trim_end(), node.tag_name().name())),
        None => {
            let end = range.start + own.rfind("</").unwrap_or(own.len());
            (end..end, new.to_owned())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::{Drive, InertiaCheck, load};

    fn round_trip(file: &str) {
        let mut robot = load(format!("{}/../{file}", env!("CARGO_MANIFEST_DIR")), InertiaCheck::Required).unwrap();
        for (k, joint) in robot.joints.iter_mut().enumerate() {
            let factor = 1.3 + 0.1 * k as f64;
            joint.inertia.0.iter_mut().for_each(|value| *value *= factor);
            joint.drive = Drive { viscous: 0.1 * factor, coulomb: 0.2 * factor, armature: 0.3 * factor };
        }
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("new.urdf");
        std::fs::write(&path, with_parameters(&robot).unwrap()).unwrap();
        let read = load(&path, InertiaCheck::Required).unwrap();
        for (new, old) in read.joints.iter().zip(&robot.joints) {
            assert_eq!((new.drive, &new.name, new.limits), (old.drive, &old.name, old.limits));
            for (a, b) in new.inertia.0.iter().zip(old.inertia.0) {
                assert!((a - b).abs() < 1e-13 * old.inertia.0.iter().fold(1.0f64, |m, v| m.max(v.abs())), "{a} {b}");
            }
        }
    }

    /// What a lenient reader takes is edited in place, with full digits and in SI where it was recognised otherwise.
    #[test]
    fn a_file_that_had_to_be_corrected_is_edited_too() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("arm.urdf");
        let text = "\u{feff}<!DOCTYPE robot [<!ENTITY m \"3.5\">]>\r\n<robot name=\"a\">\r\n<link name=\"b\"/>\r\n\
            <link name=\"l\"><inertial><mass value=\"&m;\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"1\"/></inertial></link>\r\n\
            <joint name=\"j\" type=\"continuous\"><parent link=\"b\"/><child link=\"l\"/><origin rpy=\"1.5708 0 0\"/></joint>\r\n\
            <gazebo><sensor:camera name=\"c\"/></gazebo></robot>";
        std::fs::write(&path, text).unwrap();
        let mut robot = load(&path, InertiaCheck::Required).unwrap();
        assert_eq!(robot.joints[0].inertia.mass(), 3.5);
        robot.joints[0].inertia.0[0] = 7.0;
        let edited = with_parameters(&robot).unwrap();
        std::fs::write(&path, &edited).unwrap();
        let read = load(&path, InertiaCheck::Ignored).unwrap();
        assert_eq!((read.joints[0].inertia.mass(), read.joints[0].origin), (7.0, robot.joints[0].origin));
        assert!(edited.contains("1.5707963267948966 0 0") && edited.contains("<sensor:camera"), "{edited}");
    }

    #[test]
    fn bodies_and_drives_come_back() {
        round_trip("urdf/irb1600_6_120.urdf");
        round_trip("tests/reference/skew7.urdf");
        round_trip("tests/reference/fixed_links.urdf");
    }

    /// Fingers that are held are part of the hand: their mass is written once.
    #[test]
    fn what_is_held_is_written_with_what_carries_it() {
        let path = format!("{}/../tests/reference/trees/two_finger.urdf", env!("CARGO_MANIFEST_DIR"));
        let file = crate::robot::description::read(path.as_ref()).unwrap();
        let moving: Vec<String> = file.masters().iter().map(|joint| joint.name.clone()).collect();
        let fingers = |name: &String| name.contains("finger");
        assert!(moving.iter().any(fingers), "{moving:?}");
        let joints = moving.into_iter().filter(|name| !fingers(name)).collect();
        let choice = crate::robot::Choice { joints: Some(joints), ..Default::default() };
        let arm = file.robot(&choice, InertiaCheck::Required).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("new.urdf");
        std::fs::write(&path, with_parameters(&arm).unwrap()).unwrap();
        let read = crate::robot::description::read(&path).unwrap().robot(&choice, InertiaCheck::Required).unwrap();
        for (new, old) in read.joints.iter().zip(&arm.joints) {
            assert!(new.inertia.0.iter().zip(old.inertia.0).all(|(a, b)| (a - b).abs() < 1e-12), "{new:?} {old:?}");
        }
    }
}
