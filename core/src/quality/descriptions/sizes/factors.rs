//! Factors of the torques of single joints: a gear left out, a current, a share of the rated torque.
//!
//! The bodies beyond a joint act on the joints before it too, so that the torques of neighbours contain the same parameters. Under free
//! bodies this gives the ratio of their scales, whatever the bodies are: no wrong mass explains it. Which torques have a factor is
//! decided by the number of changes: one torque is wrong before five are.

use super::super::change::{Change, Description};
use super::super::compare::{EXPLAINED, compare};
use super::super::fitting::{Physics, Rows, Tables};
use super::super::tried::Tried;
use super::scale::{ALIKE, STEP, best, between, merit, spread};

/// Factors below it are not reported: torque constants, gears and described bodies are up to twice from what files say.
const REPORTED: f64 = 2.0;

/// Factors up to so many times larger and smaller are tried: gears have up to 300, and units 1000.
const WIDEST: f64 = 2000.0;

/// Factors that are known roughly are looked for within this.
const NEAR: f64 = 3.0;

/// The factor is determined where it fits all rows better than at both ends of the range, at which the torque has no part in the bodies
/// of the others: by so much, in the logarithm of the mean squares.
const DETERMINED: f64 = 0.5;

/// Rounds over several factors, which share the bodies.
const ROUNDS: usize = 3;

/// The description with a factor for the torque of one more joint, for each joint that has none yet and to which all rows give one
/// beyond what is reported.
pub(crate) fn of_single_joints(physics: &Physics, rows: &Rows, from: &Description) -> Vec<Description> {
    // Nothing joins the torques of joints by themselves. And a factor takes a torque that no model explains out of the fit of the others:
    // together with another change it explains too much, but for the sign of all, which takes no torque out.
    if matches!(physics, Physics::Alone) || from.dof() < 2 || !from.has_only_scales_and_signs() {
        return Vec::new();
    }
    let tables = physics.tables(rows, from);
    let unscaled = from.without_scales();
    let with = |scales: &[f64]| {
        let scaled = scales.iter().enumerate().filter(|(_, scale)| **scale != 1.0);
        scaled.fold(unscaled.clone(), |description, (joint, scale)| description.with(Change::JointScale(joint, *scale)))
    };
    let own = |joint: usize| {
        if !rows.measured[from.torque_of[joint]] || from.torque_scale[joint] != 1.0 {
            return None;
        }
        let mut scales = from.torque_scale.clone();
        scales[joint] = determined(merit_of(&tables, rows, &with, &scales, joint))?;
        // The factor changes what those found before are.
        let earlier: Vec<usize> = from.scaled().collect();
        for _ in 0..if earlier.is_empty() { 0 } else { ROUNDS } {
            for &other in earlier.iter().chain([&joint]) {
                scales[other] = fitted(&tables, rows, &with, &scales, other, NEAR)?;
            }
        }
        let reported = |&other: &usize| scales[other].ln().abs() > REPORTED.ln();
        earlier.iter().chain([&joint]).all(reported).then(|| with(&scales))
    };
    (0..from.dof()).filter_map(own).collect()
}

/// The factor of one torque under which all rows are fitted best, the others as they are.
fn fitted(
    tables: &Tables,
    rows: &Rows,
    with: &impl Fn(&[f64]) -> Description,
    scales: &[f64],
    joint: usize,
    widest: f64,
) -> Option<f64> {
    best(scales[joint], widest, merit_of(tables, rows, with, scales, joint))
}

/// How well all rows are fitted with a factor for one torque, the others as they are.
fn merit_of(
    tables: &Tables,
    rows: &Rows,
    with: &impl Fn(&[f64]) -> Description,
    scales: &[f64],
    joint: usize,
) -> impl Fn(f64) -> f64 {
    move |scale: f64| {
        let mut scales = scales.to_vec();
        scales[joint] = scale;
        merit(tables, rows, &with(&scales))
    }
}

/// The factor beyond what is reported under which `merit` is least, where it is determined.
fn determined(merit: impl Fn(f64) -> f64) -> Option<f64> {
    let (grid, merits) = spread(1.0, WIDEST, &merit);
    let least = (0..grid.len()).min_by(|&a, &b| merits[a].total_cmp(&merits[b]))?;
    // Ends of the range are no valley, and one around no factor gives none that is reported.
    if least == 0 || least + 1 == grid.len() || grid[least].ln().abs() < (REPORTED / STEP).ln() {
        return None;
    }
    let factor = between(grid[least] / STEP, grid[least] * STEP, &merit);
    let decoupled = merits[0].min(merits[merits.len() - 1]);
    (merit(factor) < decoupled - DETERMINED && factor.ln().abs() > REPORTED.ln()).then_some(factor)
}

/// The description with a factor for every torque, and how many times larger the logged torques are: a current or a share of the rated
/// torque has another factor on each joint. It takes the place of factors of some that were `found`, where free bodies explain the torques
/// no worse by it and the described ones clearly better. The ratios of the factors are those under free bodies, their common size
/// is that of the described ones.
pub(crate) fn of_all_joints(
    free: &Physics,
    bodies: &Physics,
    rows: &Rows,
    start: &Tried,
    found: &Tried,
) -> Option<(Tried, Vec<Option<f64>>)> {
    let given = &start.description;
    let whole = rows.whole();
    let takes_part = |joint: &usize| start.evaluation.unexplained[given.torque_of[*joint]].is_some();
    let joints: Vec<usize> = (0..given.dof()).filter(takes_part).collect();
    let with = |scales: &[f64]| given.with_scales(1.0, &scales.iter().map(|scale| 1.0 / scale).collect::<Vec<_>>());
    let mut scales = vec![1.0; given.dof()];
    let described = bodies.tables(&whole, given);
    for widest in [WIDEST, NEAR] {
        for &joint in &joints {
            scales[joint] = fitted(&described, &whole, &with, &scales, joint, widest)?;
        }
    }
    let tables = free.tables(&whole, given);
    for _ in 0..ROUNDS {
        for &joint in &joints {
            scales[joint] = fitted(&tables, &whole, &with, &scales, joint, NEAR)?;
        }
    }
    let of_shared = |shared: f64| scales.iter().map(|scale| scale * shared).collect::<Vec<f64>>();
    let shared = |shared: f64| merit(&described, &whole, &with(&of_shared(shared)));
    let scales = of_shared(best(1.0, NEAR, shared)?);
    // Bodies that are not like the torques know no size.
    let of_bodies = Tried::new(bodies, rows, with(&scales)).filter(|tried| tried.share() < ALIKE)?;
    let found_by_bodies = Tried::new(bodies, rows, found.description.clone())?;
    let gain_of_bodies = compare(&found_by_bodies.evaluation, &of_bodies.evaluation, &rows.log)?;
    let mut sizes: Vec<f64> = joints.iter().map(|&joint| scales[joint]).collect();
    sizes.sort_by(f64::total_cmp);
    let factors: Vec<f64> = scales.iter().map(|scale| 1.0 / scale).collect();
    let mut all = given.with_scales(1.0 / sizes[sizes.len() / 2], &factors);
    all.scale_is_partial = joints.len() < given.dof();
    let after = Tried::new(free, rows, all)?;
    let gain = compare(&start.evaluation, &after.evaluation, &rows.log)?;
    let over_found = compare(&found.evaluation, &after.evaluation, &rows.log)?;
    let explained = after.evaluation.unexplained.iter().flatten().all(|share| *share < EXPLAINED);
    let known = |joint: usize| joints.contains(&joint).then(|| factors[joint]);
    let better = gain.is_better(1, EXPLAINED) && gain.is_large(1) && over_found.gain > 0.0;
    (explained && better && gain_of_bodies.is_large(joints.len() - 1))
        .then(|| (after, (0..given.dof()).map(known).collect()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A valley of this depth at a factor, whose walls rise to a plateau.
    fn valley(at: f64, depth: f64) -> impl Fn(f64) -> f64 {
        move |factor: f64| depth * ((factor / at).ln().abs() / 2.0).min(1.0)
    }

    #[test]
    fn a_factor_is_one_that_fits_better_than_no_coupling_beyond_what_is_reported() {
        let found = |at: f64, depth: f64| determined(valley(at, depth));
        for at in [2.2, 80.0, 0.45, 0.01] {
            let factor = found(at, 1.0).unwrap();
            assert!((factor / at).ln().abs() < 0.02, "{factor} {at}");
        }
        assert_eq!([found(1.9, 1.0), found(0.55, 1.0), found(1.0, 1.0)], [None; 3]);
        // A shallow valley, and one at the end of the range.
        assert!(found(80.0, 0.55).is_some() && found(80.0, 0.45).is_none());
        assert_eq!(found(1e6, 1.0), None);
    }
}
