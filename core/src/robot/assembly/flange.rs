//! The flange at another link, and the link that it is at.

use super::choice::{Choice, InertiaCheck};
use crate::error::{Error, Result};
use crate::robot::description::Description;
use crate::robot::model::Robot;

/// Distance up to which two frames are one, m (entries of the rotation): they are put together in different orders.
const ROUNDING: f64 = 1e-9;

impl Robot {
    /// The same arm with its flange at `link` of the file that it came from: what is fixed to the flange then moves with that
    /// link, in whose frame it is given.
    ///
    /// # Errors
    /// If the file has no such link, or no joint of this arm moves it.
    pub fn with_flange_at(&self, file: &Description, link: &str) -> Result<Robot> {
        let joints = file.path_to(link)?;
        let moves = |name: &str| (0..self.bodies()).any(|body| self.body(body).name == name);
        if !joints.iter().any(|joint| moves(&joint.name)) {
            let problem = format!("none of the joints {} moves it", self.joint_names().join(", "));
            return Err(Error::request(format!("link `{link}`"), problem));
        }
        let choice = Choice {
            joints: Some(self.joint_names()),
            tip: Some(link.to_owned()),
            hold: self.held.iter().cloned().collect(),
        };
        let made = file.robot(&choice, InertiaCheck::Ignored)?;
        Ok(Robot { flange: made.flange, tree: made.tree, ..self.clone() })
    }

    /// The link of the file whose frame is the flange's; of several the last.
    pub(crate) fn flange_link(&self, file: &Description) -> Option<String> {
        let is_here = |link: &str| {
            let at = self.with_flange_at(file, link).ok();
            at.is_some_and(|at| at.tip() == self.tip() && at.flange.is_near(&self.flange, ROUNDING))
        };
        file.links.iter().rev().map(|link| &link.name).find(|link| is_here(link)).cloned()
    }

    /// The arm with its flange at each of its ends, the present one first, and the link of the file whose frame that is: a robot of two
    /// arms has two.
    pub fn ends(&self, file: &Description) -> Vec<(Robot, String)> {
        let carries = |body: usize| (0..self.bodies()).any(|other| self.parent(other) == Some(body));
        let others = (0..self.bodies()).filter(|&body| body != self.tip() && !carries(body));
        let at = |body: usize| {
            let link = self.body(body).link.clone();
            Some((self.with_flange_at(file, &link).ok()?, link))
        };
        let own = self.flange_link(file).unwrap_or_else(|| self.body(self.tip()).link.clone());
        std::iter::once((self.clone(), own)).chain(others.filter_map(at)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::description;
    use std::path::Path;

    #[test]
    fn a_tool_centre_point_comes_before_fingers() {
        let link = |name: &str, mass: f64| {
            format!(
                r#"<link name="{name}"><inertial><mass value="{mass}"/>
                <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>"#
            )
        };
        let fixed = |child: &str, z: f64| {
            format!(
                r#"<joint name="to_{child}" type="fixed"><parent link="hand"/><child link="{child}"/>
                <origin xyz="0 0 {z}"/></joint>"#
            )
        };
        let fingers = [link("left", 0.1), link("right", 0.1), fixed("left", 0.05), fixed("right", 0.06)].concat();
        let text = format!(
            r#"<robot name="arm"><link name="base"/>{}<joint name="swing" type="continuous"><parent link="base"/>
            <child link="hand"/><axis xyz="0 1 0"/></joint>{fingers}{}<link name="tcp"/></robot>"#,
            link("hand", 1.0),
            fixed("tcp", 0.1)
        );
        assert_eq!(Robot::from_urdf_str(&text).unwrap().flange.translation.z, 0.1);
        // Without such a frame it is at the last finger.
        let bare = text.replace(&fixed("tcp", 0.1), "").replace(r#"<link name="tcp"/>"#, "");
        assert_eq!(Robot::from_urdf_str(&bare).unwrap().flange.translation.z, 0.06);
    }

    #[test]
    fn a_flange_moves_to_another_link_and_back() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../urdf/irb1600_6_120.urdf");
        let file = description::read(Path::new(path)).unwrap();
        let robot = file.robot(&Choice::default(), InertiaCheck::Required).unwrap();
        let own = robot.flange_link(&file).unwrap();
        assert_eq!(robot.with_flange_at(&file, &own).unwrap(), robot);
        assert_eq!(robot.ends(&file), [(robot.clone(), own)]);
        let (third, base) = (&robot.joints[2].link, &file.links[file.root()].name);
        let moved = robot.with_flange_at(&file, third).unwrap();
        assert_eq!((moved.tip(), moved.flange), (2, crate::robot::Pose::identity()));
        assert_eq!(moved.flange_link(&file).as_ref(), Some(third));
        for (link, word) in [(base.as_str(), "moves it"), ("nowhere", "no such link")] {
            let problem = robot.with_flange_at(&file, link).unwrap_err().to_string();
            assert!(problem.contains(word), "{problem}");
        }
    }
}
