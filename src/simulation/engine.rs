//! What turns torques into accelerations: rapier, or the project's own recursions.

use super::rapier_arm::RapierArm;
use crate::dynamics::{Chain, EquationsOfMotion};
use crate::error::Result;
use crate::robot::Robot;

/// Which forward dynamics a plant has.
///
/// ```
/// use tauscope::scenario::{Setup, simulate_with};
/// use tauscope::simulation::engine::EngineKind;
///
/// // The same motion under both: they agree to rounding.
/// let setup = Setup::load("tests/scenarios/pendulum.toml", None)?;
/// let run = |engine| simulate_with(engine, &setup, &setup.held_out, &mut |_| ());
/// let (rapier, recursive) = (run(EngineKind::Rapier)?, run(EngineKind::Recursive)?);
/// let pairs = rapier.signals.tau.as_slice().iter().zip(recursive.signals.tau.as_slice());
/// assert!(pairs.into_iter().all(|(a, b)| (a - b).abs() < 1e-6));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize, clap::ValueEnum)]
#[serde(rename_all = "snake_case")]
pub enum EngineKind {
    /// Rapier's articulated bodies.
    Rapier,
    /// The project's own equations of motion: the same numbers to rounding, faster, and defined for parameters that no body can have, such
    /// as base parameters. They cannot take rapier's own time step.
    #[default]
    Recursive,
}

impl EngineKind {
    /// What moves `robot`: rapier's articulated bodies have no joints that follow others.
    pub fn of(self, robot: &Robot) -> EngineKind {
        if robot.followers().is_empty() { self } else { EngineKind::Recursive }
    }

    /// As texts call it.
    pub fn name(self) -> &'static str {
        match self {
            EngineKind::Rapier => "rapier",
            EngineKind::Recursive => "own dynamics",
        }
    }
}

/// Forward dynamics of an arm, rotor inertias included, friction not.
pub(super) enum Engine {
    /// Rapier.
    Rapier(Box<RapierArm>),
    /// Own equations of motion.
    Recursive(Box<RecursiveArm>),
}

/// An arm under its own equations of motion.
pub(super) struct RecursiveArm {
    chain: Chain,
    inertial: Vec<f64>,
    armature: Vec<f64>,
    last: Option<EquationsOfMotion>,
}

impl Engine {
    /// The forward dynamics of `robot`. Where joints follow others the own equations of motion stand in for rapier.
    ///
    /// # Errors
    /// As [`RapierArm::new`].
    pub(super) fn new(kind: EngineKind, robot: &Robot) -> Result<Self> {
        Ok(match kind.of(robot) {
            EngineKind::Rapier => Engine::Rapier(Box::new(RapierArm::new(robot)?)),
            EngineKind::Recursive => Engine::Recursive(Box::new(RecursiveArm {
                chain: Chain::new(robot),
                inertial: robot.inertial_parameters(),
                armature: robot.joints.iter().map(|joint| joint.drive.armature).collect(),
                last: None,
            })),
        })
    }

    /// Joint accelerations at position `q` and velocity `qd` under joint torques `tau`; the mass matrix is kept for
    /// [`Engine::response`].
    pub(super) fn forward_dynamics(&mut self, q: &[f64], qd: &[f64], tau: &[f64], qdd: &mut [f64]) {
        match self {
            Engine::Rapier(arm) => arm.forward_dynamics(q, qd, tau, qdd),
            Engine::Recursive(arm) => {
                let RecursiveArm { chain, inertial, armature, last } = &mut **arm;
                match last {
                    Some(equations) => equations.update(chain, inertial, armature, q, qd),
                    None => *last = Some(EquationsOfMotion::new(chain, inertial, armature, q, qd)),
                }
                if let Some(equations) = last {
                    qdd.copy_from_slice(&equations.accelerations(tau));
                }
            }
        }
    }

    /// Accelerations of all joints per unit torque on `joint` at the last state.
    ///
    /// # Panics
    /// Before the first [`Engine::forward_dynamics`].
    pub(super) fn response(&self, joint: usize) -> Vec<f64> {
        match self {
            Engine::Rapier(arm) => arm.response(joint),
            Engine::Recursive(arm) => arm.last.as_ref().expect("forward dynamics come first").response(joint),
        }
    }

    /// Rapier, if it is the engine.
    pub(super) fn rapier(&mut self) -> Option<&mut RapierArm> {
        match self {
            Engine::Rapier(arm) => Some(arm),
            Engine::Recursive(_) => None,
        }
    }
}
