//! The geometry of an arm as the kernels read it, and the forward recursion they share.
//!
//! A serial arm is the case that the kernels are specialised for: each link follows the one before it. A tree, and joints
//! that follow coordinates, take the general recursions of [`super::branched`].

use super::rotation::{Rotation, Turn};
use super::spatial::{Vec3, add, add_cross, cross, dot, scale, splat3};
use crate::lane::Lane;
use crate::robot::{Coupling, JointKind, Robot};

/// Geometry of one joint.
#[derive(Debug, Clone)]
struct JointGeometry {
    kind: JointKind,
    rotation: Rotation,
    translation: [f64; 3],
    /// For a prismatic joint: the axis in parent coordinates.
    slide: [f64; 3],
    axis: [f64; 3],
    /// The axis of the link frame that a revolute joint turns about, if it is one.
    coordinate_axis: Option<usize>,
}

/// Geometry and gravity of an arm, prepared for the batched kernels.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::dynamics::{Chain, inverse_dynamics_at};
/// use tauscope::robot::{self, InertiaCheck};
///
/// // Geometry and gravity are prepared once; the inertias are given with every call.
/// let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Required)?;
/// let (chain, inertial) = (Chain::new(&robot), robot.inertial_parameters());
/// let hold = |chain: &Chain| inverse_dynamics_at(chain, &inertial, &[1.0], &[0.0], &[0.0])[0];
///
/// // On the moon it takes less torque to hold the rod.
/// let moon = chain.clone().with_gravity([0.0, 0.0, -1.62]);
/// assert!((hold(&moon) / hold(&chain) - 1.62 / 9.81).abs() < 1e-9);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Chain {
    joints: Vec<JointGeometry>,
    gravity: [f64; 3],
    /// What a serial arm does not have.
    pub(super) branches: Option<Branches>,
}

/// How the bodies of a tree hang together.
#[derive(Debug, Clone)]
pub(super) struct Branches {
    /// Number of coordinates.
    pub coordinates: usize,
    /// Bodies, each behind the one that carries it.
    pub order: Vec<usize>,
    /// The body that carries each body.
    pub parents: Vec<Option<usize>>,
    /// How the joint of each body follows the coordinates.
    pub couplings: Vec<Coupling>,
    /// Whether a coordinate moves a body, by body and coordinate.
    pub moves: Vec<bool>,
}

/// What the forward recursion knows of one link, in the link's own frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct LinkState<L> {
    /// Sine and cosine of the joint's turn.
    pub turn: Turn<L>,
    /// Origin of the link frame in the frame before it.
    pub translation: Vec3<L>,
    /// Angular velocity.
    pub omega: Vec3<L>,
    /// Angular acceleration.
    pub alpha: Vec3<L>,
    /// Acceleration of the frame origin, gravity taken as an upward acceleration of the base.
    pub acceleration: Vec3<L>,
}

impl Chain {
    /// Prepares the geometry of `robot`.
    pub fn new(robot: &Robot) -> Self {
        let bodies = robot.bodies();
        let joints = (0..bodies)
            .map(|body| {
                let joint = robot.body(body);
                let origin = joint.origin.rotation;
                let (rotation, slide) = match joint.kind {
                    JointKind::Revolute => (Rotation::about(joint.axis, origin), nalgebra::Vector3::zeros()),
                    JointKind::Prismatic => (Rotation::fixed(origin), origin * joint.axis),
                };
                JointGeometry {
                    kind: joint.kind,
                    rotation,
                    translation: joint.origin.translation.into(),
                    slide: slide.into(),
                    axis: joint.axis.into(),
                    coordinate_axis: (0..3).find(|&k| joint.kind == JointKind::Revolute && joint.axis[k] == 1.0),
                }
            })
            .collect();
        let branches = robot.tree.as_ref().map(|tree| Branches {
            coordinates: robot.dof(),
            order: robot.outwards(),
            parents: tree.parents.clone(),
            couplings: (0..bodies).map(|body| robot.coupling(body)).collect(),
            moves: (0..bodies)
                .flat_map(|b| (0..robot.dof()).map(move |c| (c, b)))
                .map(|(c, b)| robot.moves(c, b))
                .collect(),
        });
        Chain { joints, gravity: robot.gravity.into(), branches }
    }

    /// Number of coordinates.
    pub fn dof(&self) -> usize {
        self.branches.as_ref().map_or(self.joints.len(), |branches| branches.coordinates)
    }

    /// Number of moving bodies: one per coordinate, and one per joint that follows a coordinate.
    pub fn bodies(&self) -> usize {
        self.joints.len()
    }

    /// Whether `coordinate` moves `body`, so that the body's parameters act on it.
    pub fn moves(&self, coordinate: usize, body: usize) -> bool {
        match &self.branches {
            None => coordinate <= body,
            Some(branches) => branches.moves[body * branches.coordinates + coordinate],
        }
    }

    /// The body that carries a body, and how the body's joint follows the coordinates.
    #[inline(always)]
    pub(super) fn hangs(&self, body: usize) -> (Option<usize>, Coupling) {
        match &self.branches {
            None => (body.checked_sub(1), Coupling::own(body)),
            Some(branches) => (branches.parents[body], branches.couplings[body]),
        }
    }

    /// The same chain under another gravity vector (base frame, m/s2).
    pub fn with_gravity(mut self, gravity: [f64; 3]) -> Self {
        self.gravity = gravity;
        self
    }

    #[inline(always)]
    pub(super) fn is_revolute(&self, joint: usize) -> bool {
        self.joints[joint].kind == JointKind::Revolute
    }

    #[inline(always)]
    pub(super) fn axis<L: Lane>(&self, joint: usize) -> Vec3<L> {
        splat3(&self.joints[joint].axis)
    }

    /// State of the base: at rest, accelerated against gravity.
    #[inline(always)]
    pub(super) fn base<L: Lane>(&self) -> LinkState<L> {
        let zero = [L::splat(0.0); 3];
        let [x, y, z] = self.gravity;
        LinkState {
            turn: (zero[0], zero[0]),
            translation: zero,
            omega: zero,
            alpha: zero,
            acceleration: splat3(&[-x, -y, -z]),
        }
    }

    /// Rotation of link `joint` against the link before it.
    #[inline(always)]
    pub(super) fn rotation(&self, joint: usize) -> &Rotation {
        &self.joints[joint].rotation
    }

    /// The axis of the link frame that `joint` turns about, if it is one.
    #[inline(always)]
    pub(super) fn coordinate_axis(&self, joint: usize) -> Option<usize> {
        self.joints[joint].coordinate_axis
    }

    /// Origin of the frame of link `joint` in the frame before it.
    #[inline(always)]
    pub(super) fn translation<L: Lane>(&self, joint: usize, q: L) -> Vec3<L> {
        let geometry = &self.joints[joint];
        let translation = splat3(&geometry.translation);
        match geometry.kind {
            JointKind::Revolute => translation,
            JointKind::Prismatic => add(translation, scale(splat3(&geometry.slide), q)),
        }
    }

    /// State of link `joint` from that of the link before it.
    #[inline(always)]
    pub(super) fn next<L: Lane>(&self, joint: usize, before: &LinkState<L>, q: L, qd: L, qdd: L) -> LinkState<L> {
        self.next_turned(joint, before, [q, qd, qdd], self.rotation(joint).turn(q))
    }

    /// [`Chain::next`] at a position whose sine and cosine are known.
    #[inline(always)]
    pub(super) fn next_turned<L: Lane>(
        &self,
        joint: usize,
        before: &LinkState<L>,
        [q, qd, qdd]: [L; 3],
        turn: Turn<L>,
    ) -> LinkState<L> {
        let translation = self.translation(joint, q);
        let tangential = add_cross(before.acceleration, before.alpha, translation);
        let origin = add_cross(tangential, before.omega, cross(before.omega, translation));
        let [mut omega, mut alpha, mut acceleration] =
            self.rotation(joint).to_link(turn, [before.omega, before.alpha, origin]);
        match self.joints[joint].coordinate_axis {
            Some(0) => turn_on::<L, 0>(&mut omega, &mut alpha, qd, qdd),
            Some(1) => turn_on::<L, 1>(&mut omega, &mut alpha, qd, qdd),
            Some(_) => turn_on::<L, 2>(&mut omega, &mut alpha, qd, qdd),
            None => {
                let axis: Vec3<L> = self.axis(joint);
                let turn = scale(axis, qd);
                if self.is_revolute(joint) {
                    alpha = add(alpha, add(scale(axis, qdd), cross(omega, turn)));
                    omega = add(omega, turn);
                } else {
                    let coriolis = cross(omega, turn);
                    acceleration = add(acceleration, add(scale(axis, qdd), add(coriolis, coriolis)));
                }
            }
        }
        LinkState { turn, translation, omega, alpha, acceleration }
    }

    /// Force and moment about the origin of link `joint` as the link before it sees them.
    #[inline(always)]
    pub(super) fn carried<L: Lane>(
        &self,
        joint: usize,
        link: &LinkState<L>,
        force: Vec3<L>,
        moment: Vec3<L>,
    ) -> (Vec3<L>, Vec3<L>) {
        let [force, moment] = self.rotation(joint).to_parent(link.turn, [force, moment]);
        (force, add_cross(moment, link.translation, force))
    }

    /// What a wrench, its moment about the origin of link `joint`, does along the joint.
    #[inline(always)]
    pub(super) fn along<L: Lane>(&self, joint: usize, force: Vec3<L>, moment: Vec3<L>) -> L {
        match self.joints[joint].coordinate_axis {
            Some(0) => moment[0],
            Some(1) => moment[1],
            Some(_) => moment[2],
            None => dot(self.axis(joint), if self.is_revolute(joint) { moment } else { force }),
        }
    }
}

/// Adds to the motion of a link that of its joint, which turns about an axis of its frame.
#[inline(always)]
fn turn_on<L: Lane, const AXIS: usize>(omega: &mut Vec3<L>, alpha: &mut Vec3<L>, qd: L, qdd: L) {
    let (i, j) = ((AXIS + 1) % 3, (AXIS + 2) % 3);
    alpha[i] = omega[j].mul_add(qd, alpha[i]);
    alpha[j] = omega[i].mul_sub_from(qd, alpha[j]);
    alpha[AXIS] += qdd;
    omega[AXIS] += qd;
}
