//! Computed torque with PD feedback on an imperfect nominal model, so that the arm tracks with an error as a real one does.

use super::plant::Controller;
use crate::dynamics::{Chain, inverse_dynamics_at};
use crate::effects::{CoulombFriction, Effect, Instant, ViscousFriction, direction};
use crate::excitation::Reference;
use crate::robot::Robot;

/// Velocity width over which the controller's friction compensation changes sign, rad/s.
const COMPENSATION_WIDTH: f64 = 0.02;

/// Motor torque tau = ID_nominal(q, qd, qdd_ref + kp e + kd de/dt) + rotor and friction compensation, cut off at the
/// drives' effort limits (Siciliano et al. 2009, chapter 8).
pub(crate) struct ComputedTorque<'a> {
    reference: &'a dyn Reference,
    chain: Chain,
    inertial: Vec<f64>,
    nominal: Robot,
    stiffness: f64,
    damping: f64,
}

impl<'a> ComputedTorque<'a> {
    /// A controller that believes `nominal` and follows `reference` with a closed loop of natural frequency
    /// `bandwidth_hz` and damping ratio `damping_ratio`.
    pub(crate) fn new(nominal: &Robot, reference: &'a dyn Reference, bandwidth_hz: f64, damping_ratio: f64) -> Self {
        let natural = std::f64::consts::TAU * bandwidth_hz;
        ComputedTorque {
            reference,
            chain: Chain::new(nominal),
            inertial: nominal.inertial_parameters(),
            nominal: nominal.clone(),
            stiffness: natural * natural,
            damping: 2.0 * damping_ratio * natural,
        }
    }
}

impl Controller for ComputedTorque<'_> {
    fn torque(&self, t: f64, q: &[f64], qd: &[f64], tau: &mut [f64]) {
        let dof = q.len();
        let (mut q_ref, mut qd_ref, mut qdd_ref) = (vec![0.0; dof], vec![0.0; dof], vec![0.0; dof]);
        self.reference.at(t, &mut q_ref, &mut qd_ref, &mut qdd_ref);
        let command: Vec<f64> = (0..dof)
            .map(|j| qdd_ref[j] + self.stiffness * (q_ref[j] - q[j]) + self.damping * (qd_ref[j] - qd[j]))
            .collect();
        let rigid = inverse_dynamics_at(&self.chain, &self.inertial, q, qd, &command);
        let heading: Vec<f64> = qd_ref.iter().map(|&v| direction(v, COMPENSATION_WIDTH)).collect();
        let wanted = Instant {
            t,
            started: 0.0,
            q,
            qd: &qd_ref,
            qdd: &command,
            direction: &heading,
            load: &rigid,
            robot: &self.nominal,
            chain: &self.chain,
            frames: None,
        };
        let mut friction = vec![0.0; dof];
        for (joint, spec) in self.nominal.joints.iter().enumerate() {
            ViscousFriction.torque(&[spec.drive.viscous], joint, &wanted, &[], &mut friction);
            CoulombFriction.torque(&[spec.drive.coulomb], joint, &wanted, &[], &mut friction);
        }
        for (joint, spec) in self.nominal.joints.iter().enumerate() {
            let total = rigid[joint] + spec.drive.armature * command[joint] + friction[joint];
            tau[joint] = total.clamp(-spec.limits.effort, spec.limits.effort);
        }
    }
}
