//! The search for the columns of a recording by their names.

use super::families::{
    self, Place, any_position, base, best_family, candidates, names_of, numbers_in_names, own_names,
};
use super::layout::{ABSENT, Layout};
use super::names::{self, QUANTITIES, TRUE};
use super::notes::{motor_side, spare_currents, unknown_units};
use super::prefixes::{behind_prefix, several};
use super::resolve::{Clock, Found, Resolver, listed};
use crate::error::{Error, Result};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// How much must be there.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Demand<'a> {
    /// A joint may lack its torque or its velocity.
    pub lenient: bool,
    /// The rows come at a rate that is given, and no column of time is looked for.
    pub timeless: bool,
    /// No joint needs a torque.
    pub positions_alone: bool,
    /// Constants are known that make torques of motor currents.
    pub constants: bool,
    /// Columns whose use is known, though they hold no signal.
    pub hidden: &'a [usize],
    /// Names of motors, each with its joint.
    pub motors: &'a [(String, String)],
}

impl Layout {
    /// Finds the columns by their names in the header, which stands at `line` of the file. `joints` are the robot's
    /// joints in order; without them the header's own numbers or names are taken. Every joint must have all that any has.
    ///
    /// # Errors
    /// A column missing or twice, a hole in the numbering, other joints than `joints`.
    pub(crate) fn find(
        path: &Path,
        line: Option<usize>,
        header: &[String],
        joints: Option<&[String]>,
    ) -> Result<Layout> {
        Layout::search(path, line, header, joints, Demand::default())
    }

    /// The same with a demand of one's own.
    ///
    /// # Errors
    /// Those of [`Layout::find`].
    pub(crate) fn search(
        path: &Path,
        line: Option<usize>,
        header: &[String],
        joints: Option<&[String]>,
        demand: Demand,
    ) -> Result<Layout> {
        let (meanings, on_bare) = families::meanings(header, joints.unwrap_or_default());
        let names = match joints {
            Some(joints) => joints.to_vec(),
            None => own_names(&meanings),
        };
        let of_joints = numbers_in_names(&names, names.len());
        let numbered = |number: usize| numbered_joint(&names, &of_joints, number);
        let by_numbers = |own: &[String]| -> BTreeMap<String, usize> {
            numbers_in_names(own, names.len()).into_iter().map(|(name, number)| (name, numbered(number))).collect()
        };
        let mut understood: Vec<String> = on_bare.into_iter().collect();
        let mut numbers = BTreeMap::new();
        if joints.is_some() && !any_position(&meanings, &names) {
            if let Some((found, prefix)) = behind_prefix(&meanings, &names, names::POSITION) {
                understood.push(format!("the names of the joints differ by the prefix {prefix}"));
                numbers = found;
            } else {
                // Whole names are surer than numbers in them, of which robots have theirs in any order.
                numbers = by_numbers(&own_names(&meanings));
                let of_first = numbers.iter().find(|(_, number)| **number == 1);
                if let (Some((first, _)), Some(name)) = (of_first, names.first()) {
                    // A name that is cut behind its number has its bracket open.
                    let close = if first.contains('[') && !first.contains(']') { "]" } else { "" };
                    let by = if first.contains(|letter: char| letter.is_ascii_digit()) {
                        "the numbers in their names"
                    } else {
                        "their places on the controller"
                    };
                    let text = format!("joints are taken by {by}, {first}{close} for {name} and so on");
                    understood.push(text);
                }
            }
        }
        let of_robot = joints.map(<[String]>::len);
        let mut used = BTreeSet::new();
        let mut found: [[Found; 4]; 2] = Default::default();
        let mut bases = [None; 4];
        let mut twice = Vec::new();
        let (mut currents, mut of_controller, mut of_motors_alone) = (false, false, false);
        let mut units = BTreeMap::new();
        for (truth, quantity) in
            [false, true].into_iter().flat_map(|truth| (0..4).map(move |quantity| (truth, quantity)))
        {
            let mut own = candidates(&meanings, &names, &numbers, truth, quantity);
            // Another topic than that of the positions may hold them.
            let of_topic = (own.is_empty() && !truth && joints.is_some())
                .then(|| behind_prefix(&meanings, &names, quantity))
                .flatten();
            if let Some((numbers, prefix)) = of_topic {
                own = candidates(&meanings, &names, &numbers, truth, quantity);
                understood.push(format!("each {} is that of the joint behind {prefix}", QUANTITIES[quantity].name));
            }
            if own.is_empty() && !truth && joints.is_some() {
                let by_motors = of_motors(demand.motors, &names);
                own = candidates(&meanings, &names, &by_motors, truth, quantity);
                if let Some((name, number)) = by_motors.iter().find(|_| !own.is_empty()) {
                    let (quantity, joint) = (QUANTITIES[quantity].name, &names[number - 1]);
                    understood.push(format!(
                        "each {quantity} is that of a motor of the robot's file, {name} for {joint} and so on"
                    ));
                    of_motors_alone |= quantity == QUANTITIES[names::TORQUE].name;
                }
            }
            // The drives have other names than the joints, but the same numbers.
            if own.is_empty() && !truth && joints.is_some() && quantity == names::TORQUE {
                let of_drives = by_numbers(&names_of(&meanings, quantity));
                own = candidates(&meanings, &names, &of_drives, truth, quantity);
                if let Some((name, number)) = of_drives.iter().find(|_| !own.is_empty()) {
                    understood.push(format!(
                        "torques are taken by the numbers in their names, {name} for {} and so on",
                        names[number - 1]
                    ));
                }
            }
            let family = best_family(own);
            currents |= family.iter().any(|candidate| candidate.meaning.current);
            of_controller |= family.iter().any(|candidate| candidate.meaning.of_controller);
            let positions = found[0][names::POSITION].len();
            let base = base(
                &family,
                if quantity == names::POSITION { None } else { bases[names::POSITION] },
                positions,
                of_robot,
            );
            if quantity == names::POSITION
                && let (Some(lowest), Some(first)) = (families::from_another(&family, of_robot), names.first())
            {
                understood.push(format!("joints are numbered from {lowest}: that is {first}, and the others follow in the order of the robot"));
            }
            if !truth {
                bases[quantity] = base;
            }
            for candidate in family {
                let number = match candidate.joint {
                    Place::Index(index) => index,
                    Place::Number(number) => numbered(number + 1 - base.unwrap_or(1)),
                };
                let second = found[usize::from(truth)][quantity].insert(number, candidate.column);
                if let Some(first) = second.filter(|first| demand.lenient && header[*first] == header[candidate.column])
                {
                    found[usize::from(truth)][quantity].insert(number, first);
                    twice.push([first, candidate.column]);
                    continue;
                }
                if let Some(first) = second {
                    let problem = format!("holds the same as column {}; leave one of them out", header[first]);
                    return Err(Error::input(path, line, &header[candidate.column], problem));
                }
                used.insert(candidate.column);
                units.extend(candidate.meaning.unit.map(|unit| (candidate.column, unit)));
            }
        }
        if let [Some(of_position), .., Some(of_torque)] = bases
            && of_position != of_torque
        {
            understood.push(format!(
                "positions are numbered from {of_position} and torques from {of_torque}: the first of each belong together"
            ));
        }
        let resolver = Resolver { path, line, header, names: &names, fixed: joints.is_some(), lenient: demand.lenient };
        let time = match demand.timeless {
            true => Clock { time: ABSENT, ..Clock::default() },
            false => resolver.clock(&used, [names::POSITION, names::TORQUE].map(|kind| found[0][kind].is_empty()))?,
        };
        used.extend([time.time].into_iter().chain(time.nanoseconds).filter(|column| *column != ABSENT));
        let [measured, truth] = &found;
        let unclear = |quantity: usize| -> Result<()> {
            let missing = joints.is_some() && measured[quantity].is_empty();
            let more = || more_than(&names_of(&meanings, quantity), &names);
            let problem = missing.then(|| several(&meanings, &names, quantity).or_else(more)).flatten();
            let column = format!("{}1", QUANTITIES[quantity].prefixes[0]);
            problem.map_or(Ok(()), |problem| Err(Error::input(path, line, column, problem)))
        };
        unclear(names::POSITION)?;
        let q = resolver.all(QUANTITIES[names::POSITION], &measured[0], None)?;
        let count = q.len();
        let mut notes = Vec::new();
        let mut optional = |kind: usize| -> Result<Option<Vec<usize>>> {
            let found = &measured[kind];
            if found.is_empty() {
                return Ok(None);
            }
            let columns = resolver.all(QUANTITIES[kind], found, Some(count))?;
            for joint in (0..count).filter(|&joint| columns[joint] == ABSENT) {
                let name = names.get(joint).cloned().unwrap_or_else(|| format!("joint_{}", joint + 1));
                understood.push(format!("{name} has no {}, which is taken from its position", QUANTITIES[kind].name));
            }
            Ok(Some(columns))
        };
        let (qd, qdd) = (optional(names::VELOCITY)?, optional(names::ACCELERATION)?);
        if !demand.positions_alone {
            unclear(names::TORQUE)?;
        }
        let tau = match demand.positions_alone && measured[names::TORQUE].is_empty() {
            true => vec![ABSENT; count],
            false => resolver.all(QUANTITIES[names::TORQUE], &measured[names::TORQUE], Some(count))?,
        };
        let whole_truth = truth.iter().all(|found| found.keys().copied().eq(1..=count));
        let truth_columns = whole_truth.then(|| std::array::from_fn(|kind| truth[kind].values().copied().collect()));
        if truth_columns.is_none() && truth.iter().any(|found| !found.is_empty()) {
            notes.push(format!(
                "columns ending in {TRUE} are not used: they must be there for position, velocity, acceleration and \
                 torque of all {count} joints"
            ));
            used.retain(|column| !header[*column].ends_with(TRUE));
        }
        let unused: Vec<String> =
            (0..header.len())
                .filter(|column| {
                    !used.contains(column)
                        && !demand.hidden.contains(column)
                        && (notes.is_empty() || !header[*column].ends_with(TRUE))
                })
                .map(|column| {
                    if header[column].is_empty() { format!("(column {})", column + 1) } else { header[column].clone() }
                })
                .collect();
        let unknown_joints = unknown_joints(&meanings, &used);
        if !unused.is_empty() {
            notes.push(format!("columns not used: {}", listed(&unused)));
        }
        let of_quantities = [Some(&q), qd.as_ref(), qdd.as_ref(), Some(&tau)];
        let own = candidates(&meanings, &names, &numbers, false, names::TORQUE);
        let base = bases[names::TORQUE].or(bases[names::POSITION]);
        understood.extend(motor_side::note(header, &used, q.iter().copied().find(|column| *column != ABSENT)));
        notes.extend(spare_currents::note(header, &names, &tau, &own, base));
        notes.extend(unknown_units::notes(header, &names, of_quantities, &units));
        let first_torque = tau.iter().find(|column| **column != ABSENT).map_or("", |column| header[*column].as_str());
        let of_rated = unknown_units::percent(header, &names, &tau).filter(|_| !demand.constants);
        let is_of_rated = of_rated.is_some();
        understood.extend(of_rated);
        if currents {
            let makes = match demand.constants {
                true => "the torque constants of the dataset make torques of them",
                false => {
                    "taken in the place of torques: a dataset with [motors] torque_constant_nm_a (N m per A, and gear_ratio where it is that of \
                     the motor) makes torques of them"
                }
            };
            let join = if demand.constants { ":" } else { "," };
            understood.push(format!("{first_torque} and its like are motor currents{join} {makes}"));
        }
        Ok(Layout {
            time: time.time,
            nanoseconds: time.nanoseconds,
            time_factor: time.factor,
            open_unit: time.open_unit,
            time_is_index: time.is_index,
            q,
            qd,
            qdd,
            tau,
            truth: truth_columns,
            units,
            currents,
            of_rated: is_of_rated,
            of_controller: of_controller.then(|| first_torque.to_owned()),
            of_motors: of_motors_alone,
            notes,
            unknown_joints,
            understood,
            twice,
            joints: if names.is_empty() { (1..=count).map(|joint| format!("joint_{joint}")).collect() } else { names },
        })
    }
}

/// What is said where a file numbers another count of joints in their names than the robot has.
fn more_than(own: &[String], names: &[String]) -> Option<String> {
    let numbers = numbers_in_names(own, own.len());
    let (first, last) = (own.first()?, own.last()?);
    (!numbers.is_empty() && own.len() != names.len()).then(|| {
        format!(
            "the file has {} joints, {first} to {last}, and the robot {} ({}); name the columns of the robot's joints in a dataset: \
             [columns] q = [..], qd = [..], tau = [..]",
            own.len(),
            names.len(),
            names.join(", ")
        )
    })
}

/// The place, counted from 1, of the joint with a number: in the joints' `own` numbers where their names have them, which on a tree need not
/// be their order, else in their order.
fn numbered_joint(names: &[String], own: &BTreeMap<String, usize>, number: usize) -> usize {
    names.iter().position(|name| own.get(name) == Some(&number)).map_or(number, |place| place + 1)
}

/// The numbers of joints by the names of their motors, counted from 1, of joints that have one motor.
fn of_motors(motors: &[(String, String)], names: &[String]) -> BTreeMap<String, usize> {
    let has_one = |joint: &String| motors.iter().filter(|(_, own)| own == joint).count() == 1;
    let number = |joint: &String| names.iter().position(|name| name == joint).map(|place| place + 1);
    let of = |(motor, joint): &(String, String)| Some((motor.clone(), number(joint).filter(|_| has_one(joint))?));
    motors.iter().filter_map(of).collect()
}

/// Joints that columns without use name as those of a measured position or torque.
fn unknown_joints(meanings: &[Vec<names::Meaning>], used: &BTreeSet<usize>) -> Vec<String> {
    let of = |readings: &Vec<names::Meaning>| {
        let measured = readings.iter().find(|meaning| !meaning.exact_only && !meaning.of_controller)?;
        let signal = [names::POSITION, names::TORQUE].contains(&measured.quantity);
        match &measured.joint {
            names::Joint::Name(name) if signal => Some(name.clone()),
            _ => None,
        }
    };
    let unused = (0..meanings.len()).filter(|column| !used.contains(column));
    unused.filter_map(|column| of(&meanings[column])).collect::<BTreeSet<String>>().into_iter().collect()
}

#[cfg(test)]
mod tests;
