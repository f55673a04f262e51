//! A robot as it is modelled: coordinates, bodies and flange.

use super::actuator::Actuator;
use super::addresses::Addresses;
use super::joint::{Joint, JointKind};
use super::pose::Pose;
use super::tree::Tree;
use crate::error::{Error, Result};
use nalgebra::Vector3;
use std::path::PathBuf;

/// Part of gravity from which a joint feels it: less is how exactly an arm stands.
const LEAST_PART: f64 = 0.05;

/// What a robot that was read from a text has in the place of its file.
pub(crate) const TEXT: &str = "<text>";

/// A robot of one or more revolute or prismatic joints with a coordinate each, and of joints that follow them.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::robot::{self, InertiaCheck};
///
/// let robot = robot::load("../urdf/irb1600_6_120.urdf", InertiaCheck::Required)?;
/// assert_eq!((robot.dof(), robot.joint_index("joint_3")?), (6, 2));
///
/// // Gravity does not turn joint 1, whose axis is vertical in every pose.
/// assert!(!robot.feels_gravity(0) && robot.feels_gravity(1));
///
/// // Six joint frames and the flange, which lies within the arm's reach.
/// let frames = robot.frames(&[0.0, 0.5, -0.3, 0.0, 0.2, 0.0]);
/// assert_eq!(frames.len(), 7);
/// assert!(frames[6].translation.norm() < robot.reach());
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Robot {
    /// Name of the robot in the URDF.
    pub name: String,
    /// The file it came from; `<text>` where it came from a text.
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
    /// Motors that the file names, of all of its joints.
    pub actuators: Vec<Actuator>,
    /// Places of the file's joints and motors in the vectors of a simulator; empty where it is none of one.
    pub addresses: Addresses,
    /// Moving joints of the file that stand still here, each at its position, rad or m.
    pub held: Vec<(String, f64)>,
    /// Those of them that turn what the joints under study stand on, at a position that neither a log nor anyone gave.
    pub assumed: Vec<String>,
    /// Those of them that stand on a joint that moves, at a position that neither a log nor anyone gave, each with that joint.
    pub guessed: Vec<(String, String)>,
    /// Links whose weight a force of the simulator carries (`gravcomp` of MuJoCo), where other links that move have another share of theirs:
    /// inertia and weight of the described bodies then need not be those of the torques. Empty where all have the same share, none or all.
    pub lifted: Vec<String>,
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

    /// Longest way from the base to the flange along the links, m; of an arm whose links have no length, 1 m.
    pub fn reach(&self) -> f64 {
        let bodies = (0..self.bodies()).map(|body| self.body(body).origin.translation.norm());
        let slides = |joint: &Joint| match joint.kind {
            JointKind::Prismatic if joint.limits.upper.is_finite() => joint.limits.upper.abs(),
            _ => 0.0,
        };
        let reach = bodies.sum::<f64>() + self.flange.translation.norm() + self.joints.iter().map(slides).sum::<f64>();
        if reach > 0.0 { reach } else { 1.0 }
    }

    /// Whether gravity can turn or move a joint: whether in some pose its axis leaves the direction in which it has no part in that,
    /// which is gravity's own for a joint that turns and a level one for a joint that slides.
    pub fn feels_gravity(&self, coordinate: usize) -> bool {
        // Poses in which no two joints stand alike; an axis that keeps its direction in all of them keeps it.
        let pose = |step: usize| (0..self.dof()).map(|k| (step * (k + 1)) as f64 * 0.7).collect::<Vec<f64>>();
        let down = self.gravity.normalize();
        let moved = |body: &usize| self.coupling(*body).coordinate == coordinate;
        (0..3).any(|step| {
            let frames = self.frames(&pose(step));
            (0..self.bodies()).filter(moved).any(|body| {
                let joint = self.body(body);
                let axis = frames[body].rotation * joint.axis;
                match joint.kind {
                    JointKind::Prismatic => axis.dot(&down).abs() > LEAST_PART,
                    _ => axis.cross(&down).norm() > LEAST_PART,
                }
            })
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

#[cfg(test)]
mod tests {
    use crate::robot::{InertiaCheck, load};
    use nalgebra::Vector3;

    #[test]
    fn an_axis_along_gravity_in_every_pose_does_not_feel_it() {
        let urdf = concat!(env!("CARGO_MANIFEST_DIR"), "/../urdf/irb1600_6_120.urdf");
        let mut robot = load(urdf, InertiaCheck::Required).unwrap();
        let felt = |robot: &super::Robot| (0..6).map(|joint| robot.feels_gravity(joint)).collect::<Vec<bool>>();
        assert_eq!(felt(&robot), [false, true, true, true, true, true]);
        // Six hundredths from upright are felt, four are how exactly an arm stands.
        for (tilt, feels) in [(0.04, false), (0.06, true)] {
            robot.gravity = Vector3::new(9.81 * tilt, 0.0, -9.81);
            assert_eq!(felt(&robot)[0], feels, "{tilt}");
        }
    }
}
