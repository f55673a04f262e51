//! The model of the arm with everything that was found in it: bodies, drives, gravity, and effects that are no part of
//! these, in a form that the simulator takes.

use crate::channels::Channels;
use crate::diagnosis::model::{Member, Session, linear};
use crate::diagnosis::noise::Whitener;
use crate::diagnosis::regression::gram;
use crate::dynamics::Motion;
use crate::effects::{DriveParameter, Placed, Role, Site};
use crate::error::Result;
use crate::identification::consistent;
use crate::identification::effect_model::{Arm, Trust};
use crate::identification::model::Model;
use crate::robot::{Drive, Robot};
use nalgebra::DMatrix;

/// Violation of a body's conditions, relative, that is rounding.
const ROUNDING: f64 = 1e-6;

/// A model of the arm that can be simulated.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::dynamics::Motion;
/// use tauscope::diagnosis::ExtendedModel;
/// # use tauscope::diagnosis::Diagnosis;
/// # use tauscope::recording;
/// # use tauscope::robot::{self, InertiaCheck};
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Ignored)?;
/// # let log = |name: &str| recording::load(format!("../tests/reference/pendulum/{name}.csv"), None);
/// # let (train, test) = (log("train")?, log("test")?);
/// # let answer = Diagnosis::of(&robot).train([&train]).test([&test]).candidates(["torque_ripple"]).run()?;
///
/// // The arm with what was found, as a simulator takes it.
/// let model: &ExtendedModel = answer.conclusion().expect("the logs are good").extended()?;
/// assert!(model.effects.iter().any(|placed| placed.effect.about().name == "torque_ripple"));
/// assert!(model.robot.joints.iter().all(|joint| joint.inertia.physical_fault(1e-6).is_none()));
///
/// // Its torque at rest at zero.
/// assert_eq!(model.torque(&[0.0], &Motion::zeros(1, 1)).samples(), 1);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ExtendedModel {
    /// Bodies that can exist, drives and gravity.
    pub robot: Robot,
    /// What the arm does beyond, without the friction of its drives.
    pub effects: Vec<Placed>,
}

impl ExtendedModel {
    /// The model fitted with `members`, who may be none.
    ///
    /// # Errors
    /// If a log is too short to differentiate, or no bodies can be found.
    pub fn new(session: &Session, members: &[Member], whitener: &Whitener) -> Result<Self> {
        let solved = session.solved(members, whitener)?;
        let arm = session.arm_with(&solved);
        let fitted = session.model.known.fitted();
        let mut known = session.model.known.effects.clone();
        for ((effect, index), change) in fitted.into_iter().zip(&solved.values[session.blocks(&[]).known]) {
            known[effect].parameters[index] += change;
        }
        let (mut robot, mut effects) = (arm.found().clone(), Vec::new());
        for placed in known.into_iter().chain(members.iter().map(|member| member.placed.clone())) {
            take_in(placed, &mut robot, &mut effects);
        }
        effects.iter_mut().for_each(|placed| bound(placed, session));
        let gravity = robot.gravity;
        let mut robot = with_bodies(session, &robot, whitener)?;
        robot.gravity = gravity;
        Ok(ExtendedModel { robot, effects })
    }

    /// An arm as it is described, with the effects that its simulation has.
    pub fn described(robot: &Robot, present: &[Placed]) -> Self {
        let (mut robot, mut effects) = (robot.clone(), Vec::new());
        present.iter().for_each(|placed| take_in(placed.clone(), &mut robot, &mut effects));
        ExtendedModel { robot, effects }
    }

    /// Torque along a motion that is known: bodies, drives, and effects at the joints (those in gears and sensors are left
    /// out), `[joint][time]`.
    pub fn torque(&self, time: &[f64], motion: &Motion) -> Channels {
        let arm = Arm::new(&self.robot, Trust::Nominal);
        let at_joints = self.effects.iter().filter(|placed| placed.effect.about().site == Site::Joint);
        let effects: Vec<Placed> = at_joints.cloned().collect();
        let mut sum = arm.torque(motion, motion);
        arm.contributions(&effects, time, motion).iter().for_each(|torque| torque.add_to(1.0, &mut sum));
        sum
    }
}

/// Bodies, rotors, friction and gravity go into the arm, all else into the scenario. An effect that is there already grows.
fn take_in(placed: Placed, robot: &mut Robot, effects: &mut Vec<Placed>) {
    let drive = &mut robot.joints[placed.joint].drive;
    let name = placed.effect.about().name;
    match placed.effect.of_drive() {
        Some(DriveParameter::Coulomb) => drive.coulomb += placed.amount(),
        Some(DriveParameter::Viscous) => drive.viscous += placed.amount(),
        _ if placed.effect.about().site == Site::Body => {
            placed.effect.alter(&placed.parameters, placed.joint, robot);
        }
        _ => {
            let same = |other: &&mut Placed| other.effect.about().name == name && other.joint == placed.joint;
            match effects.iter_mut().find(same) {
                Some(there) => linear(placed.effect)
                    .into_iter()
                    .filter(|&k| placed.effect.parameters()[k].role == Role::Amplitude)
                    .for_each(|k| there.parameters[k] += placed.parameters[k]),
                None => effects.push(placed),
            }
        }
    }
}

/// Keeps the parameters of an effect inside their bounds, and a step of the integrator in whole parts of the sampling time.
fn bound(placed: &mut Placed, session: &Session) {
    for (parameter, value) in placed.effect.parameters().iter().zip(&mut placed.parameters) {
        *value = value.clamp(parameter.lower, parameter.upper);
    }
    if let (Site::Integrator, Some(log)) = (placed.effect.about().site, session.logs.train.rows.logs.first()) {
        let index = placed.amount_index();
        let step = &mut placed.parameters[index];
        *step = log.period / (log.period / *step).round().max(1.0);
    }
}

/// The arm with bodies that can exist and drives that take power: its own where they are such, else those nearest to its
/// base parameters in the metric of their covariance.
fn with_bodies(session: &Session, robot: &Robot, whitener: &Whitener) -> Result<Robot> {
    let sound = |drive: &Drive| [drive.armature, drive.viscous, drive.coulomb].iter().all(|v| *v >= 0.0);
    let mut joints = robot.joints.iter();
    if joints.all(|joint| {
        sound(&joint.drive) && joint.inertia.mass() > 0.0 && joint.inertia.physical_fault(ROUNDING).is_none()
    }) {
        return Ok(robot.clone());
    }
    // Under a gravity that is turned bodies weigh what no base parameter of the described arm holds.
    let described = session.model.base;
    let turned = (robot.gravity != described.robot().gravity).then(|| {
        let equations: Vec<bool> = (0..robot.dof()).map(|joint| described.has_equation(joint)).collect();
        Model::with_equations(&Robot { gravity: robot.gravity, ..described.robot().clone() }, &equations)
    });
    let model = turned.as_ref().unwrap_or(described);
    let normal = normal(session, model, whitener);
    let beta = model.base().values(&Model::standard_values(robot));
    let solution = consistent::solve(model, &normal, &beta)?;
    Ok(solution.robot(robot))
}

/// Inner products of the base parameters' columns on whitened training rows.
fn normal(session: &Session, model: &Model, whitener: &Whitener) -> DMatrix<f64> {
    let arm =
        Arm::new(model.robot(), Trust::Structure).with_coulomb_rounding(session.model.arm.coulomb_rounding.clone());
    let base = arm.baseline(model, &session.logs.train.rows);
    let mut normal = gram(&whitener.apply_all(&base));
    // What these rows do not determine stays where it is.
    let largest = normal.diagonal().max();
    for k in 0..normal.nrows() {
        normal[(k, k)] = normal[(k, k)] * (1.0 + 1e-9) + 1e-12 * largest;
    }
    normal
}
