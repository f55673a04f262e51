//! Torques of another scale than that of the described bodies, which may be wrong besides: a sign, a mounting, exchanged columns.
//!
//! Free bodies know nothing of a factor that all joints share, and little of one for each. What they see of several is a factor of the
//! joint that differs most; together with those described they show them all. A further fault hides factors, and factors hide it: so the
//! scale is judged again under what free bodies found, and under what bodies show whose torques every joint has in a unit of its own.

use super::bodies::compensation;
use super::change::{Change, Description, along_axes};
use super::compare::{EXPLAINED, compare};
use super::fitting::{Physics, Rows};
use super::known::Known;
use super::search::search;
use super::shares::{ALIKE, WRONG_MASSES};
use super::sizes::factors::{self, OwnFactors};
use super::sizes::scale::{self, Scaled};
use super::sizes::unequal;
use super::tried::Tried;
use super::verdict::Alternative;
use crate::robot::Robot;

/// Descriptions whose scale is judged at most: as given, and two others.
const JUDGED: usize = 3;

/// Torques of another scale.
pub(super) struct OtherScales {
    /// The logs as they are.
    pub before: Tried,
    /// With the factors, and what is wrong besides.
    pub after: Tried,
    /// How many times larger each logged torque is; one factor where all share it.
    pub factors: Vec<Option<f64>>,
    /// What may be wrong besides in its place.
    pub alternatives: Vec<Alternative>,
}

/// What the scale is judged by.
pub(super) struct Scales<'a> {
    pub robot: &'a Robot,
    pub free: &'a Physics,
    pub bodies: &'a Physics,
    pub rows: &'a Rows,
    pub with_motion: &'a [bool],
}

/// The scale under one description.
struct Own {
    scales: OtherScales,
    /// Under the described bodies.
    described: Tried,
}

impl Scales<'_> {
    /// The scale of the torques, where it is another. `start` are the logs as they are and `found` what free bodies found wrong with them.
    pub(super) fn judge(&self, start: &Tried, found: Option<&Tried>) -> Option<OtherScales> {
        let under = |description: &Description| Tried::new(self.bodies, self.rows, description.clone());
        // Other changes that the described bodies deny do not stand for a scale.
        let denied = |best: &Tried| under(&best.description).is_none_or(|tried| tried.share() >= ALIKE);
        let is_denied = found.is_some_and(denied);
        let only_factors = found.is_none_or(|best| best.description.has_only_factors()) || is_denied;
        // What free bodies see of all torques is their sign.
        let signed = found.filter(|best| best.description.changes == [Change::AllTorqueSigns]);
        let first = only_factors.then(|| self.of_all(&signed.unwrap_or(start).description)).flatten();
        let first = first.or_else(|| self.of_each(start, found.unwrap_or(start)));
        if first.is_none() && !is_denied {
            return self.mounted_otherwise(start, found.unwrap_or(start));
        }
        let besides = found.filter(|best| is_denied && best.description.scaled().next().is_none());
        let besides = besides.map(|best| (best.description.clone(), Vec::new()));
        let by_multiples = self
            .by_multiples(&start.description)
            .filter(|(own, _)| besides.as_ref().is_none_or(|(other, _)| !other.same_as(own)));
        let others = besides.into_iter().chain(by_multiples);
        let others = others.filter_map(|(description, alternatives)| self.with(start, &description, alternatives));
        let best = others.min_by(|a, b| a.described.share().total_cmp(&b.described.share()));
        match (first, best) {
            (Some(first), Some(best)) => {
                let is_clear = self.is_clear(&first.described, &best);
                Some(if is_clear { best } else { first }.scales)
            }
            (None, None) => self.mounted_otherwise(start, found.unwrap_or(start)),
            (first, best) => Some(first.or(best)?.scales),
        }
    }

    /// Whether a scale explains the torques clearly better than what was `found` before, both under the described bodies.
    fn is_clear(&self, found: &Tried, own: &Own) -> bool {
        let gain = compare(&found.evaluation, &own.described.evaluation, &self.rows.log);
        gain.is_some_and(|gain| gain.is_better(JUDGED, EXPLAINED) && gain.is_large(1))
    }

    /// The scale with gravity along another axis of the base, where what was `found` leaves much under the described bodies: of an arm that
    /// hangs no torque is alike before both are put right, and free bodies may see neither.
    fn mounted_otherwise(&self, start: &Tried, found: &Tried) -> Option<OtherScales> {
        let described = Tried::new(self.bodies, self.rows, found.description.clone())?;
        let size = start.description.gravity.norm();
        if described.share() <= WRONG_MASSES || size == 0.0 {
            return None;
        }
        let mounted = along_axes([-size, size]).map(|gravity| start.description.with(Change::Gravity(gravity)));
        let others = mounted.filter(|own| !own.same_as(&start.description));
        let others = others.filter_map(|description| self.with(start, &description, Vec::new()));
        let best = others.min_by(|a, b| a.described.share().total_cmp(&b.described.share()))?;
        self.is_clear(&described, &best).then_some(best.scales)
    }

    /// The scale again under what was found with one scale, a mounting or another change, that hid others: where it explains the torques
    /// clearly better.
    pub(super) fn again(&self, start: &Description, found: &Description) -> Option<OtherScales> {
        let others = found.without_scales();
        if found.scaled().next().is_none() || others.same_as(start) {
            return None;
        }
        let start = Tried::new(self.free, self.rows, start.clone())?;
        let before = Tried::new(self.bodies, self.rows, found.clone())?;
        let own = self.with(&start, &others, Vec::new())?;
        self.is_clear(&before, &own).then_some(own.scales)
    }

    /// The scale under a changed description, which free bodies with the factors must show to be clearly better than the logs as they are.
    fn with(&self, start: &Tried, description: &Description, alternatives: Vec<Alternative>) -> Option<Own> {
        let own = Tried::new(self.free, self.rows, description.clone())?;
        let Own { scales, described } = self.of_all(description).or_else(|| self.of_each(&own, &own))?;
        let free = Tried::new(self.free, self.rows, scales.after.description.clone())?;
        let gain = compare(&start.evaluation, &free.evaluation, &self.rows.log)?;
        let before = Tried::new(self.bodies, self.rows, start.description.clone())?;
        let shown = gain.is_better(JUDGED, EXPLAINED) && gain.is_large(1);
        shown.then_some(Own { scales: OtherScales { before, alternatives, ..scales }, described })
    }

    /// What is wrong besides, with what else it may be, as bodies show it whose torques every joint has in a unit of its own.
    fn by_multiples(&self, start: &Description) -> Option<(Description, Vec<Alternative>)> {
        let multiples = Physics::multiples(self.robot)?;
        let found = search(Known::alone(&multiples), self.rows, self.with_motion, start.clone())?.found?;
        Some((found.best.description, found.rivals.into_iter().map(Tried::alternative).collect()))
    }

    /// The scale that all torques share, or each has, where no controller took gravity off: torques without it are small against those of
    /// the bodies, too.
    fn of_all(&self, start: &Description) -> Option<Own> {
        let Scaled { before, after, factors, each } = scale::judge(self.bodies, self.rows, start)?;
        let weightless = Tried::new(self.bodies, self.rows, start.with(Change::WithoutGravity));
        let compensated = self.compensated(start, &factors);
        let worse = |weightless: Tried| {
            compare(&weightless.evaluation, &after.evaluation, &self.rows.log).is_some_and(|gain| gain.is_distinct())
        };
        if !weightless.into_iter().chain(compensated).all(worse) {
            return None;
        }
        let unequal = |shared: f64| unequal::of_joints([self.free, self.bodies], self.rows, start, shared, &each);
        let (after, factors) = match factors[..] {
            [Some(shared)] if start.dof() > 1 => unequal(shared).unwrap_or((after, factors)),
            _ => (after, factors),
        };
        let described = Tried::new(self.bodies, self.rows, after.description.clone())?;
        Some(Own { scales: OtherScales { before, after, factors, alternatives: Vec::new() }, described })
    }

    /// The logs without the gravity of the described bodies, whatever these weigh, where torques are smaller than those of the bodies: to
    /// masses that are free, larger ones are heavier bodies.
    fn compensated(&self, start: &Description, factors: &[Option<f64>]) -> Option<Tried> {
        let are_small = factors.iter().flatten().all(|factor| *factor < 1.0);
        are_small.then(|| compensation::of_masses(self.robot, self.rows, start)).flatten()
    }

    /// Factors of the torques one by one.
    fn of_each(&self, start: &Tried, found: &Tried) -> Option<Own> {
        let OwnFactors { after, factors } = factors::of_joints(self.free, self.bodies, self.rows, start, found)?;
        let described = Tried::new(self.bodies, self.rows, after.description.clone())?;
        if let Some(compensated) = self.compensated(&start.description, &factors) {
            let gain = compare(&compensated.evaluation, &described.evaluation, &self.rows.log)?;
            gain.is_distinct().then_some(())?;
        }
        let before = Tried::new(self.free, self.rows, start.description.clone())?;
        Some(Own { scales: OtherScales { before, after, factors, alternatives: Vec::new() }, described })
    }
}
