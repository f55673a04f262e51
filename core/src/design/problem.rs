//! The problem (16)-(17) as a function of a motion: a criterion, and penalties for the limits that an encoding does not
//! keep by construction.

use super::criterion::{self, Criterion};
use super::envelope::{Envelope, Violation};
use super::information::{Experiment, Information};
use crate::error::{Error, Result};
use crate::excitation::Reference;
use crate::identification::model::Model;

/// Added to the criterion per unit of violation (mean over time of m and shares of the effort), and for any at all.
const PENALTY: f64 = 100.0;
const PENALTY_STEP: f64 = 1.0;

/// What a motion is worth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Worth {
    /// Criterion plus penalties; less is better.
    pub value: f64,
    /// Violation of the limits with the search's margins.
    pub violation: Violation,
}

/// A criterion on an arm with its sensors and limits.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::design::{Criterion, Envelope, Experiment, Problem};
/// use tauscope::excitation::{JointLimits, random_sequence::random_sequence};
/// use tauscope::robot::{self, InertiaCheck};
/// # let pendulum = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Required)?;
/// # let limits = [JointLimits { lower: -2.0, upper: 2.0, velocity: 3.0, acceleration: 20.0 }];
///
/// // What a motion is worth to identify a pendulum by: less is better.
/// let (experiment, envelope) = (Experiment::new(&pendulum, &[0.5], 100.0)?, Envelope::new(&pendulum, &limits, None)?);
/// let problem = Problem::new(experiment, envelope, Criterion::ConditionNumber, 100.0, 0.03)?;
/// let (information, violation) = problem.observe(&random_sequence(1, "motion", 0, 4, 8.0, &limits)?);
/// let worth = problem.worth(&information, violation);
/// assert!(worth.violation.is_none());
/// assert!((worth.value - Criterion::ConditionNumber.value(&information, problem.sizes())).abs() < 1e-9);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Problem {
    /// The arm with its torque sensors.
    pub experiment: Experiment,
    /// Its limits.
    pub envelope: Envelope,
    /// What motions are judged by.
    pub criterion: Criterion,
    /// Rate of the grid a search evaluates on, Hz.
    pub grid_hz: f64,
    sizes: Vec<f64>,
}

impl Problem {
    /// Puts the parts together. `still_band` is the speed (rad/s) below which rows do not count in the identification.
    ///
    /// # Errors
    /// Names the joint whose velocity limit lies within `still_band`.
    pub fn new(
        experiment: Experiment,
        envelope: Envelope,
        criterion: Criterion,
        grid_hz: f64,
        still_band: f64,
    ) -> Result<Self> {
        for (limits, joint) in envelope.joints().iter().zip(&envelope.robot().joints) {
            if limits.velocity <= still_band {
                let problem = format!(
                    "the velocity limit {} lies within the reversal band of {still_band}, where rows do not count; raise it",
                    limits.velocity
                );
                return Err(Error::request(&joint.name, problem));
            }
        }
        let base = experiment.model().base();
        let units: Vec<&str> = base.kept().iter().map(|&standard| Model::unit(standard).name()).collect();
        let sizes = criterion::sizes(experiment.beta(), &units);
        Ok(Problem { experiment, envelope, criterion, grid_hz, sizes })
    }

    /// Sizes that relative standard deviations are taken of.
    pub fn sizes(&self) -> &[f64] {
        &self.sizes
    }

    /// Information along `motion` on the search's grid, and how far it is outside the limits.
    pub fn observe(&self, motion: &dyn Reference) -> (Information, Violation) {
        let mut violation = Violation::default();
        let mut samples = 0;
        let information = self.experiment.scan(motion, self.grid_hz, &mut |block| {
            let part = self.envelope.violation(block);
            violation.torque += part.torque;
            violation.floor += part.floor;
            violation.column += part.column;
            samples += block.time.len();
        });
        for part in [&mut violation.torque, &mut violation.floor, &mut violation.column] {
            *part /= samples as f64;
        }
        (information, violation)
    }

    /// Worth of a motion with `information`, which may include that of other motions.
    pub fn worth(&self, information: &Information, violation: Violation) -> Worth {
        let criterion = self.criterion.value(information, &self.sizes);
        let penalty = if violation.is_none() { 0.0 } else { PENALTY_STEP + PENALTY * violation.total() };
        Worth { value: criterion + penalty, violation }
    }
}
