//! Sets of changes that the logs do not separate, compared by what else is known of the arm.

use super::compare::compare;
use super::fitting::{Physics, Rows};
use super::search::{Found, Outcome};
use super::sizes::ALIKE;
use super::tried::Tried;

/// Positions leave the limits from this on, rad (m): zeros of calibrated joints are known better.
const LEAVES: f64 = 0.1;

/// An outcome whose rivals are compared by the limits of the joints, and under the described bodies where these explain the torques.
pub(super) fn settled(bodies: Option<&Physics>, rows: &Rows, mut outcome: Outcome) -> Outcome {
    outcome.found = outcome.found.take().map(|found| within_limits(rows, found));
    outcome.found = match bodies {
        Some(bodies) => outcome.found.map(|found| under_bodies(bodies, rows, found)),
        None => outcome.found,
    };
    outcome
}

/// Those of the rivals under which the fewest joints leave their limits.
fn within_limits(rows: &Rows, found: Found) -> Found {
    let outside = |tried: &Tried| {
        let positions = tried.description.positions(&rows.motion.q);
        let leaves = |joint: &usize| rows.beyond_limits(*joint, positions.channel(*joint)) > LEAVES;
        (0..tried.description.dof()).filter(leaves).count()
    };
    let each: Vec<usize> = std::iter::once(&found.best).chain(&found.rivals).map(outside).collect();
    let least = each.iter().copied().min().unwrap_or(0);
    let best = each.iter().position(|outside| *outside == least).unwrap_or(0);
    found.of(best, |place| each[place] > least)
}

/// Those of the rivals that are not clearly worse under the described bodies.
fn under_bodies(bodies: &Physics, rows: &Rows, found: Found) -> Found {
    let under = |tried: &Tried| Tried::new(bodies, rows, tried.description.clone());
    let each: Option<Vec<Tried>> = std::iter::once(&found.best).chain(&found.rivals).map(under).collect();
    let Some(each) = each else { return found };
    let least = (0..each.len()).min_by(|&a, &b| each[a].share().total_cmp(&each[b].share()));
    let Some(least) = least.filter(|&least| each[least].share() < ALIKE) else { return found };
    let best = &each[least].evaluation;
    let worse = |place: usize| {
        compare(&each[place].evaluation, best, &rows.log).is_some_and(|comparison| comparison.is_distinct())
    };
    found.of(least, |place| place != least && worse(place))
}

impl Found {
    /// The same with another best, counted from the present one on, without the rivals that are worse.
    fn of(self, best: usize, worse: impl Fn(usize) -> bool) -> Found {
        let Found { best: first, rivals, mut next, gain } = self;
        let mut each: Vec<(usize, Tried)> = std::iter::once(first).chain(rivals).enumerate().collect();
        let (_, best) = each.remove(best);
        let mut rivals = Vec::new();
        for (place, other) in each {
            match worse(place) {
                true => next = Some(next.filter(|next| next.share() < other.share()).unwrap_or(other)),
                false => rivals.push(other),
            }
        }
        Found { best, rivals, next, gain }.simplest_first()
    }
}
