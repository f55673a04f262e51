//! The sizes of the robot in a URDF as it is printed: what its units are recognised by.

use super::super::super::xml::{attribute, child, children, words};
use super::super::elements::joint_type;
use roxmltree::{Document, Node};
use std::collections::HashMap;

/// A joint with the numbers its file gives it.
pub(super) struct JointNumbers<'a, 'i> {
    /// Its element.
    pub node: Node<'a, 'i>,
    /// Type in lower case.
    pub kind: String,
    /// Distance of its frame from the parent's.
    pub length: f64,
    /// Lower and upper limit.
    pub range: Option<[f64; 2]>,
    /// Highest speed.
    pub speed: Option<f64>,
}

/// A body with the numbers its file gives it.
pub(super) struct BodyNumbers<'a, 'i> {
    /// Its inertial element.
    pub node: Node<'a, 'i>,
    /// Mass.
    pub mass: f64,
    /// Distance of the centre of mass from the link frame.
    pub center: f64,
    /// ixx, iyy, izz.
    pub moments: [f64; 3],
}

/// The numbers of all joints and bodies, and the longest way from a root to a leaf.
pub(super) struct Sizes<'a, 'i> {
    pub joints: Vec<JointNumbers<'a, 'i>>,
    pub bodies: Vec<BodyNumbers<'a, 'i>>,
    pub reach: f64,
}

impl<'a, 'i> Sizes<'a, 'i> {
    /// Reads what numbers there are; what is malformed counts as absent.
    pub(super) fn of(document: &'a Document<'i>) -> Self {
        let root = document.root_element();
        let joints: Vec<JointNumbers> = children(&root, "joint").map(|node| joint(node)).collect();
        let inertials = children(&root, "link").filter_map(|link| child(&link, "inertial"));
        Sizes { reach: reach(&joints), bodies: inertials.map(body).collect(), joints }
    }
}

/// The numbers of an attribute; None if one of its words is none.
pub(super) fn numbers(node: &Node, name: &str) -> Option<Vec<f64>> {
    words(attribute(node, name)?).map(|word| word.parse::<f64>().ok().filter(|value| value.is_finite())).collect()
}

/// The middle of a list; None if it is empty.
pub(super) fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

fn joint<'a, 'i>(node: Node<'a, 'i>) -> JointNumbers<'a, 'i> {
    let limit = child(&node, "limit");
    let one = |name: &str| limit.and_then(|limit| numbers(&limit, name)).and_then(|values| values.first().copied());
    JointNumbers {
        kind: joint_type(&node),
        length: child(&node, "origin").map_or(0.0, |origin| distance(&origin)),
        range: one("lower").zip(one("upper")).map(|(lower, upper)| [lower, upper]),
        speed: one("velocity"),
        node,
    }
}

fn body<'a, 'i>(node: Node<'a, 'i>) -> BodyNumbers<'a, 'i> {
    let one = |tag: &str, name: &str| {
        let value = child(&node, tag).and_then(|element| numbers(&element, name));
        value.and_then(|values| values.first().copied()).unwrap_or(0.0)
    };
    BodyNumbers {
        mass: one("mass", "value"),
        center: child(&node, "origin").map_or(0.0, |origin| distance(&origin)),
        moments: ["ixx", "iyy", "izz"].map(|name| one("inertia", name)),
        node,
    }
}

fn distance(origin: &Node) -> f64 {
    numbers(origin, "xyz").map_or(0.0, |xyz| xyz.iter().map(|value| value * value).sum::<f64>().sqrt())
}

/// The longest sum of lengths from a link without a joint above it to any other.
fn reach(joints: &[JointNumbers]) -> f64 {
    let end = |joint: &JointNumbers<'_, '_>, tag: &str| {
        child(&joint.node, tag).and_then(|end| attribute(&end, "link")).unwrap_or_default().to_owned()
    };
    let mut below: HashMap<String, Vec<usize>> = HashMap::new();
    for (index, joint) in joints.iter().enumerate() {
        below.entry(end(joint, "parent")).or_default().push(index);
    }
    let ends: Vec<String> = joints.iter().map(|joint| end(joint, "child")).collect();
    let mut open: Vec<(&str, f64)> =
        below.keys().filter(|&link| !ends.contains(link)).map(|link| (&**link, 0.0)).collect();
    let (mut longest, mut steps) = (0.0f64, 0);
    while let Some((link, way)) = open.pop() {
        longest = longest.max(way);
        for &joint in below.get(link).into_iter().flatten() {
            steps += 1;
            // A file whose links have several parents is refused later; its ways are not counted out.
            if steps <= joints.len() {
                open.push((&ends[joint], way + joints[joint].length));
            }
        }
    }
    longest
}
