//! Candidates: every effect of the library at every place, at a grid of the parameters that are not linear.

use super::arm::Arm;
use super::column::Column;
use super::grid::grid;
use super::roles::{is_event, linear};
use super::rows::Rows;
use crate::effects::{Effect, LIBRARY, Placed, Role, Scope};
use crate::error::Result;
use crate::identification::effect_model::Trust;

/// Effects that the baseline holds already.
const BASELINE: [&str; 3] = ["rotor_inertia", "viscous_friction", "coulomb_friction"];

/// Share of a group's largest column below which a column is rounding.
const ROUNDING: f64 = 1e-9;

/// An effect at a place with its nonlinear parameters chosen.
#[derive(Debug, Clone)]
pub struct Candidate {
    /// The effect; its amplitudes play no part, its departures are the sizes at which columns are taken.
    pub placed: Placed,
    /// The training log in which it acts; None for all logs.
    pub log: Option<usize>,
    /// Torque per unit of every amplitude and departure, not whitened.
    pub columns: Vec<Column>,
}

impl Candidate {
    /// Whether the only column makes sense with a positive value only.
    pub fn one_sided(&self) -> bool {
        let parameters = self.placed.effect.parameters();
        matches!(linear(self.placed.effect).as_slice(), [only] if parameters[*only].lower == 0.0)
    }

    /// Joints on which it has torque.
    pub fn joints(&self) -> Vec<usize> {
        if self.columns.is_empty() {
            return self.placed.joints();
        }
        let mut joints: Vec<usize> =
            self.columns.iter().flat_map(|column| column.parts.iter().map(|(joint, _)| *joint)).collect();
        joints.sort_unstable();
        joints.dedup();
        joints
    }

    /// What it is, whatever its parameters, and where it acts.
    pub fn slot(&self) -> Slot {
        (self.family(), self.log)
    }

    /// What it is, whatever its parameters.
    pub fn family(&self) -> Family {
        Family { effect: self.placed.effect.about().name, joint: self.placed.joint }
    }
}

/// An effect at a place, in one log or in all.
pub type Slot = (Family, Option<usize>);

/// An effect at a place.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Family {
    /// Name of the effect.
    pub effect: &'static str,
    /// Its joint (the first of a pair; zero for the whole arm).
    pub joint: usize,
}

/// Columns of placed effects, one group each, for the arm as found.
///
/// # Errors
/// If a log is too short to differentiate.
pub fn columns(arm: &Arm, rows: &Rows, placed: &[Placed]) -> Result<Vec<Vec<Column>>> {
    let units: Vec<Vec<Placed>> = placed.iter().map(units).collect();
    let flat: Vec<Placed> = units.iter().flatten().cloned().collect();
    let mut added = arm.added(&flat, rows)?.into_iter();
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

/// Columns of placed effects of which each acts in one log only, or in all.
///
/// # Errors
/// If a log is too short to differentiate.
pub fn columns_in(arm: &Arm, rows: &Rows, log: Option<usize>, placed: &[Placed]) -> Result<Vec<Vec<Column>>> {
    let mut groups = columns(arm, rows, placed)?;
    if let Some(log) = log {
        let own = rows.starts[log]..rows.starts[log + 1];
        let outside = |column: &mut Column| {
            for (_, values) in &mut column.parts {
                values.iter_mut().enumerate().filter(|(row, _)| !own.contains(row)).for_each(|(_, value)| *value = 0.0);
            }
        };
        groups.iter_mut().flatten().for_each(outside);
    }
    Ok(groups)
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

/// All candidates with sound columns.
///
/// # Errors
/// If a log is too short to differentiate.
pub fn all(arm: &Arm, rows: &Rows, trust: Trust, only: &[String]) -> Result<Vec<Candidate>> {
    let placed: Vec<Placed> = LIBRARY
        .iter()
        .copied()
        .filter(|effect| is_candidate(*effect, trust, only) || (rows.before > 0 && is_wanted(*effect, only)))
        .flat_map(|effect| places(effect, rows.dof()).flat_map(move |joint| grid(effect, joint, rows)))
        .collect();
    let groups = columns(arm, rows, &placed)?;
    let candidates = placed.into_iter().zip(groups).map(|(placed, columns)| Candidate { placed, log: None, columns });
    let mut candidates: Vec<Candidate> =
        candidates.filter(|candidate| candidate.columns.iter().any(Column::is_sound)).collect();
    // What happens to the arm from outside happens in one log.
    if rows.logs.len() > 1 {
        let events: Vec<Placed> =
            candidates.iter().filter(|c| is_event(c.placed.effect)).map(|c| c.placed.clone()).collect();
        for log in 0..rows.logs.len() {
            let groups = columns_in(arm, rows, Some(log), &events)?;
            let own = events.iter().cloned().zip(groups);
            candidates.extend(own.map(|(placed, columns)| Candidate { placed, log: Some(log), columns }));
        }
    }
    Ok(candidates)
}

/// Whether an effect is to be looked for: against logs from before a change nothing hides it.
pub fn is_wanted(effect: &dyn Effect, only: &[String]) -> bool {
    only.is_empty() || only.iter().any(|name| name == effect.about().name)
}

/// Whether an effect can be told from the baseline at all.
pub fn is_candidate(effect: &dyn Effect, trust: Trust, only: &[String]) -> bool {
    let about = effect.about();
    is_wanted(effect, only)
        && !BASELINE.contains(&about.name)
        && (trust == Trust::Nominal || !about.hidden_by_base_parameters)
}

/// Where an effect can be placed on an arm.
pub fn places(effect: &dyn Effect, dof: usize) -> std::ops::Range<usize> {
    match effect.about().scope {
        Scope::Joint => 0..dof,
        Scope::Pair => 0..dof.saturating_sub(1),
        Scope::Arm => 0..1,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::find;

    #[test]
    fn what_base_parameters_hide_takes_trusted_inertias() {
        let payload = find("payload").unwrap();
        assert!(is_candidate(payload, Trust::Nominal, &[]));
        assert!(!is_candidate(payload, Trust::Structure, &[]));
        assert!(!is_candidate(payload, Trust::Nominal, &["backlash".into()]));
        assert!(!is_candidate(find("coulomb_friction").unwrap(), Trust::Nominal, &[]));
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
