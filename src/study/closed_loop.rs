//! The arm of a scenario with any base parameters, simulated under the scenario's controller: what instrumental variables
//! and output-error identification take their columns from.

use crate::dynamics::{EquationsOfMotion, Motion};
use crate::effects::drive_friction;
use crate::error::{Error, Result};
use crate::excitation::Reference;
use crate::identification::model::Model;
use crate::identification::prepare::Prepared;
use crate::internal::identification::{JointRegression, STANDARD, SimulatedRows};
use crate::recording::Signals;
use crate::robot::{Joint, Robot};
use crate::scenario::{Setup, simulate_with};
use crate::simulation::engine::EngineKind;
use crate::simulation::integrator::Integrator;
use std::sync::{Arc, Mutex};

/// Instants of the reference at which the mass matrix is tried.
const TRIED: usize = 20;

/// The arm with any parameters under its controller, along one reference.
///
/// ```
/// use tauscope::identification::model::Model;
/// use tauscope::scenario::Setup;
/// use tauscope::study::closed_loop::ClosedLoop;
///
/// // The pendulum with its own parameters under its controller, along the motion of 6 s.
/// let setup = Setup::load("tests/scenarios/pendulum.toml", None)?;
/// let model = Model::new(&setup.known);
/// let beta = model.base().values(&Model::standard_values(&setup.known));
/// let motion = ClosedLoop::new(&setup, &model, &setup.motion).motion(&beta)?;
/// assert_eq!((motion.joints(), motion.samples()), (1, 3001));
///
/// // No arm has an inertia below zero.
/// let impossible: Vec<f64> = beta.iter().map(|value| -value).collect();
/// assert!(ClosedLoop::new(&setup, &model, &setup.motion).motion(&impossible).is_err());
/// # Ok::<(), tauscope::error::Error>(())
/// ```
pub struct ClosedLoop<'a> {
    setup: Setup,
    model: &'a Model,
    reference: &'a dyn Reference,
    /// Parameters and motion of the first simulation, which noise levels, windows and estimators share.
    first: Mutex<Option<(Vec<f64>, Motion)>>,
}

impl<'a> ClosedLoop<'a> {
    /// The arm of `setup` along `reference`, in steps of one sample.
    pub fn new(setup: &Setup, model: &'a Model, reference: &'a dyn Reference) -> Self {
        let mut setup = setup.clone();
        setup.scenario.plant.integrator = Integrator::Rk4;
        setup.scenario.plant.step_s = 1.0 / setup.scenario.sensors.rate_hz;
        ClosedLoop { setup, model, reference, first: Mutex::new(None) }
    }

    /// The motion of the arm with parameters `beta`.
    ///
    /// # Errors
    /// If no arm has these parameters (its mass matrix would not be positive definite), or the simulation runs away.
    pub fn motion(&self, beta: &[f64]) -> Result<Motion> {
        let mut first = self.first.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        if let Some((known, motion)) = first.as_ref()
            && known == beta
        {
            return Ok(motion.clone());
        }
        let fresh = first.is_none();
        let motion = self.simulated(beta)?;
        if fresh {
            *first = Some((beta.to_vec(), motion.clone()));
        }
        Ok(motion)
    }

    fn simulated(&self, beta: &[f64]) -> Result<Motion> {
        let robot = with_base_parameters(&self.setup.known, self.model, beta);
        self.require_mass_matrix(&robot)?;
        let setup = Setup { effects: drive_friction(&robot), plant: robot, ..self.setup.clone() };
        let truth = simulate_with(EngineKind::Recursive, &setup, self.reference, &mut |_| ())?;
        let Signals { q, qd, qdd, .. } = Arc::unwrap_or_clone(truth.signals);
        Ok(Motion { q, qd, qdd })
    }

    fn require_mass_matrix(&self, robot: &Robot) -> Result<()> {
        let dof = robot.dof();
        let armature: Vec<f64> = robot.joints.iter().map(|joint| joint.drive.armature).collect();
        let inertial = robot.inertial_parameters();
        let (mut q, mut qd, mut qdd) = (vec![0.0; dof], vec![0.0; dof], vec![0.0; dof]);
        for k in 0..TRIED {
            let t = self.reference.duration_s() * (k as f64 + 0.5) / TRIED as f64;
            self.reference.at(t, &mut q, &mut qd, &mut qdd);
            let equations = EquationsOfMotion::new(self.model.chain(), &inertial, &armature, &q, &qd);
            // Not a number is not a mass either.
            if equations.smallest_pivot().is_nan() || equations.smallest_pivot() <= 0.0 {
                let problem = format!(
                    "no arm has these parameters: at t = {t:.2} s the mass matrix is not positive definite; smooth more, or \
                     start nearer to the truth"
                );
                return Err(Error::request("simulation of the estimate", problem));
            }
        }
        Ok(())
    }
}

/// `robot` with base parameters put on the standard parameters that carry them, and nothing on the others: no possible
/// bodies, but the same torques. Friction that would drive the arm is left out.
pub fn with_base_parameters(robot: &Robot, model: &Model, beta: &[f64]) -> Robot {
    let mut standard = vec![0.0; robot.dof() * STANDARD];
    for (&place, value) in model.base().kept().iter().zip(model.base().carried(beta)) {
        standard[place] = value;
    }
    let mut made = Model::with_standard_values(robot, &standard);
    for Joint { drive, .. } in &mut made.joints {
        [drive.viscous, drive.coulomb] = [drive.viscous.max(0.0), drive.coulomb.max(0.0)];
    }
    made
}

/// A [`ClosedLoop`] with one measured log.
pub(crate) struct Alongside<'a> {
    /// The simulated arm.
    pub arm: &'a ClosedLoop<'a>,
    /// The log, with its filter and torque.
    pub prepared: &'a Prepared<'a>,
}

impl SimulatedRows for Alongside<'_> {
    fn rows(&self, beta: &[f64]) -> Result<Vec<JointRegression>> {
        self.prepared.along(self.arm.motion(beta)?).regression(self.arm.model)
    }
}
