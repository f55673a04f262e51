//! Sets of changes that the logs do not separate, compared by what else is known of the arm.

use super::found::Found;
use super::smallest::Outcome;
use super::usual_zeros::with_usual_zeros;
use crate::quality::descriptions::change::{Change, Description};
use crate::quality::descriptions::compare::{EXPLAINED, compare};
use crate::quality::descriptions::fitting::{Physics, Rows};
use crate::quality::descriptions::known::Known;
use crate::quality::descriptions::shares::{ALIKE, WRONG_MASSES};
use crate::quality::descriptions::sizes::{tilt, zeros};
use crate::quality::descriptions::tried::Tried;
use crate::quality::descriptions::weights;
use crate::robot::Robot;

/// Described bodies are those of the torques where they leave no more than so many times what free ones do: centres of mass that are off by
/// centimetres turn the weight of a link as zeros do, and zeros of two axes make up for a part of any wrong bodies. Under bodies that are
/// right both leave the same, and those that are wrong by a twentieth half as much again.
const LIKE_FREE: f64 = 1.5;

/// Centres of mass are off by so much, m: a torque that is no more than the weight which its joint carries over that length shows no zero.
const CENTER_OFF: f64 = 0.01;

/// Positions leave the limits from this on, rad (m): zeros of calibrated joints are known better.
const LEAVES: f64 = 0.1;

/// A direction of gravity is replaced by one near it that the described bodies prefer where these leave less of the torques by this share.
const ABOUT: f64 = 0.03;

/// An outcome with all directions of gravity that the mechanism does not separate, whose rivals are compared by the limits of the joints,
/// under the described bodies where these explain the torques, and by the weights that drives would carry. `known` is what the search knew.
pub(in crate::quality::descriptions) fn settled(
    known: Known,
    bodies: Option<&Physics>,
    rows: &Rows,
    mut outcome: Outcome,
) -> Outcome {
    outcome.found = outcome.found.take().map(|found| {
        let found = with_usual_zeros(known.physics, bodies, rows, found);
        let mut found = within_limits(rows, with_directions(known.physics, rows, found));
        let Some(bodies) = bodies else { return found };
        if let Some(core) = in_common(known, bodies, rows, &outcome.start, &found) {
            found = with_directions(known.physics, rows, core);
        }
        if !std::ptr::eq(bodies, known.physics) {
            found = with_zeros_of(bodies, known.physics, rows, found);
            found = under_bodies(bodies, rows, with_directions_of(bodies, known.physics, rows, found));
        }
        by_weights(bodies, rows, found)
    });
    outcome
}

/// What the best and all its rivals have in common, where the described bodies explain the torques with that alone, and no clearly better
/// with the rest: changes of which each may stand for another explain what the model lacks.
fn in_common(known: Known, bodies: &Physics, rows: &Rows, start: &Tried, found: &Found) -> Option<Found> {
    let best = &found.best.description;
    let is_shared = |change: &&Change| {
        found.rivals.iter().all(|rival| match change {
            Change::Gravity(_) => tilt::has_direction_near(&rival.description, best),
            other => rival.description.changes.contains(other),
        })
    };
    let shared: Vec<Change> = best.changes.iter().filter(is_shared).copied().collect();
    if found.rivals.is_empty() || shared.is_empty() || shared.len() == best.changes.len() {
        return None;
    }
    let as_given = Description::as_given(best.dof(), start.description.gravity);
    let core = shared.into_iter().fold(as_given, |description, change| description.with(change));
    let [own, whole] = [&core, best].map(|description| Tried::new(bodies, rows, description.clone()));
    let (own, whole) = (own?, whole?);
    let is_better = compare(&own.evaluation, &whole.evaluation, &rows.log)?.is_distinct();
    if own.share() >= ALIKE || is_better {
        return None;
    }
    let best = Tried::new(known.physics, rows, core)?;
    let gain = compare(&start.evaluation, &best.evaluation, &rows.log)?;
    Some(Found { best, rivals: Vec::new(), next: None, gain, is_determined: true })
}

/// The same with other directions of gravity that explain the logs as well among the rivals. The logs determine none where these go on from
/// the best one; a direction elsewhere, as the opposite one, is an alternative.
fn with_directions(physics: &Physics, rows: &Rows, mut found: Found) -> Found {
    let others = tilt::along_the_valley(physics, &rows.whole(), &found.best.description);
    for other in others.into_iter().filter_map(|other| Tried::new(physics, rows, other)) {
        if compare(&other.evaluation, &found.best.evaluation, &rows.log).is_none_or(|worse| worse.is_distinct()) {
            continue;
        }
        found.is_determined &= !tilt::is_next_to(&other.description, &found.best.description);
        if !found.has_direction_of(&other) {
            found.rivals.push(other);
        }
    }
    found
}

/// Whether zeros that described bodies show, if there are any, are those of bodies that are described rightly: with them these leave about
/// as much of the torques as free ones do, and a torque gains that is more than centres of mass make which are a little off: these turn the
/// weight on a joint as its zero does. `found` is what was found under the described `bodies` of `robot`.
pub(in crate::quality::descriptions) fn are_of_bodies(
    (robot, bodies, free): (&Robot, &Physics, &Physics),
    rows: &Rows,
    start: &Description,
    found: &Tried,
) -> bool {
    if !found.description.changes.iter().any(|change| matches!(change, Change::ZeroOffset(..))) {
        return true;
    }
    let carried = |joint: usize| robot.joints[joint..].iter().map(|link| link.inertia.mass()).sum::<f64>();
    let shows = |joint: usize| {
        let heavy = rows.size[joint] > CENTER_OFF * robot.gravity.norm() * carried(joint);
        rows.measured[joint] && (heavy || !rows.turns[joint])
    };
    let before = Tried::new(bodies, rows, start.clone());
    let gain = before.and_then(|before| compare(&before.evaluation, &found.evaluation, &rows.log));
    if gain.is_none_or(|gain| !(0..robot.dof()).any(|joint| shows(joint) && gain.falls(joint))) {
        return false;
    }
    let by_free = |description: &Description| {
        Tried::new(free, rows, description.clone()).map_or(f64::INFINITY, |tried| tried.share())
    };
    // Free ones as they were given, too: what these explain worse is no zero.
    found.share() <= LIKE_FREE * by_free(start).min(by_free(&found.description))
}

/// Whether the factor of a single torque that described bodies show explains the torques clearly better than a torque which depends on that
/// joint's position alone: a spring or a balancer takes as much off as another unit does, and is no fault of the data. `found` is what was
/// found under the bodies of `robot`.
pub(in crate::quality::descriptions) fn is_beyond_position(robot: &Robot, rows: &Rows, found: &Tried) -> bool {
    let scaled: Vec<usize> = found.description.scaled().collect();
    let [joint] = scaled[..] else { return true };
    let sprung = Tried::new(&Physics::Sprung(Box::new(robot.clone()), joint), rows, found.description.without_scales());
    let gain = sprung.and_then(|sprung| compare(&sprung.evaluation, &found.evaluation, &rows.log));
    gain.is_none_or(|gain| gain.is_distinct())
}

/// The same with one more zero, where the described bodies explain the torques by that and not without it, and free ones no worse: of axes
/// that are parallel these see the sum of the zeros.
fn with_zeros_of(bodies: &Physics, free: &Physics, rows: &Rows, mut found: Found) -> Found {
    let best = &found.best;
    let under = |description: &Description| Tried::new(bodies, rows, description.clone());
    let has_zero = best.description.changes.iter().any(|change| matches!(change, Change::ZeroOffset(..)));
    if !has_zero || under(&best.description).is_none_or(|tried| tried.share() < ALIKE) {
        return found;
    }
    let others = zeros::of_single_joints(bodies, &rows.whole(), &best.description);
    let explained = others.iter().filter_map(under).filter(|tried| tried.share() < ALIKE);
    let Some(least) = explained.min_by(|a, b| a.share().total_cmp(&b.share())) else { return found };
    let own = Tried::new(free, rows, least.description)
        .filter(|own| compare(&own.evaluation, &best.evaluation, &rows.log).is_some_and(|worse| !worse.is_distinct()));
    if let Some(own) = own {
        found.best = own;
    }
    found
}

/// Zeros of two neighbours that make up for each other, where the described bodies explain the torques by them and far from that without,
/// and free ones no worse: these see the sum of the zeros of parallel axes, which is none.
/// `before` are the logs as they are under the described bodies.
pub(in crate::quality::descriptions) fn opposite_zeros(
    bodies: &Physics,
    free: &Physics,
    rows: &Rows,
    before: &Tried,
) -> Option<Found> {
    let under = |physics: &Physics, description: &Description| Tried::new(physics, rows, description.clone());
    let start = &before.description;
    let is_unlike = before.evaluation.unexplained.iter().flatten().any(|share| *share >= ALIKE);
    if before.share() < WRONG_MASSES && !is_unlike {
        return None;
    }
    let pairs = zeros::of_neighbours(bodies, &rows.whole(), start);
    let tried: Vec<Tried> = pairs.iter().filter_map(|pair| under(bodies, pair)).collect();
    let best = tried.into_iter().min_by(|a, b| a.share().total_cmp(&b.share()))?;
    let gain = compare(&before.evaluation, &best.evaluation, &rows.log)?;
    let changes = best.description.changes.len();
    let [own, other] = [under(free, &best.description)?, under(free, start)?];
    let is_worse = compare(&own.evaluation, &other.evaluation, &rows.log)?.is_distinct();
    let is_clear = gain.is_better(changes, EXPLAINED) && gain.is_large(changes) && best.share() < WRONG_MASSES;
    (is_clear && !is_worse).then_some(Found { best, rivals: Vec::new(), next: None, gain, is_determined: true })
}

/// The same with the directions of gravity that the described bodies prefer, where free ones determine none.
fn with_directions_of(bodies: &Physics, free: &Physics, rows: &Rows, mut found: Found) -> Found {
    if found.is_determined {
        return found;
    }
    let whole = rows.whole();
    let lowest = tilt::lowest(bodies, &whole, &found.best.description);
    let onward = lowest.iter().flat_map(|lowest| tilt::along_the_valley(bodies, &whole, lowest));
    let preferred: Vec<Description> = lowest.iter().cloned().chain(onward).collect();
    let share = |description: &Description| {
        Tried::new(bodies, rows, description.clone()).map_or(f64::INFINITY, |tried| tried.share())
    };
    for other in preferred {
        let Some(other) = Tried::new(free, rows, other) else { continue };
        if compare(&other.evaluation, &found.best.evaluation, &rows.log).is_none_or(|worse| worse.is_distinct()) {
            continue;
        }
        let is_near = |own: &&mut Tried| tilt::is_near(&own.description, &other.description);
        match std::iter::once(&mut found.best).chain(&mut found.rivals).find(is_near) {
            // What is along an axis stays where it is about as good.
            Some(known) if share(&known.description) > share(&other.description) + ABOUT => *known = other,
            Some(_) => {}
            None => found.rivals.push(other),
        }
    }
    found
}

/// Those of the rivals under which the drives of joints that slide need no constants beyond the weights on them, where others do; of those
/// left the one with the least in front.
fn by_weights(bodies: &Physics, rows: &Rows, found: Found) -> Found {
    if found.rivals.is_empty() {
        return found;
    }
    let each: Vec<Option<f64>> = std::iter::once(&found.best)
        .chain(&found.rivals)
        .map(|tried| weights::beyond_weight(bodies, rows, &tried.description))
        .collect();
    let Some(each) = each.into_iter().collect::<Option<Vec<f64>>>() else { return found };
    let Some(least) = (0..each.len()).min_by(|&a, &b| each[a].total_cmp(&each[b])) else { return found };
    let possible = each[least] < weights::OF_WEIGHT;
    found.of(least, |place| possible && each[place] >= weights::OF_WEIGHT)
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
    // Where free bodies determine no direction of gravity, its size on the joints is that of the described masses, which are wrong by a
    // fifth.
    let by_masses = |place: usize| {
        let is_another = tilt::is_another_direction(&each[place], &each[least]);
        !found.is_determined && is_another && each[place].share() < each[least].share() + WRONG_MASSES
    };
    let worse: Vec<bool> = (0..each.len())
        .map(|place| {
            let distinct = compare(&each[place].evaluation, best, &rows.log).is_some_and(|c| c.is_distinct());
            place != least && distinct && !by_masses(place)
        })
        .collect();
    found.of(least, |place| worse[place])
}

impl Found {
    /// Whether the best or a rival is nearly another description.
    fn has_direction_of(&self, other: &Tried) -> bool {
        let is_near = |own: &Tried| tilt::is_near(&own.description, &other.description);
        is_near(&self.best) || self.rivals.iter().any(is_near)
    }

    /// The same with another best, counted from the present one on, without the rivals that are worse.
    fn of(self, best: usize, worse: impl Fn(usize) -> bool) -> Found {
        let Found { best: first, rivals, mut next, gain, is_determined } = self;
        let mut each: Vec<(usize, Tried)> = std::iter::once(first).chain(rivals).enumerate().collect();
        let (_, best) = each.remove(best);
        let mut rivals = Vec::new();
        for (place, other) in each {
            match worse(place) {
                true => next = Some(next.filter(|next| next.share() < other.share()).unwrap_or(other)),
                false => rivals.push(other),
            }
        }
        Found { best, rivals, next, gain, is_determined }.simplest_first()
    }
}
