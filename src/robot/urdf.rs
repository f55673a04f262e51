//! URDF to [`Robot`]: any serial arm of revolute and prismatic joints; links behind fixed joints are merged.

use super::urdf_numbers;
use super::{Drive, GRAVITY, Inertia, Joint, JointKind, Limits, Pose, Robot};
use crate::error::{Error, Result};
use nalgebra::{Matrix3, Rotation3, Vector3};
use std::collections::HashMap;
use std::path::Path;

/// Relative violation of the triangle inequality that passes as rounding in the file.
const ROUNDING: f64 = 1e-3;

/// Whether the inertias in a URDF are used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InertiaCheck {
    /// They are believed: an impossible one is an error.
    Required,
    /// They will be identified or are placeholders: only numbers that are not finite are an error.
    Ignored,
}

/// Loads a serial arm from a URDF file.
///
/// `armature` of `<dynamics>` (reflected rotor inertia, kg m2) is read beside the standard `damping` and `friction`.
///
/// # Errors
/// Names file, line and element for: unreadable or malformed files, a branching or cyclic chain, joint types other than
/// revolute, continuous, prismatic and fixed, mimic joints, a zero axis, numbers that are not finite, negative masses,
/// and inertias that no body can have.
pub fn load(path: impl AsRef<Path>, inertias: InertiaCheck) -> Result<Robot> {
    let path = path.as_ref();
    let text = std::fs::read_to_string(path).map_err(|e| Error::io(path, "read the URDF", e))?;
    let document = roxmltree::Document::parse(&text)
        .map_err(|e| Error::input(path, Some(e.pos().row as usize), "XML", format!("not well-formed: {e}")))?;
    let lines = Lines { path, document: &document };
    urdf_numbers::check(path, &document)?;
    let urdf = urdf_rs::read_from_string(&text)
        .map_err(|e| Error::input(path, None, "<robot>", format!("not a URDF that can be read: {e}")))?;
    let chain = Chain { urdf: &urdf, lines: &lines };
    chain.check_tree()?;
    chain.walk(inertias)
}

/// Finds elements of the file, for error messages and for attributes that urdf-rs does not know.
struct Lines<'a> {
    path: &'a Path,
    document: &'a roxmltree::Document<'a>,
}

impl<'a> Lines<'a> {
    fn element(&self, tag: &str, name: &str) -> Option<roxmltree::Node<'a, 'a>> {
        self.document
            .root_element()
            .children()
            .find(|node| node.has_tag_name(tag) && node.attribute("name").map(str::trim) == Some(name))
    }

    fn error(&self, tag: &str, name: &str, problem: impl Into<String>) -> Error {
        let line = self.element(tag, name).map(|node| self.document.text_pos_at(node.range().start).row as usize);
        Error::input(self.path, line, format!("{tag} `{name}`"), problem)
    }

    fn armature(&self, joint: &str) -> Result<f64> {
        let attribute = self
            .element("joint", joint)
            .and_then(|node| node.children().find(|child| child.has_tag_name("dynamics")))
            .and_then(|dynamics| dynamics.attribute("armature"));
        let Some(text) = attribute else { return Ok(0.0) };
        match text.trim().parse::<f64>() {
            Ok(value) if value.is_finite() && value >= 0.0 => Ok(value),
            _ => {
                Err(self.error("joint", joint, format!("armature=\"{text}\" must be a number of zero or more, kg m2")))
            }
        }
    }
}

/// The links and joints of a file, walked from the root to the flange.
struct Chain<'a> {
    urdf: &'a urdf_rs::Robot,
    lines: &'a Lines<'a>,
}

impl<'a> Chain<'a> {
    /// Every link named once, every joint between known links, one parent per link, one root that reaches all.
    fn check_tree(&self) -> Result<()> {
        let mut parent: HashMap<&str, &str> = HashMap::new();
        let mut links: HashMap<&str, usize> = HashMap::new();
        for link in &self.urdf.links {
            if links.insert(&link.name, 0).is_some() {
                return Err(self.lines.error("link", &link.name, "two links have this name; rename one"));
            }
        }
        let mut joints: HashMap<&str, usize> = HashMap::new();
        for (index, joint) in self.urdf.joints.iter().enumerate() {
            if joints.insert(&joint.name, index).is_some() {
                return Err(self.lines.error("joint", &joint.name, "two joints have this name; rename one"));
            }
            for end in [&joint.parent.link, &joint.child.link] {
                if !links.contains_key(end.as_str()) {
                    return Err(self.lines.error("joint", &joint.name, format!("there is no link `{end}`")));
                }
            }
            if let Some(other) = parent.insert(&joint.child.link, &joint.name) {
                return Err(self.lines.error(
                    "joint",
                    &joint.name,
                    format!("link `{}` already hangs on joint `{other}`: a closed loop; cut it open", joint.child.link),
                ));
            }
        }
        if links.is_empty() {
            return Err(Error::input(self.lines.path, None, "<robot>", "there is no link; is this a URDF?"));
        }
        let roots: Vec<&str> =
            self.urdf.links.iter().map(|l| l.name.as_str()).filter(|name| !parent.contains_key(name)).collect();
        let [root] = roots[..] else {
            let problem = if roots.is_empty() {
                "every link has a parent: the joints form a cycle; cut it open".to_owned()
            } else {
                format!("{} links have no parent ({}); an arm has one base", roots.len(), roots.join(", "))
            };
            return Err(Error::input(self.lines.path, None, "<robot>", problem));
        };
        let mut reached = 0;
        let mut open = vec![root];
        while let Some(link) = open.pop() {
            reached += 1;
            open.extend(self.children(link).map(|joint| joint.child.link.as_str()));
        }
        if reached < links.len() {
            return Err(Error::input(
                self.lines.path,
                None,
                "<robot>",
                format!("{} links are not reached from `{root}`: their joints form a cycle", links.len() - reached),
            ));
        }
        Ok(())
    }

    fn children(&self, link: &str) -> impl Iterator<Item = &'a urdf_rs::Joint> {
        self.urdf.joints.iter().filter(move |joint| joint.parent.link == link)
    }

    /// Follows the moving joints from the root, merging what is fixed.
    fn walk(&self, inertias: InertiaCheck) -> Result<Robot> {
        let child_links: Vec<&str> = self.urdf.joints.iter().map(|j| j.child.link.as_str()).collect();
        let root = self.urdf.links.iter().find(|l| !child_links.contains(&l.name.as_str())).map_or("", |l| &l.name);
        let mut body = self.body(root, inertias)?;
        let mut joints = Vec::new();
        while let Some((mount, joint)) = body.next.take() {
            let kind = self.kind(joint)?;
            body = self.body(&joint.child.link, inertias)?;
            let frame = pose(&joint.origin, |problem| self.lines.error("joint", &joint.name, problem))?;
            joints.push(Joint {
                name: joint.name.clone(),
                link: joint.child.link.clone(),
                kind,
                origin: mount.then(&frame),
                axis: self.axis(joint)?,
                limits: self.limits(joint)?,
                inertia: body.inertia,
                drive: self.drive(joint)?,
            });
        }
        if joints.is_empty() {
            return Err(Error::input(self.lines.path, None, "<robot>", "the arm has no moving joint"));
        }
        Ok(Robot {
            name: self.urdf.name.trim().to_owned(),
            source: self.lines.path.to_owned(),
            gravity: Vector3::from(GRAVITY),
            joints,
            flange: body.tip,
            tree: None,
        })
    }

    /// The rigid body that starts at `link`: the link and everything fixed to it, in that link's frame.
    fn body(&self, link: &str, inertias: InertiaCheck) -> Result<Body<'a>> {
        let mut body = Body { inertia: Inertia::default(), next: None, tip: Pose::identity() };
        let mut open = vec![(link.to_owned(), Pose::identity(), 0)];
        let mut deepest = 0;
        while let Some((name, place, depth)) = open.pop() {
            let own = self.inertia(&name, inertias)?;
            body.inertia = body.inertia.welded_to(&own.seen_from_parent(&place.rotation, &place.translation));
            if depth > deepest {
                (deepest, body.tip) = (depth, place);
            }
            for joint in self.children(&name) {
                if joint.joint_type == urdf_rs::JointType::Fixed {
                    let step = pose(&joint.origin, |problem| self.lines.error("joint", &joint.name, problem))?;
                    open.push((joint.child.link.clone(), place.then(&step), depth + 1));
                } else if let Some((_, other)) = body.next.replace((place, joint)) {
                    return Err(self.lines.error(
                        "joint",
                        &joint.name,
                        format!(
                            "the chain branches: `{}` moves the same body; only serial arms are handled",
                            other.name
                        ),
                    ));
                }
            }
        }
        Ok(body)
    }

    fn kind(&self, joint: &urdf_rs::Joint) -> Result<JointKind> {
        if joint.mimic.is_some() {
            return Err(self.lines.error("joint", &joint.name, "mimic joints are not handled; make it fixed"));
        }
        match joint.joint_type {
            urdf_rs::JointType::Revolute | urdf_rs::JointType::Continuous => Ok(JointKind::Revolute),
            urdf_rs::JointType::Prismatic => Ok(JointKind::Prismatic),
            _ => Err(self.lines.error(
                "joint",
                &joint.name,
                format!("type {:?} is not handled; use revolute, continuous, prismatic or fixed", joint.joint_type)
                    .to_lowercase(),
            )),
        }
    }

    fn axis(&self, joint: &urdf_rs::Joint) -> Result<Vector3<f64>> {
        let axis = Vector3::from(joint.axis.xyz.0);
        axis.try_normalize(1e-9).filter(|unit| unit.iter().all(|v| v.is_finite())).ok_or_else(|| {
            self.lines.error("joint", &joint.name, format!("axis {:?} has no direction", axis.as_slice()))
        })
    }

    fn limits(&self, joint: &urdf_rs::Joint) -> Result<Limits> {
        let given = &joint.limit;
        let or_infinite = |value: f64| if value > 0.0 { value } else { f64::INFINITY };
        if given.velocity < 0.0 || given.effort < 0.0 {
            let problem =
                format!("limits velocity {} and effort {} must not be negative", given.velocity, given.effort);
            return Err(self.lines.error("joint", &joint.name, problem));
        }
        // URDF has no way to say "none": left out, both read as zero.
        let absent = given.lower == 0.0 && given.upper == 0.0;
        let unlimited = joint.joint_type == urdf_rs::JointType::Continuous || absent;
        let (lower, upper) = if unlimited { (f64::NEG_INFINITY, f64::INFINITY) } else { (given.lower, given.upper) };
        if [lower, upper, given.velocity, given.effort].iter().any(|v| v.is_nan()) || lower > upper {
            let problem = format!("limits {lower}..{upper}: lower must not exceed upper, and none may be NaN");
            return Err(self.lines.error("joint", &joint.name, problem));
        }
        Ok(Limits { lower, upper, velocity: or_infinite(given.velocity), effort: or_infinite(given.effort) })
    }

    fn drive(&self, joint: &urdf_rs::Joint) -> Result<Drive> {
        let (viscous, coulomb) = joint.dynamics.as_ref().map_or((0.0, 0.0), |d| (d.damping, d.friction));
        for (value, attribute) in [(viscous, "damping"), (coulomb, "friction")] {
            if !(value.is_finite() && value >= 0.0) {
                let problem = format!("{attribute} {value} of <dynamics> must be a number of zero or more");
                return Err(self.lines.error("joint", &joint.name, problem));
            }
        }
        Ok(Drive { viscous, coulomb, armature: self.lines.armature(&joint.name)? })
    }

    fn inertia(&self, link: &str, check: InertiaCheck) -> Result<Inertia> {
        let Some(given) = self.urdf.links.iter().find(|l| l.name == link).map(|l| &l.inertial) else {
            return Ok(Inertia::default());
        };
        let at = pose(&given.origin, |problem| self.lines.error("link", link, problem))?;
        let i = &given.inertia;
        let tensor = Matrix3::new(i.ixx, i.ixy, i.ixz, i.ixy, i.iyy, i.iyz, i.ixz, i.iyz, i.izz);
        let turned = at.rotation * tensor * at.rotation.transpose();
        let inertia = Inertia::from_center_of_mass(given.mass.value, at.translation, turned);
        let fault = match check {
            InertiaCheck::Required => inertia.physical_fault(ROUNDING),
            InertiaCheck::Ignored => {
                inertia.0.iter().any(|v| !v.is_finite()).then(|| "an inertial number is not finite".to_owned())
            }
        };
        fault.map_or(Ok(inertia), |problem| Err(self.lines.error("link", link, problem)))
    }
}

/// A rigid body with the moving joint it carries, and the pose of the link behind the most fixed joints.
struct Body<'a> {
    inertia: Inertia,
    next: Option<(Pose, &'a urdf_rs::Joint)>,
    tip: Pose,
}

/// URDF pose: fixed-axis roll, pitch, yaw.
fn pose(given: &urdf_rs::Pose, error: impl Fn(String) -> Error) -> Result<Pose> {
    if given.xyz.0.iter().chain(&given.rpy.0).any(|v| !v.is_finite()) {
        return Err(error(format!("origin xyz {:?} rpy {:?} must be finite", given.xyz.0, given.rpy.0)));
    }
    Ok(pose_of(given))
}

/// URDF pose whose numbers are known to be finite, or do not matter.
pub(super) fn pose_of(given: &urdf_rs::Pose) -> Pose {
    let ([x, y, z], [roll, pitch, yaw]) = (given.xyz.0, given.rpy.0);
    Pose { rotation: Rotation3::from_euler_angles(roll, pitch, yaw).into_inner(), translation: Vector3::new(x, y, z) }
}
