//! The factor by which torques differ from what the described bodies need: another unit, or the motor side of a gear.
//!
//! A load at the tip makes the torques of the wrist many times larger, and friction those of all joints. So a factor counts only where
//! the bodies with it explain the torques clearly better than the bodies with a load, friction, constants and rotors.

use super::super::change::{Change, Description};
use super::super::compare::{EXPLAINED, compare};
use super::super::fitting::{Fit, JointTable, Physics, Rows, Tables};
use super::super::shares::ALIKE;
use super::super::tried::Tried;
use super::golden::golden;
use nalgebra::{DMatrix, DVector};

/// The residual of the fit without the bodies is at least this many times that with them, where they count.
const NEEDED: f64 = 2.0;

/// Masses of a URDF are wrong by less than this factor, unless they are placeholders, whose torque is not alike.
pub(crate) const PLAUSIBLE: f64 = 8.0;

/// Factors up to so many times larger and smaller than the first estimate are tried: a load may have raised that of the wrist.
const WIDEST: f64 = 100.0;

/// Ratio of two neighbours of the factors that are tried first, at most; between them golden sections, to within one per cent.
pub(crate) const STEP: f64 = 1.8;
const SECTIONS: usize = 10;

/// Factors of the joints within this of the one that all share are that one: described bodies are wrong by as much.
const UNEQUAL: f64 = 2.0;

/// Ratio of the largest of the joints' factors to the smallest from which free bodies are asked whether each joint has its own: single
/// masses are rarely wrong by more.
const SPREAD: f64 = 3.0;

/// The factor of one torque of several is known where it fits all rows better than both ends of the range in which it is refined, by so much
/// in the logarithm of the mean squares: a torque that is friction alone fits all of them alike.
pub(crate) const BOUNDED: f64 = 0.1;

/// Rounds over the joints, whose factors share the load.
const ROUNDS: usize = 3;

/// One factor of all joints and one for each are compared with none.
const TRIED: usize = 2;

/// Torques of another scale than that of the described bodies.
pub(crate) struct Scaled {
    /// The logs as they are.
    pub before: Tried,
    /// With the factors.
    pub after: Tried,
    /// How many times larger the logged torque is: one factor where the joints share it, else one per joint, where it is known.
    pub factors: Vec<Option<f64>>,
    /// The same one by one, as the described bodies have them.
    pub each: Vec<f64>,
}

/// The scale of the torques, where it is clearly another than that of the described bodies with any load.
pub(crate) fn judge(bodies: &Physics, rows: &Rows, start: &Description) -> Option<Scaled> {
    let whole = rows.whole();
    let tables = bodies.tables(&whole, start);
    let alone = without_load(&tables, rows);
    let first = first(&alone)?;
    let before = Tried::new(bodies, rows, start.clone())?;
    let scaled = |factor: f64| start.with(Change::TorqueScale(1.0 / factor));
    let shared = best(first, WIDEST, |factor| merit(&tables, &whole, &scaled(factor)))?;
    // Factors that differ much are far from one that all share: a load that makes up for it is hard to leave.
    let of_each = |factors: &[f64]| merit(&tables, &whole, &start.with_scales(shared, factors));
    let own: Vec<f64> = alone.iter().map(|factor| factor.map_or(shared, f64::abs)).collect();
    let starts = [vec![shared; start.dof()], own];
    let mut each = starts.into_iter().min_by(|a, b| of_each(a).total_cmp(&of_each(b)))?;
    for _ in 0..ROUNDS {
        for joint in 0..each.len() {
            let with = |factor: f64| {
                let mut factors = each.clone();
                factors[joint] = factor;
                of_each(&factors)
            };
            each[joint] = best(each[joint], WIDEST, with)?;
        }
    }
    // A torque without bound to its factor has no part in the bodies: its factor is not known.
    let bounded = |factor: f64| (factor / shared).ln().abs() < WIDEST.ln();
    let known = |joint: usize| alone[joint].and_then(|_| Some(each[joint]).filter(|factor| bounded(*factor)));
    let each_known: Vec<Option<f64>> = (0..each.len()).map(known).collect();
    let all: Vec<f64> = each.iter().map(|factor| if bounded(*factor) { *factor } else { shared }).collect();
    let mut own = start.with_scales(shared, &all);
    let each = all;
    own.scale_is_partial = each_known.iter().any(Option::is_none);
    let candidates = [(scaled(shared), vec![Some(shared)]), (own, each_known)];
    let [one, differing] = candidates.map(|(description, factors)| {
        let after = Tried::new(bodies, rows, description)?;
        Some((after, factors))
    });
    let (one, differing) = (one?, differing?);
    let differs = differing.1.iter().flatten().any(|factor| (factor / shared).ln().abs() > UNEQUAL.ln())
        && compare(&one.0.evaluation, &differing.0.evaluation, &rows.log).is_some_and(|own| own.is_distinct());
    // Where each joint has its own, a single one is that of none.
    let (after, factors) = if differs { differing } else { one };
    implausible(&factors)?;
    let gain = compare(&before.evaluation, &after.evaluation, &rows.log)?;
    let credible = after.share() < ALIKE;
    (credible && gain.is_better(TRIED, EXPLAINED) && gain.is_distinct()).then_some(Scaled {
        before,
        after,
        factors,
        each,
    })
}

/// Whether factors are so unlike that masses alone do not make the difference from joint to joint.
pub(crate) fn differ(factors: &[Option<f64>]) -> bool {
    sizes(factors).is_some_and(|sizes| is_spread(&sizes))
}

/// How many times larger the torque of every joint is than that of the bodies without a load; none where it is not alike.
pub(crate) fn without_load(tables: &Tables, rows: &Rows) -> Vec<Option<f64>> {
    tables.joints.iter().enumerate().map(|(joint, table)| factor(table, joint, rows)).collect()
}

/// Whether ascending factors are spread by more than masses that are described wrongly.
fn is_spread(sizes: &[f64]) -> bool {
    matches!(sizes, [least, .., most] if *most > SPREAD * least)
}

/// The median of the factors without a load, where enough joints have one and some are beyond what wrong masses explain: a load
/// may hide what the others have.
fn first(factors: &[Option<f64>]) -> Option<f64> {
    let known = sizes(factors)?;
    known.iter().any(beyond).then(|| known[known.len() / 2])
}

/// The known factors without their signs, ascending, where enough joints have one.
fn sizes(factors: &[Option<f64>]) -> Option<Vec<f64>> {
    let mut known: Vec<f64> = factors.iter().flatten().map(|factor| factor.abs()).collect();
    if known.len() < factors.len().min(2) || known.len() * 3 < factors.len() {
        return None;
    }
    known.sort_by(f64::total_cmp);
    Some(known)
}

fn beyond(factor: &f64) -> bool {
    !(1.0 / PLAUSIBLE..PLAUSIBLE).contains(factor)
}

/// The median of the factors, where it is beyond what wrong masses explain and enough joints show it.
fn implausible(factors: &[Option<f64>]) -> Option<f64> {
    let known = sizes(factors)?;
    let median = known[known.len() / 2];
    let same_side = |factor: &f64| (*factor > 1.0) == (median > 1.0);
    (beyond(&median) && known.iter().filter(|f| beyond(f)).all(same_side)).then_some(median)
}

/// How well all rows are fitted under a description, less for a better fit; infinite where nothing can be fitted.
pub(crate) fn merit(tables: &Tables, rows: &Rows, description: &Description) -> f64 {
    Fit::new(tables, rows, description).merit().unwrap_or(f64::INFINITY)
}

/// The factor around a first one, up to so many times larger and smaller, under which `merit` is least.
pub(crate) fn best(first: f64, widest: f64, merit: impl Fn(f64) -> f64) -> Option<f64> {
    let (grid, merits) = spread(first, widest, &merit);
    let least = (0..grid.len()).min_by(|&a, &b| merits[a].total_cmp(&merits[b]))?;
    merits[least].is_finite().then(|| between(grid[least] / STEP, grid[least] * STEP, merit))
}

/// Factors around a first one, evenly spread by their logarithms, with the merit of each.
pub(crate) fn spread(first: f64, widest: f64, merit: &impl Fn(f64) -> f64) -> (Vec<f64>, Vec<f64>) {
    let steps = (2.0 * widest.ln() / STEP.ln()).ceil() as usize;
    let step = 2.0 * widest.ln() / steps as f64;
    let at = |place: usize| (first.abs().ln() - widest.ln() + step * place as f64).exp();
    let grid: Vec<f64> = (0..=steps).map(at).collect();
    let merits = grid.iter().map(|factor| merit(*factor)).collect();
    (grid, merits)
}

/// The factor between two others under which `merit`, which has one valley there, is least.
pub(crate) fn between(low: f64, high: f64, merit: impl Fn(f64) -> f64) -> f64 {
    golden(low.ln(), high.ln(), SECTIONS, |log| merit(log.exp())).exp()
}

/// How many times larger the logged torque of a joint is than that of the bodies without a load; none where it is not alike.
fn factor(table: &JointTable, channel: usize, rows: &Rows) -> Option<f64> {
    let rotor = 0;
    factor_over(std::iter::once(rotor).chain(table.constant_and_friction()?).collect(), table, channel, rows)
}

/// The same of a joint whose rotor has no part in it.
pub(crate) fn factor_without_rotor(table: &JointTable, channel: usize, rows: &Rows) -> Option<f64> {
    factor_over(table.constant_and_friction()?.collect(), table, channel, rows)
}

/// The same with columns of its `own` besides the torque of the bodies.
fn factor_over(own: Vec<usize>, table: &JointTable, channel: usize, rows: &Rows) -> Option<f64> {
    let width = own.len();
    let count: usize = table.rows.iter().sum();
    if !rows.measured[channel] || count < 4 * (width + 1) {
        return None;
    }
    let sum = |each: &[f64]| each.iter().sum::<f64>();
    let mut gram = DMatrix::zeros(width + 1, width + 1);
    let mut right = DVector::zeros(width + 1);
    for block in 0..table.rows.len() {
        for (place, &column) in own.iter().enumerate() {
            for (other, &row) in own.iter().enumerate() {
                gram[(other, place)] += table.gram[block][(row, column)];
            }
            gram[(place, width)] += table.with_known[block][column];
            gram[(width, place)] += table.with_known[block][column];
            right[place] += table.with_torque[channel][block][column];
        }
    }
    gram[(width, width)] = sum(&table.known_squares);
    right[width] = sum(&table.known_torque[channel]);
    let squares = sum(&table.squares[channel]);
    let left = |size: usize| -> Option<(f64, f64)> {
        let (gram, right) = (gram.view((0, 0), (size, size)).into_owned(), right.rows(0, size).into_owned());
        let scale = gram.diagonal().map(|v: f64| if v > 0.0 { v.sqrt() } else { 1.0 });
        let unit =
            DMatrix::from_fn(size, size, |r, c| gram[(r, c)] / (scale[r] * scale[c]) + if r == c { 1e-8 } else { 0.0 });
        let solution = unit.cholesky()?.solve(&right.component_div(&scale)).component_div(&scale);
        Some(((squares - solution.dot(&right)).max(0.0), solution[size - 1]))
    };
    let ((with, factor), (without, _)) = (left(width + 1)?, left(width)?);
    let alike = with.sqrt() < ALIKE * squares.sqrt() && without.sqrt() > NEEDED * with.sqrt();
    (alike && factor != 0.0).then_some(factor)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_count_where_enough_joints_have_them_beyond_wrong_masses() {
        assert_eq!(implausible(&[Some(8.1), Some(9.0), None]), Some(9.0));
        assert_eq!(implausible(&[Some(7.9), Some(7.0), None]), None);
        assert_eq!(implausible(&[Some(0.1), Some(0.11), Some(1.2)]), Some(0.11));
        // A single joint of several, and factors on both sides.
        assert_eq!(implausible(&[Some(20.0), None, None]), None);
        assert_eq!(implausible(&[Some(20.0), Some(30.0), Some(0.01)]), None);
        assert_eq!(implausible(&[Some(-20.0)]), Some(20.0));
        // A load hides factors of the wrist: the others are enough to look closer.
        assert_eq!(first(&[None, Some(0.014), Some(0.033), Some(0.2), Some(0.2)]), Some(0.2));
        assert_eq!(first(&[Some(0.2), Some(7.0)]), None);
    }

    #[test]
    fn factors_are_spread_from_three_times_on() {
        assert!(is_spread(&[0.5, 1.0, 1.51]) && !is_spread(&[0.5, 1.0, 1.49]));
        assert!(!is_spread(&[0.1]) && !is_spread(&[]));
    }

    #[test]
    fn the_best_factor_is_found_far_from_the_first() {
        let least = |wanted: f64| move |factor: f64| (factor / wanted).ln().powi(2);
        for wanted in [0.013, 1.0, 95.0] {
            let found = best(1.0, WIDEST, least(wanted)).unwrap();
            assert!((found / wanted - 1.0).abs() < 0.01, "{found} {wanted}");
        }
        assert_eq!(best(1.0, WIDEST, |_| f64::INFINITY), None);
    }
}
