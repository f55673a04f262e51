//! The verdict on a description, with its alternatives.

use super::change::{Change, Description};
use super::shares::WRONG_MASSES;

/// A set of changes with the share of the torque that stays unexplained under it, held out.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// # use tauscope::robot::{self, InertiaCheck};
/// # use tauscope::{dataset, quality};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Required)?;
/// # let mut read = dataset::read("../tests/reference/pendulum/train.csv".as_ref(), &robot)?;
/// use tauscope::quality::descriptions::Change;
///
/// // Torque and position have opposite signs. On a single joint either may be the wrong one.
/// read.recording.tau.channel_mut(0).iter_mut().for_each(|torque| *torque *= -1.0);
/// let verdict = quality::examine(&read, Some(&robot))?.description.expect("the log is described wrongly");
/// assert_eq!(verdict.description.changes, [Change::TorqueSign(0)]);
/// assert_eq!(verdict.alternatives[0].changes, [Change::PositionSign(0)]);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Alternative {
    /// The changes.
    pub changes: Vec<Change>,
    /// Geometric mean over the torques of residual over torque.
    pub unexplained: f64,
}

/// What shows a change that explains the logs as well as their description does.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::quality::descriptions::Shown;
///
/// // A torque of 90 N m from a drive that has 40: the log is of another drive, or in another unit.
/// let shown = Shown::Effort { joint: 2, largest: 90.0, limit: 40.0 };
/// let Shown::Effort { largest, limit, .. } = shown else { unreachable!() };
/// assert!(largest > limit);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shown {
    /// As described, the drive of a joint that slides would need a constant force beyond the weight on it, N.
    Constant {
        /// The joint.
        joint: usize,
        /// The force.
        constant: f64,
        /// The weight of the described bodies where they hang on it.
        weight: f64,
    },
    /// The torque of a joint is beyond the effort limit of its drive, N m (N).
    Effort {
        /// The joint.
        joint: usize,
        /// A torque that a twentieth of the samples exceeds.
        largest: f64,
        /// The limit.
        limit: f64,
    },
}

/// A direction of gravity known to within this angle, degrees, is one direction: where it is then applied, the diagnosis finds the tilt
/// that is left. Arms are mounted along an axis for the most part: such a direction is known where no other that is tried is as good.
const NARROW: f64 = 8.0;
const NARROW_ALONG_AN_AXIS: f64 = 18.0;

/// Directions of gravity that the logs do not separate from the best one.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::quality::descriptions::Spread;
///
/// // Gravity along an axis of the base, known to within 10 degrees: no other direction that is tried is as good.
/// let spread = Spread { degrees: 10.0, includes: vec![[0.0, 0.0, -9.81]], along_an_axis: true };
/// assert!(spread.is_narrow());
///
/// // A direction between the axes must be known better.
/// assert!(!Spread { along_an_axis: false, ..spread }.is_narrow());
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Spread {
    /// Angle from the best direction within which all of them are, degrees; without bound where some are farther than any that was tried.
    pub degrees: f64,
    /// Those of them that are along an axis of the base, or the described one, m/s2.
    pub includes: Vec<[f64; 3]>,
    /// Whether the best direction is along an axis of the base itself.
    pub along_an_axis: bool,
}

impl Spread {
    /// Whether the directions are so close together that the best one stands for all.
    pub fn is_narrow(&self) -> bool {
        self.degrees <= if self.along_an_axis { NARROW_ALONG_AN_AXIS } else { NARROW }
    }
}

/// What explains the logs clearly better than their description, or as well and by a drive that exists.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// # use tauscope::robot::{self, InertiaCheck};
/// # use tauscope::{dataset, quality};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Required)?;
/// # let mut read = dataset::read("../tests/reference/pendulum/train.csv".as_ref(), &robot)?;
/// use tauscope::quality::descriptions::Change;
///
/// // A driver that reports the torque with the wrong sign.
/// read.recording.tau.channel_mut(0).iter_mut().for_each(|torque| *torque *= -1.0);
/// let verdict = quality::examine(&read, Some(&robot))?.description.expect("the log is described wrongly");
/// assert_eq!(verdict.description.changes, [Change::TorqueSign(0)]);
/// assert!(verdict.after < 0.6 * verdict.before);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Verdict {
    /// The changed description.
    pub description: Description,
    /// Share of the torque that stays unexplained under the description as it was, held out.
    pub before: f64,
    /// The same under the changed description.
    pub after: f64,
    /// Both for every torque channel that takes part.
    pub each: [Vec<Option<f64>>; 2],
    /// Other sets of as many changes that explain the logs as well.
    pub alternatives: Vec<Alternative>,
    /// The best of the sets that are clearly worse.
    pub next: Option<Alternative>,
    /// What shows the changes, where the residuals do not.
    pub shown: Option<Shown>,
    /// Factors of the torques to those of the described bodies, where their scale is wrong.
    pub factors: Vec<Option<f64>>,
    /// Whether the torques are motor currents, or percent of rated torques, by their names: the factors are amperes or percent per torque.
    pub currents: bool,
    /// Bounds of the factors, where they are wide: a load that the robot's file lacks changes the factors.
    pub factor_bounds: Vec<Option<[f64; 2]>>,
    /// Whether the direction of gravity is that which the described bodies prefer: the mechanism alone determines none.
    pub by_bodies: bool,
    /// How well the logs determine the direction of gravity, where that is changed.
    pub spread: Option<Spread>,
    /// Held joints below those under study whose assumed positions may be what a change of gravity found.
    pub assumed: Vec<String>,
    /// Whether positions or gravity are changed, and the described bodies explain the torques no better for it: the log may be that of
    /// another arm.
    pub unlike_bodies: bool,
    /// Whether positions are changed, and the file describes no bodies: another arm with such joints looks the same.
    pub without_bodies: bool,
    /// Whether there is no alternative and the logs are long enough, or several that agree: then the changed description
    /// can be gone on with.
    pub beyond_doubt: bool,
}

/// Ratio of the largest factor to the smallest up to which all joints are in one unit: what a factor of one joint is wrong by, by the others.
const UNLIKE: f64 = 1.3;

impl Verdict {
    /// Whether the factors of the torques differ so much that no bodies fit all joints in one unit.
    pub fn has_unlike_factors(&self) -> bool {
        let known = || self.factors.iter().flatten().map(|factor| factor.abs());
        known().fold(0.0, f64::max) > UNLIKE * known().fold(f64::INFINITY, f64::min)
    }

    /// Whether so much of the torques stays unexplained under a factor of them that a cause unlike it may be behind that: positions and
    /// torques of motors behind unlike gears, or another robot, leave as much. Bodies that are described wrongly leave less.
    pub fn leaves_much(&self) -> bool {
        self.shown.is_none() && self.after > WRONG_MASSES && self.description.scaled().next().is_some()
    }
}
