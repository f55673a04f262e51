//! [`Description`] to [`Robot`]: any serial arm of revolute and prismatic joints; links behind fixed joints are merged.

use super::description::{self, Description, JointDescription, Motion};
use super::{Inertia, Joint, JointKind, Pose, Robot};
use crate::error::{Error, Result};
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

/// Loads a serial arm from a file.
///
/// # Errors
/// As [`description::read`], and names file, line and element for: a branching chain, joints that are not revolute,
/// prismatic or fixed, mimic joints, and with [`InertiaCheck::Required`] negative friction and bodies that cannot exist.
pub fn load(path: impl AsRef<Path>, inertias: InertiaCheck) -> Result<Robot> {
    let description = description::read(path.as_ref())?;
    Chain { file: &description, inertias }.walk()
}

/// The links and joints of a file, walked from the root to the flange.
struct Chain<'a> {
    file: &'a Description,
    inertias: InertiaCheck,
}

impl<'a> Chain<'a> {
    fn error(&self, joint: &JointDescription, problem: impl Into<String>) -> Error {
        Error::input(&self.file.source, joint.line, format!("joint `{}`", joint.name), problem)
    }

    fn walk(&self) -> Result<Robot> {
        let mut body = self.body(self.file.root())?;
        let mut joints = Vec::new();
        while let Some((mount, joint)) = body.next.take() {
            let kind = self.kind(joint)?;
            body = self.body(joint.child)?;
            joints.push(Joint {
                name: joint.name.clone(),
                link: self.file.links[joint.child].name.clone(),
                kind,
                origin: mount.then(&joint.origin),
                axis: joint.axis,
                limits: joint.limits,
                inertia: body.inertia,
                drive: self.drive(joint)?,
            });
        }
        if joints.is_empty() {
            return Err(Error::input(&self.file.source, None, "<robot>", "the arm has no moving joint"));
        }
        Ok(Robot {
            name: self.file.name.clone(),
            source: self.file.source.clone(),
            gravity: self.file.gravity,
            joints,
            flange: body.tip,
        })
    }

    /// The rigid body that starts at `link`: the link and everything fixed to it, in that link's frame.
    fn body(&self, link: usize) -> Result<Body<'a>> {
        let mut body = Body { inertia: Inertia::default(), next: None, tip: Pose::identity() };
        let mut open = vec![(link, Pose::identity(), 0)];
        let mut deepest = 0;
        while let Some((link, place, depth)) = open.pop() {
            let own = self.inertia(link)?;
            body.inertia = body.inertia.welded_to(&own.seen_from_parent(&place.rotation, &place.translation));
            if depth > deepest {
                (deepest, body.tip) = (depth, place);
            }
            for joint in self.file.joints_on(link).map(|index| &self.file.joints[index]) {
                if joint.motion == Motion::Fixed {
                    open.push((joint.child, place.then(&joint.origin), depth + 1));
                } else if let Some((_, other)) = body.next.replace((place, joint)) {
                    let other = &other.name;
                    let problem =
                        format!("the chain branches: `{other}` moves the same body; only serial arms are handled");
                    return Err(self.error(joint, problem));
                }
            }
        }
        Ok(body)
    }

    fn kind(&self, joint: &JointDescription) -> Result<JointKind> {
        if joint.mimic.is_some() {
            return Err(self.error(joint, "mimic joints are not handled; make it fixed"));
        }
        match joint.motion {
            Motion::Revolute => Ok(JointKind::Revolute),
            Motion::Prismatic => Ok(JointKind::Prismatic),
            motion => {
                let motion = format!("{motion:?}").to_lowercase();
                let problem = format!("type {motion} is not handled; use revolute, continuous, prismatic or fixed");
                Err(self.error(joint, problem))
            }
        }
    }

    fn drive(&self, joint: &JointDescription) -> Result<super::Drive> {
        let drive = joint.drive;
        let values = [(drive.viscous, "damping"), (drive.coulomb, "friction"), (drive.armature, "armature")];
        match values.into_iter().find(|(value, _)| *value < 0.0) {
            Some((value, attribute)) => {
                let problem = format!("{attribute} {value} of <dynamics> must be a number of zero or more");
                Err(self.error(joint, problem))
            }
            None => Ok(drive),
        }
    }

    fn inertia(&self, link: usize) -> Result<Inertia> {
        let link = &self.file.links[link];
        let at = |line, field: String, problem| Err(Error::input(&self.file.source, line, field, problem));
        if self.inertias == InertiaCheck::Required {
            if let Some(missing) = &link.missing {
                return at(Some(missing.line), missing.field.clone(), missing.problem.clone());
            }
            if let Some(problem) = link.inertia.physical_fault(ROUNDING) {
                return at(link.line, format!("link `{}`", link.name), problem);
            }
        }
        Ok(link.inertia)
    }
}

/// A rigid body with the moving joint it carries, and the pose of the link behind the most fixed joints.
struct Body<'a> {
    inertia: Inertia,
    next: Option<(Pose, &'a JointDescription)>,
    tip: Pose,
}
