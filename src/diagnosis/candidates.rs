//! Candidates: every effect of the library at every place, at a grid of the parameters that are not linear.

use super::arm::Arm;
use super::column::Column;
use super::rows::Rows;
use crate::effects::{Effect, LIBRARY, Parameter, Placed, Role, Scope};
use crate::error::Result;
use crate::identification::effect_model::Trust;

/// Effects that the baseline holds already.
const BASELINE: [&str; 3] = ["rotor_inertia", "viscous_friction", "coulomb_friction"];

/// Effects whose departure is a level: absent at zero, smaller the higher it is.
const LEVELS: [&str; 1] = ["torque_saturation"];

/// Effects that come from outside.
const EVENTS: [&str; 1] = ["external_contact"];

/// Points over the range of a shape, alone or one of several, and how far the range reaches to either side of the typical
/// size.
const ALONE: usize = 10;
const ONE_OF_SEVERAL: usize = 6;
const REACH: f64 = 30.0;

/// Shares of the largest logged torque at which it may be cut off: noise alone exceeds the level.
const CUT_OFF: [f64; 6] = [0.99, 0.96, 0.92, 0.87, 0.8, 0.7];

/// Sizes of departures of which the torque is not linear, as multiples of the typical one.
const SIZES: [f64; 5] = [0.25, 0.5, 1.0, 2.0, 4.0];

/// Highest speed of a transition at low speed, over the joint's top speed; range of a drift's time constant, over the longest
/// log.
const LOW_SPEED: f64 = 0.3;
const SHORTEST_DRIFT: f64 = 0.1;
const LONGEST_DRIFT: f64 = 3.0;

/// Least distance of a power of speed from one.
const APART: f64 = 0.02;

/// Share of a group's largest column below which a column is rounding.
const ROUNDING: f64 = 1e-9;

/// Highest harmonic of a ripple scan, and lengths of contacts, s.
const HIGHEST_HARMONIC: f64 = 60.0;
const CONTACTS_S: [f64; 3] = [1.5, 3.0, 6.0];

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

/// Indices of the parameters for which there are columns: amplitudes and departures.
pub fn linear(effect: &dyn Effect) -> Vec<usize> {
    with_role(effect, |role| matches!(role, Role::Amplitude | Role::Departure))
}

/// Indices of the shapes, and of departures that are levels.
pub fn shapes(effect: &dyn Effect) -> Vec<usize> {
    let level = is_level(effect);
    with_role(effect, |role| role == Role::Shape || (level && role == Role::Departure))
}

/// Whether the departure of an effect is a level.
pub fn is_level(effect: &dyn Effect) -> bool {
    LEVELS.contains(&effect.about().name)
}

/// Whether the torque of a departure is not straight in it: times by which signals are moved.
pub fn bends(effect: &dyn Effect, index: usize) -> bool {
    let parameter = &effect.parameters()[index];
    parameter.role == Role::Departure && parameter.unit == "s"
}

/// Size below which the torque of a departure that bends is as good as straight in it.
pub fn straight_below(effect: &dyn Effect, index: usize) -> f64 {
    SIZES[0] * effect.parameters()[index].typical.abs()
}

fn with_role(effect: &dyn Effect, wanted: impl Fn(Role) -> bool) -> Vec<usize> {
    let parameters = effect.parameters().iter().enumerate();
    parameters.filter(|(_, parameter)| wanted(parameter.role)).map(|(index, _)| index).collect()
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

/// Whether an effect comes and goes on its own, whatever the motion.
pub fn is_event(effect: &dyn Effect) -> bool {
    EVENTS.contains(&effect.about().name)
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

/// The effect at one place with every combination of its grids.
fn grid(effect: &'static dyn Effect, joint: usize, rows: &Rows) -> Vec<Placed> {
    let typical = Placed::typical(effect, joint);
    if effect.about().name == "external_contact" {
        return contacts(&typical, rows);
    }
    let alone = shapes(effect).len() == 1;
    let mut all = vec![typical];
    for (index, parameter) in effect.parameters().iter().enumerate() {
        let values = match parameter.role {
            Role::Amplitude | Role::Held => continue,
            Role::Departure => departures(effect, index, joint, rows),
            Role::Shape => {
                let grid = shape_grid(parameter, alone, joint, rows);
                grid.into_iter().map(|value| within_bounds(effect, index, value, joint, rows)).collect()
            }
        };
        all = all
            .into_iter()
            .flat_map(|placed| {
                values.iter().map(move |&value| {
                    let mut placed = placed.clone();
                    placed.parameters[index] = value;
                    placed
                })
            })
            .collect();
    }
    all
}

/// Effects in the log's timing bend with their size; the others are straight as far as one looks.
fn departures(effect: &dyn Effect, index: usize, joint: usize, rows: &Rows) -> Vec<f64> {
    let parameter = &effect.parameters()[index];
    if is_level(effect) {
        let torque = rows.torque[joint].iter().zip(&rows.valid[joint]);
        let largest = torque.fold(0.0f64, |m, (v, ok)| if *ok { m.max(v.abs()) } else { m });
        return CUT_OFF.iter().map(|share| share * largest).filter(|level| *level > 0.0).collect();
    }
    if !bends(effect, index) {
        return vec![parameter.typical];
    }
    let sizes = SIZES.iter().map(|size| size * parameter.typical);
    sizes
        .clone()
        .map(|size| -size)
        .chain(sizes)
        .filter(|size| (parameter.lower..=parameter.upper).contains(size))
        .collect()
}

/// Bounds of a shape on a joint as it moves in these logs: what is called a transition at low speed must lie at low speed, and
/// a time constant longer than the logs is a drift.
pub fn shape_bounds(parameter: &Parameter, joint: usize, rows: &Rows) -> (f64, f64) {
    let (low, high) = (parameter.lower, parameter.upper);
    let (least, most) = match parameter.unit {
        "rad/s" => (0.0, LOW_SPEED * fastest(rows, joint)),
        "s" if parameter.role == Role::Shape && low > 0.0 => {
            let longest = duration(rows);
            (SHORTEST_DRIFT * longest, LONGEST_DRIFT * longest)
        }
        _ => (low, high),
    };
    let least = low.max(least).min(high);
    (least, high.min(most).max(least))
}

/// A shape within its bounds and away from where its effect is one of the baseline: a power of speed near one takes
/// coefficients of any size that all but cancel the viscous friction's.
pub fn within_bounds(effect: &dyn Effect, index: usize, value: f64, joint: usize, rows: &Rows) -> f64 {
    let parameter = &effect.parameters()[index];
    let (low, high) = shape_bounds(parameter, joint, rows);
    let value = value.clamp(low, high);
    match effect.about().name == "nonlinear_viscous_friction" && (value - 1.0).abs() < APART {
        true if value < 1.0 => 1.0 - APART,
        true => 1.0 + APART,
        false => value,
    }
}

fn fastest(rows: &Rows, joint: usize) -> f64 {
    rows.logs.iter().flat_map(|log| log.motion.qd.channel(joint)).fold(0.0, |m, v| m.max(v.abs()))
}

fn duration(rows: &Rows) -> f64 {
    rows.logs.iter().filter_map(|log| log.time.last().copied()).fold(0.0, f64::max)
}

fn shape_grid(parameter: &Parameter, alone: bool, joint: usize, rows: &Rows) -> Vec<f64> {
    let (low, high) = shape_bounds(parameter, joint, rows);
    if parameter.unit == "1/turn" {
        let step = (std::f64::consts::PI / (2.0 * range(rows, joint))).max(0.4);
        let count = ((HIGHEST_HARMONIC - low) / step) as usize;
        return (0..=count).map(|k| low + k as f64 * step).collect();
    }
    let points = if alone { ALONE } else { ONE_OF_SEVERAL };
    if low > 0.0 && high / low > 10.0 {
        let (low, high) = (low.max(parameter.typical / REACH), high.min(parameter.typical * REACH));
        return (0..points).map(|k| low * (high / low).powf(k as f64 / (points - 1) as f64)).collect();
    }
    (0..points).map(|k| low + (high - low) * (k as f64 + 0.5) / points as f64).collect()
}

/// How far a joint moves, rad.
fn range(rows: &Rows, joint: usize) -> f64 {
    let positions = rows.logs.iter().flat_map(|log| log.motion.q.channel(joint));
    let (low, high) = positions.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &q| (l.min(q), h.max(q)));
    (high - low).max(1e-6)
}

/// Contacts of a few lengths, at any time of the longest log.
fn contacts(typical: &Placed, rows: &Rows) -> Vec<Placed> {
    let end = duration(rows);
    let of_length = |length: f64| {
        (0..).map(move |k| f64::from(k) * 0.5 * length).take_while(move |start| start + 0.5 * length < end).map(
            move |start| {
                let mut placed = typical.clone();
                for (parameter, value) in placed.effect.parameters().iter().zip(&mut placed.parameters) {
                    match parameter.name {
                        "start" => *value = start,
                        "end" => *value = start + length,
                        _ => {}
                    }
                }
                placed
            },
        )
    };
    CONTACTS_S.into_iter().flat_map(of_length).collect()
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
