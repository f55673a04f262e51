//! [`Description`] to [`Robot`]: which joints have a coordinate, where the others stand, and what is welded together.

use super::description::{self, Description, JointDescription, Motion};
use super::{Drive, Follower, Inertia, Joint, JointKind, Pose, Robot, Tree};
use crate::error::{Error, Result};
use std::collections::{BTreeMap, HashMap};
use std::path::Path;

/// Relative violation of the triangle inequality that passes as rounding in the file.
const ROUNDING: f64 = 1e-3;

/// Whether the inertias in a file are used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InertiaCheck {
    /// They are believed: an impossible one is an error, friction below zero too.
    Required,
    /// They will be identified or are placeholders: impossible ones pass, and friction below zero counts as none.
    Ignored,
}

/// Which joints of a file are under study.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Choice {
    /// Joints with a coordinate, in any order; without, all that move by themselves.
    pub joints: Option<Vec<String>>,
    /// Link at the end of the arm: where no joints are named, those between the base and it are meant. The flange is there.
    pub tip: Option<String>,
    /// Where joints stand that are not under study, rad or m, by name. Those not named stand in the middle of their range, or
    /// at zero where they have none.
    pub hold: BTreeMap<String, f64>,
}

/// Loads a robot, all of whose joints are under study.
///
/// # Errors
/// As [`description::read`] and [`Description::robot`].
pub fn load(path: impl AsRef<Path>, inertias: InertiaCheck) -> Result<Robot> {
    description::read(path.as_ref())?.robot(&Choice::default(), inertias)
}

/// How a joint of the file moves with the coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Place {
    /// q = multiplier x + offset, x the position of the joint with this index.
    Moves { leader: usize, multiplier: f64, offset: f64 },
    /// It stands at this position.
    Held(f64),
}

impl Description {
    /// The joints that move by themselves, branch by branch outwards, children of a link in the order of the file.
    pub fn masters(&self) -> Vec<&JointDescription> {
        let free = |joint: &&JointDescription| moves(joint) && self.leader(joint).0.name == joint.name;
        self.depth_first().into_iter().map(|joint| &self.joints[joint]).filter(free).collect()
    }

    /// The joints that turn or slide, followers included, branch by branch outwards.
    pub fn moving(&self) -> Vec<&JointDescription> {
        self.depth_first().into_iter().map(|joint| &self.joints[joint]).filter(|joint| moves(joint)).collect()
    }

    fn link(&self, name: &str) -> Result<usize> {
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
        let chain = |link: &description::LinkDescription| {
            let path = self.path_to(&link.name).unwrap_or_default();
            let own = path.iter().map(|joint| joint.name.clone()).filter(|name| masters.contains(&name.as_str()));
            own.collect::<Vec<String>>()
        };
        self.links.iter().map(chain).filter(|chain| chain.len() == count).collect()
    }

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
        Ok(Robot { name, source, gravity: self.gravity, joints, flange, tree, columns, held, notes })
    }

    /// The joints branch by branch, each behind the one that carries it.
    fn depth_first(&self) -> Vec<usize> {
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
    fn leader<'a>(&'a self, joint: &'a JointDescription) -> (&'a JointDescription, f64, f64) {
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

    /// What every joint of the file does.
    fn places(&self, choice: &Choice) -> Result<Vec<Place>> {
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

    /// Moving joints that are held, with a note of where.
    fn held(&self, places: &[Place], choice: &Choice, notes: &mut Vec<String>) -> Vec<(String, f64)> {
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
            let said = |name: &String| choice.hold.contains_key(name);
            let is_given = said(&joint.name) || said(&self.leader(joint).0.name);
            let list = if is_given { &mut given } else { &mut middle };
            list.push(format!("{} {position:.4} {unit}", joint.name));
        }
        for (list, place) in [(given, "as given"), (middle, "in the middle of their range")] {
            if !list.is_empty() {
                notes.push(format!("joints not under study stand still {place}: {}", list.join(", ")));
            }
        }
        held
    }

    fn refused(&self, joint: &JointDescription, problem: impl Into<String>) -> Error {
        Error::input(&self.source, joint.line, format!("joint `{}`", joint.name), problem)
    }
}

/// Whether a joint of the file can have a coordinate.
fn moves(joint: &JointDescription) -> bool {
    joint.kind().is_some()
}

/// The bodies of a robot, as they are put together.
struct Assembly<'a> {
    file: &'a Description,
    inertias: InertiaCheck,
    places: &'a [Place],
    /// Joints of the moving bodies, those with a coordinate first.
    bodies: &'a [usize],
    notes: &'a mut Vec<String>,
}

impl Assembly<'_> {
    /// The moving joint `index` of the file with its body, and the body that carries it.
    fn joint(&mut self, index: usize) -> Result<(Joint, Option<usize>)> {
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
    fn welded(&self, link: usize) -> Vec<(usize, Pose)> {
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

    /// The body that carries the flange, and its pose there: the link asked for, or the one behind the most fixed joints on the
    /// body with the most moving joints before it.
    fn flange(&self, choice: &Choice, made: &[(Joint, Option<usize>)]) -> Result<(usize, Pose)> {
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
        let mut deepest = (0, Pose::identity());
        let mut open = vec![(self.file.joints[self.bodies[tip]].child, Pose::identity(), 0)];
        while let Some((link, place, depth)) = open.pop() {
            if depth > deepest.0 {
                deepest = (depth, place);
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
    fn take_over(&mut self, follower: &Drive, ratio: f64) {
        self.viscous += ratio * ratio * follower.viscous;
        self.coulomb += ratio.abs() * follower.coulomb;
        self.armature += ratio * ratio * follower.armature;
    }
}
