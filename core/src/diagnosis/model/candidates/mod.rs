//! Candidates: every effect of the library at every place, at a grid of its nonlinear parameters.
//!
//! In: the arm as estimated so far, rows of the logs, whether inertias are estimated, and the names of the effects to test. Out: a list of
//! candidates. Each is an effect on a joint (or on the whole arm) with fixed shapes (Stribeck velocity, delay, order of a ripple), the
//! training log in which it acts or all of them, and its regressor columns per unit of each amplitude, not whitened. Columns that are
//! rounding are zero. Where the estimate of the arm changes, columns that depend on it are renewed.

mod extent;

pub(crate) use extent::extent;
use extent::highest_harmonic;

use super::arm_columns::Moved;
use super::roles::{acts_upon_arm, is_event, is_outdated, linear};
use crate::diagnosis::logs::Rows;
use crate::diagnosis::regression::{Column, joints_of};
use crate::effects::{Effect, Extent, Hidden, LIBRARY, Nature, Placed, Role};
use crate::error::Result;
use crate::identification::effect_model::{Arm, Trust};
use crate::robot::Robot;
use rayon::prelude::*;
use std::sync::Arc;

/// Share of a group's largest column below which a column is rounding.
const ROUNDING: f64 = 1e-9;

/// An effect at a place with its nonlinear parameters chosen.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::diagnosis::{Candidate, Diagnosis};
///
/// // The log in which an effect was found that acts in one only, by its place among the training logs.
/// fn log_of_first(diagnosis: &Diagnosis) -> Option<usize> {
///     let candidate: &Candidate = &diagnosis.found.first()?.member.candidate;
///     candidate.log
/// }
/// ```
#[derive(Debug, Clone)]
pub struct Candidate {
    /// The effect; its amplitudes play no part, its departures are the sizes at which columns are taken.
    pub placed: Placed,
    /// The training log in which it acts; None for all logs.
    pub log: Option<usize>,
    /// Torque per unit of every amplitude and departure, not whitened; shared by all copies.
    pub columns: Arc<Vec<Column>>,
}

impl Candidate {
    /// Whether the only column makes sense with a positive value only.
    pub(crate) fn one_sided(&self) -> bool {
        let parameters = self.placed.effect.parameters();
        matches!(linear(self.placed.effect).as_slice(), [only] if parameters[*only].lower == 0.0)
    }

    /// Joints on which it has torque.
    pub fn joints(&self) -> Vec<usize> {
        if self.columns.is_empty() {
            return self.placed.joints();
        }
        joints_of(&self.columns).into_iter().collect()
    }

    /// Whether it has torque on any of `joints`.
    pub(crate) fn acts_on(&self, joints: &[usize]) -> bool {
        self.joints().iter().any(|joint| joints.contains(joint))
    }

    /// What it is, whatever its parameters, and where it acts.
    pub(crate) fn slot(&self) -> Slot {
        (self.family(), self.log)
    }

    /// What it is, whatever its parameters.
    pub fn family(&self) -> Family {
        Family { effect: self.placed.effect.about().name, joint: self.placed.joint }
    }
}

/// An effect at a place, in one log or in all.
pub(crate) type Slot = (Family, Option<usize>);

/// An effect at a place.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::diagnosis::Family;
///
/// // An effect at a place, whatever its parameters: what findings, alternatives and rankings are lists of.
/// let mut families = [Family { effect: "payload", joint: 0 }, Family { effect: "backlash", joint: 1 }];
/// families.sort();
/// assert_eq!(families[0], Family { effect: "backlash", joint: 1 });
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Family {
    /// Name of the effect.
    pub effect: &'static str,
    /// Its joint (the first of a pair; zero for the whole arm).
    pub joint: usize,
}

/// Columns to test placed effects with, one group each, for the arm as found.
///
/// # Errors
/// If a log is too short to differentiate.
pub(crate) fn columns(arm: &Arm, rows: &Rows, placed: &[Placed]) -> Result<Vec<Vec<Column>>> {
    columns_in(arm, rows, None, placed, Moved::Tested)
}

/// Columns of placed effects of which each acts in one log only, or in all.
///
/// # Errors
/// If a log is too short to differentiate.
pub(crate) fn columns_in(
    arm: &Arm,
    rows: &Rows,
    log: Option<usize>,
    placed: &[Placed],
    moved: Moved,
) -> Result<Vec<Vec<Column>>> {
    let units: Vec<Vec<Placed>> = placed.iter().map(units).collect();
    let flat: Vec<Placed> = units.iter().flatten().cloned().collect();
    let acting = log.map_or(rows.before..rows.logs.len(), |log| log..log + 1);
    let mut added = arm.added_in(acting, &flat, rows, moved)?.into_iter();
    Ok(placed
        .iter()
        .map(|one| {
            let indices = linear(one.effect);
            let mut group: Vec<Column> = added.by_ref().take(indices.len()).collect();
            let typical = |index: usize| one.effect.parameters()[index].typical.abs();
            for (column, &index) in group.iter_mut().zip(&indices) {
                column.scale(1.0 / size(one, index));
            }
            // Rounding is all that a direction has on which nothing depends.
            let reach: Vec<f64> =
                group.iter().zip(&indices).map(|(column, &index)| column.dot(column).sqrt() * typical(index)).collect();
            let largest = reach.iter().fold(0.0f64, |m, r| m.max(*r));
            for (column, reach) in group.iter_mut().zip(reach) {
                if reach < ROUNDING * largest {
                    *column = Column::default();
                }
            }
            group
        })
        .collect())
}

/// The effect with one amplitude or departure at a time.
fn units(placed: &Placed) -> Vec<Placed> {
    linear(placed.effect)
        .into_iter()
        .map(|index| {
            let mut unit = placed.absent();
            unit.parameters[index] = size(placed, index);
            unit
        })
        .collect()
}

/// Size at which the column of a parameter is taken.
fn size(placed: &Placed, index: usize) -> f64 {
    match placed.effect.parameters()[index].role {
        Role::Departure => placed.parameters[index],
        _ => 1.0,
    }
}

/// Which candidates are asked for.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Asked<'a> {
    /// Whether inertias are taken from the description, or estimated: base parameters hide some effects.
    pub trust: Trust,
    /// Names of the effects; all where there are none.
    pub only: &'a [String],
    /// Joints whose gears may have play by their impacts. On others play is looked for at its typical size.
    pub open_play: &'a [usize],
}

/// All candidates with sound columns.
///
/// # Errors
/// If a log is too short to differentiate.
pub(crate) fn all_candidates(arm: &Arm, rows: &Rows, asked: Asked) -> Result<Vec<Candidate>> {
    let of = |event: bool| wanted(rows, asked).filter(move |effect| is_event(*effect) == event);
    let mut all = at(arm, rows, of(false), asked.open_play, |_, _| true)?;
    let events = at(arm, rows, of(true), asked.open_play, |_, _| true)?;
    // What happens to the arm from outside happens in one log, or at the same time in all, held-out ones included.
    if !events.is_empty() {
        for (log, ends) in rows.starts.windows(2).enumerate() {
            let time = &rows.logs[log].time;
            let meets = |event: &&Candidate| {
                let [from, to] = event.placed.effect.acts_between(&event.placed.parameters);
                time.first().is_some_and(|first| *first < to) && time.last().is_some_and(|last| *last > from)
            };
            let own = events.iter().filter(meets).map(|event| Candidate {
                columns: Arc::new(event.columns.iter().map(|column| column.within(ends[0]..ends[1])).collect()),
                placed: event.placed.clone(),
                log: Some(log),
            });
            all.extend(own);
        }
    }
    all.extend(events);
    Ok(all)
}

/// Lasting candidates known along some rows of `length`, along the `later` rows that follow those too. Those that depend on the arm
/// are left out: it was found anew ([`renewed`]).
///
/// # Errors
/// If a log is too short to differentiate.
pub(crate) fn carried_on(
    mut candidates: Vec<Candidate>,
    arm: &Arm,
    length: usize,
    later: &Rows,
) -> Result<Vec<Candidate>> {
    candidates.retain(|candidate| !is_event(candidate.placed.effect) && !acts_upon_arm(candidate.placed.effect));
    let placed: Vec<Placed> = candidates.iter().map(|candidate| candidate.placed.clone()).collect();
    let lengths = [length, later.len()];
    candidates.par_iter_mut().zip(columns(arm, later, &placed)?).for_each(|(candidate, later)| {
        for (own, later) in Arc::make_mut(&mut candidate.columns).iter_mut().zip(&later) {
            *own = own.then(later, lengths);
        }
    });
    Ok(candidates)
}

/// The same candidates for the arm as found since, whose torque is another on the joints `moved` and whose friction is rounded otherwise on
/// those `rounded`: those that depend on either are renewed.
///
/// # Errors
/// If a log is too short to differentiate.
pub(crate) fn renewed(
    mut candidates: Vec<Candidate>,
    arm: &Arm,
    rows: &Rows,
    asked: Asked,
    [moved, rounded]: [&[usize]; 2],
) -> Result<Vec<Candidate>> {
    let is_renewed = |effect: &dyn Effect, joint: usize| is_outdated(effect, joint, moved, rounded);
    candidates.retain(|candidate| !is_renewed(candidate.placed.effect, candidate.placed.joint));
    candidates.extend(at(arm, rows, wanted(rows, asked), asked.open_play, is_renewed)?);
    Ok(candidates)
}

/// Effects of the library that may be there.
fn wanted(rows: &Rows, Asked { trust, only, .. }: Asked) -> impl Iterator<Item = &'static dyn Effect> {
    let changed = rows.of_change();
    LIBRARY
        .iter()
        .copied()
        .filter(move |effect| is_candidate(*effect, trust, only) || (changed && is_wanted(*effect, only)))
}

/// Candidates of `effects` at the joints where they are `asked` for, acting in all logs.
fn at(
    arm: &Arm,
    rows: &Rows,
    effects: impl Iterator<Item = &'static dyn Effect>,
    open_play: &[usize],
    asked: impl Fn(&dyn Effect, usize) -> bool,
) -> Result<Vec<Candidate>> {
    let of = |joint: usize| (extent(rows, joint), highest_harmonic(rows, joint));
    let extents: Vec<(Extent, f64)> = (0..rows.dof()).map(of).collect();
    let grid = |effect: &'static dyn Effect, joint: usize| match effect.about().nature == Nature::Play {
        true if !open_play.contains(&joint) => vec![Placed::typical(effect, joint)],
        _ => extents[joint].0.grid(effect, joint, extents[joint].1),
    };
    let placed: Vec<Placed> = effects
        .flat_map(|effect| places(effect, arm.described()).into_iter().map(move |joint| (effect, joint)))
        .filter(|&(effect, joint)| asked(effect, joint))
        .flat_map(|(effect, joint)| grid(effect, joint))
        .collect();
    let groups = columns(arm, rows, &placed)?;
    let candidates = placed.into_iter().zip(groups).map(|(placed, columns)| Candidate {
        placed,
        log: None,
        columns: Arc::new(columns),
    });
    Ok(candidates.filter(|candidate| candidate.columns.iter().any(Column::is_sound)).collect())
}

/// Whether an effect is to be looked for: against logs from before a change nothing hides it.
pub(crate) fn is_wanted(effect: &dyn Effect, only: &[String]) -> bool {
    only.is_empty() || only.iter().any(|name| name == effect.about().name)
}

/// Whether an effect is separable from the baseline at all.
pub fn is_candidate(effect: &dyn Effect, trust: Trust, only: &[String]) -> bool {
    let about = effect.about();
    is_wanted(effect, only)
        && about.nature != Nature::Baseline
        && (trust == Trust::Nominal || about.hidden_by_base_parameters != Hidden::Wholly)
}

/// Where an effect can be placed on an arm.
pub fn places(effect: &dyn Effect, robot: &Robot) -> Vec<usize> {
    let everywhere = effect.about().scope.places(robot.dof());
    everywhere.filter(|&joint| effect.can_be_on(joint, robot)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::logs::FEWEST_ROWS;
    use crate::diagnosis::test_logs::log;
    use crate::effects::{Rounding, Scope, find};
    use crate::robot::{InertiaCheck, load};

    #[test]
    fn what_base_parameters_hide_takes_trusted_inertias() {
        let payload = find("payload").unwrap();
        assert!(is_candidate(payload, Trust::Nominal, &[]));
        assert!(!is_candidate(payload, Trust::Structure, &[]));
        assert!(is_candidate(find("torque_gain").unwrap(), Trust::Structure, &[]));
        assert!(!is_candidate(payload, Trust::Nominal, &["backlash".into()]));
        assert!(!is_candidate(find("coulomb_friction").unwrap(), Trust::Nominal, &[]));
    }

    #[test]
    fn play_is_looked_for_at_many_sizes_where_impacts_leave_it_open() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../urdf/irb1600_6_120.urdf");
        let robot = load(path, InertiaCheck::Required).unwrap();
        let arm = Arm::new(&robot, Trust::Nominal);
        let log = log(&arm, 1);
        let rows = Rows::new(&[&log], 20.0, FEWEST_ROWS).unwrap();
        let only = ["backlash".to_owned()];
        let asked = Asked { trust: Trust::Structure, only: &only, open_play: &[0] };
        let all = all_candidates(&arm, &rows, asked).unwrap();
        let sizes = |joint: usize| all.iter().filter(|candidate| candidate.placed.joint == joint).count();
        assert!(sizes(0) > 4 && (1..6).all(|joint| sizes(joint) <= 1), "{}", sizes(0));
    }

    /// Law over the library: what is not worked out anew where friction is rounded otherwise does not change there.
    #[test]
    fn only_what_depends_on_the_rounding_changes_with_it() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../urdf/irb1600_6_120.urdf");
        let robot = load(path, InertiaCheck::Required).unwrap();
        let mut arm = Arm::new(&robot, Trust::Nominal);
        let log = log(&arm, 1);
        let rows = Rows::new(&[&log], 20.0, FEWEST_ROWS).unwrap();
        let placed: Vec<Placed> = LIBRARY.iter().map(|effect| Placed::typical(*effect, 0)).collect();
        let mut rounded = |rounding: Rounding| {
            arm.coulomb_rounding.fill(rounding);
            columns(&arm, &rows, &placed).unwrap()
        };
        let (sharp, wide) = (rounded(Rounding::Sharp), rounded(Rounding::Tanh(0.1)));
        for ((one, sharp), wide) in placed.iter().zip(&sharp).zip(&wide) {
            let name = one.effect.about().name;
            // The torque of the arm holds its friction.
            let is_renewed = |joint: usize| is_outdated(one.effect, joint, &[0, 3], &[0, 3]);
            assert!(sharp == wide || (is_renewed(0) && is_renewed(3)), "{name}");
            assert!(sharp != wide || !is_renewed(0) || acts_upon_arm(one.effect), "{name}");
            assert!(!one.effect.about().dry || one.effect.about().scope == Scope::Joint, "{name}");
            assert!(!is_renewed(1) || (acts_upon_arm(one.effect) && one.effect.about().scope == Scope::Arm), "{name}");
        }
    }

    #[test]
    fn columns_are_taken_one_parameter_at_a_time() {
        let placed = Placed::typical(find("encoder_eccentricity").unwrap(), 2);
        let units = units(&placed);
        assert_eq!(units.len(), 2);
        assert_eq!(units[0].parameters, [placed.parameters[0], 0.0]);
        assert_eq!(units[1].parameters, [0.0, placed.parameters[1]]);
        let spring = Placed::typical(find("stribeck_friction").unwrap(), 0);
        assert_eq!(super::units(&spring)[0].parameters[..2], [1.0, spring.parameters[1]]);
    }
}
