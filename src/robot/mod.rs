//! A robot arm: joints from base to flange, each carrying one rigid body; a tree of them where it branches.

mod choice;
mod coupling;
pub mod description;
mod file_kind;
mod flange;
mod inertia;
mod mjcf;
mod tree;
mod units;
mod urdf;
pub mod visuals;
mod xml;

pub use choice::{Choice, InertiaCheck, load};
pub use coupling::{Coupling, LinearMap};
pub use inertia::{Inertia, PARAMETERS, SYMBOLS, UNITS};
pub use tree::{Follower, Tree};
pub use urdf::{to_urdf, with_parameters};

use crate::error::{Error, Result};
use nalgebra::{Matrix3, Vector3};
use std::path::PathBuf;

/// Standard gravity of the models here, along -z of the base, m/s2 (Pinocchio's default).
pub const GRAVITY: [f64; 3] = [0.0, 0.0, -9.81];

/// Numbers beyond this are no arm's, and their squares would leave double precision.
pub const LARGEST: f64 = 1e9;

/// A fixed pose of a child frame in its parent: x_parent = rotation x_child + translation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// Rotation matrix, child axes in parent coordinates.
    pub rotation: Matrix3<f64>,
    /// Origin of the child in the parent, m.
    pub translation: Vector3<f64>,
}

impl Pose {
    /// The pose that changes nothing.
    pub fn identity() -> Self {
        Pose { rotation: Matrix3::identity(), translation: Vector3::zeros() }
    }

    /// This pose followed by `inner`, which is given in this pose's child frame.
    pub fn then(&self, inner: &Pose) -> Pose {
        Pose {
            rotation: self.rotation * inner.rotation,
            translation: self.rotation * inner.translation + self.translation,
        }
    }
}

/// How a joint moves along or about its axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum JointKind {
    /// Turns about the axis; coordinates in rad, efforts in N m.
    Revolute,
    /// Slides along the axis; coordinates in m, efforts in N.
    Prismatic,
}

impl JointKind {
    /// Pose of the moved joint frame in the joint frame at zero, for a joint of this kind with the unit vector `axis`.
    pub fn motion(self, axis: &Vector3<f64>, q: f64) -> Pose {
        match self {
            JointKind::Revolute => {
                let rotation =
                    nalgebra::Rotation3::from_axis_angle(&nalgebra::Unit::new_unchecked(*axis), q).into_inner();
                Pose { rotation, translation: Vector3::zeros() }
            }
            JointKind::Prismatic => Pose { rotation: Matrix3::identity(), translation: q * axis },
        }
    }
}

/// Limits of a joint, in rad (or m), rad/s (or m/s), and N m (or N). Infinite where the URDF gives none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Lowest position.
    pub lower: f64,
    /// Highest position.
    pub upper: f64,
    /// Highest speed.
    pub velocity: f64,
    /// Highest effort of the drive.
    pub effort: f64,
}

/// Friction and rotor of a joint's drive, at the joint side of the gear.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Drive {
    /// Viscous friction Fv, N m s/rad.
    pub viscous: f64,
    /// Coulomb friction Fc, N m.
    pub coulomb: f64,
    /// Rotor inertia reflected to the joint Ia, kg m2.
    pub armature: f64,
}

/// One joint and the body it carries.
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    /// Name of the joint in the URDF.
    pub name: String,
    /// Name of the link it carries.
    pub link: String,
    /// Revolute or prismatic.
    pub kind: JointKind,
    /// Pose of the joint frame at zero position in the frame of the joint that carries it (or the base).
    pub origin: Pose,
    /// Unit axis in the joint frame.
    pub axis: Vector3<f64>,
    /// Position, velocity and effort limits.
    pub limits: Limits,
    /// The body, links behind fixed joints included, about the joint frame.
    pub inertia: Inertia,
    /// Friction and rotor inertia as the URDF gives them.
    pub drive: Drive,
}

/// A robot of one or more revolute or prismatic joints with a coordinate each, and of joints that follow them.
#[derive(Debug, Clone, PartialEq)]
pub struct Robot {
    /// Name of the robot in the URDF.
    pub name: String,
    /// The file it came from.
    pub source: PathBuf,
    /// Gravity in base coordinates, m/s2.
    pub gravity: Vector3<f64>,
    /// The joints with a coordinate, from base to flange; on a tree branch by branch.
    pub joints: Vec<Joint>,
    /// Pose of the flange (the last link behind fixed joints) in the frame of the joint that carries it.
    pub flange: Pose,
    /// What a serial arm does not have; absent on one.
    pub tree: Option<Tree>,
    /// Joints that the columns of a log stand for where they are numbered or described one by one: those under study, and those
    /// that turned out to stand still or to follow.
    pub columns: Vec<String>,
    /// Moving joints of the file that stand still here, each at its position, rad or m.
    pub held: Vec<(String, f64)>,
    /// What was read otherwise than it is written, and which joints are held; a line each.
    pub notes: Vec<String>,
}

impl Robot {
    /// Number of coordinates.
    pub fn dof(&self) -> usize {
        self.joints.len()
    }

    /// Joint names from base to flange.
    pub fn joint_names(&self) -> Vec<String> {
        self.joints.iter().map(|joint| joint.name.clone()).collect()
    }

    /// Inertial parameters of all moving bodies, ten each, in the order of [`Robot::body`].
    pub fn inertial_parameters(&self) -> Vec<f64> {
        (0..self.bodies()).flat_map(|body| self.body(body).inertia.0).collect()
    }

    /// Index of the joint called `name`; the error lists the joints there are.
    pub fn joint_index(&self, name: &str) -> Result<usize> {
        self.joints.iter().position(|joint| joint.name == name).ok_or_else(|| {
            Error::request(
                format!("joint `{name}`"),
                format!("{} has no such joint; its joints are {}", self.name, self.joint_names().join(", ")),
            )
        })
    }

    /// Poses of all moving joint frames, in the order of [`Robot::body`], and of the flange as the last entry, in the base at
    /// the coordinates `x`.
    pub fn frames(&self, x: &[f64]) -> Vec<Pose> {
        let mut frames = vec![Pose::identity(); self.bodies() + 1];
        for body in self.outwards() {
            let (joint, coupling) = (self.body(body), self.coupling(body));
            let carrier = self.parent(body).map_or(Pose::identity(), |parent| frames[parent]);
            let moved = joint.motion(coupling.position(x[coupling.coordinate]));
            frames[body] = carrier.then(&joint.origin).then(&moved);
        }
        frames[self.bodies()] = frames[self.tip()].then(&self.flange);
        frames
    }
}

impl Drive {
    /// Takes away what is beyond any machine, with a note: such numbers fix a joint, or are placeholders.
    fn credible(mut self, joint: &str, line: usize, notes: &mut Vec<String>) -> Drive {
        for (value, attribute) in
            [(&mut self.viscous, "damping"), (&mut self.coulomb, "friction"), (&mut self.armature, "armature")]
        {
            if value.abs() > LARGEST {
                notes.push(format!(
                    "joint `{joint}` (line {line}): {attribute} {value:e} is beyond any machine and counts as none"
                ));
                *value = 0.0;
            }
        }
        self
    }
}

impl Joint {
    /// Pose of the moved joint frame in the joint frame at zero.
    pub fn motion(&self, q: f64) -> Pose {
        self.kind.motion(&self.axis, q)
    }
}
