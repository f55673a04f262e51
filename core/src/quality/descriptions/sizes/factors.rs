//! Factors of the torques of single joints: a gear left out, a current, a share of the rated torque.
//!
//! The bodies beyond a joint act on the joints before it too, so that the torques of neighbours contain the same parameters. Under free
//! bodies this gives the ratio of their scales, whatever the bodies are: no wrong mass explains it. Which torques have a factor is
//! decided by the number of changes: one torque is wrong before five are.

use super::super::change::{Change, Description};
use super::super::compare::{EXPLAINED, compare};
use super::super::fitting::{Physics, Rows, Tables};
use super::super::shares::{ALIKE, WRONG_MASSES};
use super::super::tried::Tried;
use super::scale::{BOUNDED, PLAUSIBLE, STEP, best, between, differ, merit, spread, without_load};

/// Factors below it are not reported: torque constants, gears and described bodies differ from those of files by up to a factor of two.
pub(crate) const REPORTED: f64 = 2.0;

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
/// beyond what is reported; `start` is what is known already.
pub(crate) fn of_single_joints(
    physics: &Physics,
    rows: &Rows,
    from: &Description,
    start: &Description,
) -> Vec<Description> {
    // Nothing joins the torques of joints by themselves. And a factor takes a torque that no model explains out of the fit of the others:
    // together with another change it explains too much, but for the sign of all, which takes no torque out.
    let adds_others = from.other_than_scales_and_signs() != start.other_than_scales_and_signs();
    if matches!(physics, Physics::Alone | Physics::Multiples(_)) || from.dof() < 2 || adds_others {
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

/// The factor beyond what is reported under which `merit` is least, where it is determined. A torque that is too small for described bodies
/// by an amount that does not show is none: a balancer takes as much.
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

/// Torques with factors of their own.
pub(crate) struct OwnFactors {
    /// The description with the factors.
    pub after: Tried,
    /// How many times larger each logged torque is.
    pub factors: Vec<Option<f64>>,
}

/// The factors of the torques, where they differ by more than masses make: a current or a share of the rated torque has another on each
/// joint, and one drive may have another gear. They take the place of what was `found`, where described bodies explain the torques clearly
/// better by them, and free ones no worse.
pub(crate) fn of_joints(
    free: &Physics,
    bodies: &Physics,
    rows: &Rows,
    start: &Tried,
    found: &Tried,
) -> Option<OwnFactors> {
    let given = &start.description;
    let whole = rows.whole();
    let described = bodies.tables(&whole, given);
    let alone = without_load(&described, rows);
    let scaled = found.description.scaled().count();
    if scaled == 0 && !differ(&alone) {
        return None;
    }
    let search = Search { free, bodies, rows, whole: &whole, described: &described, start, found };
    search.of_all(&alone)
}

/// What the search for the factors of several torques asks.
struct Search<'a> {
    free: &'a Physics,
    bodies: &'a Physics,
    rows: &'a Rows,
    whole: &'a Rows,
    /// Tables of all rows under the described bodies.
    described: &'a Tables,
    start: &'a Tried,
    found: &'a Tried,
}

impl Search<'_> {
    /// A factor for every torque. The ratios are those under free bodies where these determine them, the common size is that of the
    /// described ones.
    fn of_all(&self, alone: &[Option<f64>]) -> Option<OwnFactors> {
        let given = &self.start.description;
        let of_start = Tried::new(self.bodies, self.rows, given.clone())?;
        let takes_part = |joint: &usize| of_start.evaluation.unexplained[given.torque_of[*joint]].is_some();
        let joints: Vec<usize> = (0..given.dof()).filter(takes_part).collect();
        let with = |scales: &[f64]| given.with_scales(1.0, &scales.iter().map(|scale| 1.0 / scale).collect::<Vec<_>>());
        // A load hides the factors of a wrist, and a rough start those of others.
        let rough: Vec<f64> = alone.iter().map(|factor| factor.map_or(1.0, |factor| 1.0 / factor.abs())).collect();
        let mut scales = vec![1.0; given.dof()];
        let of = |scales: &[f64]| merit(self.described, self.whole, &with(scales));
        for widest in [WIDEST, NEAR] {
            for &joint in &joints {
                scales[joint] = fitted(self.described, self.whole, &with, &scales, joint, widest)?;
            }
        }
        let mut from_alone = rough;
        for &joint in joints.iter().cycle().take(ROUNDS * joints.len()) {
            let widest = if alone[joint].is_some() { NEAR } else { WIDEST };
            from_alone[joint] = fitted(self.described, self.whole, &with, &from_alone, joint, widest)?;
        }
        if of(&from_alone) < of(&scales) {
            scales = from_alone;
        }
        let tables = self.free.tables(self.whole, given);
        let mut ratios = scales.clone();
        for &joint in joints.iter().cycle().take(ROUNDS * joints.len()) {
            ratios[joint] = fitted(&tables, self.whole, &with, &ratios, joint, NEAR)?;
        }
        // Joints that move in turns determine no ratios.
        let under_free = |scales: &[f64]| Tried::new(self.free, self.rows, with(scales));
        let gain = compare(&under_free(&scales)?.evaluation, &under_free(&ratios)?.evaluation, &self.rows.log);
        if gain.is_some_and(|gain| gain.is_distinct()) {
            let of_shared = |shared: f64| ratios.iter().map(|scale| scale * shared).collect::<Vec<f64>>();
            let shared = best(1.0, NEAR, |shared| of(&of_shared(shared)))?;
            scales = of_shared(shared);
        }
        let mut sizes: Vec<f64> = joints.iter().map(|&joint| scales[joint]).collect();
        sizes.sort_by(f64::total_cmp);
        // A torque without bound to its factor has no part in the bodies: those of another arm come apart so.
        if sizes[0] < 1.0 / WIDEST || sizes[sizes.len() - 1] > WIDEST {
            return None;
        }
        // Of torques that are friction for the most part the factors are not known well enough to deny the masses.
        let mut known: Vec<f64> =
            joints.iter().filter(|&&joint| alone[joint].is_some()).map(|&joint| scales[joint]).collect();
        known.sort_by(f64::total_cmp);
        // A single one may be a body that is described wrongly.
        let is_beyond_masses = match known[..] {
            [least, second, .., last, most] => last > PLAUSIBLE * least || most > PLAUSIBLE * second,
            _ => false,
        };
        let factors: Vec<f64> = scales.iter().map(|scale| 1.0 / scale).collect();
        let mut all = given.with_scales(1.0 / sizes[sizes.len() / 2], &factors);
        // A torque that is friction for the most part fits with any; one whose sign is wrong does before that is found.
        let is_known = |joint: usize| {
            let times = |factor: f64| {
                let mut scales = scales.clone();
                scales[joint] *= factor;
                of(&scales)
            };
            let is_opposite = alone[joint].is_some_and(|factor| factor < 0.0);
            let is_bounded = || times(1.0) < times(NEAR).min(times(1.0 / NEAR)) - BOUNDED;
            joints.contains(&joint) && (is_opposite || is_bounded())
        };
        all.scale_is_partial = !(0..given.dof()).all(is_known);
        let after = self.accepted(all, joints.len() - 1, is_beyond_masses)?;
        // Those that wrong masses make are none.
        let reported = |&joint: &usize| scales[joint].ln().abs() > REPORTED.ln() && is_known(joint);
        let beyond: Vec<usize> = joints.iter().copied().filter(reported).collect();
        if !beyond.is_empty() && 2 * beyond.len() < joints.len() {
            let mut few = vec![1.0; given.dof()];
            beyond.iter().for_each(|&joint| few[joint] = scales[joint]);
            for &joint in beyond.iter().cycle().take(ROUNDS * beyond.len()) {
                few[joint] = fitted(&tables, self.whole, &with, &few, joint, NEAR)?;
            }
            let single =
                |description: Description, &joint: &usize| description.with(Change::JointScale(joint, few[joint]));
            let few = Tried::new(self.free, self.rows, beyond.iter().fold(given.clone(), single))?;
            if !compare(&few.evaluation, &after.evaluation, &self.rows.log).is_some_and(|gain| gain.is_distinct()) {
                return Some(OwnFactors { after: few, factors: Vec::new() });
            }
        }
        let known = |joint: usize| is_known(joint).then(|| factors[joint]);
        Some(OwnFactors { after, factors: (0..given.dof()).map(known).collect() })
    }

    /// A description with so many factors under free bodies, where they are clearly better under the described ones, and either free bodies
    /// show it too, or no masses make such factors.
    fn accepted(&self, description: Description, factors: usize, is_beyond_masses: bool) -> Option<Tried> {
        let under = |description: &Description| Tried::new(self.bodies, self.rows, description.clone());
        // Bodies that are not like the torques know no size.
        let of_bodies = under(&description).filter(|tried| tried.share() < ALIKE)?;
        let log = &self.rows.log;
        let gain = |from: &Tried, to: &Tried| compare(&from.evaluation, &to.evaluation, log);
        let changes = factors.saturating_sub(self.found.description.changes.len()).max(1);
        let over_start = gain(&under(&self.start.description)?, &of_bodies)?;
        let over_found = gain(&under(&self.found.description)?, &of_bodies)?;
        let after = Tried::new(self.free, self.rows, description)?;
        let explained = after.evaluation.unexplained.iter().flatten().all(|share| *share < EXPLAINED);
        let of_free = gain(self.start, &after)?;
        let shown = of_free.is_better(1, EXPLAINED) && of_free.is_large(1) && explained;
        let over_free = gain(self.found, &after)?;
        let no_worse = !gain(&after, self.start).is_some_and(|loss| loss.is_distinct());
        let clearly = match shown && over_free.gain > 0.0 {
            true => true,
            false => {
                let better = over_start.is_better(self.described.joints.len(), EXPLAINED);
                is_beyond_masses && no_worse && better && over_start.is_large_beyond(WRONG_MASSES)
            }
        };
        (clearly && over_start.is_large_in_all(changes) && over_found.is_large_in_all(changes)).then_some(after)
    }
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
        // A torque that is too small for its bodies, by how much does not show.
        let open = |factor: f64| if factor < 4.0 { 1.0 } else { 0.05 * (factor / 90.0_f64).ln().abs().min(1.0) };
        assert_eq!(determined(open), None);
    }
}
