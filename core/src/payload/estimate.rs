//! The load's parameters from equations, what else changed, and how exact both are.

use super::equations::{CHANGES, Equations, Layout};
use super::sums::{Key, Sums, inverse, jackknife, of_blocks, of_joints, selection, total, weights};
use crate::robot::PARAMETERS;
use nalgebra::{DMatrix, DVector};
use std::collections::BTreeMap;

/// Standard errors by which a change at a joint must differ from zero to be believed. Standard errors between some tens of blocks
/// are too small by a tenth or two, and there are three changes a joint: 4 keeps false ones below one in a hundred pairs of logs.
pub(super) const SIGNIFICANT: f64 = 4.0;

/// Least size of such a change, as a share of the joint's torque: smaller ones move the load by less than its drive's torque
/// constant does.
pub(super) const MATTERS: f64 = 0.02;

/// Square that a change must take off the residual, over what another torque constant of its joint would take off: where both
/// explain it, the torque constant is the simpler reason, and the share that the joint shows of the load has it.
const OVER_GAIN: f64 = 2.0;

/// Fewest coarse clusters that standard errors come from.
const FEWEST_COARSE: usize = 8;

/// Share of its square that must be left of a direction over all other columns to be determined at all; below it is rounding.
const INDEPENDENT: f64 = 1e-8;

/// Share of a parameter that must lie in directions that are determined.
const WHOLE: f64 = 1.0 - 1e-4;

/// A fit of the load and of what else changed.
#[derive(Debug, Clone)]
pub(super) struct Estimate {
    /// The load's parameters, in the units of [`super::load_columns::SCALE`].
    pub load: DVector<f64>,
    /// Their covariance.
    pub covariance: DMatrix<f64>,
    /// What it would be if all rows erred independently: the metric of the fit.
    pub plain: DMatrix<f64>,
    /// Which of them any torque depends on.
    pub visible: [bool; PARAMETERS],
    /// What changed besides: joint, kind, change, standard error.
    pub changes: Vec<(usize, usize, f64, f64)>,
    /// All parameters in the order of the layout.
    pub beta: DVector<f64>,
    /// Blocks that the standard errors are between.
    pub blocks: usize,
}

/// Fits of one load.
#[derive(Debug, Clone)]
pub(super) struct Estimates {
    /// The load alone.
    pub plain: Estimate,
    /// The load with what else changed beyond doubt; the same where nothing did.
    pub changed: Estimate,
    /// The load with a free offset at every joint.
    pub free_offsets: Estimate,
}

/// Equations in sums, ready to be fitted.
pub(super) struct Fitting<'a> {
    equations: &'a Equations,
    layout: Layout,
    blocks: BTreeMap<Key, Sums>,
    /// Sums of each joint, and the same under its weight.
    joints: Vec<Sums>,
    by_joint: Vec<Sums>,
    all: Sums,
    /// One over the variance of the residual of each joint.
    weights: Vec<f64>,
    /// Root mean square of each joint's torque, N m.
    torque: Vec<f64>,
}

impl<'a> Fitting<'a> {
    /// `torque` is the root mean square of each joint's torque.
    pub(super) fn new(equations: &'a Equations, torque: &[f64]) -> Self {
        let layout = equations.layout;
        let joints = of_joints(&equations.joints, layout.size());
        let weights = weights(&joints, &(0..layout.arm + PARAMETERS).collect::<Vec<_>>());
        let mut fitting = Fitting {
            equations,
            layout,
            blocks: BTreeMap::new(),
            joints,
            by_joint: Vec::new(),
            all: total([], layout.size()),
            weights: Vec::new(),
            torque: torque.to_vec(),
        };
        fitting.weigh(weights);
        fitting
    }

    fn weigh(&mut self, weights: Vec<f64>) {
        self.by_joint = self.joints.iter().zip(&weights).map(|(sums, &weight)| sums.times(weight)).collect();
        self.blocks = of_blocks(&self.equations.joints, &weights, self.layout.size());
        self.all = total(self.blocks.values(), self.layout.size());
        self.weights = weights;
    }

    /// The load alone, with what else changed beyond doubt, and with a free offset at every joint.
    pub(super) fn run(mut self) -> Estimates {
        let plain = self.fit(&[]);
        let offsets: Vec<usize> = (0..self.layout.dof)
            .filter(|&joint| !self.equations.joints[joint].y.is_empty())
            .map(|joint| self.layout.change(joint, 0))
            .collect();
        let free_offsets = self.fit(&offsets);
        let mut chosen: Vec<usize> = Vec::new();
        while let Some(next) = self.next(&chosen) {
            chosen.push(next);
        }
        if chosen.is_empty() {
            return Estimates { changed: plain.clone(), plain, free_offsets };
        }
        let free: Vec<usize> = (0..self.layout.arm + PARAMETERS).chain(chosen.iter().copied()).collect();
        self.weigh(weights(&self.joints, &free));
        Estimates { plain, changed: self.fit(&chosen), free_offsets }
    }

    /// The change that is most significant with those already `chosen` in the model.
    fn next(&self, chosen: &[usize]) -> Option<usize> {
        let map = self.map(chosen);
        let normal = self.all.mapped(&map);
        let inverse = inverse(&normal.gram);
        let beta = &map * (&inverse * &normal.rhs);
        let mut clusters: BTreeMap<usize, DVector<f64>> = BTreeMap::new();
        for (key, block) in &self.blocks {
            let slope = &block.rhs - &block.gram * &beta;
            *clusters.entry(key.cluster).or_insert_with(|| DVector::zeros(slope.len())) += slope;
        }
        let count = clusters.len() as f64;
        // What another torque constant of each joint would take off: its column is the load's torque.
        let mut load = DVector::zeros(beta.len());
        load.rows_mut(self.layout.arm, PARAMETERS).copy_from(&beta.rows(self.layout.arm, PARAMETERS));
        let by_gain: Vec<f64> = self
            .by_joint
            .iter()
            .map(|sums| {
                let (own, slope) = (&sums.gram * &load, load.dot(&(&sums.rhs - &sums.gram * &beta)));
                let across = map.transpose() * &own;
                let left = load.dot(&own) - across.dot(&(&inverse * &across));
                if left > INDEPENDENT * load.dot(&own) { slope * slope / left } else { 0.0 }
            })
            .collect();
        let strength = |place: usize| -> Option<f64> {
            let own = self.all.gram[(place, place)];
            let across = map.transpose() * self.all.gram.column(place);
            let along = &inverse * &across;
            let left = own - across.dot(&along);
            if own == 0.0 || left < INDEPENDENT * own {
                return None;
            }
            let scores: Vec<f64> =
                clusters.values().map(|slope| slope[place] - (map.transpose() * slope).dot(&along)).collect();
            let (sum, squares) = scores.iter().fold((0.0, 0.0), |(sum, squares), s| (sum + s, squares + s * s));
            let error = (squares * count / (count - 1.0).max(1.0)).sqrt();
            let joint = (place - self.layout.arm - PARAMETERS) / CHANGES.len();
            let rows = self.equations.joints[joint].y.len().max(1) as f64;
            // Its root mean square over the rows of the joint.
            let size = (sum / left).abs() * (own / self.weights[joint] / rows).sqrt();
            let strength = sum.abs() / error.max(f64::MIN_POSITIVE);
            let is_no_gain = sum * sum / left > OVER_GAIN * by_gain[joint];
            (strength > SIGNIFICANT && size > MATTERS * self.torque[joint] && is_no_gain).then_some(strength)
        };
        let places = (self.layout.arm + PARAMETERS..self.layout.size()).filter(|place| !chosen.contains(place));
        let found = places.filter_map(|place| Some((place, strength(place)?)));
        found.max_by(|a, b| a.1.total_cmp(&b.1)).map(|(place, _)| place)
    }

    /// From free parameters to all: those of the arm, the directions of the load that the rows determine, changes `chosen`.
    fn map(&self, chosen: &[usize]) -> DMatrix<f64> {
        let (arm, size) = (self.layout.arm, self.layout.size());
        let others: Vec<usize> = (0..arm).chain(chosen.iter().copied()).collect();
        let load = DMatrix::from_fn(PARAMETERS, PARAMETERS, |i, j| self.all.gram[(arm + i, arm + j)]);
        let mut left = load.clone();
        if !others.is_empty() {
            let pick = selection(size, &others);
            let across = DMatrix::from_fn(size, PARAMETERS, |i, j| self.all.gram[(i, arm + j)]);
            let across = pick.transpose() * across;
            let own = pick.transpose() * &self.all.gram * &pick;
            left -= across.transpose() * inverse(&own) * across;
        }
        let eigen = left.symmetric_eigen();
        let least = INDEPENDENT * load.diagonal().max();
        let seen: Vec<usize> = (0..PARAMETERS).filter(|&k| eigen.eigenvalues[k] > least).collect();
        let mut map = DMatrix::zeros(size, arm + seen.len() + chosen.len());
        (0..arm).for_each(|k| map[(k, k)] = 1.0);
        for (place, &k) in seen.iter().enumerate() {
            (0..PARAMETERS).for_each(|i| map[(arm + i, arm + place)] = eigen.eigenvectors[(i, k)]);
        }
        for (place, &k) in chosen.iter().enumerate() {
            map[(k, arm + seen.len() + place)] = 1.0;
        }
        map
    }

    fn fit(&self, chosen: &[usize]) -> Estimate {
        let (arm, size) = (self.layout.arm, self.layout.size());
        let map = self.map(chosen);
        let normal = self.all.mapped(&map);
        // Under these weights the variance of every row is one.
        let plain = inverse(&normal.gram);
        let beta = &map * (&plain * &normal.rhs);
        let plain = &map * plain * map.transpose();
        let between = |cluster: fn(&Key) -> Option<usize>| {
            jackknife(&self.blocks, &map, cluster)
                .map(|(covariance, count)| (&map * covariance * map.transpose(), count))
        };
        let by_block = between(|key| Some(key.cluster));
        let blocks = by_block.as_ref().map_or(1, |(_, count)| *count);
        let coarse = between(|key| Some(key.coarse)).filter(|(_, count)| *count >= FEWEST_COARSE);
        let by_log = [between(|key| key.before), between(|key| key.after)];
        let mut covariance = by_block.map_or_else(|| plain.clone(), |(covariance, _)| covariance);
        let logs =
            by_log.into_iter().flatten().fold(DMatrix::zeros(size, size), |sum, (covariance, _)| sum + covariance);
        // Never below the noise, nor below the spread between longer blocks and between logs.
        for k in 0..size {
            let own = covariance[(k, k)];
            let longer = coarse.as_ref().map_or(0.0, |(covariance, _)| covariance[(k, k)]);
            let least = plain[(k, k)].max(logs[(k, k)]).max(longer);
            if own < least {
                let factor = (least / own.max(f64::MIN_POSITIVE)).sqrt().min(1e150);
                covariance.row_mut(k).scale_mut(factor);
                covariance.column_mut(k).scale_mut(factor);
            }
        }
        let own = |matrix: &DMatrix<f64>| matrix.view((arm, arm), (PARAMETERS, PARAMETERS)).clone_owned();
        let load_covariance = own(&covariance);
        let visible = std::array::from_fn(|k| map.view((arm + k, arm), (1, map.ncols() - arm)).norm_squared() > WHOLE);
        let changes = chosen
            .iter()
            .map(|&place| {
                let change = place - arm - PARAMETERS;
                (change / CHANGES.len(), change % CHANGES.len(), beta[place], covariance[(place, place)].sqrt())
            })
            .collect();
        Estimate {
            load: beta.rows(arm, PARAMETERS).clone_owned(),
            plain: own(&plain),
            covariance: load_covariance,
            visible,
            changes,
            beta,
            blocks,
        }
    }
}
