//! A URDF as a description: every link and joint of the file, whatever else it holds.

use super::super::xml::{XmlText, attribute, child, children, line};
use super::elements::{joint_type, pose_of};
use super::{clean, numbers, settled, transmissions, tree};
use crate::error::{Error, Result};
use crate::robot::description::{
    Description, JointDescription, LinkDescription, Mimic, Missing, Motion, settle_mimics,
};
use crate::robot::model::{Addresses, Drive, GRAVITY, Inertia, Limits};
use nalgebra::{Matrix3, Vector3};
use roxmltree::{Document, Node};
use std::collections::HashMap;
use std::path::Path;

/// Friction below zero that is rounding of a fit, N m or N m s/rad: no drive has so little.
const ROUNDING: f64 = 1e-9;

/// Reads a robot from the text of a URDF.
///
/// `armature` of `<dynamics>` (reflected rotor inertia, kg m2) is read as well as the standard `damping` and `friction`.
///
/// # Errors
/// Names file, line and element for: unreadable or malformed files, links and joints that form no tree, numbers that are
/// malformed or not finite, a zero axis, limits that contradict themselves.
pub(crate) fn read(source: XmlText) -> Result<Description> {
    let (source, notes) = settled::of(source)?;
    describe(&source, notes)
}

/// The looks of a URDF: its links and joints with the visual shapes that can be shown.
///
/// # Errors
/// If the file cannot be read any longer.
pub(crate) fn looks(path: &Path) -> Result<urdf_rs::Robot> {
    let (source, _) = settled::settled(path)?;
    parsed(&source, &source.parse()?, true)
}

fn parsed(source: &XmlText, document: &Document, looks: bool) -> Result<urdf_rs::Robot> {
    urdf_rs::read_from_string(&clean::clean(document, looks))
        .map_err(|e| Error::input(&source.path, None, "<robot>", format!("not a URDF that can be read: {e}")))
}

fn describe(source: &XmlText, notes: Vec<String>) -> Result<Description> {
    let document = source.parse()?;
    let root = document.root_element();
    let reader =
        Reader { path: &source.path, links: named(source, &root, "link")?, joints: named(source, &root, "joint")? };
    if reader.links.is_empty() {
        return Err(Error::input(&source.path, None, "<robot>", "there is no link; is this a URDF?"));
    }
    reader.check(&root)?;
    let urdf = parsed(source, &document, false)?;
    let mut description = reader.description(&urdf, notes)?;
    let known = |joint: &str| description.joints.iter().any(|own| own.name == joint);
    description.actuators = transmissions::motors(&root, known);
    Ok(description)
}

/// The named elements of one kind in the order of the file.
fn named<'a, 'i>(source: &XmlText, root: &Node<'a, 'i>, tag: &'static str) -> Result<Vec<(&'a str, Node<'a, 'i>)>> {
    let all = children(root, tag).map(|node| match attribute(&node, "name") {
        Some(name) => Ok((name, node)),
        None => Err(Error::input(&source.path, Some(line(&node)), format!("<{tag}>"), "it has no name; give it one")),
    });
    all.collect()
}

/// The elements of a file.
struct Reader<'a, 'i> {
    path: &'a Path,
    links: Vec<(&'a str, Node<'a, 'i>)>,
    joints: Vec<(&'a str, Node<'a, 'i>)>,
}

impl Reader<'_, '_> {
    fn error(&self, tag: &str, name: &str, node: &Node, problem: impl Into<String>) -> Error {
        Error::input(self.path, Some(line(node)), format!("{tag} `{name}`"), problem)
    }

    /// Checks what must hold before the URDF crate reads the file, so that errors name their place.
    fn check(&self, root: &Node) -> Result<()> {
        for (name, node) in &self.joints {
            let kind = joint_type(node);
            if kind.is_empty() {
                let problem = "it has no type; use revolute, continuous, prismatic or fixed";
                return Err(self.error("joint", name, node, problem));
            }
            for end in ["parent", "child"] {
                if child(node, end).and_then(|end| attribute(&end, "link")).is_none() {
                    return Err(self.error("joint", name, node, format!("it has no <{end} link=\"...\"/>")));
                }
            }
            numbers::check_joint(self.path, node, kind == "fixed")?;
        }
        let moved = tree::moved(root);
        let moving = self.links.iter().filter(|(name, _)| moved.contains(name));
        moving.into_iter().try_for_each(|(_, node)| numbers::check_body(self.path, node))
    }

    fn description(&self, urdf: &urdf_rs::Robot, mut notes: Vec<String>) -> Result<Description> {
        let kept = tree::Tree { path: self.path, links: &self.links, joints: &self.joints }.main(&mut notes)?;
        let index: HashMap<&str, usize> = kept.iter().enumerate().map(|(at, &link)| (self.links[link].0, at)).collect();
        let mut links = Vec::new();
        for &link in &kept {
            links.push(self.link(&self.links[link], &urdf.links[link], &mut notes));
        }
        let mut joints = Vec::new();
        for ((name, node), joint) in self.joints.iter().zip(&urdf.joints) {
            let ends = (index.get(joint.parent.link.as_str()), index.get(joint.child.link.as_str()));
            if let (Some(&parent), Some(&child)) = ends {
                joints.push(self.joint(name, node, joint, [parent, child], &mut notes)?);
            }
        }
        settle_mimics(self.path, &mut joints, &mut notes)?;
        Ok(Description {
            name: self.name(urdf.name.trim()),
            source: self.path.to_owned(),
            gravity: Vector3::from(GRAVITY),
            links,
            joints,
            actuators: Vec::new(),
            addresses: Addresses::default(),
            notes,
        })
    }

    /// The name of the robot, or of its file.
    fn name(&self, given: &str) -> String {
        let file =
            || self.path.file_stem().map_or_else(|| "robot".to_owned(), |stem| stem.to_string_lossy().into_owned());
        if given.is_empty() { file() } else { given.to_owned() }
    }

    fn link(&self, (name, node): &(&str, Node), link: &urdf_rs::Link, notes: &mut Vec<String>) -> LinkDescription {
        let given = &link.inertial;
        let at = pose_of(&given.origin);
        let i = &given.inertia;
        let tensor = Matrix3::new(i.ixx, i.ixy, i.ixz, i.ixy, i.iyy, i.iyz, i.ixz, i.iyz, i.izz);
        let turned = at.rotation * tensor * at.rotation.transpose();
        let inertia = Inertia::from_center_of_mass(given.mass.value, at.translation, turned);
        let inertial = child(node, "inertial");
        if given.mass.value != 0.0 && inertial.is_some_and(|node| child(&node, "inertia").is_none()) {
            let line = inertial.map_or(0, |node| line(&node));
            notes.push(format!("link `{name}` (line {line}) has a mass and no <inertia>: it is taken as a point mass"));
        }
        let missing = inertial.and_then(|inertial| missing(name, &inertial));
        LinkDescription { name: (*name).to_owned(), inertia, missing, gravcomp: 0.0, line: Some(line(node)) }
    }

    fn joint(
        &self,
        name: &str,
        node: &Node,
        joint: &urdf_rs::Joint,
        [parent, child]: [usize; 2],
        notes: &mut Vec<String>,
    ) -> Result<JointDescription> {
        let motion = self.motion(name, node, notes)?;
        let moves = matches!(motion, Motion::Revolute | Motion::Prismatic);
        Ok(JointDescription {
            name: name.to_owned(),
            motion,
            parent,
            child,
            origin: pose_of(&joint.origin),
            axis: if moves { self.axis(name, node, joint)? } else { Vector3::x() },
            limits: self.limits(name, node, joint)?,
            drive: Self::drive(node, joint).credible(name, line(node), notes),
            mimic: joint.mimic.as_ref().filter(|_| moves).map(|mimic| Mimic {
                master: mimic.joint.trim().to_owned(),
                multiplier: mimic.multiplier.unwrap_or(1.0),
                offset: mimic.offset.unwrap_or(0.0),
            }),
            line: Some(line(node)),
        })
    }

    fn motion(&self, name: &str, node: &Node, notes: &mut Vec<String>) -> Result<Motion> {
        match joint_type(node).as_str() {
            "revolute" | "continuous" => Ok(Motion::Revolute),
            "prismatic" => Ok(Motion::Prismatic),
            "fixed" => Ok(Motion::Fixed),
            "floating" => Ok(Motion::Floating),
            "planar" => Ok(Motion::Planar),
            kind @ ("spherical" | "ball" | "universal" | "screw") => {
                notes.push(format!("joint `{name}` (line {}) is {kind}: it is held at zero", line(node)));
                Ok(Motion::Floating)
            }
            kind => {
                let problem = format!("type {kind} is not handled; use revolute, continuous, prismatic or fixed");
                Err(self.error("joint", name, node, problem))
            }
        }
    }

    fn axis(&self, name: &str, node: &Node, joint: &urdf_rs::Joint) -> Result<Vector3<f64>> {
        let axis = Vector3::from(joint.axis.xyz.0);
        axis.try_normalize(1e-9)
            .ok_or_else(|| self.error("joint", name, node, format!("axis {:?} has no direction", axis.as_slice())))
    }

    fn limits(&self, name: &str, node: &Node, joint: &urdf_rs::Joint) -> Result<Limits> {
        let given = &joint.limit;
        let or_infinite = |value: f64| if value > 0.0 { value } else { f64::INFINITY };
        if given.velocity < 0.0 || given.effort < 0.0 {
            let problem =
                format!("limits velocity {} and effort {} must not be negative", given.velocity, given.effort);
            return Err(self.error("joint", name, node, problem));
        }
        // URDF has no way to say "none": left out, both read as zero.
        let absent = given.lower == 0.0 && given.upper == 0.0;
        let unlimited = joint.joint_type == urdf_rs::JointType::Continuous || absent;
        let (lower, upper) = if unlimited { (f64::NEG_INFINITY, f64::INFINITY) } else { (given.lower, given.upper) };
        if lower > upper {
            let problem =
                format!("limits {lower}..{upper}: lower must not exceed upper; exchange them if they are swapped");
            return Err(self.error("joint", name, node, problem));
        }
        Ok(Limits { lower, upper, velocity: or_infinite(given.velocity), effort: or_infinite(given.effort) })
    }

    fn drive(node: &Node, joint: &urdf_rs::Joint) -> Drive {
        let settled = |value: f64| if value < 0.0 && value > -ROUNDING { 0.0 } else { value };
        let (viscous, coulomb) = joint.dynamics.as_ref().map_or((0.0, 0.0), |d| (d.damping, d.friction));
        let armature = child(node, "dynamics").and_then(|dynamics| attribute(&dynamics, "armature"));
        let armature = armature.and_then(|text| text.parse().ok()).unwrap_or(0.0);
        Drive { viscous: settled(viscous), coulomb: settled(coulomb), armature: settled(armature) }
    }
}

/// The first number of a body that the file leaves out.
fn missing(link: &str, inertial: &Node) -> Option<Missing> {
    let absent = |tag: &str, name: &str, line: usize| Missing {
        line,
        field: format!("{name} of <{tag}> in `{link}`"),
        problem: "is missing; add it".to_owned(),
    };
    let Some(mass) = child(inertial, "mass") else { return Some(absent("mass", "value", line(inertial))) };
    if attribute(&mass, "value").is_none() {
        return Some(absent("mass", "value", line(&mass)));
    }
    let inertia = child(inertial, "inertia")?;
    let moment = ["ixx", "iyy", "izz"].into_iter().find(|name| attribute(&inertia, name).is_none())?;
    Some(absent("inertia", moment, line(&inertia)))
}
