//! The robot of a description.

use super::bodies::Assembly;
use super::choice::{Choice, InertiaCheck};
use super::places::Place;
use crate::error::{Error, Result};
use crate::robot::description::{self, Description};
use crate::robot::model::{Follower, Joint, Robot, TEXT, Tree};
use std::path::Path;

/// Loads a robot, all of whose joints are under study.
///
/// # Errors
/// As [`description::read`] and [`Description::robot`].
pub fn load(path: impl AsRef<Path>, inertias: InertiaCheck) -> Result<Robot> {
    description::read(path.as_ref())?.robot(&Choice::default(), inertias)
}

impl Robot {
    /// Reads a robot from the text of a URDF or of a MuJoCo model. All of its joints are under study. Its inertias are placeholders
    /// until they are identified: impossible ones pass, as with [`InertiaCheck::Ignored`]. Files that the text includes are looked
    /// for in the current folder. For a part of the joints, or inertias that must be possible: [`description::parse`] and
    /// [`Description::robot`].
    ///
    /// ```
    /// # extern crate tauscope_core as tauscope;
    /// use tauscope::robot::{self, Robot};
    ///
    /// let text = r#"<robot name="pendulum"><link name="base"/>
    /// <joint name="swing" type="continuous"><parent link="base"/><child link="rod"/><axis xyz="0 1 0"/></joint>
    /// <link name="rod"><inertial><origin xyz="0 0 -0.3"/><mass value="2"/>
    /// <inertia ixx="0.02" iyy="0.02" izz="0.001" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"#;
    /// let robot = Robot::from_urdf_str(text)?;
    /// assert_eq!(robot.joint_names(), ["swing"]);
    /// assert_eq!(robot.joints[0].inertia.mass(), 2.0);
    ///
    /// // Errors name line and element.
    /// let refused = Robot::from_urdf_str(&text.replace("rod", "arm").replacen("arm", "rod", 1)).unwrap_err();
    /// assert!(refused.to_string().starts_with("<text>:2: "), "{refused}");
    /// # Ok::<(), tauscope::error::Error>(())
    /// ```
    ///
    /// # Errors
    /// Names line and element of what is wrong with the text, and what to do; a text of another kind is named; no joint that moves.
    pub fn from_urdf_str(text: &str) -> Result<Robot> {
        description::parse(text, TEXT)?.robot(&Choice::default(), InertiaCheck::Ignored)
    }
}

impl Description {
    /// The robot whose joints under study have a coordinate each. All others are held, and what they carry is welded to the
    /// link that carries them; joints that mimic one under study follow it, with their friction and rotor in its drive.
    ///
    /// # Errors
    /// A joint or link that the file does not have or that cannot move, no joint that moves; with
    /// [`InertiaCheck::Required`] friction below zero and bodies that cannot exist, where they move.
    pub fn robot(&self, choice: &Choice, inertias: InertiaCheck) -> Result<Robot> {
        let places = self.places(choice)?;
        let mut notes = self.notes.clone();
        let held = self.held(&places, choice, &mut notes);
        let (assumed, guessed) = (self.assumed(&places, choice), self.guessed(&places, choice));
        let order: Vec<usize> =
            self.depth_first().into_iter().filter(|&j| matches!(places[j], Place::Moves { .. })).collect();
        let leads = |joint: &usize| matches!(places[*joint], Place::Moves { leader, .. } if leader == *joint);
        let (coordinates, followers): (Vec<usize>, Vec<usize>) = order.into_iter().partition(leads);
        if coordinates.is_empty() {
            return Err(Error::input(&self.source, None, "<robot>", "the arm has no moving joint"));
        }
        let bodies: Vec<usize> = coordinates.iter().chain(&followers).copied().collect();
        let mut assembly = Assembly { file: self, inertias, places: &places, bodies: &bodies, notes: &mut notes };
        let made = bodies.iter().map(|&joint| assembly.joint(joint)).collect::<Result<Vec<_>>>()?;
        let (tip, flange) = assembly.flange(choice, &made)?;
        let lifted = assembly.lifted();
        assembly.note_impossible_masses(&made);
        let (mut joints, parents): (Vec<Joint>, Vec<Option<usize>>) = made.into_iter().unzip();
        let trailing = joints.split_off(coordinates.len());
        let mut followed = Vec::new();
        for (mut joint, &index) in trailing.into_iter().zip(&followers) {
            let Place::Moves { leader, multiplier, offset } = places[index] else { continue };
            let coordinate = coordinates.iter().position(|&own| own == leader).unwrap_or(0);
            joints[coordinate].drive.take_over(&std::mem::take(&mut joint.drive), multiplier);
            followed.push(Follower { joint, coordinate, multiplier, offset });
        }
        let serial =
            followed.is_empty() && parents.iter().enumerate().all(|(body, parent)| *parent == body.checked_sub(1));
        let tree = (!serial || tip + 1 != joints.len()).then_some(Tree { followers: followed, parents, tip });
        let (name, source) = (self.name.clone(), self.source.clone());
        let columns = joints.iter().map(|joint| joint.name.clone()).collect();
        let (gravity, actuators, addresses) = (self.gravity, self.actuators.clone(), self.addresses.clone());
        Ok(Robot {
            name,
            source,
            gravity,
            joints,
            flange,
            tree,
            columns,
            actuators,
            addresses,
            held,
            assumed,
            guessed,
            lifted,
            notes,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::{to_mjcf, with_parameters};

    fn irb() -> (String, Robot) {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../urdf/irb1600_6_120.urdf");
        (std::fs::read_to_string(path).unwrap(), load(path, InertiaCheck::Ignored).unwrap())
    }

    #[test]
    fn a_text_gives_the_robot_of_its_file() {
        let (text, file) = irb();
        let read = Robot::from_urdf_str(&text).unwrap();
        assert_eq!(Robot { source: file.source.clone(), ..read.clone() }, file);
        // It is written without a file to write into.
        let written = Robot::from_urdf_str(&with_parameters(&read).unwrap()).unwrap();
        assert_eq!((written.joint_names(), written.dof()), (file.joint_names(), 6));
        // MuJoCo models too.
        assert_eq!(Robot::from_urdf_str(&to_mjcf(&file)).unwrap().joint_names(), file.joint_names());
    }

    #[test]
    fn errors_of_a_text_name_the_place() {
        let (text, _) = irb();
        let refused = |text: &str| Robot::from_urdf_str(text).unwrap_err().to_string();
        let line = 1 + text.lines().position(|line| line.contains("\"joint_2\"")).unwrap();
        let message = refused(&text.replacen("<joint name=\"joint_2\"", "<joint", 1));
        assert!(message.starts_with(&format!("<text>:{line}: ")), "{message}");
        assert!(refused("").starts_with("<text>"));
        assert!(refused("t,q1,tau1\n0,1,2\n").contains("a table or log"));
        let still = refused("<robot name=\"a\"><link name=\"b\"/></robot>");
        assert!(still.contains("no moving joint"), "{still}");
    }
}
