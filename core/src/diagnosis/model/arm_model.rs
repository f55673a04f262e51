//! The model of an arm with effects: its regressor along a data set, and the places of its parameters.

use super::arm_columns::Moved;
use super::blocks::ParameterBlocks;
use super::candidates::{Asked, Candidate};
use super::data_set::DataSet;
use super::known::Known;
use super::member::Member;
use super::roles::{bounded, shapes};
use crate::diagnosis::logs::Rows;
use crate::diagnosis::regression::{Column, Described, combined};
use crate::error::Result;
use crate::identification::effect_model::{Arm, Trust};
use crate::identification::model::Model;
use crate::identification::standard::STANDARD;
use crate::robot::PARAMETERS;

/// Share of a shape's value over which its derivative is taken.
const DIFFERENCE: f64 = 0.02;

/// The arm under diagnosis: what is known of it, and its parameters as last fitted.
#[derive(Debug, Clone)]
pub struct ArmModel<'a> {
    /// Base parameters and rotors.
    pub base: &'a Model,
    /// Whether its inertias are estimated or taken from the URDF.
    pub trust: Trust,
    /// What is known before anything is tested.
    pub known: Known<'a>,
    /// The arm as found so far.
    pub arm: Arm,
    /// Joints whose gears may have play: impacts show some, but not significantly.
    pub open_play: Vec<usize>,
    /// Gain of the log-likelihood by the likeliest rounding of the sign of friction where that was not taken, `[joint]`.
    pub rounding_gains: Vec<f64>,
}

impl ArmModel<'_> {
    /// Largest torque of a joint of the arm as found, N m.
    pub fn largest_torque(&self, rows: &Rows, joint: usize) -> f64 {
        let torque = self.arm.all_torque(rows);
        torque.part(joint).unwrap_or_default().iter().fold(0.0f64, |m, v| m.max(v.abs()))
    }

    /// What the description says of the base parameters of the bodies, where they are estimated: each as far off at the most as the largest of
    /// its kind on its link. Nothing where bodies are described without mass or by placeholders, and where a data set has no baseline.
    pub(crate) fn described(&self, data: &DataSet) -> Vec<Described> {
        let robot = self.base.robot();
        let is_known = self.trust == Trust::Structure && robot.placeholders().is_none() && robot.lifted.is_empty();
        if !is_known || data.baseline.is_empty() {
            return Vec::new();
        }
        let base = self.base.base();
        let values = base.values(&Model::standard_values(self.base.robot()));
        let inertial = || base.kept().iter().copied().enumerate().filter(|(_, kept)| kept % STANDARD < PARAMETERS);
        let kind = |kept: usize| (kept / STANDARD, Model::unit(kept));
        let largest = |own: usize| {
            let alike = inertial().filter(|(_, kept)| kind(*kept) == kind(own));
            alike.map(|(place, _)| values[place].abs()).fold(0.0, f64::max)
        };
        let each = inertial().map(|(place, kept)| Described { place, value: values[place], std: largest(kept) });
        each.filter(|one| one.std > 0.0).collect()
    }

    /// Places of the parameters with `members`, in the order of [`ArmModel::columns`].
    pub(crate) fn blocks(&self, data: &DataSet, members: &[Member]) -> ParameterBlocks {
        ParameterBlocks::new(data.baseline.len(), data.known, members)
    }

    /// Candidates of the effects with the names `only`, of all where there are none.
    pub(crate) fn asked<'b>(&'b self, only: &'b [String]) -> Asked<'b> {
        Asked { trust: self.trust, only, open_play: &self.open_play }
    }

    /// Regressor along a data set: columns of the baseline, then of every effect its own and the derivatives to its shapes.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub fn columns(&self, data: &DataSet, members: &[Member]) -> Result<Vec<Column>> {
        let mut all = data.baseline.clone();
        for member in members.iter().filter(|member| !member.held) {
            if data.training || member.candidate.log.is_none() {
                let Candidate { placed, log, .. } = &member.candidate;
                let placed = std::slice::from_ref(placed);
                let columns = data.columns(&self.arm, *log, placed, Moved::Modelled)?;
                let mut own: Vec<Column> = columns.iter().flat_map(|group| group.iter().cloned()).collect();
                let shapes = shapes(placed[0].effect);
                if shapes.iter().all(|index| member.fixed.contains(index)) {
                    own.extend(shapes.iter().map(|_| Column::default()));
                } else {
                    own.extend(self.tangents(data, &member.candidate, &member.factors)?);
                }
                for (column, index) in own.iter_mut().zip(member.places()) {
                    if member.fixed.contains(&index) {
                        *column = Column::default();
                    }
                }
                all.extend(own);
            } else {
                // What happened in a training log did not happen here.
                all.extend(member.places().map(|_| Column::default()));
            }
        }
        Ok(all)
    }

    /// Derivatives of an effect's torque to its shapes.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub fn tangents(&self, data: &DataSet, candidate: &Candidate, factors: &[f64]) -> Result<Vec<Column>> {
        let Candidate { placed, log, .. } = candidate;
        let mut tangents = Vec::new();
        for index in shapes(placed.effect) {
            let parameter = &placed.effect.parameters()[index];
            let step = DIFFERENCE * placed.parameters[index].abs().max(0.1 * parameter.typical.abs());
            let moved = |by: f64| {
                let mut moved = placed.clone();
                moved.parameters[index] = bounded(parameter, placed.parameters[index] + by);
                moved
            };
            let (ahead, behind) = (moved(step), moved(-step));
            let apart = ahead.parameters[index] - behind.parameters[index];
            let both = data.columns(&self.arm, *log, &[ahead, behind], Moved::Modelled)?;
            let mut tangent = combined(&both[0], factors);
            tangent.add(-1.0, &combined(&both[1], factors));
            tangent.scale(1.0 / apart);
            tangents.push(tangent);
        }
        Ok(tangents)
    }
}
