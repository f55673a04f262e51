//! Physical effects: each law is written once and serves the plant, the identification model and the catalogue.
//!
//! Sign convention: an effect's torque is what the motor must add because of it.

mod coulomb_friction;
mod viscous_friction;

pub use coulomb_friction::CoulombFriction;
pub use viscous_friction::ViscousFriction;

use crate::dynamics::Motion;

/// The state of the arm at one instant, as a law sees it. All slices have one entry per joint.
#[derive(Debug, Clone, Copy)]
pub struct Instant<'a> {
    /// Time in s.
    pub t: f64,
    /// Positions.
    pub q: &'a [f64],
    /// Velocities.
    pub qd: &'a [f64],
    /// Direction of motion in [-1, 1]: the sign of the velocity, or of the imminent motion at standstill.
    pub direction: &'a [f64],
}

/// What the catalogue says of an effect.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct About {
    /// Its name in scenarios, results and tests.
    pub name: &'static str,
    /// Its law as a formula.
    pub equation: &'static str,
    /// A sentence a practitioner understands.
    pub explanation: &'static str,
    /// The paper or book the law comes from.
    pub reference: &'static str,
}

/// One parameter of an effect.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Parameter {
    /// Symbol used in parameter names: "Fv".
    pub symbol: &'static str,
    /// Unit on a revolute joint.
    pub unit: &'static str,
}

/// A physical law that adds torque to a joint, linear in its parameters.
pub trait Effect: Sync {
    /// What the catalogue says of it.
    fn about(&self) -> &'static About;

    /// Its parameters; zero means absent.
    fn parameters(&self) -> &'static [Parameter];

    /// Whether the law jumps with the direction of motion, so that the joint can stick.
    fn is_dry(&self) -> bool {
        false
    }

    /// Torque the motor of `joint` must add, for parameters `p`.
    fn torque(&self, p: &[f64], joint: usize, x: &Instant) -> f64;
}

/// Direction of motion along a measured velocity: tanh(v / width), the sign smoothed over the width in which noise
/// makes it unreliable; a width of zero gives the plain sign.
pub fn direction(velocity: f64, width: f64) -> f64 {
    if width > 0.0 {
        (velocity / width).tanh()
    } else if velocity == 0.0 {
        0.0
    } else {
        velocity.signum()
    }
}

/// An effect's torque along a motion on its own joint, for parameters `p`.
pub fn along(effect: &dyn Effect, p: &[f64], joint: usize, motion: &Motion, time: &[f64], width: f64) -> Vec<f64> {
    let dof = motion.joints();
    let mut q = vec![0.0; dof];
    let mut qd = vec![0.0; dof];
    let mut heading = vec![0.0; dof];
    (0..motion.samples())
        .map(|sample| {
            for other in 0..dof {
                q[other] = motion.q.channel(other)[sample];
                qd[other] = motion.qd.channel(other)[sample];
                heading[other] = direction(qd[other], width);
            }
            let t = time[sample];
            effect.torque(p, joint, &Instant { t, q: &q, qd: &qd, direction: &heading })
        })
        .collect()
}
