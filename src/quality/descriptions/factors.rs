//! Factors by which the torques of single joints differ from those of the others: a current, per cent of a rated torque, the motor
//! side of one gear.
//!
//! The bodies beyond a joint act on the joints before it too, so that the torques of neighbours contain the same parameters. With
//! free bodies this gives the ratio of their scales, whatever the bodies are: no wrong mass explains it. Most joints are taken to be
//! right, unless the described bodies say otherwise.

use super::change::{Change, Description};
use super::compare::compare;
use super::fitting::{Fit, Physics, Rows, Tables};
use super::scale::{ALIKE, best};
use super::search::CLEAN;
use super::tried::Tried;

/// Some joint must have a factor beyond this: drives, gears and described bodies are up to twice from what files say.
const UNLIKELY: f64 = 3.0;

/// Where one has, factors of other joints are told from this on.
const TOLD: f64 = 1.25;

/// Described bodies are wrong by as much: a shared factor below it is that of the joint in the middle.
const UNEQUAL: f64 = 2.0;

/// Rounds over the joints, at most: a factor changes what the neighbours' are.
const ROUNDS: usize = 8;

/// Rounds end where no factor changes by more, as a logarithm.
const SETTLED: f64 = 0.02;

/// A torque with another factor is explained to this share.
const EXPLAINED: f64 = 0.2;

/// The description as it is and with the factors, where some joints clearly have one of their own.
pub fn judge(free: &Physics, bodies: Option<&Physics>, rows: &Rows, start: &Description) -> Option<(Tried, Tried)> {
    let before = Tried::new(free, rows, start.clone())?;
    let takes_part = |joint: &usize| before.evaluation.unexplained[start.torque_of[*joint]].is_some();
    let joints: Vec<usize> = (0..start.dof()).filter(takes_part).collect();
    let clean = before.evaluation.unexplained.iter().flatten().all(|share| *share < CLEAN);
    if joints.len() < 2 || clean {
        return None;
    }
    let mut factors = relative(&free.tables(rows, start), rows, start, &joints)?;
    let shared = shared(&factors, bodies, rows, start, &joints)?;
    factors.iter_mut().for_each(|factor| *factor /= shared);
    let beyond = |own: &[usize], least: f64| -> Vec<usize> {
        own.iter().copied().filter(|&joint| factors[joint].ln().abs() > least.ln()).collect()
    };
    if beyond(&joints, UNLIKELY).is_empty() {
        return None;
    }
    let mut own = beyond(&joints, TOLD);
    let described = |own: &[usize]| {
        let with = |description: Description, &joint: &usize| {
            description.with(Change::JointScale(joint, 1.0 / factors[joint]))
        };
        Tried::new(free, rows, own.iter().fold(start.clone(), with))
    };
    // A factor that the torques do not need is left out.
    let all = described(&own)?;
    let needed = |joint: &usize| {
        let others: Vec<usize> = own.iter().copied().filter(|other| other != joint).collect();
        let without = described(&others)?;
        Some(compare(&without.evaluation, &all.evaluation, &rows.log)?.is_distinct())
    };
    let needed: Vec<bool> = own.iter().map(|joint| needed(joint).unwrap_or(false)).collect();
    let mut each = needed.iter();
    own.retain(|_| each.next() == Some(&true));
    let after = described(&own).filter(|_| !beyond(&own, UNLIKELY).is_empty())?;
    let gain = compare(&before.evaluation, &after.evaluation, &rows.log)?;
    let explained =
        |&joint: &usize| after.evaluation.unexplained[start.torque_of[joint]].is_some_and(|s| s < EXPLAINED);
    (gain.is_better(start.dof()) && gain.is_large(1) && own.iter().all(explained)).then_some((before, after))
}

/// Factors with which free bodies explain all torques best; only their ratios are known.
fn relative(tables: &Tables, rows: &Rows, start: &Description, joints: &[usize]) -> Option<Vec<f64>> {
    let mut factors = vec![1.0; start.dof()];
    for _ in 0..ROUNDS {
        let mut changed: f64 = 0.0;
        for &joint in joints {
            let merit = |factor: f64| {
                let mut factors = factors.clone();
                factors[joint] = factor;
                Fit::new(tables, rows, &start.with_scales(1.0, &factors)).merit().unwrap_or(f64::INFINITY)
            };
            let factor = best(factors[joint], merit)?;
            changed = changed.max((factor / factors[joint]).ln().abs());
            factors[joint] = factor;
        }
        if changed < SETTLED {
            break;
        }
    }
    Some(factors)
}

/// What the factors share: that of the joint in the middle, unless described bodies explain the torques with quite another one.
fn shared(
    factors: &[f64],
    bodies: Option<&Physics>,
    rows: &Rows,
    start: &Description,
    joints: &[usize],
) -> Option<f64> {
    let mut sorted: Vec<f64> = joints.iter().map(|&joint| factors[joint]).collect();
    sorted.sort_by(f64::total_cmp);
    let middle = sorted.get(sorted.len() / 2).copied()?;
    let of_bodies = || {
        let bodies = bodies?;
        let tables = bodies.tables(rows, start);
        let with = |shared: f64| {
            let scaled: Vec<f64> = factors.iter().map(|factor| factor / shared).collect();
            start.with_scales(1.0, &scaled)
        };
        let merit = |shared: f64| Fit::new(&tables, rows, &with(shared)).merit().unwrap_or(f64::INFINITY);
        let shared = best(1.0, merit)?;
        (Tried::new(bodies, rows, with(shared))?.share() < ALIKE).then_some(shared)
    };
    Some(of_bodies().filter(|shared| (shared / middle).ln().abs() > UNEQUAL.ln()).unwrap_or(middle))
}
