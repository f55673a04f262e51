//! The simulated arm: rapier's forward dynamics with friction laws, sticking joints and motor torque.

use super::rapier_arm::RapierArm;
use crate::effects::{Effect, Instant};
use crate::error::Result;
use crate::robot::Robot;

/// A law at work on one joint of the plant.
#[derive(Clone)]
pub struct Law {
    /// The law.
    pub effect: &'static dyn Effect,
    /// The joint it acts on.
    pub joint: usize,
    /// Its parameters.
    pub parameters: Vec<f64>,
}

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

/// Position and velocity of all joints.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// Positions.
    pub q: Vec<f64>,
    /// Velocities.
    pub qd: Vec<f64>,
}

/// What happens at one instant: motor torque, accelerations and friction.
#[derive(Debug, Clone, PartialEq)]
pub struct Response {
    /// Motor torque.
    pub tau: Vec<f64>,
    /// Accelerations.
    pub qdd: Vec<f64>,
    /// Torque that the laws take from the motor, friction of stuck joints included.
    pub friction: Vec<f64>,
}

/// Motor torque as a function of time and state.
pub trait Controller {
    /// Torque of all joints at time `t` in state (q, qd).
    fn torque(&self, t: f64, q: &[f64], qd: &[f64], tau: &mut [f64]);
}

/// The arm and everything that acts on it but the motors.
pub struct Plant {
    pub(super) arm: RapierArm,
    laws: Vec<Law>,
    dry: Vec<bool>,
}

impl Plant {
    /// Builds `robot` in rapier with `laws` on its joints.
    ///
    /// # Errors
    /// As [`RapierArm::new`].
    pub fn new(robot: &Robot, laws: Vec<Law>) -> Result<Self> {
        let mut dry = vec![false; robot.dof()];
        for law in laws.iter().filter(|law| law.effect.is_dry()) {
            dry[law.joint] = true;
        }
        Ok(Plant { arm: RapierArm::new(robot)?, laws, dry })
    }

    /// Number of joints.
    pub fn dof(&self) -> usize {
        self.dry.len()
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

    /// Torque the laws take, with the direction of every joint given.
    fn law_torque(&self, t: f64, x: &State, direction: &[f64]) -> Vec<f64> {
        let mut torque = vec![0.0; self.dof()];
        let instant = Instant { t, q: &x.q, qd: &x.qd, direction };
        for law in &self.laws {
            torque[law.joint] += law.effect.torque(&law.parameters, law.joint, &instant);
        }
        torque
    }

    /// Motor torque, accelerations and friction at (t, x) with the contacts held as they are.
    pub fn respond(&mut self, t: f64, x: &State, contacts: &[Contact], controller: &dyn Controller) -> Response {
        let mut tau = vec![0.0; self.dof()];
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
        let mut friction = self.law_torque(t, x, &direction);
        let net: Vec<f64> = tau.iter().zip(&friction).map(|(motor, law)| motor - law).collect();
        let mut qdd = vec![0.0; self.dof()];
        self.arm.forward_dynamics(&x.q, &x.qd, &net, &mut qdd);
        self.hold(contacts, &mut qdd, &mut friction);
        Response { tau, qdd, friction }
    }

    /// Adds the friction that keeps stuck joints from accelerating (Karnopp 1985, with rapier's own inverse mass matrix).
    fn hold(&self, contacts: &[Contact], qdd: &mut [f64], friction: &mut [f64]) {
        let stuck: Vec<usize> = (0..contacts.len()).filter(|&j| contacts[j] == Contact::Stuck).collect();
        if stuck.is_empty() {
            return;
        }
        let columns: Vec<Vec<f64>> = stuck.iter().map(|&joint| self.arm.response(joint)).collect();
        let block = nalgebra::DMatrix::from_fn(stuck.len(), stuck.len(), |r, c| columns[c][stuck[r]]);
        let wanted = nalgebra::DVector::from_fn(stuck.len(), |r, _| qdd[stuck[r]]);
        let holding =
            block.cholesky().expect("a principal block of an inverse mass matrix is positive definite").solve(&wanted);
        for (index, &joint) in stuck.iter().enumerate() {
            friction[joint] += holding[index];
            for (value, response) in qdd.iter_mut().zip(&columns[index]) {
                *value -= holding[index] * response;
            }
        }
        for &joint in &stuck {
            qdd[joint] = 0.0;
        }
    }

    /// Lets go of stuck joints whose friction cannot hold them, worst first, until all that is stuck can be held.
    pub fn release(&mut self, t: f64, x: &State, contacts: &mut [Contact], controller: &dyn Controller) {
        for _ in 0..self.dof() {
            if !contacts.contains(&Contact::Stuck) {
                return;
            }
            let friction = self.respond(t, x, contacts, controller).friction;
            let forward = self.law_torque(t, x, &vec![1.0; self.dof()]);
            let backward = self.law_torque(t, x, &vec![-1.0; self.dof()]);
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
