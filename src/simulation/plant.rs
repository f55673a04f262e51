//! The simulated arm: forward dynamics with effects at its joints, sticking joints and elastic gears.
//!
//! A joint has a motor side, which is measured and on which friction acts, and a link side, which the engine moves. Without an
//! elastic gear the two are one. With one, the rotor is a body of its own and the gear's torque moves the link.

use super::balance::Balance;
use super::engine::{Engine, EngineKind};
use crate::dynamics::{Chain, inverse_dynamics_at};
use crate::effects::{Gear, Instant, Placed, Site};
use crate::error::{Error, Result};
use crate::robot::Robot;

/// Whether a joint slides, and which way, or is held by its dry friction.
///
/// ```
/// use tauscope::effects::drive_friction;
/// use tauscope::robot::{self, InertiaCheck};
/// use tauscope::simulation::plant::{Contact, Plant};
///
/// // At rest the pivot sticks by its Coulomb friction; in motion it slides. Without friction it does neither.
/// let robot = robot::load("tests/reference/pendulum.urdf", InertiaCheck::Required)?;
/// let plant = Plant::new(&robot, drive_friction(&robot))?;
/// assert_eq!((plant.contacts(&[0.0]), plant.contacts(&[-0.2])), (vec![Contact::Stuck], vec![Contact::Backward]));
/// assert_eq!(Plant::new(&robot, Vec::new())?.contacts(&[0.0]), [Contact::Free]);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Contact {
    /// Sliding towards positive positions.
    Forward,
    /// Sliding towards negative positions.
    Backward,
    /// Held at zero velocity by friction.
    Stuck,
    /// No dry friction: direction is the sign of the velocity.
    Free,
}

/// Position and velocity of all joints, on both sides of the gears.
///
/// ```
/// use tauscope::effects::{JointElasticity, Placed};
/// use tauscope::robot::{self, InertiaCheck};
/// use tauscope::simulation::plant::{Plant, State};
///
/// // Motor and link are one where gears are rigid.
/// let state = State::new(vec![0.5], vec![0.0]);
/// assert_eq!(state.q, state.link_q);
///
/// // Behind a soft gear the rod hangs lower than its motor stands.
/// let robot = robot::load("tests/reference/pendulum.urdf", InertiaCheck::Required)?;
/// let gear = Placed { effect: &JointElasticity, joint: 0, parameters: vec![0.01] };
/// let resting = Plant::new(&robot, vec![gear])?.resting(vec![0.5]);
/// assert!(resting.link_q[0] < resting.q[0] - 0.02);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// Motor positions.
    pub q: Vec<f64>,
    /// Motor velocities.
    pub qd: Vec<f64>,
    /// Link positions.
    pub link_q: Vec<f64>,
    /// Link velocities.
    pub link_qd: Vec<f64>,
}

impl State {
    /// Motors and links together.
    pub fn new(q: Vec<f64>, qd: Vec<f64>) -> Self {
        State { link_q: q.clone(), link_qd: qd.clone(), q, qd }
    }
}

/// What happens at one instant: motor torque, accelerations and friction.
///
/// ```
/// use tauscope::robot::{self, InertiaCheck};
/// use tauscope::simulation::plant::{Controller, Plant, State};
/// # struct Off;
/// # impl Controller for Off {
/// #     fn torque(&self, _: f64, _: &[f64], _: &[f64], tau: &mut [f64]) { tau.fill(0.0); }
/// # }
/// # let mut robot = robot::load("tests/reference/pendulum.urdf", InertiaCheck::Required)?;
///
/// // Let go at a quarter turn, its motor off: -m g l / (I + Ia).
/// let mut plant = Plant::new(&robot, Vec::new())?;
/// let state = State::new(vec![std::f64::consts::FRAC_PI_2], vec![0.0]);
/// let (memory, contacts) = (plant.fresh_memory(), plant.contacts(&state.qd));
/// let response = plant.respond(0.0, &state, &memory, &contacts, &Off);
/// assert_eq!(response.tau, [0.0]);
/// assert!((response.qdd[0] + 9.81 / 0.77).abs() < 1e-6);
/// # let _ = &mut robot;
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Response {
    /// Motor torque.
    pub tau: Vec<f64>,
    /// Motor accelerations.
    pub qdd: Vec<f64>,
    /// Link accelerations.
    pub link_qdd: Vec<f64>,
    /// Torque that the effects at the joints take from the motor, friction of stuck joints included.
    pub friction: Vec<f64>,
}

/// Motor torque as a function of time and state.
///
/// ```
/// use tauscope::robot::{self, InertiaCheck};
/// use tauscope::simulation::plant::{Controller, Plant, State};
///
/// /// A spring to zero, with a damper.
/// struct Spring;
///
/// impl Controller for Spring {
///     fn torque(&self, _: f64, q: &[f64], qd: &[f64], tau: &mut [f64]) {
///         tau[0] = -40.0 * q[0] - 2.0 * qd[0];
///     }
/// }
/// let robot = robot::load("tests/reference/pendulum.urdf", InertiaCheck::Required)?;
/// let mut plant = Plant::new(&robot, Vec::new())?;
/// let state = State::new(vec![0.1], vec![0.5]);
/// let (memory, contacts) = (plant.fresh_memory(), plant.contacts(&state.qd));
/// assert_eq!(plant.respond(0.0, &state, &memory, &contacts, &Spring).tau, [-5.0]);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
pub trait Controller {
    /// Torque of all joints at time `t` for motor positions `q` and velocities `qd`.
    fn torque(&self, t: f64, q: &[f64], qd: &[f64], tau: &mut [f64]);
}

/// What the effects remember, one entry per effect.
pub type Memory = Vec<Vec<f64>>;

/// The arm and everything that acts on it but the motors.
///
/// ```
/// use tauscope::effects::{JointElasticity, Placed, drive_friction};
/// use tauscope::robot::{self, InertiaCheck};
/// use tauscope::simulation::plant::Plant;
///
/// // An arm with the friction of its drives, and a soft gear at joint 2.
/// let robot = robot::load("urdf/irb1600_6_120.urdf", InertiaCheck::Required)?;
/// let mut effects = drive_friction(&robot);
/// effects.push(Placed::typical(&JointElasticity, 1));
/// let plant = Plant::new(&robot, effects)?;
/// assert_eq!((plant.dof(), plant.is_rigid(0), plant.is_rigid(1)), (6, true, false));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
pub struct Plant {
    pub(super) arm: Engine,
    effects: Vec<Placed>,
    dry: Vec<bool>,
    /// The gears that are not rigid.
    gears: Vec<Option<Gear>>,
    uses_acceleration: bool,
    /// Time at which the simulation began, s.
    pub(super) started: f64,
    robot: Robot,
    inertial: Vec<f64>,
    chain: Chain,
}

impl Plant {
    /// Builds `robot` in rapier with `effects` at its joints and in its gears. Effects on bodies must have altered `robot`
    /// before; effects in sensors play no part here.
    ///
    /// # Errors
    /// As [`super::rapier_arm::RapierArm::new`]; and for an elastic gear without rotor inertia.
    pub fn new(robot: &Robot, effects: Vec<Placed>) -> Result<Self> {
        Self::with_engine(EngineKind::Rapier, robot, effects)
    }

    /// [`Plant::new`] with another engine than rapier.
    ///
    /// # Errors
    /// As [`Plant::new`].
    pub fn with_engine(engine: EngineKind, robot: &Robot, mut effects: Vec<Placed>) -> Result<Self> {
        // What the integrator gets wrong comes of itself.
        effects.retain(|placed| placed.effect.about().site != Site::Integrator);
        let mut dry = vec![false; robot.dof()];
        let mut gears: Vec<Option<Gear>> = vec![None; robot.dof()];
        for placed in &effects {
            if placed.effect.about().dry {
                dry[placed.joint] = true;
            }
            let gear = placed.effect.gear(&placed.parameters).filter(|gear| !gear.is_rigid());
            if let Some(gear) = gear {
                let there = &mut gears[placed.joint];
                *there = Some(there.map_or(gear, |other| other.in_series(gear)));
            }
        }
        let mut links = robot.clone();
        for (joint, gear) in links.joints.iter_mut().zip(&mut gears) {
            let Some(gear) = gear else { continue };
            if joint.drive.armature <= 0.0 {
                let problem = "an elastic gear or backlash needs a rotor inertia (armature) on the motor side";
                return Err(Error::request(&joint.name, problem));
            }
            *gear = gear.completed(joint.drive.armature);
            joint.drive.armature = 0.0;
        }
        Ok(Plant {
            arm: Engine::new(engine, &links)?,
            dry,
            gears,
            started: 0.0,
            uses_acceleration: effects.iter().any(|placed| placed.effect.about().uses_acceleration),
            effects,
            inertial: robot.inertial_parameters(),
            chain: Chain::new(robot),
            robot: robot.clone(),
        })
    }

    /// Number of joints.
    pub fn dof(&self) -> usize {
        self.dry.len()
    }

    /// Whether motor and link of a joint are one.
    pub fn is_rigid(&self, joint: usize) -> bool {
        self.gears[joint].is_none()
    }

    /// Inertia of the rotor that an elastic gear sets apart from its link, kg m2; None for a rigid joint.
    fn rotor_apart(&self, joint: usize) -> Option<f64> {
        (!self.is_rigid(joint)).then(|| self.robot.joints[joint].drive.armature)
    }

    /// Motors at rest at `q` with the links where their gears hold them against gravity.
    pub fn resting(&self, q: Vec<f64>) -> State {
        let still = vec![0.0; self.dof()];
        let mut state = State::new(q, still.clone());
        let load = inverse_dynamics_at(&self.chain, &self.inertial, &state.q, &still, &still);
        for (joint, gear) in self.gears.iter().enumerate() {
            state.link_q[joint] -= gear.map_or(0.0, |gear| gear.twist(load[joint]));
        }
        state
    }

    /// What the effects remember before anything has happened.
    pub fn fresh_memory(&self) -> Memory {
        self.effects.iter().map(|placed| vec![0.0; placed.effect.memory()]).collect()
    }

    /// The memory after `dt` seconds between two states.
    pub fn remember(&self, memory: &Memory, t: f64, from: &State, to: &State, dt: f64) -> Memory {
        if memory.iter().all(Vec::is_empty) {
            return memory.clone();
        }
        let mean = |a: &[f64], b: &[f64]| -> Vec<f64> { a.iter().zip(b).map(|(x, y)| 0.5 * (x + y)).collect() };
        let (q, qd) = (mean(&from.q, &to.q), mean(&from.qd, &to.qd));
        let direction: Vec<f64> = qd.iter().map(|&v| crate::effects::direction(v, 0.0)).collect();
        let zeros = vec![0.0; self.dof()];
        let x = Instant { qdd: &zeros, load: &zeros, ..self.instant(t + 0.5 * dt, &q, &qd, &direction) };
        let mut carried = memory.clone();
        for (placed, own) in self.effects.iter().zip(&mut carried) {
            placed.effect.advance(&placed.parameters, placed.joint, &x, dt, own);
        }
        carried
    }

    /// Contacts of a state taken afresh: joints at exactly zero velocity count as stuck until shown otherwise.
    pub fn contacts(&self, qd: &[f64]) -> Vec<Contact> {
        qd.iter()
            .zip(&self.dry)
            .map(|(&v, &dry)| match (dry, v) {
                (false, _) => Contact::Free,
                (true, v) if v > 0.0 => Contact::Forward,
                (true, v) if v < 0.0 => Contact::Backward,
                (true, _) => Contact::Stuck,
            })
            .collect()
    }

    /// An instant whose accelerations and loads are still to be filled in.
    fn instant<'a>(&'a self, t: f64, q: &'a [f64], qd: &'a [f64], direction: &'a [f64]) -> Instant<'a> {
        Instant {
            t,
            started: self.started,
            q,
            qd,
            qdd: &[],
            direction,
            load: &[],
            robot: &self.robot,
            chain: &self.chain,
            frames: None,
        }
    }

    /// Torque the effects take at given directions, accelerations and loads.
    fn effect_torque(
        &self,
        t: f64,
        x: &State,
        memory: &Memory,
        direction: &[f64],
        qdd: &[f64],
        load: &[f64],
    ) -> Vec<f64> {
        let mut torque = vec![0.0; self.dof()];
        let instant = Instant { qdd, load, ..self.instant(t, &x.q, &x.qd, direction) };
        for (placed, own) in self.effects.iter().zip(memory) {
            placed.effect.torque(&placed.parameters, placed.joint, &instant, own, &mut torque);
        }
        torque
    }

    /// Torque on the link side of every gear at given link accelerations.
    fn load(&self, x: &State, link_qdd: &[f64]) -> Vec<f64> {
        let mut load = inverse_dynamics_at(&self.chain, &self.inertial, &x.link_q, &x.link_qd, link_qdd);
        for (joint, value) in load.iter_mut().enumerate() {
            if self.gears[joint].is_some() {
                *value = self.gear_torque(x, joint);
            }
        }
        load
    }

    fn gear_torque(&self, x: &State, joint: usize) -> f64 {
        self.gears[joint].map_or(0.0, |gear| gear.torque(x.q[joint] - x.link_q[joint], x.qd[joint] - x.link_qd[joint]))
    }

    /// Motor torque, accelerations and friction at (t, x) with the contacts held as they are.
    pub fn respond(
        &mut self,
        t: f64,
        x: &State,
        memory: &Memory,
        contacts: &[Contact],
        controller: &dyn Controller,
    ) -> Response {
        let dof = self.dof();
        let mut tau = vec![0.0; dof];
        controller.torque(t, &x.q, &x.qd, &mut tau);
        let direction: Vec<f64> = contacts
            .iter()
            .zip(&x.qd)
            .map(|(contact, &v)| match contact {
                Contact::Forward => 1.0,
                Contact::Backward => -1.0,
                Contact::Stuck => 0.0,
                Contact::Free => crate::effects::direction(v, 0.0),
            })
            .collect();
        let zeros = vec![0.0; dof];
        let mut friction = self.effect_torque(t, x, memory, &direction, &zeros, &zeros);
        let (mut qdd, mut link_qdd) = self.accelerate(x, &tau, &friction);
        if self.uses_acceleration || contacts.contains(&Contact::Stuck) {
            let stuck = (0..dof).filter(|&joint| contacts[joint] == Contact::Stuck).collect();
            let rotors: Vec<Option<f64>> = (0..dof).map(|joint| self.rotor_apart(joint)).collect();
            let balance = Balance::new(&self.arm, &rotors, stuck, &qdd, &link_qdd, &friction);
            let law = |qdd: &[f64], link_qdd: &[f64]| {
                self.effect_torque(t, x, memory, &direction, qdd, &self.load(x, link_qdd))
            };
            (qdd, link_qdd, friction) = balance.solve(self.uses_acceleration, law);
        }
        Response { tau, qdd, link_qdd, friction }
    }

    /// Motor and link accelerations under motor torque `tau` of which `friction` is lost.
    fn accelerate(&mut self, x: &State, tau: &[f64], friction: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let gear: Vec<f64> = (0..self.dof()).map(|joint| self.gear_torque(x, joint)).collect();
        let drive: Vec<f64> = (0..self.dof())
            .map(|joint| if self.is_rigid(joint) { tau[joint] - friction[joint] } else { gear[joint] })
            .collect();
        let mut link_qdd = vec![0.0; self.dof()];
        self.arm.forward_dynamics(&x.link_q, &x.link_qd, &drive, &mut link_qdd);
        let mut qdd = link_qdd.clone();
        for joint in (0..self.dof()).filter(|&joint| self.gears[joint].is_some()) {
            let rotor = self.robot.joints[joint].drive.armature;
            qdd[joint] = (tau[joint] - friction[joint] - gear[joint]) / rotor;
        }
        (qdd, link_qdd)
    }

    /// Lets go of stuck joints whose friction cannot hold them, worst first, until all that is stuck can be held.
    pub fn release(
        &mut self,
        t: f64,
        x: &State,
        memory: &Memory,
        contacts: &mut [Contact],
        controller: &dyn Controller,
    ) {
        for _ in 0..self.dof() {
            if !contacts.contains(&Contact::Stuck) {
                return;
            }
            let response = self.respond(t, x, memory, contacts, controller);
            let load = self.load(x, &response.link_qdd);
            let level = |sign: f64| self.effect_torque(t, x, memory, &vec![sign; self.dof()], &response.qdd, &load);
            let (forward, backward, friction) = (level(1.0), level(-1.0), &response.friction);
            let excess = |joint: usize| (friction[joint] - forward[joint]).max(backward[joint] - friction[joint]);
            let worst = (0..self.dof())
                .filter(|&joint| contacts[joint] == Contact::Stuck)
                .max_by(|&a, &b| excess(a).total_cmp(&excess(b)));
            match worst {
                Some(joint) if excess(joint) > 0.0 => {
                    let drives_forward = friction[joint] > forward[joint];
                    contacts[joint] = if drives_forward { Contact::Forward } else { Contact::Backward };
                }
                _ => return,
            }
        }
    }
}
