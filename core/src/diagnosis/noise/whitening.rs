//! Whitening: the noise of every joint made white, each by its own model.

use super::innovations::InnovationsFilter;
use super::joint_whitener::JointWhitener;
use super::memory::{FactorMemory, NoiseMemory, key_of_factors, key_of_noise};
use crate::diagnosis::logs::Rows;
use crate::diagnosis::regression::{
    Column, Factored, JointEquations, JointFactors, OfJoint, Projection, Solved, parts_on,
};
use crate::identification::noise::AutoregressiveNoise;
use rayon::prelude::*;
use std::sync::Arc;

/// Turns the noise of every joint into white noise of unit variance.
#[derive(Debug, Clone)]
pub struct Whitener {
    joints: Vec<JointWhitener>,
    /// Regressions in this noise and in others.
    memory: Arc<FactorMemory>,
}

impl Whitener {
    /// From what `torque` has beyond the columns in `present` (the baseline, effects) and the rich ones.
    pub fn new(rows: &Rows, torque: &Column, present: &[Column]) -> Self {
        let joints = (0..rows.dof()).into_par_iter().map(|joint| JointWhitener::of(rows, torque, present, joint));
        Whitener { joints: joints.collect(), memory: Arc::default() }
    }

    /// [`Whitener::new`], with joints whose noise was estimated from the same before taken from `memory`.
    pub(crate) fn remembered(memory: &NoiseMemory, rows: &Rows, torque: &Column, present: &[Column]) -> Self {
        let joints = (0..rows.dof()).into_par_iter().map(|joint| {
            let signals = present.iter().chain([torque]).filter_map(|column| column.part(joint));
            let estimate = || JointWhitener::of(rows, torque, present, joint);
            JointWhitener::clone(&memory.get(key_of_noise(joint, &rows.valid[joint], signals), estimate))
        });
        Whitener { joints: joints.collect(), memory: memory.factors.clone() }
    }

    /// The same with the noise of one joint from what `torque` has there beyond the columns in `present` and the rich ones.
    pub(crate) fn anew_on(&self, joint: usize, rows: &Rows, torque: &Column, present: &[Column]) -> Self {
        let mut anew = self.clone();
        anew.joints[joint] = JointWhitener::of(rows, torque, present, joint);
        anew
    }

    /// For noise that is known, one for each joint.
    pub fn of_known(rows: &Rows, noises: Vec<AutoregressiveNoise>) -> Self {
        let joints = noises.into_iter().zip(&rows.valid).map(|(noise, valid)| JointWhitener {
            filter: Arc::new(InnovationsFilter::new(noise, valid, &rows.starts)),
            misfit: 1.0,
        });
        Whitener { joints: joints.collect(), memory: Arc::default() }
    }

    /// A column whitened; the rows that do not count are gone.
    pub fn apply(&self, column: &Column) -> Column {
        let parts = column.parts.iter().map(|(joint, signal)| (*joint, self.joints[*joint].apply(signal)));
        Column::of(parts.collect())
    }

    /// [`Whitener::apply`] of many.
    pub(crate) fn apply_all(&self, columns: &[Column]) -> Vec<Column> {
        columns.par_iter().map(|column| self.apply(column)).collect()
    }

    /// The least-squares fit of `torque` by `columns`, none of them whitened yet.
    pub fn fit(&self, columns: &[Column], torque: &Column) -> Projection {
        Projection::of(&self.factored(columns, torque))
    }

    /// The same fit with its covariance.
    pub(crate) fn solve(&self, columns: &[Column], torque: &Column) -> Solved {
        self.equations(columns, torque).solved(|_| 1.0)
    }

    /// Its normal equations, joint by joint.
    pub(crate) fn equations(&self, columns: &[Column], torque: &Column) -> JointEquations {
        JointEquations::new(self.factored(columns, torque))
    }

    fn factored(&self, columns: &[Column], torque: &Column) -> Factored {
        let of_joint = |(joint, JointWhitener { filter, misfit }): (usize, &JointWhitener)| {
            let (places, parts) = parts_on(columns, joint);
            let torque = torque.part(joint);
            if places.is_empty() && torque.is_none() {
                return None;
            }
            let signals = parts.iter().copied().chain([torque.unwrap_or_default()]);
            let factors = self.memory.get(key_of_factors(filter, signals), || {
                let columns = parts.iter().flat_map(|part| filter.apply(part)).collect();
                let torque = torque.map_or_else(|| vec![0.0; filter.rows().len()], |torque| filter.apply(torque));
                JointFactors::new(columns, parts.len(), torque)
            });
            Some(OfJoint { joint, places, factors, weight: 1.0 / misfit })
        };
        let joints = self.joints.par_iter().enumerate().filter_map(of_joint);
        Factored { columns: columns.len(), joints: joints.collect() }
    }

    /// The number of valid rows of each joint.
    pub fn rows(&self) -> Vec<usize> {
        self.joints.iter().map(|joint| joint.filter.rows().len()).collect()
    }

    /// The same noise over other rows.
    pub fn on(&self, rows: &Rows) -> Whitener {
        let joints = self.joints.iter().zip(&rows.valid).map(|(joint, valid)| JointWhitener {
            filter: Arc::new(InnovationsFilter::new(joint.filter.noise().clone(), valid, &rows.starts)),
            misfit: joint.misfit,
        });
        Whitener { joints: joints.collect(), memory: self.memory.clone() }
    }

    /// The same noise with each joint's standard deviation times a factor, for a residual beyond the noise.
    pub(crate) fn with_misfit(mut self, factors: &[f64]) -> Whitener {
        self.joints.iter_mut().zip(factors).for_each(|(joint, factor)| joint.misfit *= factor);
        self
    }

    /// Factor by which the residual of a joint exceeds its noise, at least one.
    pub fn misfit(&self, joint: usize) -> f64 {
        self.joints[joint].misfit
    }

    /// Whether the residual of any of `joints` is well above the noise: by more than the factor `misfit`.
    pub(crate) fn is_misfit(&self, joints: &[usize], misfit: f64) -> bool {
        self.largest_misfit(joints) > misfit
    }

    /// The largest factor on the noise of these joints that makes it as large as the residual.
    pub(crate) fn largest_misfit(&self, joints: &[usize]) -> f64 {
        joints.iter().map(|&joint| self.misfit(joint)).fold(0.0, f64::max)
    }

    /// Standard deviation of each joint's noise in the rows, without misfit, N m.
    pub fn noise_std(&self) -> Vec<f64> {
        self.joints.iter().map(|joint| joint.filter.noise().std()).collect()
    }

    /// Standard deviation of the innovations of each joint, without misfit, N m.
    pub fn innovation_std(&self) -> Vec<f64> {
        self.joints.iter().map(|joint| joint.filter.noise().innovation_std).collect()
    }

    /// Sum over all rows of the logarithm of the standard deviation of the innovations, misfit included.
    pub(crate) fn log_scale(&self) -> f64 {
        self.joints
            .iter()
            .map(|joint| joint.filter.rows().len() as f64 * (joint.misfit * joint.filter.noise().innovation_std).ln())
            .sum()
    }

    /// Sum over the joints of the logarithm of the standard deviation of the innovations.
    pub(crate) fn mean_log_scale(&self) -> f64 {
        self.joints.iter().map(|joint| joint.filter.noise().innovation_std.ln()).sum()
    }

    /// Row of the logs of each whitened row of a joint.
    pub fn places(&self, joint: usize) -> &[usize] {
        self.joints[joint].filter.rows()
    }
}
