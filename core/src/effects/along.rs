//! An effect along a motion that is known: the model's side of the law.

use super::by_sample::{BySample, Turned};
use super::{About, Instant, Placed, Rounding, Scope};
use crate::channels::Channels;
use crate::dynamics::{Chain, Motion, inverse_dynamics};
use crate::robot::{Pose, Robot};
use std::borrow::Cow;
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
    /// How the sign of each joint's velocity is rounded.
    rounding: Vec<Rounding>,
    /// The motion sample by sample, worked out when a law asks for it.
    by_sample: OnceLock<Cow<'a, BySample>>,
    /// Direction of motion of every joint, sample by sample, worked out when a law asks for it.
    direction: OnceLock<Turned>,
    /// Torque on the rigid bodies, worked out when a law asks for it.
    load: OnceLock<Channels>,
    /// The same sample by sample.
    load_by_sample: OnceLock<Turned>,
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
        let rounding = rounding.to_vec();
        let [direction, load_by_sample] = [(); 2].map(|()| OnceLock::new());
        let (by_sample, load) = (OnceLock::new(), OnceLock::new());
        Along { robot, chain, time, motion, rounding, by_sample, direction, load, load_by_sample }
    }

    /// With its motion sample by sample, where that is known already.
    pub(crate) fn with_samples(self, known: &'a BySample) -> Self {
        Along { by_sample: Cow::Borrowed(known).into(), ..self }
    }

    /// Number of samples.
    pub fn samples(&self) -> usize {
        self.motion.samples()
    }

    /// Torque on the rigid bodies, `[joint][time]`.
    pub fn load(&self) -> &Channels {
        self.load.get_or_init(|| inverse_dynamics(self.chain, &self.robot.inertial_parameters(), self.motion))
    }

    fn by_sample(&self) -> &BySample {
        self.by_sample.get_or_init(|| Cow::Owned(BySample::of(self.motion)))
    }

    fn load_by_sample(&self) -> &Turned {
        self.load_by_sample.get_or_init(|| Turned::of(self.load()))
    }

    fn direction(&self) -> &Turned {
        self.direction.get_or_init(|| {
            let turned = |joint: usize, signal: &[f64]| {
                let accelerations = self.motion.qdd.channel(joint);
                signal.iter().zip(accelerations).map(|(&v, &a)| self.rounding[joint].direction(v, a)).collect()
            };
            Turned::of(&self.motion.qd.map(turned))
        })
    }

    /// What laws may ask about each sample: those of a law with friction (`dry`) the direction of motion, those of one that
    /// uses accelerations the load.
    fn instants<'s>(&'s self, about: &About) -> impl Fn(usize) -> Instant<'s> + use<'s, 'a> {
        let BySample { q, qd, qdd } = self.by_sample();
        let direction = about.dry.then(|| self.direction());
        let load = about.uses_acceleration.then(|| self.load_by_sample());
        move |sample| Instant {
            t: self.time[sample],
            started: self.time[0],
            q: q.at(sample),
            qd: qd.at(sample),
            qdd: qdd.at(sample),
            direction: direction.map_or(&[], |direction| direction.at(sample)),
            load: load.map_or(&[], |load| load.at(sample)),
            robot: self.robot,
            chain: self.chain,
            frames: None,
        }
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
    let mut poses = Poses::default();
    placed.iter().map(|one| of_law(one, along, &mut poses)).collect()
}

/// Poses of the joint frames along a motion, at the samples at which a law asked for them: they are the same for all laws.
#[derive(Debug, Default)]
pub(crate) struct Poses(Vec<Option<Vec<Pose>>>);

impl Poses {
    fn at(&mut self, sample: usize, samples: usize, robot: &Robot, q: &[f64]) -> &[Pose] {
        self.0.resize(samples, None);
        self.0[sample].get_or_insert_with(|| robot.frames(q))
    }
}

/// [`contributions`] of one; `poses` are those known along the same motion.
pub(crate) fn of_law(placed: &Placed, along: &Along, poses: &mut Poses) -> Contribution {
    let Placed { effect, joint, parameters } = placed;
    let (about, dof, samples) = (effect.about(), along.robot.dof(), along.samples());
    let mut torque = altered_bodies(placed, along);
    if let Some(own) = effect.torque_at_positions(parameters, along.motion.q.channel(*joint)) {
        torque.on_mut(*joint, samples).iter_mut().zip(own).for_each(|(sum, more)| *sum += more);
        return torque;
    }
    let mut memory = vec![0.0; effect.memory()];
    // Most laws act on one joint: the others need not be looked at, sample by sample.
    let channels = if about.scope == Scope::Joint { *joint..joint + 1 } else { 0..dof };
    let [from, to] = effect.acts_between(parameters);
    let instants = along.instants(about);
    let (mut mean, mut out) = (Mean::new(dof), vec![0.0; dof]);
    for sample in 0..samples {
        let mut instant = instants(sample);
        if !memory.is_empty() && sample > 0 {
            let last = instants(sample - 1);
            effect.advance(parameters, *joint, &mean.of(&last, &instant), instant.t - last.t, &mut memory);
        }
        if memory.is_empty() && !(from..=to).contains(&instant.t) {
            continue;
        }
        if effect.uses_frames() {
            instant.frames = Some(poses.at(sample, samples, along.robot, instant.q));
        }
        out[channels.clone()].fill(0.0);
        effect.torque(parameters, *joint, &instant, &memory, &mut out);
        for channel in channels.clone() {
            if out[channel] != 0.0 {
                torque.on_mut(channel, samples)[sample] += out[channel];
            }
        }
    }
    torque
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
        torque.subtract(along.load());
        torque
    };
    for joint in 0..along.robot.dof() {
        let rotor = altered.joints[joint].drive.armature - along.robot.joints[joint].drive.armature;
        let qdd = along.motion.qdd.channel(joint);
        torque.channel_mut(joint).iter_mut().zip(qdd).for_each(|(value, a)| *value += rotor * a);
    }
    torque.into()
}

/// Half way between two instants.
struct Mean {
    q: Vec<f64>,
    qd: Vec<f64>,
    qdd: Vec<f64>,
    direction: Vec<f64>,
    load: Vec<f64>,
}

impl Mean {
    fn new(dof: usize) -> Self {
        let [q, qd, qdd, direction, load] = [(); 5].map(|()| Vec::with_capacity(dof));
        Mean { q, qd, qdd, direction, load }
    }

    fn of<'a>(&'a mut self, last: &Instant<'a>, now: &Instant<'a>) -> Instant<'a> {
        let middle = |own: &mut Vec<f64>, a: &[f64], b: &[f64]| {
            own.clear();
            own.extend(a.iter().zip(b).map(|(a, b)| 0.5 * (b + a)));
        };
        middle(&mut self.q, last.q, now.q);
        middle(&mut self.qd, last.qd, now.qd);
        middle(&mut self.qdd, last.qdd, now.qdd);
        middle(&mut self.direction, last.direction, now.direction);
        middle(&mut self.load, last.load, now.load);
        let Mean { q, qd, qdd, direction, load } = self;
        Instant { t: 0.5 * (last.t + now.t), q, qd, qdd, direction, load, frames: None, ..*now }
    }
}
