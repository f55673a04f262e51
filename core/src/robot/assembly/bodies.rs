//! The bodies of a robot, welded together from links that move as one.

use super::choice::{Choice, InertiaCheck};
use super::places::Place;
use crate::error::{Error, Result};
use crate::robot::description::{Description, JointDescription, Motion};
use crate::robot::model::{Drive, Inertia, Joint, JointKind, Pose};

/// Relative violation of the triangle inequality that passes as rounding in the file.
const ROUNDING: f64 = 1e-3;

/// The bodies of a robot, as they are put together.
pub(super) struct Assembly<'a> {
    pub file: &'a Description,
    pub inertias: InertiaCheck,
    pub places: &'a [Place],
    /// Joints of the moving bodies, those with a coordinate first.
    pub bodies: &'a [usize],
    pub notes: &'a mut Vec<String>,
}

impl Assembly<'_> {
    /// The moving joint `index` of the file with its body, and the body that carries it.
    pub(super) fn joint(&mut self, index: usize) -> Result<(Joint, Option<usize>)> {
        let file = self.file;
        let given = &file.joints[index];
        let (parent, mount) = self.carrier(given.parent);
        let mut inertia = Inertia::default();
        for (link, place) in self.welded(given.child) {
            inertia = inertia.welded_to(&self.inertia(link)?.seen_from_parent(&place.rotation, &place.translation));
        }
        let joint = Joint {
            name: given.name.clone(),
            link: file.links[given.child].name.clone(),
            kind: given.kind().unwrap_or(JointKind::Revolute),
            origin: mount.then(&given.origin),
            axis: given.axis,
            limits: given.limits,
            inertia,
            drive: self.drive(given)?,
        };
        Ok((joint, parent))
    }

    /// The moving body that a link belongs to, none for the base, and the link's pose in it.
    fn carrier(&self, mut link: usize) -> (Option<usize>, Pose) {
        let mut pose = Pose::identity();
        while let Some(joint) = self.file.joint_above(link) {
            if let Some(body) = self.bodies.iter().position(|&own| own == joint) {
                return (Some(body), pose);
            }
            pose = self.standing(joint).then(&pose);
            link = self.file.joints[joint].parent;
        }
        (None, pose)
    }

    /// Pose of the child of a joint that does not move, in the parent link.
    fn standing(&self, joint: usize) -> Pose {
        let given = &self.file.joints[joint];
        match (self.places[joint], given.kind()) {
            (Place::Held(position), Some(kind)) if position != 0.0 => {
                given.origin.then(&kind.motion(&given.axis, position))
            }
            _ => given.origin,
        }
    }

    /// The links that move as one with `link`, with their poses in it; of those that hang on fixed joints alone the deepest is
    /// the last.
    pub(super) fn welded(&self, link: usize) -> Vec<(usize, Pose)> {
        let mut found = Vec::new();
        let mut open = vec![(link, Pose::identity())];
        while let Some((link, place)) = open.pop() {
            found.push((link, place));
            for joint in self.file.joints_on(link).filter(|joint| !self.bodies.contains(joint)) {
                open.push((self.file.joints[joint].child, place.then(&self.standing(joint))));
            }
        }
        found
    }

    fn drive(&mut self, joint: &JointDescription) -> Result<Drive> {
        let mut drive = joint.drive;
        for (value, attribute) in
            [(&mut drive.viscous, "damping"), (&mut drive.coulomb, "friction"), (&mut drive.armature, "armature")]
        {
            if *value >= 0.0 {
                continue;
            }
            if self.inertias == InertiaCheck::Required {
                let problem = format!("{attribute} {value} of <dynamics> must be a number of zero or more");
                return Err(self.file.refused(joint, problem));
            }
            self.notes.push(format!("joint `{}`: {attribute} {value} is below zero and counts as none", joint.name));
            *value = 0.0;
        }
        Ok(drive)
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

    /// Notes moving bodies whose mass is negative, and those without mass where others have one: a slip in the file.
    pub(super) fn note_impossible_masses(&mut self, made: &[(Joint, Option<usize>)]) {
        let of_joints = |is_meant: fn(f64) -> bool| -> Vec<&str> {
            let meant = made.iter().filter(|(joint, _)| is_meant(joint.inertia.mass()));
            meant.map(|(joint, _)| joint.name.as_str()).collect()
        };
        let (negative, none) = (of_joints(|mass| mass < 0.0), of_joints(|mass| mass == 0.0));
        for (joints, what) in [(negative, "a negative mass"), (none, "no mass")] {
            if !joints.is_empty() && joints.len() < made.len() {
                let text = format!(
                    "in the file the body that moves with {} has {what}; `--trust structure` does not use it",
                    joints.join(", with ")
                );
                self.notes.push(text);
            }
        }
    }

    /// The body that carries the flange, and its pose there: the link asked for, or the one behind the most fixed joints on the
    /// body with the most moving joints before it. Of several a frame without mass, as files give the flange and the tool centre point,
    /// comes before a finger.
    pub(super) fn flange(&self, choice: &Choice, made: &[(Joint, Option<usize>)]) -> Result<(usize, Pose)> {
        if let Some(tip) = &choice.tip
            && let (Some(body), pose) = self.carrier(self.file.link(tip)?)
        {
            return Ok((body, pose));
        }
        let depth = |mut body: usize| {
            let mut depth = 0;
            while let Some(parent) = made[body].1 {
                (body, depth) = (parent, depth + 1);
            }
            depth
        };
        let tip = (0..made.len()).rev().max_by_key(|&body| depth(body)).unwrap_or(0);
        let mut deepest = ((0, false), Pose::identity());
        let mut open = vec![(self.file.joints[self.bodies[tip]].child, Pose::identity(), 0)];
        while let Some((link, place, depth)) = open.pop() {
            let is_frame = self.file.links[link].inertia.mass() == 0.0;
            if depth > 0 && (depth, is_frame) > deepest.0 {
                deepest = ((depth, is_frame), place);
            }
            for joint in self.file.joints_on(link).map(|joint| &self.file.joints[joint]) {
                if joint.motion == Motion::Fixed {
                    open.push((joint.child, place.then(&joint.origin), depth + 1));
                }
            }
        }
        Ok((tip, deepest.1))
    }
}

impl Drive {
    /// Adds the friction and rotor of a joint that moves `ratio` times as fast: power and kinetic energy stay the same.
    pub(super) fn take_over(&mut self, follower: &Drive, ratio: f64) {
        self.viscous += ratio * ratio * follower.viscous;
        self.coulomb += ratio.abs() * follower.coulomb;
        self.armature += ratio * ratio * follower.armature;
    }
}
