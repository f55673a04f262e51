//! Joints of a description: which move, which lead, and the ways between base and links.

use super::tree::{Description, JointDescription, LinkDescription};
use crate::error::{Error, Result};

impl Description {
    /// The joints that move by themselves, branch by branch outwards, children of a link in the order of the file.
    pub fn masters(&self) -> Vec<&JointDescription> {
        let free = |joint: &&JointDescription| joint.kind().is_some() && self.leader(joint).0.name == joint.name;
        self.depth_first().into_iter().map(|joint| &self.joints[joint]).filter(free).collect()
    }

    /// The joints that turn or slide, followers included, branch by branch outwards.
    pub fn moving(&self) -> Vec<&JointDescription> {
        self.depth_first().into_iter().map(|joint| &self.joints[joint]).filter(|joint| joint.kind().is_some()).collect()
    }

    /// Index of a link by its name.
    ///
    /// # Errors
    /// If there is no such link; the error lists the links there are.
    pub(in crate::robot) fn link(&self, name: &str) -> Result<usize> {
        self.links.iter().position(|link| link.name == name).ok_or_else(|| {
            let names: Vec<&str> = self.links.iter().map(|link| link.name.as_str()).collect();
            let problem = format!("{} has no such link; its links are {}", self.source.display(), names.join(", "));
            Error::request(format!("link `{name}`"), problem)
        })
    }

    /// The joints between the base and a link, from the base outwards.
    ///
    /// # Errors
    /// If there is no such link; the error lists the links there are.
    pub fn path_to(&self, link: &str) -> Result<Vec<&JointDescription>> {
        let mut at = self.link(link)?;
        let mut path = Vec::new();
        while let Some(joint) = self.joint_above(at) {
            path.push(&self.joints[joint]);
            at = self.joints[joint].parent;
        }
        path.reverse();
        Ok(path)
    }

    /// Of the joints `named` those that lead: the others follow one of them.
    pub fn leading(&self, named: &[String]) -> Vec<String> {
        let follows = |name: &String| {
            let joint = self.joints.iter().find(|joint| joint.name == *name);
            let leader = joint.map(|joint| self.leader(joint).0);
            leader.is_some_and(|leader| leader.name != *name && named.contains(&leader.name))
        };
        named.iter().filter(|name| !follows(name)).cloned().collect()
    }

    /// The joints that move by themselves between the base and some link, for every link where they are `count`.
    pub fn chains_of(&self, count: usize) -> Vec<Vec<String>> {
        let masters: Vec<&str> = self.masters().iter().map(|joint| joint.name.as_str()).collect();
        let chain = |link: &LinkDescription| {
            let path = self.path_to(&link.name).unwrap_or_default();
            let own = path.iter().map(|joint| joint.name.clone()).filter(|name| masters.contains(&name.as_str()));
            own.collect::<Vec<String>>()
        };
        self.links.iter().map(chain).filter(|chain| chain.len() == count).collect()
    }

    /// The joints branch by branch, each behind the one that carries it.
    pub(in crate::robot) fn depth_first(&self) -> Vec<usize> {
        let mut order = Vec::with_capacity(self.joints.len());
        let mut open = vec![self.root()];
        while let Some(link) = open.pop() {
            order.extend(self.joint_above(link));
            let mut next: Vec<usize> = self.joints_on(link).map(|joint| self.joints[joint].child).collect();
            next.reverse();
            open.extend(next);
        }
        order
    }

    /// The joint that a joint follows in the end, itself where it follows none, with multiplier and offset.
    pub(in crate::robot) fn leader<'a>(&'a self, joint: &'a JointDescription) -> (&'a JointDescription, f64, f64) {
        let (mut at, mut multiplier, mut offset) = (joint, 1.0, 0.0);
        while let Some(mimic) = &at.mimic {
            let Some(master) = self.joints.iter().find(|other| other.name == mimic.master) else { break };
            // q = m (m' x + o') + o.
            offset += multiplier * mimic.offset;
            multiplier *= mimic.multiplier;
            at = master;
        }
        (at, multiplier, offset)
    }

    /// An error about a joint, at its line.
    pub(in crate::robot) fn refused(&self, joint: &JointDescription, problem: impl Into<String>) -> Error {
        Error::input(&self.source, joint.line, format!("joint `{}`", joint.name), problem)
    }
}
