//! Where the joints of a file are: which have a coordinate, which follow one, and where the others stand.

use super::choice::Choice;
use crate::error::{Error, Result};
use crate::robot::description::{Description, JointDescription, Motion};
use crate::robot::model::JointKind;
use std::collections::HashMap;

/// How a joint of the file moves with the coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Place {
    /// q = multiplier x + offset, x the position of the joint with this index.
    Moves { leader: usize, multiplier: f64, offset: f64 },
    /// It stands at this position.
    Held(f64),
}

impl Description {
    /// What every joint of the file does.
    pub(super) fn places(&self, choice: &Choice) -> Result<Vec<Place>> {
        let index: HashMap<&str, usize> = self.joints.iter().enumerate().map(|(at, j)| (j.name.as_str(), at)).collect();
        let chosen = self.chosen(choice, &index)?;
        // A joint that follows one not under study leads instead of it.
        let mut leaders: HashMap<usize, (usize, f64, f64)> = HashMap::new();
        for &joint in &chosen {
            let (master, multiplier, offset) = self.leader(&self.joints[joint]);
            let master = index[master.name.as_str()];
            let own = chosen.contains(&master);
            if !own && multiplier == 0.0 {
                let problem = "it follows another with a multiplier of zero; name that one instead";
                return Err(self.refused(&self.joints[joint], problem));
            }
            let lead = if own { (master, 1.0, 0.0) } else { (joint, multiplier, offset) };
            leaders.entry(master).or_insert(lead);
        }
        let place = |joint: &JointDescription| {
            let (master, multiplier, offset) = self.leader(joint);
            match (moves(joint), leaders.get(&index[master.name.as_str()])) {
                (false, _) => Place::Held(0.0),
                // x of the master is (q - offset) / multiplier of the joint that leads.
                (true, Some(&(leader, own, shift))) => {
                    Place::Moves { leader, multiplier: multiplier / own, offset: offset - multiplier / own * shift }
                }
                (true, None) => {
                    let follows = choice.hold.get(&joint.name).copied();
                    Place::Held(follows.unwrap_or_else(|| multiplier * self.rest(master, choice) + offset))
                }
            }
        };
        Ok(self.joints.iter().map(place).collect())
    }

    fn chosen(&self, choice: &Choice, index: &HashMap<&str, usize>) -> Result<Vec<usize>> {
        let of =
            |joints: Vec<&JointDescription>| -> Vec<usize> { joints.iter().map(|j| index[j.name.as_str()]).collect() };
        match (&choice.joints, &choice.tip) {
            (None, None) => Ok(of(self.masters())),
            (None, Some(tip)) => Ok(of(self.path_to(tip)?.into_iter().filter(|joint| moves(joint)).collect())),
            (Some(names), _) => names.iter().map(|name| self.named(name, index)).collect(),
        }
    }

    fn named(&self, name: &str, index: &HashMap<&str, usize>) -> Result<usize> {
        match index.get(name) {
            Some(&joint) if moves(&self.joints[joint]) => Ok(joint),
            Some(&joint) => Err(self.refused(&self.joints[joint], "it does not turn or slide; name joints that do")),
            None => {
                let names: Vec<&str> = self.moving().iter().map(|joint| joint.name.as_str()).collect();
                let problem =
                    format!("{} has no such joint; its moving joints are {}", self.source.display(), names.join(", "));
                Err(Error::request(format!("joint `{name}`"), problem))
            }
        }
    }

    /// Where a joint without coordinate stands.
    fn rest(&self, joint: &JointDescription, choice: &Choice) -> f64 {
        let limits = &joint.limits;
        let middle = 0.5 * (limits.lower + limits.upper);
        let zero = if moves(joint) { 0.0f64.clamp(limits.lower, limits.upper) } else { 0.0 };
        choice.hold.get(&joint.name).copied().unwrap_or(if middle.is_finite() && moves(joint) { middle } else { zero })
    }

    /// Whether someone said where a held joint stands.
    fn is_given(&self, joint: &JointDescription, choice: &Choice) -> bool {
        let said = |name: &String| choice.hold.contains_key(name);
        said(&joint.name) || said(&self.leader(joint).0.name)
    }

    /// Held joints that turn what a joint under study stands on, where nobody said how they stand.
    pub(super) fn assumed(&self, places: &[Place], choice: &Choice) -> Vec<String> {
        let mut carries = vec![false; self.joints.len()];
        for (joint, _) in self.joints.iter().zip(places).filter(|(_, place)| matches!(place, Place::Moves { .. })) {
            let mut link = joint.parent;
            while let Some(above) = self.joint_above(link) {
                carries[above] = true;
                link = self.joints[above].parent;
            }
        }
        let assumed = |at: &usize| {
            let joint = &self.joints[*at];
            let turns = joint.motion == Motion::Revolute && matches!(places[*at], Place::Held(_));
            turns && carries[*at] && !self.is_given(joint, choice)
        };
        (0..self.joints.len()).filter(assumed).map(|at| self.joints[at].name.clone()).collect()
    }

    /// Held joints behind joints that move, where nobody said how they stand, each with the nearest joint that moves and carries it.
    pub(super) fn guessed(&self, places: &[Place], choice: &Choice) -> Vec<(String, String)> {
        let carrier = |joint: &JointDescription| {
            let above = |link: usize| self.joint_above(link);
            let mut on = std::iter::successors(above(joint.parent), |&at| above(self.joints[at].parent));
            on.find(|&at| matches!(places[at], Place::Moves { .. })).map(|at| self.joints[at].name.clone())
        };
        let held = self.joints.iter().zip(places).filter(|(_, place)| matches!(place, Place::Held(_)));
        held.filter(|(joint, _)| moves(joint) && !self.is_given(joint, choice))
            .filter_map(|(joint, _)| Some((joint.name.clone(), carrier(joint)?)))
            .collect()
    }

    /// Moving joints that are held, with a note of where.
    pub(super) fn held(&self, places: &[Place], choice: &Choice, notes: &mut Vec<String>) -> Vec<(String, f64)> {
        let mut held = Vec::new();
        let mut given = Vec::new();
        let mut middle = Vec::new();
        for (joint, place) in self.joints.iter().zip(places) {
            let Place::Held(position) = *place else { continue };
            match joint.motion {
                Motion::Fixed => continue,
                Motion::Floating | Motion::Planar => {
                    let motion = if joint.motion == Motion::Floating { "floats" } else { "moves in a plane" };
                    notes.push(format!("joint `{}` {motion}: its link stands still at zero", joint.name));
                    continue;
                }
                Motion::Revolute | Motion::Prismatic => {}
            }
            held.push((joint.name.clone(), position));
            let unit = if joint.kind() == Some(JointKind::Prismatic) { "m" } else { "rad" };
            let list = if self.is_given(joint, choice) { &mut given } else { &mut middle };
            list.push(format!("{} {position:.4} {unit}", joint.name));
        }
        for (list, place) in
            [(given, "where the logs show them or [hold] has them"), (middle, "in the middle of their range")]
        {
            if !list.is_empty() {
                notes.push(format!("joints not under study stand still {place}: {}", shortened(&list)));
            }
        }
        held
    }
}

/// The first three of a list, and how many more there are.
pub(crate) fn shortened(list: &[String]) -> String {
    const NAMED: usize = 3;
    // One more is as short as its number.
    match list.len() {
        all if all > NAMED + 1 => format!("{} and {} more", list[..NAMED].join(", "), all - NAMED),
        _ => list.join(", "),
    }
}

/// Whether a joint of the file can have a coordinate.
fn moves(joint: &JointDescription) -> bool {
    joint.kind().is_some()
}

#[cfg(test)]
mod tests {
    use super::shortened;

    #[test]
    fn long_lists_are_counted() {
        let list = |count: usize| shortened(&(1..=count).map(|joint| format!("j{joint}")).collect::<Vec<_>>());
        assert_eq!([list(1), list(4), list(5)], ["j1", "j1, j2, j3, j4", "j1, j2, j3 and 2 more"].map(str::to_owned));
    }
}
