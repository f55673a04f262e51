//! One joint's rows of a regression.

use super::joint_sums::JointSums;
use crate::channels::Channels;
use crate::identification::numerics::gram::{BLOCK, Gram, products, valid_block};
use crate::identification::numerics::sequences::combined;
use crate::identification::numerics::tsqr::Triangle;
use nalgebra::DMatrix;
use std::ops::Range;

/// One joint's share of a linear regression: torque = columns * parameters.
#[derive(Debug, Clone)]
pub struct JointRegression {
    /// Name of the joint.
    pub joint: String,
    /// Which parameters the columns belong to.
    pub parameters: Vec<usize>,
    /// Columns, `[active parameter][row]`.
    pub columns: Channels,
    /// Measured torque of each row.
    pub torque: Vec<f64>,
    /// Valid rows; the others are kept in place so that noise can be followed over time.
    pub valid: Vec<bool>,
}

impl JointRegression {
    /// Several logs of one joint one after the other, with `separation` rows without weight between them.
    pub fn joined(mut parts: Vec<JointRegression>, separation: usize) -> Self {
        // A single log, which may be long, stays where it is.
        if parts.len() == 1 && parts[0].parameters.is_sorted_by(|a, b| a < b) {
            return parts.swap_remove(0);
        }
        let mut parameters: Vec<usize> = parts.iter().flat_map(|part| part.parameters.clone()).collect();
        parameters.sort_unstable();
        parameters.dedup();
        let rows: usize = parts.iter().map(|part| part.columns.samples()).sum();
        let samples = rows + separation * parts.len().saturating_sub(1);
        let mut joined = JointRegression {
            joint: parts.first().map_or(String::new(), |part| part.joint.clone()),
            columns: Channels::zeros(parameters.len(), samples),
            torque: vec![0.0; samples],
            valid: vec![false; samples],
            parameters,
        };
        let mut start = 0;
        for part in parts {
            let rows = start..start + part.columns.samples();
            joined.torque[rows.clone()].copy_from_slice(&part.torque);
            joined.valid[rows.clone()].copy_from_slice(&part.valid);
            for (parameter, column) in part.parameters.iter().zip(part.columns.iter()) {
                let place = joined.parameters.iter().position(|p| p == parameter);
                // A parameter can have several columns of one joint only by summing them.
                if let Some(place) = place {
                    let target = &mut joined.columns.channel_mut(place)[rows.clone()];
                    target.iter_mut().zip(column).for_each(|(t, c)| *t += c);
                }
            }
            start = rows.end + separation;
        }
        joined
    }

    /// Adds the column of one more parameter, whose present `value` is already part of the prediction.
    pub(in crate::identification) fn append(&mut self, parameter: usize, column: &[f64], value: f64) {
        let mut columns: Vec<Vec<f64>> = self.columns.iter().map(<[f64]>::to_vec).collect();
        columns.push(column.to_vec());
        self.columns = Channels::from_vectors(&columns);
        self.parameters.push(parameter);
        self.torque.iter_mut().zip(column).for_each(|(torque, x)| *torque += value * x);
    }

    /// The same without the parameters that are held, whose torque is taken off; the others, `kept` in order, are counted
    /// anew.
    pub(in crate::identification) fn without(&self, held: &[(usize, f64)], kept: &[usize]) -> Self {
        let (mut parameters, mut columns) = (Vec::new(), Vec::new());
        let mut torque = self.torque.clone();
        for (parameter, column) in self.parameters.iter().zip(self.columns.iter()) {
            if let Some((_, value)) = held.iter().find(|(own, _)| own == parameter) {
                torque.iter_mut().zip(column).for_each(|(torque, x)| *torque -= value * x);
            } else if let Ok(place) = kept.binary_search(parameter) {
                parameters.push(place);
                columns.push(column.to_vec());
            }
        }
        let columns = Channels::from_vectors(&columns);
        JointRegression { joint: self.joint.clone(), parameters, columns, torque, valid: self.valid.clone() }
    }

    /// Every `step`-th of some rows.
    pub(in crate::identification) fn part(&self, rows: Range<usize>, step: usize) -> Self {
        let pick = |signal: &[f64]| signal[rows.clone()].iter().copied().step_by(step).collect::<Vec<f64>>();
        let columns: Vec<Vec<f64>> = self.columns.iter().map(pick).collect();
        let torque = pick(&self.torque);
        JointRegression {
            joint: self.joint.clone(),
            parameters: self.parameters.clone(),
            columns: match columns.is_empty() {
                true => Channels::zeros(0, torque.len()),
                false => Channels::from_vectors(&columns),
            },
            valid: self.valid[rows.clone()].iter().copied().step_by(step).collect(),
            torque,
        }
    }

    /// Number of valid rows.
    pub fn rows(&self) -> usize {
        self.valid.iter().filter(|&&ok| ok).count()
    }

    /// Torque that `beta` predicts, for every row.
    pub fn predict(&self, beta: &[f64]) -> Vec<f64> {
        let weights: Vec<f64> = self.parameters.iter().map(|&parameter| beta[parameter]).collect();
        combined(&self.columns, &weights)
    }

    /// Torque minus prediction, for every row.
    pub fn residual(&self, beta: &[f64]) -> Vec<f64> {
        self.torque.iter().zip(self.predict(beta)).map(|(measured, model)| measured - model).collect()
    }

    /// The regression of a joint without an equation: `rows` rows none of which counts.
    pub(crate) fn without_equation(joint: String, rows: usize) -> Self {
        JointRegression {
            joint,
            parameters: Vec::new(),
            columns: Channels::zeros(0, rows),
            torque: vec![0.0; rows],
            valid: vec![false; rows],
        }
    }

    /// Root mean square of the residual over the valid rows; not a number where none does.
    pub fn residual_rms(&self, beta: &[f64]) -> f64 {
        let residual = self.residual(beta);
        let sum: f64 = residual.iter().zip(&self.valid).filter(|(_, ok)| **ok).map(|(r, _)| r * r).sum();
        (sum / self.rows() as f64).sqrt()
    }

    /// Inner product of two signals over the valid rows.
    pub(in crate::identification) fn dot(&self, a: &[f64], b: &[f64]) -> f64 {
        a.iter().zip(b).zip(&self.valid).map(|((x, y), &ok)| if ok { x * y } else { 0.0 }).sum()
    }

    /// X'X over the valid rows.
    pub(super) fn gram(&self) -> DMatrix<f64> {
        let mut gram = Gram::new(self.parameters.len());
        gram.add_valid(self.columns.iter(), &self.valid);
        gram.matrix()
    }

    /// The Gram matrix of columns and torque over the valid rows.
    pub(super) fn sums(&self) -> JointSums {
        let mut gram = Gram::new(self.parameters.len() + 1);
        gram.add_valid(self.columns.iter().chain([self.torque.as_slice()]), &self.valid);
        JointSums { parameters: self.parameters.clone(), rows: self.rows(), gram: gram.matrix() }
    }

    /// The triangle of columns and torque over the valid rows.
    pub(super) fn triangle(&self) -> DMatrix<f64> {
        let mut triangle = Triangle::new(self.parameters.len() + 1);
        let mut block = vec![0.0; (self.parameters.len() + 1) * BLOCK];
        for (number, valid) in self.valid.chunks(BLOCK).enumerate() {
            let block = &mut block[..(self.parameters.len() + 1) * valid.len()];
            let table = self.columns.iter().chain([self.torque.as_slice()]);
            valid_block(table, number * BLOCK, valid, block);
            triangle.add(block, valid.len());
        }
        triangle.factor()
    }

    /// X'y over the valid rows, for one value y per row.
    pub(super) fn products(&self, signal: &[f64]) -> Vec<f64> {
        if self.parameters.is_empty() {
            return Vec::new();
        }
        let fast = products(&self.columns, &self.masked(signal));
        // Rows that do not count may hold what is not a number.
        let sum = |(value, column): (f64, &[f64])| if value.is_finite() { value } else { self.dot(column, signal) };
        fast.into_iter().zip(self.columns.iter()).map(sum).collect()
    }

    /// Adds `weight` times X'X over the valid rows to `sum`, at the places of this joint's parameters.
    pub(in crate::identification) fn add_gram(&self, weight: f64, sum: &mut DMatrix<f64>) {
        self.scatter(weight, &self.gram(), sum);
    }

    /// Adds `weight` times the Gram matrix of `table`, `[active parameter][row]`, to `sum`.
    pub(in crate::identification) fn scatter_gram(&self, weight: f64, table: &Channels, sum: &mut DMatrix<f64>) {
        let mut gram = Gram::new(self.parameters.len());
        gram.add(table.as_slice(), table.samples());
        self.scatter(weight, &gram.matrix(), sum);
    }

    /// Adds `weight` times a matrix over this joint's columns to `sum`, at the places of the parameters.
    pub(super) fn scatter(&self, weight: f64, gram: &DMatrix<f64>, sum: &mut DMatrix<f64>) {
        for (r, &row) in self.parameters.iter().enumerate() {
            for (c, &column) in self.parameters.iter().enumerate() {
                sum[(row, column)] += weight * gram[(r, c)];
            }
        }
    }

    /// The columns, zero where rows do not count.
    pub(in crate::identification) fn masked_columns(&self) -> Channels {
        let mut columns = self.columns.clone();
        for column in 0..columns.channels() {
            columns.channel_mut(column).iter_mut().zip(&self.valid).filter(|(_, ok)| !**ok).for_each(|(x, _)| *x = 0.0);
        }
        columns
    }

    pub(in crate::identification) fn masked(&self, signal: &[f64]) -> Vec<f64> {
        signal.iter().zip(&self.valid).map(|(&value, &ok)| if ok { value } else { 0.0 }).collect()
    }
}
