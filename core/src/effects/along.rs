//! An effect along a motion that is known: the model's side of the law.

use super::{Instant, Placed, Rounding, Scope};
use crate::channels::Channels;
use crate::dynamics::{Chain, Motion, inverse_dynamics};
use crate::robot::{Pose, Robot};
use std::sync::OnceLock;

/// A known motion with all that laws may ask about it.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::channels::Channels;
/// use tauscope::dynamics::{Chain, Motion};
/// use tauscope::effects::{Along, CoulombFriction, Placed, contribution};
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Required)?;
///
/// // A joint that turns forwards, stops and turns back. Over a width of 0.01 rad/s the sign of the velocity is smooth.
/// let (chain, mut motion) = (Chain::new(&robot), Motion::zeros(1, 3));
/// motion.qd = Channels::from_vectors(&[vec![0.5, 0.0, -0.5]]);
/// let along = Along::new(&robot, &chain, &[0.0, 0.1, 0.2], &motion, 0.01);
///
/// let friction = Placed { effect: &CoulombFriction, joint: 0, parameters: vec![4.0] };
/// assert_eq!(contribution(&[friction], &along).channel(0), [4.0, 0.0, -4.0]);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
pub struct Along<'a> {
    /// The arm as it is known.
    pub robot: &'a Robot,
    /// Its geometry.
    pub chain: &'a Chain,
    /// Time, s.
    pub time: &'a [f64],
    /// The motion.
    pub motion: &'a Motion,
    /// Direction of motion of every joint.
    direction: Channels,
    /// Torque on the rigid bodies, worked out when a law asks for it.
    load: OnceLock<Channels>,
}

impl<'a> Along<'a> {
    /// Prepares a motion; `width` is the velocity over which the direction is smoothed, rad/s.
    pub fn new(robot: &'a Robot, chain: &'a Chain, time: &'a [f64], motion: &'a Motion, width: f64) -> Self {
        Self::turning_over(robot, chain, time, motion, &vec![Rounding::Tanh(width); motion.qd.channels()])
    }

    /// [`Along::new`] with a rounding for each joint.
    pub(crate) fn turning_over(
        robot: &'a Robot,
        chain: &'a Chain,
        time: &'a [f64],
        motion: &'a Motion,
        rounding: &[Rounding],
    ) -> Self {
        let turned = |joint: usize, signal: &[f64]| {
            let accelerations = motion.qdd.channel(joint);
            signal.iter().zip(accelerations).map(|(&v, &a)| rounding[joint].direction(v, a)).collect()
        };
        let heading = motion.qd.map(turned);
        Along { robot, chain, time, motion, direction: heading, load: OnceLock::new() }
    }

    /// Number of samples.
    pub fn samples(&self) -> usize {
        self.motion.samples()
    }

    /// Torque on the rigid bodies, `[joint][time]`.
    pub fn load(&self) -> &Channels {
        self.load.get_or_init(|| inverse_dynamics(self.chain, &self.robot.inertial_parameters(), self.motion))
    }
}

/// A torque along a motion, held for the joints on which it acts: most laws act on one.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::channels::Channels;
/// use tauscope::effects::Contribution;
///
/// // A torque on the second of two joints, over two samples.
/// let torque = Contribution::from(Channels::from_vectors(&[vec![0.0, 0.0], vec![1.0, 2.0]]));
/// assert_eq!((torque.on(0), torque.on(1)), (None, Some(&[1.0, 2.0][..])));
///
/// // Half of it is taken off.
/// let mut sum = Channels::from_vectors(&[vec![9.0, 9.0], vec![9.0, 9.0]]);
/// torque.add_to(-0.5, &mut sum);
/// assert_eq!(sum.channel(1), [8.5, 8.0]);
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Contribution {
    joints: Vec<Option<Vec<f64>>>,
}

impl Contribution {
    /// None yet, on so many joints.
    fn none(dof: usize) -> Self {
        Contribution { joints: vec![None; dof] }
    }

    /// The torque on a joint over time, N m (N for one that slides); None where it does not act.
    pub fn on(&self, joint: usize) -> Option<&[f64]> {
        self.joints.get(joint)?.as_deref()
    }

    /// The torque on a joint to write, of so many `samples`.
    fn on_mut(&mut self, joint: usize, samples: usize) -> &mut [f64] {
        self.joints[joint].get_or_insert_with(|| vec![0.0; samples])
    }

    /// Adds a factor of it to torques, `[joint][time]`.
    pub fn add_to(&self, factor: f64, sum: &mut Channels) {
        let acting = self.joints.iter().enumerate().filter_map(|(joint, torque)| Some((joint, torque.as_ref()?)));
        for (joint, torque) in acting {
            sum.channel_mut(joint).iter_mut().zip(torque).for_each(|(value, more)| *value += factor * more);
        }
    }
}

impl From<Channels> for Contribution {
    /// Joints without torque are left out.
    fn from(torque: Channels) -> Self {
        let acts = |signal: &[f64]| signal.iter().any(|value| *value != 0.0);
        Contribution { joints: torque.iter().map(|signal| acts(signal).then(|| signal.to_vec())).collect() }
    }
}

/// Direction of motion along a measured velocity: tanh(v / width), the sign smoothed over the width in which noise
/// makes it unreliable; a width of zero gives the plain sign.
#[inline]
pub fn direction(velocity: f64, width: f64) -> f64 {
    Rounding::Tanh(width).direction(velocity, 0.0)
}

/// Torque that each placed effect adds along a motion: its law at the joints, and what the bodies it alters need more. Effects
/// in gears and sensors add nothing here.
pub fn contributions(placed: &[Placed], along: &Along) -> Vec<Contribution> {
    let (dof, samples) = (along.robot.dof(), along.samples());
    let needs_load = placed.iter().any(|one| one.effect.about().uses_acceleration);
    let mut torques: Vec<Contribution> = placed.iter().map(|one| altered_bodies(one, along)).collect();
    let mut memories: Vec<Vec<f64>> = placed.iter().map(|one| vec![0.0; one.effect.memory()]).collect();
    // Most laws act on one joint: the others need not be looked at, sample by sample.
    let only = |one: &Placed| (one.effect.about().scope == Scope::Joint).then_some(one.joint);
    let reach: Vec<Option<usize>> = placed.iter().map(only).collect();
    let remembers = memories.iter().any(|memory| !memory.is_empty());
    let needs_frames = placed.iter().any(|one| one.effect.uses_frames());
    let acting = placed.iter().map(|one| one.effect.acts_between(&one.parameters));
    let [from, to] =
        acting.fold([f64::INFINITY, f64::NEG_INFINITY], |all, own| [all[0].min(own[0]), all[1].max(own[1])]);
    let (mut now, mut last) = (Frame::new(dof), Frame::new(dof));
    let mut out = vec![0.0; dof];
    for sample in 0..samples {
        if !remembers && !(from..=to).contains(&along.time[sample]) {
            continue;
        }
        if remembers {
            std::mem::swap(&mut now, &mut last);
        }
        now.gather(along, sample, needs_load);
        if needs_frames {
            now.frames = Some(along.robot.frames(&now.q));
        }
        if remembers && sample > 0 {
            let dt = along.time[sample] - along.time[sample - 1];
            let mean = last.mean(&now);
            for (one, memory) in placed.iter().zip(&mut memories) {
                one.effect.advance(&one.parameters, one.joint, &mean.instant(along), dt, memory);
            }
        }
        let instant = now.instant(along);
        for (((one, memory), torque), reach) in placed.iter().zip(&memories).zip(&mut torques).zip(&reach) {
            let channels = reach.map_or(0..dof, |joint| joint..joint + 1);
            out[channels.clone()].fill(0.0);
            one.effect.torque(&one.parameters, one.joint, &instant, memory, &mut out);
            for channel in channels {
                if out[channel] != 0.0 {
                    torque.on_mut(channel, samples)[sample] += out[channel];
                }
            }
        }
    }
    torques
}

/// [`contributions`] of several effects together, `[joint][time]`.
pub fn contribution(placed: &[Placed], along: &Along) -> Channels {
    let mut sum = Channels::zeros(along.robot.dof(), along.samples());
    contributions(placed, along).iter().for_each(|torque| torque.add_to(1.0, &mut sum));
    sum
}

/// Torque that altered bodies and rotors need more than those of the arm as it is known.
fn altered_bodies(placed: &Placed, along: &Along) -> Contribution {
    let mut altered = along.robot.clone();
    placed.effect.alter(&placed.parameters, placed.joint, &mut altered);
    if altered == *along.robot {
        return Contribution::none(along.robot.dof());
    }
    let known = along.robot.inertial_parameters();
    let mut torque = if altered.gravity == along.robot.gravity {
        // Torque is linear in the inertial parameters.
        let more: Vec<f64> = altered.inertial_parameters().iter().zip(&known).map(|(new, old)| new - old).collect();
        inverse_dynamics(along.chain, &more, along.motion)
    } else {
        let mut torque = inverse_dynamics(&Chain::new(&altered), &altered.inertial_parameters(), along.motion);
        torque.as_mut_slice().iter_mut().zip(along.load().as_slice()).for_each(|(value, known)| *value -= known);
        torque
    };
    for joint in 0..along.robot.dof() {
        let rotor = altered.joints[joint].drive.armature - along.robot.joints[joint].drive.armature;
        let qdd = along.motion.qdd.channel(joint);
        torque.channel_mut(joint).iter_mut().zip(qdd).for_each(|(value, a)| *value += rotor * a);
    }
    torque.into()
}

/// One sample of everything, gathered from the channels.
#[derive(Debug, Clone)]
struct Frame {
    t: f64,
    q: Vec<f64>,
    qd: Vec<f64>,
    qdd: Vec<f64>,
    direction: Vec<f64>,
    load: Vec<f64>,
    /// Poses of the joint frames, where a law asks for them.
    frames: Option<Vec<Pose>>,
}

impl Frame {
    fn new(dof: usize) -> Self {
        let zeros = || vec![0.0; dof];
        Frame { t: 0.0, q: zeros(), qd: zeros(), qdd: zeros(), direction: zeros(), load: zeros(), frames: None }
    }

    fn gather(&mut self, along: &Along, sample: usize, with_load: bool) {
        self.t = along.time[sample];
        for (values, channels) in [
            (&mut self.q, &along.motion.q),
            (&mut self.qd, &along.motion.qd),
            (&mut self.qdd, &along.motion.qdd),
            (&mut self.direction, &along.direction),
        ] {
            for (joint, value) in values.iter_mut().enumerate() {
                *value = channels.channel(joint)[sample];
            }
        }
        if with_load {
            for (joint, value) in self.load.iter_mut().enumerate() {
                *value = along.load().channel(joint)[sample];
            }
        }
    }

    fn mean(&self, other: &Frame) -> Frame {
        let middle = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| 0.5 * (x + y)).collect();
        Frame {
            t: 0.5 * (self.t + other.t),
            q: middle(&self.q, &other.q),
            qd: middle(&self.qd, &other.qd),
            qdd: middle(&self.qdd, &other.qdd),
            direction: middle(&self.direction, &other.direction),
            load: middle(&self.load, &other.load),
            frames: None,
        }
    }

    fn instant<'a>(&'a self, along: &'a Along) -> Instant<'a> {
        Instant {
            t: self.t,
            started: along.time[0],
            q: &self.q,
            qd: &self.qd,
            qdd: &self.qdd,
            direction: &self.direction,
            load: &self.load,
            robot: along.robot,
            chain: along.chain,
            frames: self.frames.as_deref(),
        }
    }
}
