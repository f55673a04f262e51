//! Linear least squares with bounds, by an active set (Lawson and Hanson 1974, chapter 23; Stark and Parker 1995): solve
//! for what is free, hold at its bound what leaves it, release what the gradient pulls back inside.

use super::scaled_normal::ScaledNormal;
use crate::error::Result;
use nalgebra::{DMatrix, DVector};

/// A parameter between two values, by its index; infinite where there is no bound.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::identification) struct Bound {
    /// Index of the parameter.
    pub parameter: usize,
    /// Smallest value.
    pub lower: f64,
    /// Largest value.
    pub upper: f64,
}

/// Changes of the held set per bounded parameter before the search gives up; it needs a few.
const TURNS: usize = 10;

/// Parameters that stay at a bound, with their values.
pub(super) type Held = Vec<(usize, f64)>;

/// Minimises x'Nx/2 - b'x within bounds, some parameters `fixed` at their values. Returns x and the parameters that are fixed
/// or stay at a bound, with their values.
///
/// # Errors
/// Names the parameters that the motion does not separate.
pub(in crate::identification) fn solve(
    normal: &DMatrix<f64>,
    right: &DVector<f64>,
    bounds: &[Bound],
    fixed: &[(usize, f64)],
    names: &[String],
) -> Result<(Vec<f64>, Held)> {
    let is_fixed = |k: usize| fixed.iter().any(|(own, _)| *own == k);
    let mut held: Held = fixed.to_vec();
    let mut x = free(normal, right, &held, names)?;
    for _ in 0..=TURNS * bounds.len() {
        let over = |bound: &Bound| (bound.lower - x[bound.parameter]).max(x[bound.parameter] - bound.upper);
        // In units of the precision of each.
        let weight = |bound: &Bound| normal[(bound.parameter, bound.parameter)].sqrt();
        let worst = bounds
            .iter()
            .filter(|bound| over(bound) > 0.0 && held.iter().all(|(k, _)| *k != bound.parameter))
            .max_by(|a, b| (over(a) * weight(a)).total_cmp(&(over(b) * weight(b))));
        if let Some(bound) = worst {
            held.push((bound.parameter, x[bound.parameter].clamp(bound.lower, bound.upper)));
        } else {
            let gradient = normal * DVector::from_column_slice(&x) - right;
            let pulls = |&(k, value): &(usize, f64)| {
                let inward = bounds
                    .iter()
                    .find(|bound| bound.parameter == k)
                    .map_or(0.0, |bound| if value == bound.lower { -gradient[k] } else { gradient[k] });
                inward / normal[(k, k)].sqrt().max(f64::MIN_POSITIVE)
            };
            let rounding = 1e-10 * right.amax();
            let freed = (0..held.len()).filter(|&k| !is_fixed(held[k].0));
            let strongest = freed.max_by(|&a, &b| pulls(&held[a]).total_cmp(&pulls(&held[b])));
            match strongest.filter(|&k| pulls(&held[k]) > rounding) {
                Some(k) => {
                    held.swap_remove(k);
                }
                None => break,
            }
        }
        x = free(normal, right, &held, names)?;
    }
    held.sort_by_key(|(k, _)| *k);
    Ok((x, held))
}

/// The solution with some parameters held.
fn free(normal: &DMatrix<f64>, right: &DVector<f64>, held: &[(usize, f64)], names: &[String]) -> Result<Vec<f64>> {
    let free: Vec<usize> = (0..names.len()).filter(|k| held.iter().all(|(own, _)| own != k)).collect();
    let mut x = vec![0.0; names.len()];
    held.iter().for_each(|&(k, value)| x[k] = value);
    if free.is_empty() {
        return Ok(x);
    }
    let part = DMatrix::from_fn(free.len(), free.len(), |r, c| normal[(free[r], free[c])]);
    let known: DVector<f64> = DVector::from_fn(free.len(), |r, _| {
        right[free[r]] - held.iter().map(|&(k, value)| normal[(free[r], k)] * value).sum::<f64>()
    });
    let own: Vec<String> = free.iter().map(|&k| names[k].clone()).collect();
    let found = ScaledNormal::new(&part, &own)?.solve(&known);
    free.iter().zip(found.iter()).for_each(|(&k, &value)| x[k] = value);
    Ok(x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn names(count: usize) -> Vec<String> {
        (0..count).map(|k| format!("p{k}")).collect()
    }

    #[test]
    fn by_hand() {
        // (x - 1)^2 + (y + 2)^2 + x y with y >= 0: y stays at zero, x = 1.
        let normal = DMatrix::from_row_slice(2, 2, &[2.0, 1.0, 1.0, 2.0]);
        let right = DVector::from_vec(vec![2.0, -4.0]);
        let bound = Bound { parameter: 1, lower: 0.0, upper: f64::INFINITY };
        let (x, held) = solve(&normal, &right, &[bound], &[], &names(2)).unwrap();
        assert!((x[0] - 1.0).abs() < 1e-12 && x[1] == 0.0, "{x:?}");
        assert_eq!(held, [(1, 0.0)]);
        let (x, held) = solve(&normal, &right, &[], &[], &names(2)).unwrap();
        assert!((x[1] + 10.0 / 3.0).abs() < 1e-12 && held.is_empty(), "{x:?}");
        // x fixed at 2: y = (-4 - 2) / 2, above a bound of -1 that then holds it.
        let (x, held) = solve(&normal, &right, &[], &[(0, 2.0)], &names(2)).unwrap();
        assert!(x[0] == 2.0 && (x[1] + 3.0).abs() < 1e-12 && held == [(0, 2.0)], "{x:?}");
        let bound = Bound { lower: -1.0, ..bound };
        assert_eq!(solve(&normal, &right, &[bound], &[(0, 2.0)], &names(2)).unwrap().0, [2.0, -1.0]);
    }

    proptest! {
        /// Karush-Kuhn-Tucker: nothing free has a gradient, nothing held would rather be inside.
        #[test]
        fn is_the_minimum(rows in prop::collection::vec(prop::collection::vec(-1.0..1.0f64, 5), 12)) {
            let table = DMatrix::from_fn(12, 4, |r, c| rows[r][c] + if r == c { 2.0 } else { 0.0 });
            let target = DVector::from_fn(12, |r, _| 3.0 * rows[r][4]);
            let (normal, right) = (table.transpose() * &table, table.transpose() * target);
            let bounds: Vec<Bound> = (0..4)
                .map(|parameter| Bound { parameter, lower: 0.0, upper: if parameter < 2 { 0.3 } else { f64::INFINITY } })
                .collect();
            let (x, held) = solve(&normal, &right, &bounds, &[], &names(4)).unwrap();
            let gradient = &normal * DVector::from_column_slice(&x) - right;
            for (k, bound) in bounds.iter().enumerate() {
                prop_assert!(x[k] >= bound.lower - 1e-12 && x[k] <= bound.upper + 1e-12);
                match held.iter().find(|(own, _)| *own == k) {
                    Some((_, value)) if *value == bound.lower => prop_assert!(gradient[k] > -1e-7),
                    Some(_) => prop_assert!(gradient[k] < 1e-7),
                    None => prop_assert!(gradient[k].abs() < 1e-7),
                }
            }
        }
    }
}
