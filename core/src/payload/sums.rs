//! Sums of squares and products of weighted rows, block by block: fits, standard errors between blocks and between logs.

use nalgebra::{DMatrix, DVector};
use std::collections::BTreeMap;

/// Share of a column's square that is added to it before a normal matrix is inverted: what no row determines stays finite.
const RIDGE: f64 = 1e-11;

/// What rows of a block belong to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Key {
    /// Rows of one cluster may err together.
    pub cluster: usize,
    /// The same of longer clusters.
    pub coarse: usize,
    /// The log before the change that the row is of.
    pub before: Option<usize>,
    /// The log after it.
    pub after: Option<usize>,
}

/// Most blocks of a log, for numbers of blocks of all logs.
const MOST: usize = 1 << 32;

/// Blocks of a coarse cluster.
const COARSE: usize = 4;

impl Key {
    /// The key of block `block` of log `log`, numbers of their own for each.
    pub(super) fn new((log, block): (usize, usize), before: Option<usize>, after: Option<usize>) -> Self {
        Key { cluster: log * MOST + block, coarse: log * MOST + block / COARSE, before, after }
    }
}

/// Rows of one joint: `y` is the sum of the columns, each times its parameter.
#[derive(Debug)]
pub(super) struct JointRows {
    /// Parameters of the columns.
    pub parameters: Vec<usize>,
    /// `[column][row]`.
    pub columns: Vec<Vec<f64>>,
    /// Torque, or its difference.
    pub y: Vec<f64>,
    /// What each row belongs to.
    pub keys: Vec<Key>,
}

/// Normal equations.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Sums {
    /// Columns by columns.
    pub gram: DMatrix<f64>,
    /// Columns by torque.
    pub rhs: DVector<f64>,
    /// Torque by torque.
    pub square: f64,
    /// Rows.
    pub rows: usize,
}

impl Sums {
    fn zeros(size: usize) -> Self {
        Sums { gram: DMatrix::zeros(size, size), rhs: DVector::zeros(size), square: 0.0, rows: 0 }
    }

    fn add(&mut self, other: &Sums, weight: f64) {
        self.gram += &other.gram * weight;
        self.rhs += &other.rhs * weight;
        self.square += weight * other.square;
        self.rows += other.rows;
    }

    /// The same under a weight.
    pub(super) fn times(&self, weight: f64) -> Sums {
        let mut sums = Sums::zeros(self.rhs.len());
        sums.add(self, weight);
        sums
    }

    /// The same in other parameters, of which `map` makes these.
    pub(super) fn mapped(&self, map: &DMatrix<f64>) -> Sums {
        let gram = map.transpose() * &self.gram * map;
        Sums { gram, rhs: map.transpose() * &self.rhs, ..*self }
    }

    /// Weighted mean square of the residual under parameters.
    pub(super) fn mean_square(&self, beta: &DVector<f64>) -> f64 {
        let sum = self.square - 2.0 * self.rhs.dot(beta) + (&self.gram * beta).dot(beta);
        (sum / self.rows.max(1) as f64).max(0.0)
    }
}

/// Inverse of a normal matrix; what it does not determine gets a large but finite variance.
pub(super) fn inverse(gram: &DMatrix<f64>) -> DMatrix<f64> {
    let size = gram.diagonal().map(|square| if square > 0.0 { square.sqrt() } else { 1.0 });
    let unit = DMatrix::from_fn(gram.nrows(), gram.ncols(), |i, j| {
        gram[(i, j)] / (size[i] * size[j]) + if i == j { RIDGE } else { 0.0 }
    });
    let unit = match unit.clone().cholesky() {
        Some(factor) => factor.inverse(),
        // Rounding made it indefinite: what is lost is below the ridge.
        None => unit.pseudo_inverse(RIDGE).unwrap_or_else(|_| DMatrix::zeros(gram.nrows(), gram.ncols())),
    };
    DMatrix::from_fn(gram.nrows(), gram.ncols(), |i, j| unit[(i, j)] / (size[i] * size[j]))
}

/// Sums of the rows of every joint.
pub(super) fn of_joints(joints: &[JointRows], size: usize) -> Vec<Sums> {
    joints.iter().map(|joint| sums_of(joint, 0..joint.y.len(), size)).collect()
}

/// Sums of all joints, each under its weight, by what the rows belong to.
pub(super) fn of_blocks(joints: &[JointRows], weights: &[f64], size: usize) -> BTreeMap<Key, Sums> {
    let mut blocks = BTreeMap::new();
    for (joint, &weight) in joints.iter().zip(weights) {
        let mut start = 0;
        while start < joint.keys.len() {
            let key = joint.keys[start];
            let end = start + joint.keys[start..].iter().take_while(|other| **other == key).count();
            let sums = sums_of(joint, start..end, size);
            blocks.entry(key).or_insert_with(|| Sums::zeros(size)).add(&sums, weight);
            start = end;
        }
    }
    blocks
}

/// The sum of all.
pub(super) fn total<'a>(blocks: impl IntoIterator<Item = &'a Sums>, size: usize) -> Sums {
    blocks.into_iter().fold(Sums::zeros(size), |mut sum, block| {
        sum.add(block, 1.0);
        sum
    })
}

/// Joint rows under weights that make the residual of every joint one, by reweighting.
pub(super) fn weights(of_joints: &[Sums], free: &[usize]) -> Vec<f64> {
    /// The weights have settled after few rounds.
    const ROUNDS: usize = 4;
    let size = of_joints.first().map_or(0, |sums| sums.rhs.len());
    let map = selection(size, free);
    let joints: Vec<Sums> = of_joints.iter().map(|sums| sums.mapped(&map)).collect();
    let inverse_of = |square: f64| if square > 0.0 { 1.0 / square } else { 0.0 };
    let mut weights: Vec<f64> = joints.iter().map(|sums| inverse_of(sums.square / sums.rows.max(1) as f64)).collect();
    for _ in 0..ROUNDS {
        let mut all = Sums::zeros(free.len());
        joints.iter().zip(&weights).for_each(|(sums, &weight)| all.add(sums, weight));
        let beta = inverse(&all.gram) * &all.rhs;
        for (weight, sums) in weights.iter_mut().zip(&joints) {
            // A joint that fits to rounding must not outweigh the others beyond measure.
            let floor = 1e-12 * sums.square / sums.rows.max(1) as f64;
            *weight = inverse_of(sums.mean_square(&beta).max(floor));
        }
    }
    weights
}

/// The map from some parameters to all: the others are zero.
pub(super) fn selection(size: usize, free: &[usize]) -> DMatrix<f64> {
    let mut map = DMatrix::zeros(size, free.len());
    free.iter().enumerate().for_each(|(place, &k)| map[(k, place)] = 1.0);
    map
}

fn sums_of(joint: &JointRows, rows: std::ops::Range<usize>, size: usize) -> Sums {
    let own = joint.parameters.len();
    let table = DMatrix::from_fn(rows.len(), own, |row, k| joint.columns[k][rows.start + row]);
    let y = DVector::from_column_slice(&joint.y[rows.clone()]);
    let (gram, rhs) = (table.tr_mul(&table), table.tr_mul(&y));
    let mut sums = Sums { square: y.norm_squared(), rows: rows.len(), ..Sums::zeros(size) };
    for (i, &a) in joint.parameters.iter().enumerate() {
        sums.rhs[a] += rhs[i];
        for (j, &b) in joint.parameters.iter().enumerate() {
            sums.gram[(a, b)] += gram[(i, j)];
        }
    }
    sums
}

/// Covariance of `beta` by leaving out one cluster at a time (Efron's jackknife), where `cluster` says which one a block is of;
/// nothing where there are fewer than two.
pub(super) fn jackknife(
    blocks: &BTreeMap<Key, Sums>,
    map: &DMatrix<f64>,
    cluster: impl Fn(&Key) -> Option<usize>,
) -> Option<(DMatrix<f64>, usize)> {
    let mut clusters: BTreeMap<usize, Sums> = BTreeMap::new();
    let size = map.ncols();
    for (key, block) in blocks {
        if let Some(cluster) = cluster(key) {
            clusters.entry(cluster).or_insert_with(|| Sums::zeros(size)).add(&block.mapped(map), 1.0);
        }
    }
    let count = clusters.len();
    if count < 2 {
        return None;
    }
    let all = total(blocks.values(), map.nrows()).mapped(map);
    let without: Vec<DVector<f64>> =
        clusters.values().map(|block| inverse(&(&all.gram - &block.gram)) * (&all.rhs - &block.rhs)).collect();
    let mean = without.iter().fold(DVector::zeros(size), |sum, beta| sum + beta) / count as f64;
    let spread = without.iter().fold(DMatrix::zeros(size, size), |sum, beta| {
        let off = beta - &mean;
        sum + &off * off.transpose()
    });
    Some((spread * ((count - 1) as f64 / count as f64), count))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key(cluster: usize) -> Key {
        Key::new((0, cluster), None, Some(0))
    }

    #[test]
    fn the_jackknife_of_a_mean_is_its_standard_error() {
        // 1, 2, 3 and 6 have the mean 3 and the variance 14 / 3: that of the mean is 14 / 12.
        let y = vec![1.0, 2.0, 3.0, 6.0];
        let keys = (0..4).map(key).collect();
        let joint = JointRows { parameters: vec![0], columns: vec![vec![1.0; 4]], y, keys };
        let blocks = of_blocks(&[joint], &[1.0], 1);
        let (variance, count) = jackknife(&blocks, &DMatrix::identity(1, 1), |key| Some(key.cluster)).unwrap();
        assert_eq!(count, 4);
        assert!((variance[(0, 0)] - 14.0 / 12.0).abs() < 1e-9, "{variance}");
        assert!(jackknife(&blocks, &DMatrix::identity(1, 1), |key| key.after).is_none(), "one log has no spread");
    }

    #[test]
    fn weights_are_one_over_the_variance_of_each_joint() {
        let joint = |size: f64| JointRows {
            parameters: vec![0],
            columns: vec![vec![1.0; 4]],
            y: vec![5.0 + size, 5.0 - size, 5.0 + size, 5.0 - size],
            keys: vec![key(0); 4],
        };
        let found = weights(&of_joints(&[joint(0.1), joint(2.0)], 1), &[0]);
        assert!((found[0] - 100.0).abs() < 1e-6 && (found[1] - 0.25).abs() < 1e-6, "{found:?}");
    }

    #[test]
    fn an_inverse_leaves_what_is_not_determined_finite() {
        let gram = DMatrix::from_row_slice(2, 2, &[4.0, 0.0, 0.0, 0.0]);
        let found = inverse(&gram);
        assert!((found[(0, 0)] - 0.25).abs() < 1e-9 && found[(1, 1)].is_finite());
    }
}
