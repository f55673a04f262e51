//! A robot as its file describes it: a tree of links and joints of every kind, before it is decided which joints move.

use crate::robot::model::{Actuator, Addresses, Drive, Inertia, JointKind, Limits, Pose};
use nalgebra::Vector3;
use std::path::PathBuf;

/// How a joint of a file moves.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::robot::description::{self, Motion};
///
/// let file = description::read("../tests/reference/trees/two_finger.urdf".as_ref())?;
/// let of = |motion| file.joints.iter().filter(|joint| joint.motion == motion).count();
/// assert_eq!((of(Motion::Revolute), of(Motion::Prismatic), of(Motion::Fixed)), (4, 2, 3));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Motion {
    /// Not at all.
    Fixed,
    /// Turns about its axis, with or without a range.
    Revolute,
    /// Slides along its axis.
    Prismatic,
    /// Six degrees of freedom: the free base of a simulation. No drive moves it; it is held at zero.
    Floating,
    /// Three degrees of freedom in a plane: the base of a mobile robot. It is held at zero.
    Planar,
}

/// A joint that follows another: q = multiplier q_master + offset.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::robot::description;
///
/// // <joint name="finger_right_joint" ..> <mimic joint="finger_left_joint"/>
/// let file = description::read("../tests/reference/trees/two_finger.urdf".as_ref())?;
/// let mimic = file.joints.iter().find_map(|joint| joint.mimic.as_ref()).expect("a finger follows the other");
/// assert_eq!((&mimic.master[..], mimic.multiplier, mimic.offset), ("finger_left_joint", 1.0, 0.0));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Mimic {
    /// Name of the joint that is followed; it may itself follow another.
    pub master: String,
    /// Ratio of the velocities.
    pub multiplier: f64,
    /// Position at zero position of the master, rad or m.
    pub offset: f64,
}

/// A number of a body that a file leaves out; it counts as zero where the body does not matter.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::robot::{Choice, InertiaCheck, description};
///
/// let text = r#"<robot name="r"><link name="base"/>
/// <joint name="j" type="continuous"><parent link="base"/><child link="rod"/><axis xyz="0 1 0"/></joint>
/// <link name="rod"><inertial><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"#;
/// let file = description::parse(text, "r.urdf")?;
/// let missing = file.links[1].missing.as_ref().expect("the rod has no mass");
/// assert_eq!((missing.line, &missing.field[..]), (3, "value of <mass> in `rod`"));
///
/// // It matters where the inertias are to be believed.
/// assert!(file.robot(&Choice::default(), InertiaCheck::Ignored).is_ok());
/// assert!(file.robot(&Choice::default(), InertiaCheck::Required).is_err());
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Missing {
    /// Line in the file, counted from 1.
    pub line: usize,
    /// The attribute, its element and the link.
    pub field: String,
    /// What is wrong and what to do.
    pub problem: String,
}

/// A link of a file.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::robot::description;
///
/// // Every link of the file, whether or not it moves.
/// let file = description::read("../tests/reference/pendulum.urdf".as_ref())?;
/// let names: Vec<&str> = file.links.iter().map(|link| &link.name[..]).collect();
/// assert_eq!(names, ["stand", "rod"]);
/// assert_eq!((file.links[1].inertia.mass(), &file.links[1].missing), (2.0, &None));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct LinkDescription {
    /// Its name.
    pub name: String,
    /// Its body about and in the axes of the link frame, as the file gives it: it need not be one that can exist, but its
    /// numbers are finite. Zero where the file gives none.
    pub inertia: Inertia,
    /// What the file leaves out of the body although it gives one: an error where the body is to be believed.
    pub missing: Option<Missing>,
    /// Share of its weight that a force at its centre of mass carries in a simulation (`gravcomp` of MuJoCo); zero elsewhere.
    pub gravcomp: f64,
    /// Line in the file, for error messages.
    pub line: Option<usize>,
}

/// A joint of a file.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::robot::{JointKind, description};
///
/// let file = description::read("../tests/reference/pendulum.urdf".as_ref())?;
/// let pivot = &file.joints[0];
/// assert_eq!((&pivot.name[..], pivot.kind()), ("pivot", Some(JointKind::Revolute)));
/// assert_eq!((&file.links[pivot.parent].name[..], &file.links[pivot.child].name[..]), ("stand", "rod"));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct JointDescription {
    /// Its name.
    pub name: String,
    /// How it moves.
    pub motion: Motion,
    /// Index of the link that carries it.
    pub parent: usize,
    /// Index of the link it carries.
    pub child: usize,
    /// Pose of the joint frame at zero position in the frame of the parent link. The child's link frame is the moved joint
    /// frame.
    pub origin: Pose,
    /// Unit axis in the joint frame.
    pub axis: Vector3<f64>,
    /// Limits; infinite where the file gives none. An effort or speed limit of zero means none.
    pub limits: Limits,
    /// Friction and rotor inertia as the file gives them: finite, but a fit may have made them negative.
    pub drive: Drive,
    /// The joint it follows.
    pub mimic: Option<Mimic>,
    /// Line in the file, for error messages.
    pub line: Option<usize>,
}

impl JointDescription {
    /// How it moves if it can have a coordinate; None where it does not turn or slide.
    pub fn kind(&self) -> Option<JointKind> {
        match self.motion {
            Motion::Revolute => Some(JointKind::Revolute),
            Motion::Prismatic => Some(JointKind::Prismatic),
            Motion::Fixed | Motion::Floating | Motion::Planar => None,
        }
    }
}

/// A robot as described by a file. Its reader guarantees: names are unique, every link but one has exactly one joint above
/// it, all are reached from that root, every `master` exists and no chain of followers closes on itself.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::robot::{Choice, InertiaCheck, description};
///
/// // The file has 13 links and joints; which of them move is decided afterwards.
/// let file = description::read("../tests/reference/trees/two_finger.urdf".as_ref())?;
/// assert_eq!(file.links[file.root()].name, "world");
///
/// let whole = file.robot(&Choice::default(), InertiaCheck::Required)?;
/// let choice = Choice { tip: Some("tcp".to_owned()), ..Choice::default() };
/// let without_fingers = file.robot(&choice, InertiaCheck::Required)?;
/// assert_eq!((whole.dof(), without_fingers.dof()), (5, 4));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Description {
    /// Name of the robot.
    pub name: String,
    /// The file.
    pub source: PathBuf,
    /// Gravity in base coordinates, m/s2.
    pub gravity: Vector3<f64>,
    /// Links in the order of the file.
    pub links: Vec<LinkDescription>,
    /// Joints in the order of the file.
    pub joints: Vec<JointDescription>,
    /// Motors that the file names.
    pub actuators: Vec<Actuator>,
    /// Places of the joints and motors in the vectors of a simulator; empty where the file is none of one.
    pub addresses: Addresses,
    /// What was read otherwise than it is written, a line each: units recognised, rounded angles, friction below zero.
    pub notes: Vec<String>,
}

impl Description {
    /// Index of the link without a joint above it.
    pub fn root(&self) -> usize {
        (0..self.links.len()).find(|&link| self.joints.iter().all(|joint| joint.child != link)).unwrap_or(0)
    }

    /// The joint above a link.
    pub(crate) fn joint_above(&self, link: usize) -> Option<usize> {
        self.joints.iter().position(|joint| joint.child == link)
    }

    /// The joints that hang on a link, in the order of the file.
    pub(crate) fn joints_on(&self, link: usize) -> impl Iterator<Item = usize> {
        (0..self.joints.len()).filter(move |&joint| self.joints[joint].parent == link)
    }
}
