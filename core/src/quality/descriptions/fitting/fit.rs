//! The fit of one description: weighted least squares with friction that takes power, judged on blocks of time held out.

use super::super::change::Description;
use super::physics::{Bounds, FRICTION_COLUMNS, JointTable, Tables};
use super::rows::Rows;
use crate::linear::Cholesky;
use nalgebra::{DMatrix, DVector};
use std::ops::Range;

/// Interleaved parts of the blocks, each of which is predicted from the others.
const FOLDS: usize = 6;

/// Residuals below this share of a torque's root mean square count as this share: no drive's torque is known better, and a
/// log without noise would otherwise weigh without bound.
const FLOOR: f64 = 0.02;

/// Added to the diagonal of the normal matrix, whose columns have unit length: what the motion does not excite stays small.
const RIDGE: f64 = 1e-6;

/// Weight of a bound of a sum over the data: the sum exceeds it by a hundredth of what it would come to.
const BOUND: f64 = 100.0;

/// A joint takes part where it has this many rows per column.
const ROWS_PER_COLUMN: usize = 2;

/// Fewer rows do not judge a block.
const ROWS_PER_BLOCK: usize = 4;

/// Passes in which the weight of each joint follows its residual.
const PASSES: usize = 2;

/// Residuals of the torques under a description.
pub(crate) struct Evaluation {
    /// Logarithm of the held-out mean square, floor included, `[torque channel][block]`; none where a block has no rows.
    pub held_out: Vec<Vec<Option<f64>>>,
    /// Held-out residual over the torque, root mean square, of every torque channel that takes part.
    pub unexplained: Vec<Option<f64>>,
}

/// Friction in a torque.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Friction {
    /// The joint.
    pub joint: usize,
    /// Its mean in the direction of motion, over the root mean square torque.
    pub share: f64,
    /// Standard error of that.
    pub error: f64,
}

/// Normal equations of a joint under a description.
struct Equations<'a> {
    table: &'a JointTable,
    joint: usize,
    channel: usize,
    /// Columns times the torque to explain, of each block.
    right: Vec<DVector<f64>>,
    /// Sum of squares of the torque to explain, of each block.
    squares: Vec<f64>,
    /// Log of each block.
    log: &'a [usize],
    rows: f64,
    floor: f64,
    /// Square of the factor from the logged torque to the one explained.
    factor: f64,
}

/// A description's equations, ready to be solved.
pub(crate) struct Fit<'a> {
    joints: Vec<Equations<'a>>,
    bounds: &'a Bounds,
    /// Blocks of each log.
    logs: Vec<Range<usize>>,
    blocks: usize,
    channels: usize,
}

impl<'a> Fit<'a> {
    /// Sets up the equations; joints whose torque is not measured, or which hardly move, have none.
    pub(crate) fn new(tables: &'a Tables, rows: &'a Rows, description: &Description) -> Fit<'a> {
        let joints = tables.joints.iter().enumerate().filter_map(|(joint, table)| {
            let channel = description.torque_of[joint];
            let count: usize = table.rows.iter().sum();
            if !rows.measured[channel] || count < ROWS_PER_COLUMN * table.width() {
                return None;
            }
            let sign = description.torque_sign[joint] * description.torque_scale[joint];
            let right = table.with_torque[channel].iter().zip(&table.with_known).map(|(own, known)| sign * own - known);
            let squares = (0..rows.log.len()).map(|block| {
                let torque = sign * sign * table.squares[channel][block];
                torque - 2.0 * sign * table.known_torque[channel][block] + table.known_squares[block]
            });
            Some(Equations {
                table,
                joint,
                channel,
                right: right.collect(),
                squares: squares.collect(),
                log: &rows.log,
                rows: count as f64,
                floor: (FLOOR * rows.size[channel] * sign).powi(2),
                factor: sign * sign,
            })
        });
        let ends = |log: usize| rows.log.partition_point(|own| *own < log);
        Fit {
            joints: joints.collect(),
            bounds: &tables.bounds,
            logs: (0..rows.logs()).map(|log| ends(log)..ends(log + 1)).collect(),
            blocks: rows.log.len(),
            channels: rows.tau.channels(),
        }
    }

    /// Sum over the joints of the logarithm of the mean squared residual of a fit of all rows: a quick order of merit.
    pub(crate) fn merit(&self) -> Option<f64> {
        let (_, residuals) = self.weighted()?;
        let each = self.joints.iter().zip(residuals);
        Some(each.map(|(joint, left)| ((left + joint.floor) / joint.factor).ln()).sum())
    }

    /// The description judged on held-out blocks; none where nothing can be fitted.
    pub(crate) fn evaluate(&self) -> Option<Evaluation> {
        let (weights, _) = self.weighted()?;
        let folds = FOLDS.min(self.blocks);
        let mut out = Evaluation {
            held_out: vec![vec![None; self.blocks]; self.channels],
            unexplained: vec![None; self.channels],
        };
        let mut sums = vec![[0.0; 2]; self.channels];
        for fold in 0..folds {
            let solution = self.solve(&weights, self.bounds, &|block| block % folds != fold)?;
            for block in (fold..self.blocks).step_by(folds) {
                for joint in self.joints.iter().filter(|joint| joint.table.rows[block] >= ROWS_PER_BLOCK) {
                    let rows = joint.table.rows[block] as f64;
                    let left = joint.left(block, &solution);
                    out.held_out[joint.channel][block] = Some(((left / rows + joint.floor) / joint.factor).ln());
                    sums[joint.channel][0] += left / joint.factor;
                    sums[joint.channel][1] += joint.table.squares[joint.channel][block];
                }
            }
        }
        for (share, [left, all]) in out.unexplained.iter_mut().zip(sums) {
            *share = (all > 0.0).then(|| (left / all).sqrt());
        }
        Some(out)
    }

    /// Share of every torque that takes part, root mean square, that a fit of all rows leaves.
    pub(crate) fn residuals(&self) -> Option<Vec<f64>> {
        let (weights, _) = self.weighted()?;
        let solution = self.solve(&weights, self.bounds, &|_| true)?;
        let of = |joint: &Equations| {
            let left: f64 = (0..self.blocks).map(|block| joint.left(block, &solution)).sum();
            (left / joint.squares.iter().sum::<f64>().max(f64::MIN_POSITIVE)).sqrt()
        };
        Some(self.joints.iter().map(of).collect())
    }

    /// Friction of every torque that takes part, with its standard error by leaving out each block in turn (jackknife): residuals
    /// within a block are dependent. Its sign is free here: an estimate that is held at zero has no error.
    pub(crate) fn friction(&self) -> Option<Vec<Friction>> {
        let (weights, _) = self.weighted()?;
        let mut nonnegative = self.bounds.nonnegative.clone();
        for joint in &self.joints {
            let all = joint.table.width();
            for parameters in &joint.table.parameters {
                parameters[all - FRICTION_COLUMNS..].iter().flatten().for_each(|&place| nonnegative[place] = false);
            }
        }
        let free = Bounds { nonnegative, limits: Vec::new() };
        let of = |wanted: &dyn Fn(usize) -> bool| -> Option<Vec<f64>> {
            let solution = self.solve(&weights, &free, wanted)?;
            Some(self.joints.iter().map(|joint| joint.friction(&solution)).collect())
        };
        let whole = of(&|_| true)?;
        let left_out: Vec<Vec<f64>> = (0..self.blocks).map(|held| of(&|block| block != held)).collect::<Option<_>>()?;
        let friction = |place: usize| Friction {
            joint: self.joints[place].joint,
            share: whole[place],
            error: jackknife(&left_out, place),
        };
        Some((0..whole.len()).map(friction).collect())
    }

    /// Parameters at these places, each with its standard error by leaving out each block in turn.
    pub(crate) fn with_errors(&self, places: &[usize]) -> Option<Vec<(f64, f64)>> {
        let (weights, _) = self.weighted()?;
        let whole = self.solve(&weights, self.bounds, &|_| true)?;
        let left_out =
            |held: usize| Some(self.solve(&weights, self.bounds, &|block| block != held)?.as_slice().to_vec());
        let left_out: Vec<Vec<f64>> = (0..self.blocks).map(left_out).collect::<Option<_>>()?;
        Some(places.iter().map(|&place| (whole[place], jackknife(&left_out, place))).collect())
    }

    /// All parameters in a fit of all rows, in the order of the tables.
    pub(crate) fn parameters(&self) -> Option<Vec<f64>> {
        let (weights, _) = self.weighted()?;
        Some(self.solve(&weights, self.bounds, &|_| true)?.as_slice().to_vec())
    }

    /// Constant torque of the drive of every joint that takes part, with the joint, in a fit of all rows.
    pub(crate) fn constants(&self) -> Option<Vec<(usize, f64)>> {
        let (weights, _) = self.weighted()?;
        let solution = self.solve(&weights, self.bounds, &|_| true)?;
        let of = |joint: &Equations| {
            let column = joint.table.constant_and_friction().map(|own| own.start);
            let place = column.and_then(|column| joint.table.parameters.iter().find_map(|own| own[column]));
            (joint.joint, place.map_or(0.0, |place| solution[place]))
        };
        Some(self.joints.iter().map(of).collect())
    }

    /// Weights of the joints, and the mean squared residual of each with them.
    fn weighted(&self) -> Option<(Vec<f64>, Vec<f64>)> {
        let own: Vec<f64> = self.joints.iter().map(Equations::own_residual).collect::<Option<_>>()?;
        let mut residuals = own.clone();
        let mut weights = Vec::new();
        for _ in 0..PASSES {
            let variance = |(joint, left): (&Equations, &f64)| 1.0 / left.max(joint.floor).max(f64::MIN_POSITIVE);
            weights = self.joints.iter().zip(&residuals).map(variance).collect();
            let solution = self.solve(&weights, self.bounds, &|_| true)?;
            let left = |joint: &Equations| {
                (0..self.blocks).map(|block| joint.left(block, &solution)).sum::<f64>() / joint.rows
            };
            residuals = self.joints.iter().zip(&own).map(|(joint, own)| left(joint).max(*own)).collect();
        }
        Some((weights, residuals))
    }

    /// Parameters that fit the wanted blocks best.
    fn solve(&self, weights: &[f64], bounds: &Bounds, wanted: &dyn Fn(usize) -> bool) -> Option<DVector<f64>> {
        let all = self.bounds.nonnegative.len();
        let (mut gram, mut right) = (DMatrix::zeros(all, all), DVector::zeros(all));
        for (joint, weight) in self.joints.iter().zip(weights) {
            // The places of columns differ from log to log alone.
            for log in &self.logs {
                let Some(first) = log.clone().find(|&block| wanted(block)) else { continue };
                let places: Vec<(usize, usize)> = joint.places(first).collect();
                let (mut own, mut own_right) = (joint.table.gram[first].clone(), joint.right[first].clone());
                for block in (first + 1..log.end).filter(|&block| wanted(block)) {
                    own += &joint.table.gram[block];
                    own_right += &joint.right[block];
                }
                for &(j, b) in &places {
                    right[b] += weight * own_right[j];
                    places.iter().for_each(|&(i, a)| gram[(a, b)] += weight * own[(i, j)]);
                }
            }
        }
        constrained(&gram, &right, bounds)
    }
}

/// Standard error of the value at a place, from its values with each block left out.
fn jackknife(left_out: &[Vec<f64>], place: usize) -> f64 {
    let count = left_out.len() as f64;
    let mean = left_out.iter().map(|each| each[place]).sum::<f64>() / count;
    let scatter: f64 = left_out.iter().map(|each| (each[place] - mean).powi(2)).sum();
    (scatter * (count - 1.0) / count).sqrt()
}

impl Equations<'_> {
    /// Columns that play a part in a block, each with its place among all parameters.
    fn places(&self, block: usize) -> impl Iterator<Item = (usize, usize)> {
        let places = self.table.parameters[self.log[block]].iter().enumerate();
        places.filter_map(|(column, place)| place.map(|place| (column, place)))
    }

    /// The parameters of the columns of a block; zero for those that play no part.
    fn own(&self, block: usize, solution: &DVector<f64>) -> DVector<f64> {
        let mut own = DVector::zeros(self.table.width());
        self.places(block).for_each(|(column, place)| own[column] = solution[place]);
        own
    }

    /// Sum of squares that parameters leave in a block.
    fn left(&self, block: usize, solution: &DVector<f64>) -> f64 {
        let gram = &self.table.gram[block];
        let own = self.own(block, solution);
        (self.squares[block] - 2.0 * own.dot(&self.right[block]) + own.dot(&(gram * &own))).max(0.0)
    }

    /// Mean of the friction torque in the direction of motion, over the root mean square torque.
    fn friction(&self, solution: &DVector<f64>) -> f64 {
        let first = self.table.width() - FRICTION_COLUMNS;
        let ones = DVector::from_element(FRICTION_COLUMNS, 1.0);
        let (mut with, mut all) = (0.0, 0.0);
        for (block, gram) in self.table.gram.iter().enumerate() {
            // The columns sum to the direction of motion.
            let directions = gram.view((first, first), (FRICTION_COLUMNS, FRICTION_COLUMNS)) * &ones;
            with += directions.dot(&self.own(block, solution).rows(first, FRICTION_COLUMNS));
            all += directions.sum();
        }
        let torque = (self.squares.iter().sum::<f64>() / self.rows).sqrt();
        with / (all * torque).max(f64::MIN_POSITIVE)
    }

    /// Mean squared residual of a fit of this joint by itself, one load for all logs.
    fn own_residual(&self) -> Option<f64> {
        let width = self.table.width();
        let gram = self.table.gram.iter().fold(DMatrix::zeros(width, width), |sum: DMatrix<f64>, gram| sum + gram);
        let right = self.right.iter().fold(DVector::zeros(width), |sum: DVector<f64>, right| sum + right);
        let free = Bounds { nonnegative: vec![false; width], limits: Vec::new() };
        let solution = constrained(&gram, &right, &free)?;
        let squares: f64 = self.squares.iter().sum();
        let left = squares - 2.0 * solution.dot(&right) + solution.dot(&(&gram * &solution));
        Some(left.max(0.0) / (self.rows - width as f64).max(1.0))
    }
}

/// Solves normal equations under bounds; a sum that exceeds its own is held at it.
fn constrained(gram: &DMatrix<f64>, right: &DVector<f64>, bounds: &Bounds) -> Option<DVector<f64>> {
    let scale = gram.diagonal().map(|v: f64| if v > 0.0 { v.sqrt() } else { 1.0 });
    let solution = with_signs(gram, right, &scale, &bounds.nonnegative)?;
    let (mut held_gram, mut held_right) = (gram.clone(), right.clone());
    let mut exceeds = false;
    for limit in &bounds.limits {
        let of = |values: &DVector<f64>| limit.parameters.iter().map(|&b| values[b]).sum::<f64>();
        if of(&solution) > limit.most {
            exceeds = true;
            let weight = BOUND * limit.parameters.iter().map(|&b| gram[(b, b)]).fold(0.0, f64::max);
            for &b in &limit.parameters {
                held_right[b] += weight * limit.most;
                limit.parameters.iter().for_each(|&a| held_gram[(a, b)] += weight);
            }
        }
    }
    if exceeds { with_signs(&held_gram, &held_right, &scale, &bounds.nonnegative) } else { Some(solution) }
}

/// Solves normal equations under signs: the most negative of the parameters that cannot be negative is held at zero until
/// none is left. The columns have the lengths `scale`.
fn with_signs(
    gram: &DMatrix<f64>,
    right: &DVector<f64>,
    scale: &DVector<f64>,
    nonnegative: &[bool],
) -> Option<DVector<f64>> {
    let inverse_scale = scale.map(|length| 1.0 / length);
    let mut unit = gram.clone();
    for (mut column, own) in unit.column_iter_mut().zip(&inverse_scale) {
        column.component_mul_assign(&inverse_scale);
        column *= *own;
    }
    (0..unit.nrows()).for_each(|b| unit[(b, b)] += RIDGE);
    let unit_right = right.component_mul(&inverse_scale);
    let mut free: Vec<usize> = (0..right.len()).collect();
    loop {
        let whole = free.len() == right.len();
        let own = if whole { unit.clone() } else { unit.select_rows(&free).select_columns(&free) };
        let factored = Cholesky::new(own)?;
        let solved = factored.solve(&unit_right.select_rows(&free));
        let held = negative(&factored, &solved, |place| nonnegative[free[place]]);
        if held.is_empty() {
            let mut out = DVector::zeros(right.len());
            free.iter().zip(solved.iter()).for_each(|(&b, value)| out[b] = value * inverse_scale[b]);
            return Some(out);
        }
        free = (0..free.len()).filter(|place| !held.contains(place)).map(|place| free[place]).collect();
    }
}

/// The places that are held at zero one after the other, the most negative first, until none of those that cannot be negative is. Holding
/// one changes the solution and the inverse of the matrix by its column alone, so that no step needs a factor of its own.
fn negative(factored: &Cholesky, solved: &DVector<f64>, nonnegative: impl Fn(usize) -> bool) -> Vec<usize> {
    let mut held = Vec::new();
    let worst = |solved: &DVector<f64>, held: &[usize]| {
        let negative = |place: &usize| nonnegative(*place) && solved[*place] < 0.0 && !held.contains(place);
        (0..solved.len()).filter(negative).min_by(|&a, &b| solved[a].total_cmp(&solved[b]))
    };
    let Some(mut next) = worst(solved, &held) else { return held };
    let (mut solved, mut inverse) = (solved.clone(), factored.inverse());
    loop {
        held.push(next);
        let column = inverse.column(next).into_owned();
        let pivot = column[next];
        solved.axpy(-solved[next] / pivot, &column, 1.0);
        inverse.ger(-1.0 / pivot, &column, &column, 1.0);
        match worst(&solved, &held) {
            Some(other) => next = other,
            None => return held,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::physics::Limit;
    use super::*;

    #[test]
    fn a_parameter_that_cannot_be_negative_is_zero_and_the_others_fit() {
        let columns = DMatrix::from_row_slice(4, 2, &[1.0, 0.0, 1.0, 1.0, 1.0, 2.0, 1.0, 3.0]);
        let torque = DVector::from_vec(vec![4.0, 3.0, 2.0, 1.0]);
        let (gram, right) = (columns.tr_mul(&columns), columns.tr_mul(&torque));
        let signs = |nonnegative: [bool; 2]| Bounds { nonnegative: nonnegative.to_vec(), limits: Vec::new() };
        let free = constrained(&gram, &right, &signs([false, false])).unwrap();
        assert!((free[0] - 4.0).abs() < 1e-4 && (free[1] + 1.0).abs() < 1e-4, "{free}");
        let held = constrained(&gram, &right, &signs([false, true])).unwrap();
        assert!((held[0] - 2.5).abs() < 1e-4 && held[1] == 0.0, "{held}");
    }

    #[test]
    fn a_sum_is_held_at_its_bound_where_it_exceeds_it() {
        let (gram, right) = (DMatrix::identity(3, 3), DVector::from_vec(vec![3.0, 1.0, 5.0]));
        let sum = |most: f64| {
            let limits = vec![Limit { parameters: vec![0, 1], most }];
            let solution = constrained(&gram, &right, &Bounds { nonnegative: vec![true; 3], limits }).unwrap();
            (solution[0] + solution[1], solution[2])
        };
        let near = |(found, other): (f64, f64), wanted: f64| {
            assert!((found - wanted).abs() < 0.02 && (other - 5.0).abs() < 1e-4, "{found} {other}, {wanted}");
        };
        near(sum(4.5), 4.0);
        near(sum(3.5), 3.5);
        // The second is held at zero.
        near(sum(1.0), 1.0);
    }
}
