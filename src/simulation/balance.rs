//! Joints that friction holds still, and laws that depend on the acceleration they take part in.

use super::engine::Engine;
use nalgebra::{DMatrix, DVector};

/// Newton steps after which accelerations that laws depend on are taken as they are.
const MOST_NEWTON_STEPS: usize = 30;

/// The accelerations when friction holds some joints still (Karnopp 1985, with the engine's own inverse mass matrix) and laws
/// depend on the accelerations themselves.
pub(super) struct Balance {
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
    /// For the joints that friction holds (`stuck`), at the accelerations and the effects' torque with nothing held and no
    /// law that depends on acceleration. `arm` has just answered for this state; `rotors` are the inertias of the rotors
    /// that gears set apart from their links, None for rigid joints.
    pub(super) fn new(
        arm: &Engine,
        rotors: &[Option<f64>],
        stuck: Vec<usize>,
        qdd: &[f64],
        link_qdd: &[f64],
        torque: &[f64],
    ) -> Self {
        let dof = rotors.len();
        let (mut motor, mut link) = (DMatrix::zeros(dof, dof), DMatrix::zeros(dof, dof));
        for joint in 0..dof {
            match rotors[joint] {
                None => {
                    link.set_column(joint, &DVector::from_vec(arm.response(joint)));
                    for row in (0..dof).filter(|&row| rotors[row].is_none()) {
                        motor[(row, joint)] = link[(row, joint)];
                    }
                }
                Some(inertia) => motor[(joint, joint)] = 1.0 / inertia,
            }
        }
        Balance {
            stuck,
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

    /// Motor and link accelerations and the effects' torque at which `law`, their torque at given accelerations of motors
    /// and links, holds: Newton's method on the effects' torque
    /// with a Jacobian by differences, which is exact for laws that are linear in acceleration and load.
    pub(super) fn solve(
        &self,
        depends: bool,
        law: impl Fn(&[f64], &[f64]) -> Vec<f64>,
    ) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
        let dof = self.free_qdd.len();
        let mut extra = DVector::zeros(dof);
        if depends {
            let residual = |extra: &DVector<f64>| -> DVector<f64> {
                let (qdd, link_qdd, _) = self.held(extra);
                DVector::from_vec(law(qdd.as_slice(), link_qdd.as_slice())) - &self.start_torque - extra
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
