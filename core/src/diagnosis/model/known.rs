//! What is known before anything is tested: the arm, effects that the simulation has already, and logs from before a change.
//!
//! Effects that are known are part of the baseline: their torque is taken off, and the derivatives to all their parameters
//! stay free, so that an effect that is known but not exactly is not taken for another. Logs from before a change share the
//! baseline, and the candidates are zero there: the error with which the arm was identified is then no change.

use crate::diagnosis::logs::Rows;
use crate::diagnosis::regression::Column;
use crate::effects::{Effect, Placed, Role, Rounding};
use crate::error::Result;
use crate::identification::effect_model::{Arm, Trust};
use crate::recording::Recording;
use crate::robot::Robot;

/// Share of a parameter over which its derivative is taken.
const DIFFERENCE: f64 = 0.02;

/// What is known before anything is tested.
#[derive(Debug, Clone)]
pub struct Known<'a> {
    /// The arm: what effects in gears and sensors act upon until it is fitted.
    pub arm: Arm,
    /// Effects at work, with the parameters they are known to have.
    pub effects: Vec<Placed>,
    /// Logs from before the change in question.
    pub reference: Vec<&'a Recording>,
}

impl Known<'_> {
    /// Nothing but the robot description.
    pub fn nothing(robot: &Robot, trust: Trust) -> Self {
        Known { arm: Arm::new(robot, trust), effects: Vec::new(), reference: Vec::new() }
    }

    /// The same with an arm whose friction changes its direction over some speed on each joint, rad/s or m/s.
    pub(crate) fn with_coulomb_rounding(&self, rounding: Vec<Rounding>) -> Self {
        Known { arm: self.arm.clone().with_coulomb_rounding(rounding), ..self.clone() }
    }

    /// Torque of the effects over all rows.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub fn torque(&self, rows: &Rows) -> Result<Column> {
        let mut sum = Column::default();
        for column in self.arm.added_throughout(&self.effects, rows)? {
            sum.add(1.0, &column);
        }
        Ok(sum)
    }

    /// Derivatives of that torque to the parameters that are fitted, in the order of [`Known::fitted`].
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub fn derivatives(&self, rows: &Rows) -> Result<Vec<Column>> {
        let moved: Vec<Placed> = self.fitted().into_iter().flat_map(|place| self.neighbours(place)).collect();
        let torques = self.arm.added_throughout(&moved, rows)?;
        let pairs = self.fitted().into_iter().zip(moved.chunks_exact(2).zip(torques.chunks_exact(2)));
        Ok(pairs
            .map(|((_, index), (placed, torque))| {
                let mut column = torque[0].clone();
                column.add(-1.0, &torque[1]);
                let apart = placed[0].parameters[index] - placed[1].parameters[index];
                column.scale(if apart == 0.0 { 0.0 } else { 1.0 / apart });
                column
            })
            .collect())
    }

    /// Parameters that are fitted again: index of the effect, index of the parameter.
    pub fn fitted(&self) -> Vec<(usize, usize)> {
        let of = |effect: &dyn Effect| {
            let parameters = effect.parameters().iter().enumerate();
            parameters.filter(|(_, parameter)| parameter.role != Role::Held).map(|(k, _)| k).collect::<Vec<_>>()
        };
        let effects = self.effects.iter().enumerate();
        effects.flat_map(|(effect, placed)| of(placed.effect).into_iter().map(move |k| (effect, k))).collect()
    }

    /// An effect with one parameter a little higher and a little lower.
    fn neighbours(&self, (effect, index): (usize, usize)) -> [Placed; 2] {
        let placed = &self.effects[effect];
        let parameter = &placed.effect.parameters()[index];
        let step = DIFFERENCE * placed.parameters[index].abs().max(0.1 * parameter.typical.abs());
        [step, -step].map(|by| {
            let mut moved = placed.clone();
            moved.parameters[index] = (moved.parameters[index] + by).clamp(parameter.lower, parameter.upper);
            moved
        })
    }
}
