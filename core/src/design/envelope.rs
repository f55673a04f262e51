//! Limits of an arm beyond the position, velocity and acceleration of its joints: the torque of the drives, the floor,
//! and a column around the base that wrist and tool stay out of.
//!
//! The points watched are the origins of the joint frames from the fourth joint on, and the flange. A point is inside the
//! column when it is nearer to the base's z axis than the column's radius and below its top.

use super::information::Samples;
use crate::channels::Channels;
use crate::dynamics::{Chain, Point, coordinates, inverse_dynamics_at};
use crate::effects::direction;
use crate::error::{Error, Result};
use crate::excitation::{JointLimits, Reference, limits};
use crate::robot::Robot;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Rate at which a motion is checked before it is returned, Hz.
pub const CHECK_RATE_HZ: f64 = 10_000.0;

/// Joints before this one carry no point that is watched: they place the arm, those after them turn its wrist.
const FIRST_WATCHED: usize = 3;

/// What the search keeps clear of on its coarse grid, so that the limits hold between the samples: m, share of the effort.
const SEARCH_MARGIN_M: f64 = 0.01;
const SEARCH_MARGIN_EFFORT: f64 = 0.02;

/// The space the arm may use, in the base frame.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::design::{Envelope, Workspace};
/// use tauscope::excitation::JointLimits;
/// use tauscope::robot::{self, InertiaCheck};
///
/// // A floor at the height of the base, and a column around it. The arm at zero is clear of both.
/// let arm = robot::load("../urdf/irb1600_6_120.urdf", InertiaCheck::Required)?;
/// let limits = vec![JointLimits { lower: -0.5, upper: 0.5, velocity: 2.0, acceleration: 10.0 }; 6];
/// let workspace = Workspace { floor_m: 0.0, column_radius_m: 0.35, column_top_m: 0.7 };
/// assert!(Envelope::new(&arm, &limits, Some(workspace)).is_ok());
///
/// // Where motions start it must be, so that a floor above the arm is refused.
/// assert!(Envelope::new(&arm, &limits, Some(Workspace { floor_m: 2.0, ..workspace })).is_err());
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Workspace {
    /// Height of the floor, m: wrist and tool stay above.
    pub floor_m: f64,
    /// Radius of the column around the base that wrist and tool stay out of, m; zero for none.
    pub column_radius_m: f64,
    /// Top of that column, m.
    pub column_top_m: f64,
}

impl Workspace {
    fn validate(&self) -> Result<()> {
        for (name, value) in
            [("floor_m", self.floor_m), ("column_radius_m", self.column_radius_m), ("column_top_m", self.column_top_m)]
        {
            if !value.is_finite() {
                return Err(Error::request(format!("workspace.{name}"), format!("must be a number, found {value}")));
            }
        }
        Ok(())
    }

    /// Height of a point over the floor, m.
    fn above_floor(&self, point: &Vector3<f64>) -> f64 {
        point.z - self.floor_m
    }

    /// Distance of a point to the column (by the nearer of side and top), m; negative inside.
    fn outside_column(&self, point: &Vector3<f64>) -> f64 {
        ((point.x * point.x + point.y * point.y).sqrt() - self.column_radius_m).max(point.z - self.column_top_m)
    }
}

/// How far a motion is outside, averaged over its samples: zero when it keeps all limits with the search's margin.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Violation {
    /// Torque beyond the effort limits, in units of them, summed over the joints.
    pub torque: f64,
    /// Depth under the floor, m, summed over the points.
    pub floor: f64,
    /// Depth inside the column, m, summed over the points.
    pub column: f64,
}

impl Violation {
    /// All parts together; m and shares of the effort count alike.
    pub fn total(&self) -> f64 {
        self.torque + self.floor + self.column
    }

    /// Whether all limits are kept.
    pub fn is_none(&self) -> bool {
        self.total() == 0.0
    }
}

/// The closest a motion comes to each limit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Clearance {
    /// Largest share of any effort limit, 0 to 1.
    pub effort_used: f64,
    /// Least height over the floor, m; none without a workspace.
    pub floor_m: Option<f64>,
    /// Least distance to the column, m.
    pub column_m: Option<f64>,
}

/// The limits of an arm.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::design::Envelope;
/// use tauscope::excitation::{JointLimits, random_sequence::random_sequence};
/// use tauscope::robot::{self, InertiaCheck};
///
/// let mut pendulum = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Required)?;
/// let limits = [JointLimits { lower: -2.0, upper: 2.0, velocity: 3.0, acceleration: 20.0 }];
/// let motion = random_sequence(1, "motion", 0, 4, 6.0, &limits)?;
/// let clearance = Envelope::new(&pendulum, &limits, None)?.check(&motion)?;
/// assert!(clearance.effort_used < 1.0);
///
/// // A weaker drive cannot follow it.
/// pendulum.joints[0].limits.effort = 0.5 * clearance.effort_used * pendulum.joints[0].limits.effort;
/// assert!(Envelope::new(&pendulum, &limits, None)?.check(&motion).is_err());
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Envelope {
    robot: Robot,
    chain: Chain,
    inertial: Vec<f64>,
    joints: Vec<JointLimits>,
    workspace: Option<Workspace>,
    /// The points watched, those of [`Envelope::watched`].
    points: Vec<Point>,
}

impl Envelope {
    /// Limits of `robot`; efforts are those it carries, `joints` the others.
    ///
    /// # Errors
    /// Names the limit that rest at zero, where every motion starts and ends, does not keep.
    pub fn new(robot: &Robot, joints: &[JointLimits], workspace: Option<Workspace>) -> Result<Self> {
        let envelope = Envelope {
            robot: robot.clone(),
            chain: Chain::new(robot),
            inertial: robot.inertial_parameters(),
            joints: joints.to_vec(),
            workspace,
            points: points(robot),
        };
        for (limits, joint) in joints.iter().zip(&robot.joints) {
            limits.validate(&joint.name)?;
        }
        workspace.map_or(Ok(()), |workspace| workspace.validate())?;
        let zero = vec![0.0; robot.dof()];
        envelope.keeps([&zero, &zero, &zero], &mut Margins::default()).map_err(|passed| {
            Error::request(
                passed.subject,
                format!("{} in the zero pose, where every motion starts and ends; {}", passed.what, passed.advice),
            )
        })?;
        Ok(envelope)
    }

    /// The arm.
    pub fn robot(&self) -> &Robot {
        &self.robot
    }

    /// Limits on position, velocity and acceleration.
    pub fn joints(&self) -> &[JointLimits] {
        &self.joints
    }

    /// How far `samples` are outside, summed over them; divide by their number for the mean.
    pub(super) fn violation(&self, samples: &Samples) -> Violation {
        let mut sum = Violation::default();
        for (joint, tau) in self.robot.joints.iter().zip(samples.torque.iter()) {
            let effort = joint.limits.effort * (1.0 - SEARCH_MARGIN_EFFORT);
            sum.torque += tau.iter().map(|t| (t.abs() / effort - 1.0).max(0.0)).sum::<f64>();
        }
        if let Some(workspace) = &self.workspace {
            self.violation_of(workspace, &samples.motion.q, &mut sum);
        }
        sum
    }

    fn violation_of(&self, workspace: &Workspace, q: &Channels, sum: &mut Violation) {
        let places = coordinates(&self.chain, q, &self.points);
        let depth = |clearance: f64| (SEARCH_MARGIN_M - clearance).max(0.0);
        for point in 0..self.points.len() {
            let [x, y, z] = [0, 1, 2].map(|axis| places.channel(3 * point + axis));
            for ((&x, &y), &z) in x.iter().zip(y).zip(z) {
                let place = Vector3::new(x, y, z);
                sum.floor += depth(workspace.above_floor(&place));
                sum.column += depth(workspace.outside_column(&place));
            }
        }
    }

    fn watched<'a, T>(&self, frames: &'a [T]) -> &'a [T] {
        &frames[FIRST_WATCHED.min(self.robot.bodies())..]
    }

    /// Checks that `motion` keeps every limit in samples at [`CHECK_RATE_HZ`]; those of the joints at all times where the
    /// motion's law gives.
    ///
    /// # Errors
    /// Names the limit passed, when and by how much.
    pub fn check(&self, motion: &dyn Reference) -> Result<Clearance> {
        limits::check(motion, &self.joints, CHECK_RATE_HZ, &self.robot.joint_names())?;
        let dof = self.robot.dof();
        let [mut q, mut qd, mut qdd] = [(); 3].map(|()| vec![0.0; dof]);
        let mut margins = Margins::default();
        let steps = (motion.duration_s() * CHECK_RATE_HZ).floor() as u64;
        for t in (0..=steps).map(|k| k as f64 / CHECK_RATE_HZ) {
            motion.at(t, &mut q, &mut qd, &mut qdd);
            self.keeps([&q, &qd, &qdd], &mut margins).map_err(|passed| {
                Error::request(passed.subject, format!("{} at t = {t:.4} s; {}", passed.what, passed.advice))
            })?;
        }
        Ok(Clearance {
            effort_used: margins.effort_used,
            floor_m: self.workspace.map(|_| margins.floor),
            column_m: self.workspace.map(|_| margins.column),
        })
    }

    /// Checks one state.
    fn keeps(&self, [q, qd, qdd]: [&[f64]; 3], margins: &mut Margins) -> std::result::Result<(), Passed> {
        for (index, joint) in self.robot.joints.iter().enumerate() {
            let limits = &self.joints[index];
            let inside = q[index] >= limits.lower && q[index] <= limits.upper;
            let slow = qd[index].abs() <= limits.velocity && qdd[index].abs() <= limits.acceleration;
            if !(inside && slow) {
                return Err(Passed {
                    subject: joint.name.clone(),
                    what: format!("passes its position, velocity or acceleration limit at {:.5} rad", q[index]),
                    advice: "slow the motion down or make it smaller",
                });
            }
        }
        for (index, tau) in self.torque(q, qd, qdd).into_iter().enumerate() {
            let joint = &self.robot.joints[index];
            let used = tau.abs() / joint.limits.effort;
            // Written so that a torque that is not a number counts as passed.
            let kept = used <= 1.0;
            if !kept {
                return Err(Passed {
                    subject: joint.name.clone(),
                    what: format!(
                        "takes {tau:.2} {unit}, more than its torque limit of {:.2} {unit},",
                        joint.limits.effort,
                        unit = joint.effort_unit()
                    ),
                    advice: "raise the effort limit or lower the load",
                });
            }
            margins.effort_used = margins.effort_used.max(used);
        }
        self.workspace.map_or(Ok(()), |workspace| self.keeps_clear(&workspace, q, margins))
    }

    fn keeps_clear(&self, workspace: &Workspace, q: &[f64], margins: &mut Margins) -> std::result::Result<(), Passed> {
        let frames = self.robot.frames(q);
        let watched = self.watched(&frames);
        for (index, frame) in watched.iter().enumerate() {
            let point = &frame.translation;
            let (floor, column) = (workspace.above_floor(point), workspace.outside_column(point));
            let name = || match self.robot.joints.get(FIRST_WATCHED + index) {
                Some(joint) if index + 1 < watched.len() => format!("the frame of {}", joint.name),
                _ => "the flange".to_owned(),
            };
            if floor < 0.0 {
                return Err(Passed {
                    subject: "workspace.floor_m".to_owned(),
                    what: format!("{} is {:.3} m below the floor at z = {} m", name(), -floor, workspace.floor_m),
                    advice: "lower the floor",
                });
            }
            if column < 0.0 {
                let (radius, top) = (workspace.column_radius_m, workspace.column_top_m);
                return Err(Passed {
                    subject: "workspace.column_radius_m".to_owned(),
                    what: format!(
                        "{} is inside the column of {radius} m up to z = {top} m by {:.3} m",
                        name(),
                        -column
                    ),
                    advice: "make the column smaller",
                });
            }
            margins.floor = margins.floor.min(floor);
            margins.column = margins.column.min(column);
        }
        Ok(())
    }

    /// Torque of the motors: rigid bodies, rotors, friction. At standstill dry friction counts against whatever else acts.
    fn torque(&self, q: &[f64], qd: &[f64], qdd: &[f64]) -> Vec<f64> {
        let mut tau = inverse_dynamics_at(&self.chain, &self.inertial, q, qd, qdd);
        for (index, (tau, joint)) in tau.iter_mut().zip(&self.robot.joints).enumerate() {
            let drive = joint.drive;
            *tau += drive.armature * qdd[index] + drive.viscous * qd[index];
            let heading = if qd[index] == 0.0 { tau.signum() } else { direction(qd[index], 0.0) };
            *tau += drive.coulomb * heading;
        }
        tau
    }
}

/// Origins of the frames of the joints watched, and the flange.
fn points(robot: &Robot) -> Vec<Point> {
    let origins = (FIRST_WATCHED..robot.bodies()).map(|link| Point { link, place: [0.0; 3] });
    let flange = Point { link: robot.tip(), place: robot.flange.translation.into() };
    origins.chain([flange]).collect()
}

/// A limit passed.
struct Passed {
    subject: String,
    what: String,
    advice: &'static str,
}

/// The closest approach to each limit so far.
struct Margins {
    effort_used: f64,
    floor: f64,
    column: f64,
}

impl Default for Margins {
    fn default() -> Self {
        Margins { effort_used: 0.0, floor: f64::INFINITY, column: f64::INFINITY }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{WORKSPACE, irb1600, limits};
    use super::*;
    use crate::excitation::freudenstein::{FreudensteinSequence, JointMoves};

    /// All joints stand still but one, which goes to `to` and back in 4 s.
    fn out_and_back(joint: usize, to: f64) -> FreudensteinSequence {
        let mut joints = vec![JointMoves { duration_s: vec![4.0], via: vec![] }; 6];
        joints[joint] = JointMoves { duration_s: vec![2.0, 2.0], via: vec![to] };
        FreudensteinSequence::new(4.0, joints).unwrap()
    }

    fn envelope(workspace: Workspace) -> Envelope {
        let robot = irb1600();
        Envelope::new(&robot, &limits(&robot), Some(workspace)).unwrap()
    }

    #[test]
    fn floor_and_column_are_kept_or_named() {
        let wide = envelope(WORKSPACE);
        let clearance = wide.check(&out_and_back(0, 1.0)).unwrap();
        // Turning about the vertical axis keeps the forearm at z = 0.9615 m.
        assert!((clearance.floor_m.unwrap() - 0.9615).abs() < 1e-9, "{clearance:?}");
        // Leaning forward by 100 deg puts the outstretched arm through the floor.
        let message = wide.check(&out_and_back(1, 1.745)).unwrap_err().to_string();
        assert!(message.contains("floor_m") && message.contains("t = ") && message.contains("joint_6"), "{message}");
        // Folding the forearm straight down next to a wide column runs into it.
        let message = envelope(Workspace { column_radius_m: 0.6, column_top_m: 0.9, ..WORKSPACE })
            .check(&out_and_back(2, 0.9))
            .unwrap_err()
            .to_string();
        assert!(message.contains("column"), "{message}");
    }

    #[test]
    fn torque_beyond_the_effort_is_named() {
        let mut robot = irb1600();
        robot.joints[0].limits.effort = 100.0;
        let tight = Envelope::new(&robot, &limits(&robot), None).unwrap();
        let message = tight.check(&out_and_back(0, 1.0)).unwrap_err().to_string();
        assert!(message.contains("joint_1") && message.contains("torque limit of 100.00"), "{message}");
    }

    #[test]
    fn limits_that_the_zero_pose_passes_are_named() {
        let robot = irb1600();
        let refusal =
            |robot: &Robot, workspace| Envelope::new(robot, &limits(robot), Some(workspace)).unwrap_err().to_string();
        let message = refusal(&robot, Workspace { floor_m: 1.2, ..WORKSPACE });
        assert!(message.contains("floor_m") && message.contains("zero pose"), "{message}");
        let message = refusal(&robot, Workspace { column_radius_m: 2.0, column_top_m: 2.0, ..WORKSPACE });
        assert!(message.contains("column") && message.contains("zero pose"), "{message}");
        assert!(refusal(&robot, Workspace { floor_m: f64::NAN, ..WORKSPACE }).contains("floor_m"));
        let mut weak = irb1600();
        weak.joints[2].limits.effort = 20.0;
        let message = refusal(&weak, WORKSPACE);
        assert!(message.contains("joint_3") && message.contains("zero pose"), "{message}");
        let mut bounds = limits(&robot);
        bounds[1].lower = 0.3;
        let message = Envelope::new(&robot, &bounds, None).unwrap_err().to_string();
        assert!(message.contains("joint_2") && message.contains("lower"), "{message}");
    }
}
