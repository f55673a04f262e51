//! Joints of a description: which move, which lead, and the ways between base and links.

use super::tree::{Description, JointDescription, LinkDescription};
use crate::error::{Error, Result};
use crate::robot::JointKind;

impl Description {
    /// The joints that move by themselves, branch by branch outwards, children of a link in the order of the file.
    pub(crate) fn masters(&self) -> Vec<&JointDescription> {
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
    pub(crate) fn path_to(&self, link: &str) -> Result<Vec<&JointDescription>> {
        let mut at = self.link(link)?;
        let mut path = Vec::new();
        while let Some(joint) = self.joint_above(at) {
            path.push(&self.joints[joint]);
            at = self.joints[joint].parent;
        }
        path.reverse();
        Ok(path)
    }

    /// Those of the joints `named` that lead: the others follow one of them.
    pub fn leading(&self, named: &[String]) -> Vec<String> {
        let follows = |name: &String| {
            let joint = self.joints.iter().find(|joint| joint.name == *name);
            let leader = joint.map(|joint| self.leader(joint).0);
            leader.is_some_and(|leader| leader.name != *name && named.contains(&leader.name))
        };
        named.iter().filter(|name| !follows(name)).cloned().collect()
    }

    /// The joints that move by themselves between the base and some link, for every link where they are `count`; also without a lift or
    /// rail on which the arm stands, whose joints slide.
    pub(crate) fn chains_of(&self, count: usize) -> Vec<Vec<String>> {
        let masters: Vec<&str> = self.masters().iter().map(|joint| joint.name.as_str()).collect();
        let chain = |link: &LinkDescription| {
            let path = self.path_to(&link.name).unwrap_or_default();
            let own: Vec<_> = path.into_iter().filter(|joint| masters.contains(&joint.name.as_str())).collect();
            let (rail, arm) = own.split_at_checked(own.len().saturating_sub(count))?;
            let slides = |joint: &&JointDescription| joint.kind() == Some(JointKind::Prismatic);
            let is_arm = rail.iter().all(slides) && (rail.is_empty() || !arm.iter().any(slides));
            (is_arm && arm.len() == count).then(|| arm.iter().map(|joint| joint.name.clone()).collect())
        };
        self.links.iter().filter_map(chain).collect()
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

#[cfg(test)]
mod tests {
    use crate::robot::description;

    /// An arm of joints of these kinds, one on the other.
    fn chains(kinds: &[&str], count: usize) -> Vec<String> {
        let mut text = String::from("<robot name=\"r\"><link name=\"l0\"/>");
        for (joint, kind) in kinds.iter().enumerate() {
            text += &format!(
                "<link name=\"l{0}\"/><joint name=\"j{0}\" type=\"{kind}\"><parent link=\"l{joint}\"/><child link=\"l{0}\"/>\
                 <axis xyz=\"0 0 1\"/><limit lower=\"-1\" upper=\"1\" effort=\"9\" velocity=\"9\"/></joint>",
                joint + 1
            );
        }
        let file = description::parse(&(text + "</robot>"), "arm").unwrap();
        file.chains_of(count).into_iter().map(|chain| chain.join(" ")).collect()
    }

    #[test]
    fn an_arm_on_a_lift_is_a_chain_of_its_own() {
        let turns = ["revolute"; 3];
        assert_eq!(chains(&turns, 2), ["j1 j2"]);
        let lifted = ["prismatic", "revolute", "revolute"];
        assert_eq!(chains(&lifted, 2), ["j1 j2", "j2 j3"]);
        assert_eq!(chains(&lifted, 3), ["j1 j2 j3"]);
        // A gripper that slides is none of the arm.
        assert_eq!(chains(&["revolute", "revolute", "prismatic"], 2), ["j1 j2"]);
    }
}
