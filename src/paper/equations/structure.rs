//! What of the 78 parameters the torques can show at all.
//!
//! Parameters that only ever occur in one and the same sum have equal columns in the regressor: no motion separates them
//! apart, and a fit that reports a value for each has chosen it arbitrarily.

use super::{JOINTS, PARAMETER_COUNT, Variant, regressor};
use crate::error::{Error, Result};
use crate::random;
use nalgebra::DMatrix;
use rand::RngExt;
use std::f64::consts::PI;

/// Angles, velocities and accelerations of all joints at one instant, in rad, rad/s and rad/s^2.
pub(crate) type State = [[f64; JOINTS]; 3];

/// Columns count as proportional, and singular values as zero, below this relative difference.
const TOLERANCE: f64 = 1e-10;

/// What a set of states determines.
#[derive(Debug, Clone)]
pub(crate) struct RankStructure {
    /// Number of independent combinations of X that the torques show.
    pub rank: usize,
    /// Dimension of the space of changes of X that no torque shows: 78 less the rank.
    pub null_dimension: usize,
    /// Parameters with proportional columns, by number k of X_k, smallest first. Parameters that no state excites are
    /// in no group.
    pub groups: Vec<Vec<usize>>,
}

/// Rank of the regressor over `states` (singular values above 1e-10 of the largest, columns scaled) and the groups of
/// parameters with proportional columns.
///
/// # Errors
/// Fewer than 13 states, which give fewer torques than there are parameters; values that are not finite.
pub(crate) fn rank_structure(variant: Variant, states: &[State]) -> Result<RankStructure> {
    let rows = JOINTS * states.len();
    if rows < PARAMETER_COUNT {
        let problem = format!("{} states give {rows} torques for {PARAMETER_COUNT} parameters; give 13", states.len());
        return Err(Error::request("rank of the 78-parameter model", problem));
    }
    if let Some(i) = states.iter().position(|state| state.as_flattened().iter().any(|v| !v.is_finite())) {
        return Err(Error::request("rank of the 78-parameter model", format!("state {i} is not finite; leave it out")));
    }
    let y = scaled_regressor(variant, states);
    let cosines = y.tr_mul(&y);
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for k in (0..PARAMETER_COUNT).filter(|&k| cosines[(k, k)] > 0.0) {
        match groups.iter_mut().find(|group| cosines[(group[0] - 1, k)].abs() > 1.0 - TOLERANCE) {
            Some(group) => group.push(k + 1),
            None => groups.push(vec![k + 1]),
        }
    }
    let singular_values = y.singular_values();
    let rank = singular_values.iter().filter(|&&s| s > TOLERANCE * singular_values.max()).count();
    Ok(RankStructure { rank, null_dimension: PARAMETER_COUNT - rank, groups })
}

/// The regressors of all states on top of each other, with columns of length 1 where they are not zero.
pub(super) fn scaled_regressor(variant: Variant, states: &[State]) -> DMatrix<f64> {
    let mut y = DMatrix::zeros(JOINTS * states.len(), PARAMETER_COUNT);
    for (s, [theta, dtheta, ddtheta]) in states.iter().enumerate() {
        for (i, row) in regressor(variant, theta, dtheta, ddtheta).iter().enumerate() {
            for (k, &value) in row.iter().enumerate() {
                y[(JOINTS * s + i, k)] = value;
            }
        }
    }
    for mut column in y.column_iter_mut() {
        let norm = column.norm();
        if norm > 0.0 {
            column /= norm;
        }
    }
    y
}

/// `count` random states: angles in a full turn, velocities within 3 rad/s, accelerations within 10 rad/s^2.
pub(crate) fn random_states(seed: u64, count: usize) -> Vec<State> {
    (0..count)
        .map(|index| {
            let mut random = random::stream(seed, "states of the 78-parameter model", index as u64);
            [PI, 3.0, 10.0].map(|limit| std::array::from_fn(|_| random.random_range(-limit..limit)))
        })
        .collect()
}
