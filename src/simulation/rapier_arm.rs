//! An arm as an articulated body in rapier, used as its forward-dynamics engine: (q, v, tau) -> a.
//!
//! Rapier's own time step is first order, because it couples the velocity terms with the step into the mass matrix. At a
//! vanishing step its joint accelerations are exact to rounding; integration over time is done outside.

use crate::error::{Error, Result};
use crate::robot::{Inertia, Joint, JointKind, Pose, Robot};
use nalgebra::{Matrix3, Rotation3, SymmetricEigen, UnitQuaternion, Vector3};
use rapier3d::dynamics::{
    GenericJoint, GenericJointBuilder, JointAxesMask, MassProperties, Multibody, MultibodyIndex, MultibodyJoint,
    RigidBodyBuilder, RigidBodyHandle,
};
use rapier3d::math::{Pose as RapierPose, Rotation, Vector};
use rapier3d::pipeline::PhysicsWorld;

/// A step that moves nothing but makes rapier compute accelerations (it skips the solve at a step of zero).
const VANISHING_STEP_S: f64 = 1e-20;

/// A robot built as a rapier multibody on a fixed base.
///
/// ```
/// use tauscope::robot::{self, InertiaCheck};
/// use tauscope::simulation::rapier_arm::RapierArm;
///
/// // A pendulum let go at a quarter turn: -m g l / (I + Ia).
/// let robot = robot::load("tests/reference/pendulum.urdf", InertiaCheck::Required)?;
/// let (mut arm, mut qdd) = (RapierArm::new(&robot)?, [0.0]);
/// arm.forward_dynamics(&[std::f64::consts::FRAC_PI_2], &[0.0], &[0.0], &mut qdd);
/// assert!((qdd[0] + 9.81 / 0.77).abs() < 1e-6);
/// assert!((arm.response(0)[0] - 1.0 / 0.77).abs() < 1e-6);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
pub struct RapierArm {
    world: PhysicsWorld,
    /// The base, then one body per joint.
    bodies: Vec<RigidBodyHandle>,
    /// Place in `bodies` of what carries each joint's body.
    carriers: Vec<usize>,
    joints: Vec<GenericJoint>,
    kinds: Vec<JointKind>,
    multibody: MultibodyIndex,
}

impl RapierArm {
    /// Builds `robot` in an empty world under its gravity, rotor inertias included, friction not.
    ///
    /// # Errors
    /// If a link has no mass or an inertia that no body has: the mass matrix would be singular; if joints follow others.
    pub fn new(robot: &Robot) -> Result<Self> {
        if let Some(follower) = robot.followers().first() {
            let problem = "rapier's articulated bodies have no joints that follow others; use the engine `recursive`";
            return Err(Error::request(format!("joint `{}` of {}", follower.joint.name, robot.name), problem));
        }
        let carriers: Vec<usize> =
            (0..robot.dof()).map(|joint| robot.parent(joint).map_or(0, |parent| parent + 1)).collect();
        let mut world = PhysicsWorld::new();
        world.gravity = vector(&robot.gravity);
        world.integration_parameters.num_solver_iterations = 1;
        world.integration_parameters.num_internal_stabilization_iterations = 0;
        world.integration_parameters.max_ccd_substeps = 0;
        world.integration_parameters.normalized_max_linear_velocity = f64::MAX;

        let mut bodies = vec![world.insert_body(RigidBodyBuilder::fixed())];
        let mut joints = Vec::new();
        let mut handle = None;
        for (joint, &carrier) in robot.joints.iter().zip(&carriers) {
            let properties = mass_properties(&joint.inertia)
                .map_err(|problem| Error::request(format!("link `{}` of {}", joint.link, robot.name), problem))?;
            let body =
                world.insert_body(RigidBodyBuilder::dynamic().can_sleep(false).additional_mass_properties(properties));
            let rapier_joint = generic_joint(joint);
            handle = world.insert_multibody_joint(bodies[carrier], body, rapier_joint);
            bodies.push(body);
            joints.push(rapier_joint);
        }
        let multibody = handle
            .and_then(|_| world.multibody_joints.rigid_body_link(bodies[robot.dof()]))
            .map(|link| link.multibody)
            .ok_or_else(|| Error::request(&robot.name, "rapier does not take the arm as one articulated body"))?;
        let mut arm = RapierArm {
            world,
            bodies,
            carriers,
            joints,
            kinds: robot.joints.iter().map(|j| j.kind).collect(),
            multibody,
        };
        // The base counts as free until the kinematics have seen that its body is fixed.
        let RapierArm { world, multibody, .. } = &mut arm;
        let body = world.multibody_joints.get_multibody_mut(*multibody).expect("just inserted");
        body.forward_kinematics(&world.bodies, true);
        body.update_rigid_bodies(&mut world.bodies, true);
        world.integration_parameters.dt = 0.0;
        world.step();
        let body = world.multibody_joints.get_multibody_mut(*multibody).expect("just inserted");
        if body.ndofs() != robot.dof() {
            let problem = format!("rapier made {} degrees of freedom of {} joints", body.ndofs(), robot.dof());
            return Err(Error::request(&robot.name, problem));
        }
        // Rapier gives every angular joint a damping of 0.1 by default; friction is a law of its own here.
        body.damping_mut().fill(0.0);
        for (value, joint) in body.armature_mut().iter_mut().zip(&robot.joints) {
            *value = joint.drive.armature;
        }
        arm.set_state(&vec![0.0; robot.dof()], &vec![0.0; robot.dof()]);
        Ok(arm)
    }

    /// Number of joints.
    pub fn dof(&self) -> usize {
        self.joints.len()
    }

    /// Joint accelerations at position `q` and velocity `qd` under joint torques `tau`, and rapier's mass matrix
    /// (rotor inertias included) kept for [`RapierArm::response`].
    pub fn forward_dynamics(&mut self, q: &[f64], qd: &[f64], tau: &[f64], qdd: &mut [f64]) {
        self.set_state(q, qd);
        self.apply_torque(tau);
        self.world.integration_parameters.dt = VANISHING_STEP_S;
        self.world.step();
        for (out, &value) in qdd.iter_mut().zip(self.body().generalized_acceleration().iter()) {
            *out = value;
        }
    }

    /// Accelerations of all joints per unit torque on `joint` at the last state: a column of the inverse mass matrix.
    pub fn response(&self, joint: usize) -> Vec<f64> {
        let mut unit = nalgebra::DVector::zeros(self.dof());
        unit[joint] = 1.0;
        self.body().inv_augmented_mass().solve_mut(&mut unit);
        unit.as_slice().to_vec()
    }

    /// Rapier's own time step of `dt` seconds under joint torques `tau`: what a plain rapier user gets. Returns the
    /// accelerations that rapier used; position and velocity are updated in place.
    pub fn native_step(&mut self, q: &mut [f64], qd: &mut [f64], tau: &[f64], dt: f64) -> Vec<f64> {
        self.set_state(q, qd);
        self.apply_torque(tau);
        self.world.integration_parameters.dt = dt;
        self.world.step();
        let body = self.body();
        for (index, link) in body.links().skip(1).enumerate() {
            q[index] = link.joint().coords()[free_axis(self.kinds[index])];
            qd[index] = body.generalized_velocity()[link.assembly_id()];
        }
        body.generalized_acceleration().iter().copied().collect()
    }

    fn body(&self) -> &Multibody {
        self.world.multibody_joints.get_multibody(self.multibody).expect("the arm stays in its world")
    }

    fn set_state(&mut self, q: &[f64], qd: &[f64]) {
        let world = &mut self.world;
        let body = world.multibody_joints.get_multibody_mut(self.multibody).expect("the arm stays in its world");
        for (index, link) in body.links_mut().skip(1).enumerate() {
            // A fresh joint with one displacement: no history, so the state is exactly q.
            link.joint = MultibodyJoint::new(self.joints[index], false);
            link.joint.apply_displacement(&[q[index]]);
        }
        body.generalized_velocity_mut().copy_from_slice(qd);
        body.forward_kinematics(&world.bodies, false);
        body.update_rigid_bodies(&mut world.bodies, true);
    }

    /// Joint torques as equal and opposite wrenches on neighbouring bodies (rapier takes no generalised forces).
    fn apply_torque(&mut self, tau: &[f64]) {
        for &handle in &self.bodies {
            let body = &mut self.world.bodies[handle];
            body.reset_forces(false);
            body.reset_torques(false);
        }
        for (joint, &effort) in tau.iter().enumerate() {
            let jacobian = self.body().body_jacobian(joint + 1);
            let rows = if self.kinds[joint] == JointKind::Revolute { 3..6 } else { 0..3 };
            let axis: Vec<f64> = rows.map(|row| jacobian[(row, joint)]).collect();
            let along = effort * Vector::new(axis[0], axis[1], axis[2]);
            let (parent, child) = (self.bodies[self.carriers[joint]], self.bodies[joint + 1]);
            if self.kinds[joint] == JointKind::Revolute {
                self.world.bodies[child].add_torque(along, false);
                self.world.bodies[parent].add_torque(-along, false);
            } else {
                // Both forces on one line of action, through the child's centre of mass.
                let point = self.world.bodies[child].center_of_mass();
                self.world.bodies[child].add_force_at_point(along, point, false);
                self.world.bodies[parent].add_force_at_point(-along, point, false);
            }
        }
    }
}

/// Index of the free coordinate in rapier's six-vector of a joint: its axis is turned onto x.
fn free_axis(kind: JointKind) -> usize {
    match kind {
        JointKind::Revolute => 3,
        JointKind::Prismatic => 0,
    }
}

/// The joint with its axis turned onto rapier's x axis.
fn generic_joint(joint: &Joint) -> GenericJoint {
    let locked = match joint.kind {
        JointKind::Revolute => JointAxesMask::LOCKED_REVOLUTE_AXES,
        JointKind::Prismatic => JointAxesMask::LOCKED_PRISMATIC_AXES,
    };
    let turn = Rotation3::rotation_between(&Vector3::x(), &joint.axis)
        .unwrap_or_else(|| Rotation3::from_axis_angle(&Vector3::z_axis(), std::f64::consts::PI));
    let basis = Pose { rotation: turn.into_inner(), translation: Vector3::zeros() };
    GenericJointBuilder::new(locked)
        .local_frame1(rapier_pose(&joint.origin.then(&basis)))
        .local_frame2(rapier_pose(&basis))
        .build()
}

/// Mass properties by nalgebra's eigenvectors: rapier's own decomposition loses digits where principal moments nearly coincide.
fn mass_properties(inertia: &Inertia) -> std::result::Result<MassProperties, String> {
    let eigen = SymmetricEigen::new(inertia.tensor_about_center());
    if !(inertia.mass() > 0.0 && eigen.eigenvalues.iter().all(|&moment| moment > 0.0)) {
        return Err(format!(
            "it cannot be simulated: mass {} kg and principal moments {:.3e} {:.3e} {:.3e} kg m2 must all be positive",
            inertia.mass(),
            eigen.eigenvalues[0],
            eigen.eigenvalues[1],
            eigen.eigenvalues[2]
        ));
    }
    let mut axes = eigen.eigenvectors;
    if axes.determinant() < 0.0 {
        axes.column_mut(2).neg_mut();
    }
    Ok(MassProperties::with_principal_inertia_frame(
        vector(&inertia.center_of_mass()),
        inertia.mass(),
        vector(&eigen.eigenvalues),
        rotation(&axes),
    ))
}

fn vector(v: &Vector3<f64>) -> Vector {
    Vector::new(v.x, v.y, v.z)
}

fn rotation(matrix: &Matrix3<f64>) -> Rotation {
    let q = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(*matrix)).into_inner().normalize();
    Rotation::from_xyzw(q.i, q.j, q.k, q.w)
}

fn rapier_pose(pose: &Pose) -> RapierPose {
    RapierPose::from_parts(vector(&pose.translation), rotation(&pose.rotation))
}
