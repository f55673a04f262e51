//! The simulated arm: forward dynamics with effects at its joints, sticking joints and elastic gears.
//!
//! A joint has a motor side, which is measured and on which friction acts, and a link side, which the engine moves. Without an
//! elastic gear the two are one. With one, the rotor is a body of its own and the gear's torque moves the link.

use super::engine::{Engine, EngineKind};
use crate::dynamics::{Chain, inverse_dynamics_at};
use crate::effects::{Gear, Instant, Placed, Site};
use crate::error::{Error, Result};
use crate::robot::Robot;
use nalgebra::{DMatrix, DVector};

/// Newton steps after which accelerations that laws depend on are taken as they are.
const MOST_NEWTON_STEPS: usize = 30;

/// Whether a joint slides, and which way, or is held by its dry friction.
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
pub trait Controller {
    /// Torque of all joints at time `t` for motor positions `q` and velocities `qd`.
    fn torque(&self, t: f64, q: &[f64], qd: &[f64], tau: &mut [f64]);
}

/// What the effects remember, one entry per effect.
pub type Memory = Vec<Vec<f64>>;

/// The arm and everything that acts on it but the motors.
pub struct Plant {
    pub(super) arm: Engine,
    effects: Vec<Placed>,
    dry: Vec<bool>,
    /// The gears that are not rigid.
    gears: Vec<Option<Gear>>,
    uses_acceleration: bool,
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
        Instant { t, q, qd, qdd: &[], direction, load: &[], robot: &self.robot, chain: &self.chain }
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
            let balance = Balance::new(self, contacts, &qdd, &link_qdd, &friction);
            let law = |plant: &Plant, qdd: &[f64], link_qdd: &[f64]| {
                plant.effect_torque(t, x, memory, &direction, qdd, &plant.load(x, link_qdd))
            };
            (qdd, link_qdd, friction) = balance.solve(self, self.uses_acceleration, law);
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

/// The accelerations when friction holds some joints still (Karnopp 1985, with the engine's own inverse mass matrix) and laws
/// depend on the accelerations themselves.
struct Balance {
    stuck: Vec<usize>,
    /// Motor accelerations per unit motor torque.
    motor: DMatrix<f64>,
    /// Link accelerations per unit motor torque.
    link: DMatrix<f64>,
    /// Accelerations and effect torque from which the balance starts.
    free_qdd: DVector<f64>,
    free_link_qdd: DVector<f64>,
    start_torque: DVector<f64>,
}

impl Balance {
    fn new(plant: &Plant, contacts: &[Contact], qdd: &[f64], link_qdd: &[f64], torque: &[f64]) -> Self {
        let dof = plant.dof();
        let (mut motor, mut link) = (DMatrix::zeros(dof, dof), DMatrix::zeros(dof, dof));
        for joint in 0..dof {
            if plant.is_rigid(joint) {
                link.set_column(joint, &DVector::from_vec(plant.arm.response(joint)));
                for row in (0..dof).filter(|&row| plant.is_rigid(row)) {
                    motor[(row, joint)] = link[(row, joint)];
                }
            } else {
                motor[(joint, joint)] = 1.0 / plant.robot.joints[joint].drive.armature;
            }
        }
        Balance {
            stuck: (0..dof).filter(|&joint| contacts[joint] == Contact::Stuck).collect(),
            motor,
            link,
            free_qdd: DVector::from_column_slice(qdd),
            free_link_qdd: DVector::from_column_slice(link_qdd),
            start_torque: DVector::from_column_slice(torque),
        }
    }

    /// Accelerations of motors and links and the torque taken, for a change `extra` of the effects' torque, with the
    /// torque that holds stuck joints added.
    fn held(&self, extra: &DVector<f64>) -> (DVector<f64>, DVector<f64>, DVector<f64>) {
        let mut torque = extra.clone();
        let mut qdd = &self.free_qdd - &self.motor * extra;
        if !self.stuck.is_empty() {
            let n = self.stuck.len();
            let block = DMatrix::from_fn(n, n, |r, c| self.motor[(self.stuck[r], self.stuck[c])]);
            let wanted = DVector::from_fn(n, |r, _| qdd[self.stuck[r]]);
            // A principal block of an inverse mass matrix is positive definite; an arm that has run away to infinity
            // is noticed by its numbers, not here.
            let holding = block.cholesky().map_or_else(|| DVector::zeros(n), |factor| factor.solve(&wanted));
            for (index, &joint) in self.stuck.iter().enumerate() {
                torque[joint] += holding[index];
            }
            qdd = &self.free_qdd - &self.motor * &torque;
            for &joint in &self.stuck {
                qdd[joint] = 0.0;
            }
        }
        let mut link_qdd = &self.free_link_qdd - &self.link * &torque;
        for joint in 0..qdd.len() {
            if self.link.column(joint).iter().any(|&v| v != 0.0) {
                link_qdd[joint] = qdd[joint];
            }
        }
        (qdd, link_qdd, torque)
    }

    /// Motor and link accelerations and the effects' torque at which the laws hold: Newton's method on the effects' torque
    /// with a Jacobian by differences, which is exact for laws that are linear in acceleration and load.
    fn solve(
        &self,
        plant: &Plant,
        depends: bool,
        law: impl Fn(&Plant, &[f64], &[f64]) -> Vec<f64>,
    ) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
        let dof = self.free_qdd.len();
        let mut extra = DVector::zeros(dof);
        if depends {
            let residual = |extra: &DVector<f64>| -> DVector<f64> {
                let (qdd, link_qdd, _) = self.held(extra);
                DVector::from_vec(law(plant, qdd.as_slice(), link_qdd.as_slice())) - &self.start_torque - extra
            };
            let mut off = residual(&extra);
            for _ in 0..MOST_NEWTON_STEPS {
                if off.amax() <= 1e-14 * (1.0 + self.start_torque.amax() + extra.amax()) {
                    break;
                }
                let step = 1e-3 * (1.0 + extra.amax());
                let mut jacobian = DMatrix::zeros(dof, dof);
                for joint in 0..dof {
                    let mut moved = extra.clone();
                    moved[joint] += step;
                    jacobian.set_column(joint, &((residual(&moved) - &off) / step));
                }
                let Some(change) = jacobian.lu().solve(&off) else { break };
                let next = &extra - change;
                let next_off = residual(&next);
                if next_off.amax() >= off.amax() {
                    break;
                }
                (extra, off) = (next, next_off);
            }
        }
        let (qdd, link_qdd, torque) = self.held(&extra);
        let friction = &self.start_torque + torque;
        (qdd.as_slice().to_vec(), link_qdd.as_slice().to_vec(), friction.as_slice().to_vec())
    }
}
