//! Joints: how they move, their limits and their drives, and the body that each carries.

use super::constants::LARGEST;
use super::inertia::Inertia;
use super::pose::Pose;
use nalgebra::{Matrix3, Vector3};

/// How a joint moves along or about its axis.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use nalgebra::Vector3;
/// use tauscope::robot::JointKind;
///
/// // A rail slides along its axis and keeps its attitude.
/// let moved = JointKind::Prismatic.motion(&Vector3::x(), 0.3);
/// assert_eq!(moved.translation, Vector3::new(0.3, 0.0, 0.0));
/// assert_eq!(moved.rotation, nalgebra::Matrix3::identity());
/// ```
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
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::robot::{self, InertiaCheck};
///
/// // A joint that turns without end has limits of speed and effort alone.
/// let pendulum = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Required)?;
/// let limits = pendulum.joints[0].limits;
/// assert_eq!((limits.lower, limits.upper), (f64::NEG_INFINITY, f64::INFINITY));
/// assert_eq!((limits.velocity, limits.effort), (8.0, 60.0));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
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

impl Limits {
    /// By how much positions leave the limits, rad (m); zero or less where they do not.
    pub(crate) fn left_by(&self, positions: &[f64]) -> f64 {
        positions.iter().map(|q| (self.lower - q).max(q - self.upper)).fold(f64::NEG_INFINITY, f64::max)
    }
}

/// Friction and rotor of a joint's drive, at the joint side of the gear.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::robot::{self, Drive, InertiaCheck};
///
/// // <dynamics damping="0.4" friction="0.6" armature="0.1"/>
/// let pendulum = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Required)?;
/// assert_eq!(pendulum.joints[0].drive, Drive { viscous: 0.4, coulomb: 0.6, armature: 0.1 });
/// assert!(Drive::default().is_frictionless());
/// # Ok::<(), tauscope::error::Error>(())
/// ```
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
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::robot::{self, InertiaCheck, JointKind};
///
/// let pendulum = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Required)?;
/// let pivot = &pendulum.joints[0];
/// assert_eq!((&pivot.name[..], &pivot.link[..], pivot.kind), ("pivot", "rod", JointKind::Revolute));
///
/// // A quarter turn about y lifts the centre of mass from below the pivot to its side.
/// let center = pivot.motion(std::f64::consts::FRAC_PI_2).rotation * pivot.inertia.center_of_mass();
/// assert!((center.x.abs() - 0.5).abs() < 1e-12 && center.z.abs() < 1e-12);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
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

impl Drive {
    /// Whether it has no friction.
    pub fn is_frictionless(&self) -> bool {
        self.viscous == 0.0 && self.coulomb == 0.0
    }

    /// Takes away what is beyond any machine, with a note: such numbers fix a joint, or are placeholders.
    pub(in crate::robot) fn credible(mut self, joint: &str, line: usize, notes: &mut Vec<String>) -> Drive {
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
