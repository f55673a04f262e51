//! Parameters that logs do not separate from others: by the digits of the sums or under the noise of the torque.
//!
//! Geometry that is written with few digits makes columns that are nearly, not quite, combinations of others, and a motion
//! that leaves a joint almost at rest does the same. The part of such a column that is orthogonal to the others is below the noise: its
//! parameter is held at the description's value, and the others take over what it would have had.
//!
//! Base parameters that small tilts alone separate from others, which are merged into these ([`crate::dynamics::BaseParameters`]), are held
//! until the log shows that they differ from the description: all that is held then is the little that the tilt makes of them.

use super::joint_regression::JointRegression;
use super::joint_sums::JointSums;
use nalgebra::{Cholesky, DMatrix, DVector};

/// Least share of a column's length orthogonal to those before it that sums of squares resolve: its square is ten thousand times the
/// rounding of the sums.
const RESOLVED: f64 = 1e-6;

/// Rounds of weighting the joints by the residual of the fit.
const ROUNDS: usize = 2;

/// A parameter whose standard deviation alone makes as much torque as the whole log holds, times this, is not determined:
/// the log gives no better bound than the torque that it holds.
const WHOLE_TORQUE: f64 = 1.0;

/// The first `count` parameters that the rows cannot determine, with the value at which to hold them: that of `described`,
/// or zero where that would make more torque than the rows have.
///
/// `units` are the parameters' units: one that is less sure than the largest of its unit is large is not determined either, since a
/// parameter of the arm's size would not show. Parameters that are `merged` into others are not, either, as long as they do not
/// differ from the description by [`SHOWN`] standard deviations.
pub(crate) fn undetermined(
    joints: &[JointRegression],
    described: &[f64],
    units: &[&str],
    merged: &[bool],
) -> Vec<(usize, f64)> {
    let count = described.len();
    // What is solved for of merged parameters is how they differ from the description.
    let known: Vec<f64> =
        described.iter().zip(merged).map(|(&value, &merged)| if merged { value } else { 0.0 }).collect();
    let sums: Vec<JointSums> = joints.iter().filter(|joint| joint.rows() > 0).map(JointRegression::sums).collect();
    let torque = |own: &JointSums| own.gram[(own.parameters.len(), own.parameters.len())];
    let mut sigma: Vec<f64> = sums.iter().map(|own| positive((torque(own) / own.rows as f64).sqrt())).collect();
    let (normal, _) = equations(&sums, &sigma, &known);
    let mut kept = independent(&normal, (0..count).collect(), RESOLVED);
    for _ in 0..ROUNDS {
        let (normal, right) = equations(&sums, &sigma, &known);
        let Some(mut beta) = solution(&normal, &right, &kept) else { break };
        beta.iter_mut().zip(&known).for_each(|(beta, known)| *beta += known);
        for (own, sigma) in sums.iter().zip(&mut sigma) {
            let signed = own.parameters.iter().map(|&k| beta.get(k).map_or(0.0, |b| -b)).chain([1.0]);
            let signed = DVector::from_iterator(own.parameters.len() + 1, signed);
            let left = (&own.gram * &signed).dot(&signed).max(own.least_residual());
            let freedom = own.rows.saturating_sub(own.parameters.len()).max(1);
            *sigma = positive((left / freedom as f64).sqrt());
        }
    }
    let (normal, right) = equations(&sums, &sigma, &known);
    let whole = sums.iter().zip(&sigma).map(|(own, s)| torque(own) / (s * s)).sum::<f64>().sqrt();
    kept = independent(&normal, kept, (1.0 / (WHOLE_TORQUE * whole).max(1.0)).max(RESOLVED));
    while let Some(least) = least_sure(&normal, &right, &kept, (units, merged)) {
        kept.retain(|&k| k != least);
    }
    while let Some(least) = least_shown(&normal, &right, &kept, merged) {
        kept.retain(|&k| k != least);
    }
    let held = |k: usize| {
        let makes = normal[(k, k)].sqrt() * described[k].abs();
        (k, if makes <= whole { described[k] } else { 0.0 })
    };
    (0..count).filter(|k| !kept.contains(k)).map(held).collect()
}

/// Standard deviations from zero at which a parameter gives the size of those of its unit.
const SURE: f64 = 3.0;

/// Standard deviations by which a merged parameter differs from the description before it is a parameter of its own. At three, one in
/// 370 is by chance; and one that is held wrongly makes less torque than three standard deviations of its estimate.
const SHOWN: f64 = 3.0;

/// The least determined parameter relative to the largest of its unit, if its standard deviation is larger than that. One at a time: of two
/// that the log knows together only, neither is sure, and either is once the other is held.
fn least_sure(
    normal: &DMatrix<f64>,
    right: &DVector<f64>,
    kept: &[usize],
    (units, merged): (&[&str], &[bool]),
) -> Option<usize> {
    let (beta, std) = solution(normal, right, kept).zip(deviations(normal, kept))?;
    let is_sure = |&&k: &&usize| !merged[k] && beta[k].abs() > SURE * std[k];
    let largest = |unit: &str| {
        kept.iter().filter(is_sure).filter(|&&k| units[k] == unit).map(|&k| beta[k].abs()).fold(0.0, f64::max)
    };
    let unsure = |&k: &usize| std[k] / largest(units[k]);
    let open = kept.iter().copied().filter(|k| unsure(k).is_finite() && unsure(k) > 1.0);
    open.max_by(|a, b| unsure(a).total_cmp(&unsure(b)))
}

/// The merged parameter that differs least from the description, if it does not show.
fn least_shown(normal: &DMatrix<f64>, right: &DVector<f64>, kept: &[usize], merged: &[bool]) -> Option<usize> {
    if kept.iter().all(|&k| !merged[k]) {
        return None;
    }
    let (beta, std) = solution(normal, right, kept).zip(deviations(normal, kept))?;
    let shown = |k: &usize| beta[*k].abs() / std[*k];
    let least = kept.iter().copied().filter(|&k| merged[k]).min_by(|a, b| shown(a).total_cmp(&shown(b)))?;
    (shown(&least) < SHOWN).then_some(least)
}

fn positive(value: f64) -> f64 {
    if value > 0.0 && value.is_finite() { value } else { 1.0 }
}

/// X'WX and X'Wy of the parameters, for the torque less that of the `known` values.
fn equations(sums: &[JointSums], sigma: &[f64], known: &[f64]) -> (DMatrix<f64>, DVector<f64>) {
    let count = known.len();
    let (mut normal, mut right) = (DMatrix::zeros(count, count), DVector::zeros(count));
    for (own, s) in sums.iter().zip(sigma) {
        let last = own.parameters.len();
        for (r, &row) in own.parameters.iter().enumerate().filter(|(_, k)| **k < count) {
            right[row] += own.gram[(r, last)] / (s * s);
            for (c, &column) in own.parameters.iter().enumerate().filter(|(_, k)| **k < count) {
                normal[(row, column)] += own.gram[(r, c)] / (s * s);
            }
        }
    }
    if known.iter().any(|&value| value != 0.0) {
        right -= &normal * DVector::from_column_slice(known);
    }
    (normal, right)
}

/// Those of `candidates`, in their order, whose column has more than a `share` orthogonal to the ones kept before it: by the Cholesky factor
/// of the `normal` matrix, since of the columns themselves nothing is kept but these sums.
fn independent(normal: &DMatrix<f64>, candidates: Vec<usize>, share: f64) -> Vec<usize> {
    let mut kept: Vec<usize> = Vec::new();
    // Row i: what the kept column i has along the orthonormal directions of those before it, and its own length last.
    let mut factor: Vec<Vec<f64>> = Vec::new();
    for k in candidates {
        let length = normal[(k, k)].sqrt();
        if !(length > 0.0 && length.is_finite()) {
            continue;
        }
        let mut row: Vec<f64> = Vec::with_capacity(kept.len() + 1);
        for (i, &other) in kept.iter().enumerate() {
            let size = normal[(other, other)].sqrt();
            let along: f64 = factor[i][..i].iter().zip(&row).map(|(a, b)| a * b).sum();
            row.push((normal[(k, other)] / (length * size) - along) / factor[i][i]);
        }
        let left = 1.0 - row.iter().map(|x| x * x).sum::<f64>();
        if left > share * share {
            row.push(left.sqrt());
            factor.push(row);
            kept.push(k);
        }
    }
    kept
}

/// Standard deviations of the `kept` parameters, if the noise is white; zero for the others.
fn deviations(normal: &DMatrix<f64>, kept: &[usize]) -> Option<Vec<f64>> {
    let scale: Vec<f64> = kept.iter().map(|&k| 1.0 / normal[(k, k)].sqrt()).collect();
    let unit = DMatrix::from_fn(kept.len(), kept.len(), |r, c| normal[(kept[r], kept[c])] * scale[r] * scale[c]);
    let inverse = Cholesky::new(unit)?.inverse();
    let mut std = vec![0.0; normal.nrows()];
    kept.iter().enumerate().for_each(|(place, &k)| std[k] = inverse[(place, place)].sqrt() * scale[place]);
    Some(std)
}

/// The solution in the `kept` parameters, zero in the others.
fn solution(normal: &DMatrix<f64>, right: &DVector<f64>, kept: &[usize]) -> Option<Vec<f64>> {
    let scale: Vec<f64> = kept.iter().map(|&k| 1.0 / normal[(k, k)].sqrt()).collect();
    let unit = DMatrix::from_fn(kept.len(), kept.len(), |r, c| normal[(kept[r], kept[c])] * scale[r] * scale[c]);
    let scaled = DVector::from_fn(kept.len(), |r, _| right[kept[r]] * scale[r]);
    let found = Cholesky::new(unit)?.solve(&scaled);
    let mut beta = vec![0.0; normal.nrows()];
    kept.iter().zip(found.iter()).zip(&scale).for_each(|((&k, value), scale)| beta[k] = value * scale);
    Some(beta)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::channels::Channels;
    use crate::random;
    use rand_distr::{Distribution, StandardNormal};

    /// Three columns, the third the sum of the others but for `apart` of itself, under noise of a thousandth of the torque.
    fn rows(apart: f64) -> JointRegression {
        let mut source = random::stream(8, "undetermined", 0);
        let mut draw = || -> f64 { StandardNormal.sample(&mut source) };
        let [mut a, mut b, mut c, mut torque] = [const { Vec::new() }; 4];
        for _ in 0..2000 {
            let (x, y, z) = (draw(), draw(), draw());
            a.push(x);
            b.push(y);
            c.push(x + y + apart * z);
            torque.push(2.0 * x - y + 3.0 * (x + y + apart * z) + 5e-3 * draw());
        }
        let valid = vec![true; torque.len()];
        let columns = Channels::from_vectors(&[a, b, c]);
        JointRegression { joint: "a".into(), parameters: vec![0, 1, 2], columns, torque, valid }
    }

    #[test]
    fn what_the_noise_hides_is_held_and_what_shows_is_not() {
        assert_eq!(undetermined(&[rows(1e-2)], &[0.0, 0.0, 3.5], &["kg"; 3], &[false; 3]), []);
        assert_eq!(undetermined(&[rows(1e-6)], &[0.0, 0.0, 3.5], &["kg"; 3], &[false; 3]), [(2, 3.5)]);
        assert_eq!(undetermined(&[rows(0.0)], &[0.0, 0.0, 3.5], &["kg"; 3], &[false; 3]), [(2, 3.5)]);
        assert_eq!(
            undetermined(&[rows(0.0)], &[0.0, 0.0, 1e9], &["kg"; 3], &[false; 3]),
            [(2, 0.0)],
            "no log has so much torque"
        );
    }

    #[test]
    fn what_does_not_act_at_all_is_held() {
        let mut still = rows(1e-2);
        still.columns.channel_mut(1).fill(0.0);
        assert_eq!(undetermined(&[still], &[1.0, 2.0, 3.0], &["kg"; 3], &[false; 3]), [(1, 2.0)]);
        let mut nothing = rows(1e-2);
        nothing.valid.fill(false);
        assert_eq!(
            undetermined(&[nothing], &[1.0, 2.0], &["kg"; 2], &[false; 2]).len(),
            2,
            "without rows nothing is determined"
        );
    }

    #[test]
    fn a_parameter_of_the_size_of_others_that_would_not_show_is_held() {
        let mut faint = rows(1e-2);
        let (columns, torque) = (&mut faint.columns, &mut faint.torque);
        // Its parameter is zero.
        torque.iter_mut().zip(columns.channel(1)).for_each(|(torque, value)| *torque += value);
        columns.channel_mut(1).iter_mut().for_each(|value| *value *= 1e-6);
        assert_eq!(undetermined(std::slice::from_ref(&faint), &[1.0, 2.0, 3.0], &["kg"; 3], &[false; 3]), [(1, 2.0)]);
        // Of a unit of its own it may be of any size.
        assert_eq!(undetermined(&[faint], &[1.0, 2.0, 3.0], &["kg", "N", "kg"], &[false; 3]), []);
    }

    #[test]
    fn of_two_that_are_known_together_one_is_held() {
        // The sum of the first two has a column of length one, their difference one below the noise; the third gives the size.
        let mut pair = rows(1.0);
        let (x, y) = (pair.columns.channel(0).to_vec(), pair.columns.channel(1).to_vec());
        for (row, (x, y)) in x.iter().zip(&y).enumerate() {
            let (one, other) = (x + 3e-5 * y, *x);
            pair.torque[row] += one + 2.0 * other - 2.0 * x + y;
            pair.columns.channel_mut(0)[row] = one;
            pair.columns.channel_mut(1)[row] = other;
        }
        let held = undetermined(&[pair], &[1.5, 1.5, 3.0], &["kg"; 3], &[false; 3]);
        assert!(matches!(held[..], [(0 | 1, 1.5)]), "{held:?}");
    }

    /// A third column of its own but for its size, which has a parameter of 3.
    fn merged(size: f64) -> JointRegression {
        let mut rows = rows(1.0);
        let (x, y) = (rows.columns.channel(0).to_vec(), rows.columns.channel(1).to_vec());
        let third = rows.columns.channel_mut(2);
        for (row, value) in third.iter_mut().enumerate() {
            let own = *value - x[row] - y[row];
            rows.torque[row] += 3.0 * (size * own - *value);
            *value = size * own;
        }
        rows
    }

    #[test]
    fn a_merged_parameter_is_held_until_it_differs_from_the_description() {
        let held = |size: f64, described: f64| {
            undetermined(&[merged(size)], &[2.0, -1.0, described], &["kg"; 3], &[false, false, true])
        };
        // Its standard deviation is 5e-3 / sqrt(2000) over its size: 1.1e-4 at a size of one.
        assert_eq!(held(1.0, 3.0 + 1.5e-4), [(2, 3.0 + 1.5e-4)]);
        assert_eq!(held(1.0, 3.0 + 8e-4), []);
        assert_eq!(held(1e-2, 3.0 + 1.5e-2), [(2, 3.0 + 1.5e-2)]);
        assert_eq!(held(1e-2, 3.0 + 8e-2), []);
        assert_eq!(held(1e-3, 3.0), [(2, 3.0)]);
        assert_eq!(held(1e-6, 0.0), [(2, 0.0)]);
    }
}
