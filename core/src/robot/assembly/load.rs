//! The robot of a description.

use super::bodies::Assembly;
use super::choice::{Choice, InertiaCheck};
use super::places::Place;
use crate::error::{Error, Result};
use crate::robot::description::{self, Description};
use crate::robot::model::{Follower, Joint, Robot, Tree};
use std::path::Path;

/// Loads a robot, all of whose joints are under study.
///
/// # Errors
/// As [`description::read`] and [`Description::robot`].
pub fn load(path: impl AsRef<Path>, inertias: InertiaCheck) -> Result<Robot> {
    description::read(path.as_ref())?.robot(&Choice::default(), inertias)
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
        let (gravity, actuators) = (self.gravity, self.actuators.clone());
        Ok(Robot { name, source, gravity, joints, flange, tree, columns, actuators, held, assumed, guessed, notes })
    }
}
