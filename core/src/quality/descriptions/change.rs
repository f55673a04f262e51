//! Changes to the description of logs, and what a description makes of the logged signals.

use crate::channels::Channels;
use crate::recording::Recording;
use nalgebra::Vector3;

/// Size of gravity, m/s2, where a change of its direction is tried on a description without any.
const GRAVITY: f64 = 9.81;

/// One change to the description of the logs.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::quality::descriptions::{Change, words};
///
/// let joints = ["hip", "knee"].map(str::to_owned);
/// assert_eq!(words(Change::TorqueExchange(0, 1), &joints), "the torques of hip and knee are exchanged");
/// assert_eq!(words(Change::AllTorqueSigns, &joints), "all torques have the wrong sign");
///
/// // Exchanged columns are a mistake of one kind, whichever they are of.
/// assert_eq!(Change::TorqueSign(0).rank(), Change::TorqueSign(1).rank());
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Change {
    /// The torque of a joint has the opposite sign.
    TorqueSign(usize),
    /// All torques have the opposite sign.
    AllTorqueSigns,
    /// The torques of two joints are in each other's columns.
    TorqueExchange(usize, usize),
    /// Positions, velocities and torques of two joints are in each other's columns.
    JointExchange(usize, usize),
    /// Position and velocity of a joint have the opposite sign.
    PositionSign(usize),
    /// All positions and velocities have the opposite sign.
    AllPositionSigns,
    /// Position, velocity and torque of a joint have the opposite sign: the axis points the other way.
    AxisSign(usize),
    /// Positions and velocities of two joints are in each other's columns.
    PositionExchange(usize, usize),
    /// The torque lacks that of gravity.
    WithoutGravity,
    /// Gravity in base coordinates is another, m/s2.
    Gravity([f64; 3]),
    /// Torques are this many times too small, by a factor that all joints share (another unit, a gear).
    TorqueScale(f64),
    /// The torque of one joint is this many times too small: a gear, a current, a share of the rated torque.
    JointScale(usize, f64),
    /// The zero of a joint's position is another: so much must be added to it, rad.
    ZeroOffset(usize, f64),
}

impl Change {
    /// Kinds in the order in which recorders are usually wrong; of descriptions that explain logs equally well, the first is
    /// named first.
    pub fn rank(self) -> usize {
        match self {
            Change::TorqueSign(_) => 0,
            Change::AllTorqueSigns => 1,
            Change::TorqueExchange(..) => 2,
            Change::WithoutGravity => 3,
            Change::Gravity(_) => 4,
            Change::JointExchange(..) => 5,
            Change::AxisSign(_) => 6,
            Change::ZeroOffset(..) => 7,
            Change::PositionSign(_) => 8,
            Change::AllPositionSigns => 9,
            Change::PositionExchange(..) => 10,
            Change::TorqueScale(_) => 11,
            Change::JointScale(..) => 12,
        }
    }

    /// Whether every torque stays that of its joint along the same motion, but for its sign and size.
    pub(crate) fn keeps_each_torque(self) -> bool {
        use Change::{AllTorqueSigns, JointScale, TorqueScale, TorqueSign};
        matches!(self, TorqueSign(_) | AllTorqueSigns | TorqueScale(_) | JointScale(..))
    }
}

/// How logged channels become signals of the arm: the identity, or that after some changes.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::quality::descriptions::{Change, Description};
/// use tauscope::recording;
///
/// // A log whose first two torques are exchanged, and one of them has the wrong sign.
/// let mut log = recording::load("../tests/reference/payload/before.csv", None)?;
/// let (first, second) = (log.tau.channel(0)[0], log.tau.channel(1)[0]);
/// let given = Description::as_given(5, [0.0, 0.0, -9.81].into());
/// let changed = given.with(Change::TorqueExchange(0, 1)).with(Change::TorqueSign(0));
/// changed.apply(&mut log);
/// assert_eq!((log.tau.channel(0)[0], log.tau.channel(1)[0]), (-second, first));
/// assert!(!changed.same_as(&given) && changed.same_motion(&given));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Description {
    /// Position channel of every joint.
    pub position_of: Vec<usize>,
    /// Sign of every joint's position.
    pub position_sign: Vec<f64>,
    /// What is added to every joint's position after that, rad (m).
    pub position_offset: Vec<f64>,
    /// Torque channel of every joint.
    pub torque_of: Vec<usize>,
    /// Sign of every joint's torque.
    pub torque_sign: Vec<f64>,
    /// Gravity in base coordinates, m/s2.
    pub gravity: Vector3<f64>,
    /// Factor of every joint's torque.
    pub torque_scale: Vec<f64>,
    /// Whether the factor of some joint's torque is not known, so that no file can apply it.
    pub scale_is_partial: bool,
    /// What was changed.
    pub changes: Vec<Change>,
}

/// Gravity along each axis of the base, of each of two sizes, m/s2.
pub(super) fn along_axes(sizes: [f64; 2]) -> impl Iterator<Item = [f64; 3]> {
    let along = |axis: usize, size: f64| std::array::from_fn(|own| if own == axis { size } else { 0.0 });
    (0..3).flat_map(move |axis| sizes.map(|size| along(axis, size)))
}

impl Description {
    /// Logs as they are, of an arm of `dof` joints under a gravity.
    pub fn as_given(dof: usize, gravity: Vector3<f64>) -> Description {
        Description {
            position_of: (0..dof).collect(),
            position_sign: vec![1.0; dof],
            position_offset: vec![0.0; dof],
            torque_of: (0..dof).collect(),
            torque_sign: vec![1.0; dof],
            gravity,
            torque_scale: vec![1.0; dof],
            scale_is_partial: false,
            changes: Vec::new(),
        }
    }

    /// Number of joints.
    pub fn dof(&self) -> usize {
        self.torque_of.len()
    }

    /// The description with one more change.
    pub fn with(&self, change: Change) -> Description {
        let mut out = self.clone();
        match change {
            Change::TorqueSign(joint) => out.torque_sign[joint] = -out.torque_sign[joint],
            Change::AllTorqueSigns => out.torque_sign.iter_mut().for_each(|sign| *sign = -*sign),
            Change::TorqueExchange(a, b) => out.torque_of.swap(a, b),
            Change::JointExchange(a, b) => {
                out.torque_of.swap(a, b);
                out.position_of.swap(a, b);
            }
            Change::PositionSign(joint) => out.position_sign[joint] = -out.position_sign[joint],
            Change::AllPositionSigns => out.position_sign.iter_mut().for_each(|sign| *sign = -*sign),
            Change::AxisSign(joint) => {
                out.position_sign[joint] = -out.position_sign[joint];
                out.torque_sign[joint] = -out.torque_sign[joint];
            }
            Change::PositionExchange(a, b) => out.position_of.swap(a, b),
            Change::WithoutGravity => out.gravity = Vector3::zeros(),
            Change::Gravity(gravity) => out.gravity = Vector3::from(gravity),
            Change::TorqueScale(factor) => out.torque_scale.iter_mut().for_each(|scale| *scale *= factor),
            Change::JointScale(joint, factor) => out.torque_scale[joint] *= factor,
            Change::ZeroOffset(joint, offset) => out.position_offset[joint] += offset,
        }
        out.changes.push(change);
        out
    }

    /// The description with the columns of all joints in reverse order, as of a recorder that begins at the tip: exchanges of which none
    /// explains anything by itself. None where two are exchanged at most, or a torque is not `measured`.
    pub(crate) fn in_reverse_order(&self, measured: &[bool]) -> Option<Description> {
        let dof = self.dof();
        let pairs = 0..dof / 2;
        let all = pairs.len() > 1 && measured.iter().all(|measured| *measured);
        all.then(|| pairs.fold(self.clone(), |out, joint| out.with(Change::JointExchange(joint, dof - 1 - joint))))
    }

    /// The description with the direction of gravity, which it changes, refined.
    pub fn with_gravity(&self, gravity: Vector3<f64>) -> Description {
        let refined = |&change: &Change| match change {
            Change::Gravity(_) => Change::Gravity(gravity.into()),
            other => other,
        };
        Description { gravity, changes: self.changes.iter().map(refined).collect(), ..self.clone() }
    }

    /// The description with torques that are larger than they should be by one factor per joint, about `usual` times.
    pub fn with_scales(&self, usual: f64, factors: &[f64]) -> Description {
        let mut out = self.with(Change::TorqueScale(1.0 / usual));
        out.torque_scale = self.torque_scale.iter().zip(factors).map(|(scale, factor)| scale / factor).collect();
        out
    }

    /// The description with other offsets of joints' zeros.
    pub(crate) fn with_zeros(&self, offsets: &[f64]) -> Description {
        let mut out = Description { position_offset: vec![0.0; self.dof()], ..self.clone() };
        out.changes.retain(|change| !matches!(change, Change::ZeroOffset(..)));
        let others = offsets.iter().enumerate().filter(|(_, offset)| **offset != 0.0);
        others.fold(out, |description, (joint, offset)| description.with(Change::ZeroOffset(joint, *offset)))
    }

    /// The positions of the arm's joints from those of a log.
    pub fn positions(&self, logged: &Channels) -> Channels {
        let position = |joint: usize, v: &f64| self.position_sign[joint] * v + self.position_offset[joint];
        logged.map(|joint, _| logged.channel(self.position_of[joint]).iter().map(|v| position(joint, v)).collect())
    }

    /// The velocities or accelerations of the arm's joints from those of a log.
    pub fn rates(&self, logged: &Channels) -> Channels {
        let rate = |joint: usize, v: &f64| self.position_sign[joint] * v;
        logged.map(|joint, _| logged.channel(self.position_of[joint]).iter().map(|v| rate(joint, v)).collect())
    }

    /// Makes the signals of the arm from those of a log.
    pub fn apply(&self, log: &mut Recording) {
        log.q = self.positions(&log.q);
        [log.qd.as_mut(), log.qdd.as_mut()].into_iter().flatten().for_each(|table| *table = self.rates(table));
        let torque = |joint: usize, v: &f64| self.torque_sign[joint] * self.torque_scale[joint] * v;
        let tau = &log.tau;
        log.tau = tau.map(|joint, _| tau.channel(self.torque_of[joint]).iter().map(|v| torque(joint, v)).collect());
        log.truth = None;
    }

    /// Whether two descriptions make the same of every log.
    pub fn same_as(&self, other: &Description) -> bool {
        let strip = |description: &Description| Description { changes: Vec::new(), ..description.clone() };
        strip(self) == strip(other)
    }

    /// Joints whose torque has a factor.
    pub fn scaled(&self) -> impl Iterator<Item = usize> {
        (0..self.dof()).filter(|&joint| self.torque_scale[joint] != 1.0)
    }

    /// Whether nothing but factors of single torques is changed.
    pub(crate) fn has_only_factors(&self) -> bool {
        self.changes.iter().all(|change| matches!(change, Change::JointScale(..)))
    }

    /// Number of changes that are neither factors of single torques nor the sign of all.
    pub(crate) fn other_than_scales_and_signs(&self) -> usize {
        let is_other = |change: &&Change| !matches!(change, Change::JointScale(..) | Change::AllTorqueSigns);
        self.changes.iter().filter(is_other).count()
    }

    /// The description without factors of torques.
    pub(crate) fn without_scales(&self) -> Description {
        let mut out = Description { torque_scale: vec![1.0; self.dof()], ..self.clone() };
        out.changes.retain(|change| !matches!(change, Change::JointScale(..) | Change::TorqueScale(_)));
        out
    }

    /// Whether two descriptions differ in the size of factors of torques and of offsets of zeros only.
    pub(crate) fn same_but_for_sizes(&self, other: &Description) -> bool {
        let differs = |values: &[f64], usual: f64| values.iter().map(|v| f64::from(*v != usual)).collect();
        let strip = |description: &Description| Description {
            torque_scale: differs(&description.torque_scale, 1.0),
            position_offset: differs(&description.position_offset, 0.0),
            ..description.clone()
        };
        strip(self).same_as(&strip(other))
    }

    /// Whether a joint's position is made otherwise from the log than as it is there.
    pub(crate) fn changes_position_of(&self, joint: usize) -> bool {
        self.position_of[joint] != joint || self.position_sign[joint] != 1.0 || self.position_offset[joint] != 0.0
    }

    /// Whether two descriptions give the model the same motion under the same gravity.
    pub fn same_motion(&self, other: &Description) -> bool {
        self.position_of == other.position_of
            && self.position_sign == other.position_sign
            && self.position_offset == other.position_offset
            && self.gravity == other.gravity
    }

    /// All descriptions one change away, of joints whose torque is `measured`; the simplest kinds first, which decides
    /// between descriptions that explain the logs equally well.
    pub fn neighbours(&self, measured: &[bool], known_arm: bool) -> Vec<Description> {
        let dof = self.dof();
        let joints: Vec<usize> = (0..dof).filter(|&joint| measured[self.torque_of[joint]]).collect();
        let pairs = || (0..dof).flat_map(|a| (a + 1..dof).map(move |b| (a, b)));
        let measured_pairs = || pairs().filter(|(a, b)| joints.contains(a) && joints.contains(b));
        let mut changes: Vec<Change> = joints.iter().map(|&joint| Change::TorqueSign(joint)).collect();
        if known_arm {
            if dof > 1 {
                changes.push(Change::AllTorqueSigns);
            }
            let size = if self.gravity.norm() > 0.0 { self.gravity.norm() } else { GRAVITY };
            changes.extend(measured_pairs().map(|(a, b)| Change::TorqueExchange(a, b)));
            changes.push(Change::WithoutGravity);
            changes.extend(along_axes([-size, size]).map(Change::Gravity));
            changes.extend(measured_pairs().map(|(a, b)| Change::JointExchange(a, b)));
            changes.extend((0..dof).map(Change::AxisSign));
            changes.extend((0..dof).map(Change::PositionSign));
            if dof > 1 {
                changes.push(Change::AllPositionSigns);
            }
            changes.extend(pairs().map(|(a, b)| Change::PositionExchange(a, b)));
        }
        let start = Description::as_given(dof, self.gravity);
        changes
            .into_iter()
            .map(|change| self.with(change))
            .filter(|next| !next.same_as(self) && !next.same_as(&start))
            .collect()
    }
}
