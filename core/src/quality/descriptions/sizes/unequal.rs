//! Factors of torques that differ a little from joint to joint: motors behind unlike gears.
//!
//! Gears of one arm have 50 and 120 turns for the most part. To described bodies, whose masses may be wrong by as much, one factor of all
//! torques explains them well enough. Free bodies show the ratios, whatever the bodies weigh: torques of neighbours hold the same parameters.

use super::super::change::Description;
use super::super::compare::{DISTINCT, EXPLAINED, compare};
use super::super::fitting::{Physics, Rows};
use super::super::tried::Tried;
use super::scale::{BOUNDED, best, merit};

/// Ratios to the shared factor are looked for within this: a joint farther from it has its own already.
const NEAR: f64 = 3.0;

/// Rounds over the joints, which share the bodies.
const ROUNDS: usize = 3;

/// The factors of the torques one by one, how many times larger each is, with the logs as they are then explained: where free bodies explain
/// the torques clearly better by them than by the one that is `shared`, and either the gain is large under these, or under the described
/// ones too. `of_bodies` are the factors that the described bodies have by themselves.
pub(crate) fn of_joints(
    [free, bodies]: [&Physics; 2],
    rows: &Rows,
    start: &Description,
    shared: f64,
    of_bodies: &[f64],
) -> Option<(Tried, Vec<Option<f64>>)> {
    let whole = rows.whole();
    let with = |ratios: &[f64]| {
        let factors: Vec<f64> = ratios.iter().map(|ratio| shared * ratio).collect();
        start.with_scales(shared, &factors)
    };
    let tables = free.tables(&whole, start);
    let joints: Vec<usize> = (0..start.dof()).filter(|&joint| rows.measured[start.torque_of[joint]]).collect();
    let merit_of = |ratios: &[f64], joint: usize, ratio: f64| {
        let mut ratios = ratios.to_vec();
        ratios[joint] = ratio;
        merit(&tables, &whole, &with(&ratios))
    };
    let refined = |mut ratios: Vec<f64>| {
        for &joint in joints.iter().cycle().take(ROUNDS * joints.len()) {
            ratios[joint] = best(ratios[joint], NEAR, |ratio| merit_of(&ratios, joint, ratio))?;
        }
        Some(ratios)
    };
    // Ratios that free bodies hardly determine, as those of a wrist, stay near those of the described ones where these are right.
    let equal = vec![1.0; start.dof()];
    let by_bodies = of_bodies.iter().map(|factor| factor / shared).collect();
    let refined = [equal.clone(), by_bodies].into_iter().filter_map(refined);
    let of_all = |ratios: &Vec<f64>| merit(&tables, &whole, &with(ratios));
    let ratios = refined.min_by(|a, b| of_all(a).total_cmp(&of_all(b)))?;
    let under = |physics: &Physics, ratios: &[f64]| Tried::new(physics, rows, with(ratios));
    let of_free = compare(&under(free, &equal)?.evaluation, &under(free, &ratios)?.evaluation, &rows.log)?;
    tracing::debug!(?ratios, gain = of_free.gain, p = of_free.p, channels = ?of_free.channels, "unequal factors");
    if !of_free.is_better(1, EXPLAINED) {
        return None;
    }
    let is_known = |joint: usize| {
        let ends = [ratios[joint] / NEAR, ratios[joint] * NEAR].map(|end| merit_of(&ratios, joint, end));
        joints.contains(&joint) && merit_of(&ratios, joint, ratios[joint]) < ends[0].min(ends[1]) - BOUNDED
    };
    let known: Vec<bool> = (0..start.dof()).map(is_known).collect();
    // The size that all share is that of the described bodies.
    let described = bodies.tables(&whole, start);
    let times = |size: f64| ratios.iter().map(|ratio| size * ratio).collect::<Vec<f64>>();
    let size = best(1.0, NEAR, |size| merit(&described, &whole, &with(&times(size))))?;
    let ratios = times(size);
    let mut description = with(&ratios);
    description.scale_is_partial = known.contains(&false);
    let after = Tried::new(bodies, rows, description)?;
    let of_bodies = compare(&under(bodies, &equal)?.evaluation, &after.evaluation, &rows.log)?;
    tracing::debug!(?ratios, gain = of_bodies.gain, p = of_bodies.p, channels = ?of_bodies.channels, "unequal factors of described bodies");
    let by_both = of_bodies.is_better(1, EXPLAINED) && of_bodies.is_large(1);
    let is_no_worse = of_bodies.gain > -2.0 * DISTINCT.ln();
    let factor = |joint: usize| known[joint].then_some(shared * ratios[joint]);
    (by_both || (of_free.is_large(1) && is_no_worse)).then(|| (after, (0..start.dof()).map(factor).collect()))
}
