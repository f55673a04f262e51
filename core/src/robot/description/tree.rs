//! A robot as its file describes it: a tree of links and joints of every kind, before it is decided which joints move.

use crate::robot::model::{Drive, Inertia, JointKind, Limits, Pose};
use nalgebra::Vector3;
use std::path::PathBuf;

/// How a joint of a file moves.
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
#[derive(Debug, Clone, PartialEq)]
pub struct LinkDescription {
    /// Its name.
    pub name: String,
    /// Its body about and in the axes of the link frame, as the file gives it: it need not be one that can exist, but its
    /// numbers are finite. Zero where the file gives none.
    pub inertia: Inertia,
    /// What the file leaves out of the body although it gives one: an error where the body is to be believed.
    pub missing: Option<Missing>,
    /// Line in the file, for error messages.
    pub line: Option<usize>,
}

/// A joint of a file.
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
    /// What was read otherwise than it is written, a line each: units recognised, rounded angles, friction below zero.
    pub notes: Vec<String>,
}

impl Description {
    /// Index of the link without a joint above it.
    pub fn root(&self) -> usize {
        (0..self.links.len()).find(|&link| self.joints.iter().all(|joint| joint.child != link)).unwrap_or(0)
    }

    /// The joint above a link.
    pub fn joint_above(&self, link: usize) -> Option<usize> {
        self.joints.iter().position(|joint| joint.child == link)
    }

    /// The joints that hang on a link, in the order of the file.
    pub fn joints_on(&self, link: usize) -> impl Iterator<Item = usize> {
        (0..self.joints.len()).filter(move |&joint| self.joints[joint].parent == link)
    }
}
