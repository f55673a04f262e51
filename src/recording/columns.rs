//! The table of a recording: which column is which signal of which joint. All formats that are tables share it.

mod families;
mod left_out;

pub use families::joint_names;

use super::names::{self, Part, QUANTITIES, Quantity, TRUE};
use super::{Recording, Signals};
use crate::channels::Channels;
use crate::error::{Error, Result};
use families::{Place, any_position, base, behind_prefix, best_family, candidates, numbers_in_names, own_names};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::Arc;

/// Columns of one quantity: number of the joint, counted from 1 -> index of the column.
type Found = BTreeMap<usize, usize>;

/// In place of a column that the file has not.
pub const ABSENT: usize = usize::MAX;

/// Which column of a file is which signal; every table holds one column index per joint.
#[derive(Debug)]
pub struct Layout {
    joints: Vec<String>,
    /// [`ABSENT`] where the rows come at a rate that is given.
    time: usize,
    /// Nanoseconds of the second, where `time` is in whole seconds.
    nanoseconds: Option<usize>,
    time_factor: Option<f64>,
    /// The name of the column of time does not give its unit.
    pub open_unit: bool,
    /// Time may be the index of the rows.
    pub time_is_index: bool,
    q: Vec<usize>,
    /// [`ABSENT`] for joints without, as the two below.
    qd: Option<Vec<usize>>,
    qdd: Option<Vec<usize>>,
    tau: Vec<usize>,
    truth: Option<[Vec<usize>; 4]>,
    /// Torques are motor currents.
    pub currents: bool,
    /// What the file has and the recording will not.
    pub notes: Vec<String>,
    /// How the columns were understood where that is not obvious.
    pub understood: Vec<String>,
}

/// The first value that cannot be used.
#[derive(Debug)]
pub struct Fault {
    /// Counted from 0.
    pub row: usize,
    /// Index of the column.
    pub column: usize,
    /// What is wrong.
    pub problem: String,
}

/// How much must be there.
#[derive(Debug, Clone, Copy, Default)]
pub struct Demand {
    /// A joint may lack its torque or its velocity.
    pub lenient: bool,
    /// The rows come at a rate that is given, and no column of time is looked for.
    pub timeless: bool,
    /// No joint needs a torque.
    pub positions_alone: bool,
}

impl Layout {
    /// Finds the columns by their names in the header, which stands at `line` of the file. `joints` are the robot's
    /// joints in order; without them the header's own numbers or names are taken. Every joint must have all that any has.
    ///
    /// # Errors
    /// A column missing or twice, a hole in the numbering, other joints than `joints`.
    pub fn find(path: &Path, line: Option<usize>, header: &[String], joints: Option<&[String]>) -> Result<Layout> {
        Layout::search(path, line, header, joints, Demand::default())
    }

    /// The same with a demand of one's own.
    ///
    /// # Errors
    /// Those of [`Layout::find`].
    pub fn search(
        path: &Path,
        line: Option<usize>,
        header: &[String],
        joints: Option<&[String]>,
        demand: Demand,
    ) -> Result<Layout> {
        let meanings: Vec<_> = header.iter().map(|name| names::meanings(name)).collect();
        let names = match joints {
            Some(joints) => joints.to_vec(),
            None => own_names(&meanings),
        };
        let mut understood = Vec::new();
        let mut numbers = BTreeMap::new();
        if joints.is_some() && !any_position(&meanings, &names) {
            numbers = numbers_in_names(&meanings, names.len());
            if let (Some((first, _)), Some(name)) = (numbers.first_key_value(), names.first()) {
                understood
                    .push(format!("joints are taken by the numbers in their names, {first} for {name} and so on"));
            } else if let Some((found, prefix)) = behind_prefix(&meanings, &names) {
                understood.push(format!("the names of the joints differ by the prefix {prefix}"));
                numbers = found;
            }
        }
        let mut used = BTreeSet::new();
        let mut found: [[Found; 4]; 2] = Default::default();
        let mut bases = [None; 4];
        let mut currents = false;
        for (truth, quantity) in
            [false, true].into_iter().flat_map(|truth| (0..4).map(move |quantity| (truth, quantity)))
        {
            let family = best_family(candidates(&meanings, &names, &numbers, truth, quantity));
            currents |= family.iter().any(|candidate| candidate.meaning.current);
            let positions = found[0][names::POSITION].len();
            let base =
                base(&family, if quantity == names::POSITION { None } else { bases[names::POSITION] }, positions);
            if !truth {
                bases[quantity] = base;
            }
            for candidate in family {
                let number = match candidate.joint {
                    Place::Index(index) => index,
                    Place::Number(number) => number + 1 - base.unwrap_or(1),
                };
                let second = found[usize::from(truth)][quantity].insert(number, candidate.column);
                if let Some(first) = second.filter(|first| demand.lenient && header[*first] == header[candidate.column])
                {
                    found[usize::from(truth)][quantity].insert(number, first);
                    understood.push(format!("{} stands twice in the header: the first is used", header[first]));
                    continue;
                }
                if let Some(first) = second {
                    let problem = format!("holds the same as column {}; leave one of them out", header[first]);
                    return Err(Error::input(path, line, &header[candidate.column], problem));
                }
                used.insert(candidate.column);
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
                .filter(|column| !used.contains(column) && (notes.is_empty() || !header[*column].ends_with(TRUE)))
                .map(|column| {
                    if header[column].is_empty() { format!("(column {})", column + 1) } else { header[column].clone() }
                })
                .collect();
        if !unused.is_empty() {
            notes.push(format!("columns not used: {}", listed(&unused)));
        }
        if currents {
            let column = tau.iter().find(|column| **column != ABSENT).map_or("", |column| header[*column].as_str());
            understood.push(format!("{column} and its like are motor currents, taken in the place of torques"));
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
            currents,
            notes,
            understood,
            joints: if names.is_empty() { (1..=count).map(|joint| format!("joint_{joint}")).collect() } else { names },
        })
    }

    /// Indices of the columns that make the recording, increasing.
    pub fn used(&self) -> Vec<usize> {
        let mut used = vec![self.time];
        used.extend(self.nanoseconds);
        let optional = [&self.qd, &self.qdd].into_iter().flatten();
        let truth = self.truth.iter().flatten();
        used.extend([&self.q, &self.tau].into_iter().chain(optional).chain(truth).flatten());
        used.retain(|column| *column != ABSENT);
        used.sort_unstable();
        used.dedup();
        used
    }

    /// Index of the column of time; [`ABSENT`] where there is none.
    pub fn time(&self) -> usize {
        self.time
    }

    /// Index of the column of the nanoseconds behind whole seconds.
    pub fn nanoseconds(&self) -> Option<usize> {
        self.nanoseconds
    }

    /// Seconds per unit of time, where the column's name gives it.
    pub fn time_factor(&self) -> Option<f64> {
        self.time_factor
    }

    /// Names of the joints.
    pub fn joints(&self) -> &[String] {
        &self.joints
    }

    /// Index of the column of every joint's position.
    pub fn positions(&self) -> &[usize] {
        &self.q
    }

    /// Index of the column of every joint's torque; [`ABSENT`] for joints without.
    pub fn torques(&self) -> &[usize] {
        &self.tau
    }

    /// Takes time from a column that was added, in seconds.
    pub fn set_time(&mut self, column: usize) {
        (self.time, self.nanoseconds) = (column, None);
    }

    /// Index of the column of every joint's velocity; [`ABSENT`] for joints without.
    pub fn velocities(&self) -> Option<&[usize]> {
        self.qd.as_deref()
    }

    /// Indices of the columns of velocity and acceleration.
    pub fn derivatives(&self) -> impl Iterator<Item = usize> + '_ {
        [&self.qd, &self.qdd].into_iter().flatten().flatten().copied().filter(|column| *column != ABSENT)
    }

    /// The first row with a value that is not finite or a time that does not increase. `columns` is indexed as the
    /// header.
    pub fn fault(&self, columns: &[Vec<f64>]) -> Option<Fault> {
        let infinite = self.used().into_iter().filter_map(|column| {
            let row = columns[column].iter().position(|value| !value.is_finite())?;
            Some(Fault { row, column, problem: format!("{} is not a finite number", columns[column][row]) })
        });
        let time = &columns[self.time];
        let backward = time.windows(2).position(|pair| pair[1] <= pair[0]).map(|before| Fault {
            row: before + 1,
            column: self.time,
            problem: format!("time must increase, but {:?} s follows {:?} s", time[before + 1], time[before]),
        });
        infinite.chain(backward).min_by_key(|fault| fault.row)
    }

    /// The recording; `columns` is indexed as the header. Robot and provenance stay empty.
    pub fn recording(self, mut columns: Vec<Vec<f64>>) -> Recording {
        let time = std::mem::take(&mut columns[self.time]);
        let mut take = |indices: &[usize]| {
            let column = |&index: &usize| match index {
                ABSENT => vec![f64::NAN; time.len()],
                _ => std::mem::take(&mut columns[index]),
            };
            let vectors: Vec<_> = indices.iter().map(column).collect();
            Channels::from_vectors(&vectors)
        };
        let q = take(&self.q);
        let qd = self.qd.as_deref().map(&mut take);
        let qdd = self.qdd.as_deref().map(&mut take);
        let tau = take(&self.tau);
        let truth = self.truth.map(|[q, qd, qdd, tau]| {
            Arc::new(Signals { q: take(&q), qd: take(&qd), qdd: take(&qdd), tau: take(&tau) })
        });
        Recording { joints: self.joints, time, q, qd, qdd, tau, truth, ..Default::default() }
    }
}

/// Names of columns, those of one list as one: `action[0..5]`.
fn listed(names: &[String]) -> String {
    const SHOWN: usize = 30;
    let parts = |name: &str| -> Option<(String, usize)> {
        let (stem, number) = name.strip_suffix(']')?.rsplit_once('[')?;
        Some((stem.to_owned(), number.parse().ok()?))
    };
    let mut out: Vec<String> = Vec::new();
    let mut at = 0;
    while at < names.len() {
        let mut end = at + 1;
        if let Some((stem, first)) = parts(&names[at]) {
            while end < names.len() && parts(&names[end]) == Some((stem.clone(), first + end - at)) {
                end += 1;
            }
            if end > at + 1 {
                out.push(format!("{stem}[{first}..{}]", first + end - at - 1));
                at = end;
                continue;
            }
        }
        out.push(names[at].clone());
        at = end;
    }
    let more = out.len().saturating_sub(SHOWN);
    out.truncate(SHOWN);
    let text = out.join(", ");
    if more > 0 { format!("{text} and {more} more") } else { text }
}

/// Where time is.
#[derive(Debug, Clone, Copy, Default)]
struct Clock {
    time: usize,
    nanoseconds: Option<usize>,
    factor: Option<f64>,
    open_unit: bool,
    is_index: bool,
}

/// Turns columns found into one column per joint, or reports what is missing.
struct Resolver<'a> {
    path: &'a Path,
    line: Option<usize>,
    header: &'a [String],
    names: &'a [String],
    /// The names are the caller's, not the header's.
    fixed: bool,
    lenient: bool,
}

impl Resolver<'_> {
    /// The column of time, or the two of seconds and nanoseconds.
    fn clock(&self, used: &BTreeSet<usize>, [no_position, no_torque]: [bool; 2]) -> Result<Clock> {
        let times = self.header.iter().enumerate().filter(|(column, _)| !used.contains(column));
        let times = times.filter_map(|(column, name)| names::time(name, column).map(|time| (column, time)));
        let times: Vec<(usize, names::Time)> = times.collect();
        let of_part = |part| times.iter().filter(move |(_, time)| time.part == part);
        let best = times.iter().filter(|(_, time)| time.part != Part::Nanoseconds).min_by_key(|(_, time)| time.rank);
        let Some(&(column, time)) = best else {
            let (others, files) = match (no_position, no_torque) {
                (false, false) => ("", ""),
                (true, false) => (", and none of position", CURE_OF_SIGNALS),
                (false, true) => (", and none of torque", CURE_OF_SIGNALS),
                (true, true) => (", and none of position or torque", CURE_OF_SIGNALS),
            };
            let reason = format!("no column of time (t or time, in s){others}");
            return Err(self.missing("t", &reason, &format!("{CURE_OF_TIME}{files}")));
        };
        let second = of_part(Part::Whole).find(|(other, own)| *other != column && own.rank == names::OWN_TIME);
        if let (names::OWN_TIME, Some(&(second, _))) = (time.rank, second) {
            let problem = format!("holds the same as column {}; leave one of them out", self.header[column]);
            return Err(Error::input(self.path, self.line, &self.header[second], problem));
        }
        let nanoseconds = of_part(Part::Nanoseconds).next().map(|(column, _)| *column);
        Ok(Clock {
            time: column,
            nanoseconds: nanoseconds.filter(|_| time.part == Part::Seconds),
            factor: time.factor,
            open_unit: time.factor.is_none()
                && !matches!(time.rank, names::OWN_TIME | names::INDEX)
                && time.part == Part::Whole,
            is_index: time.rank == names::INDEX,
        })
    }

    /// Column of each joint; `count` joints where that is already known.
    fn all(&self, quantity: Quantity, found: &Found, count: Option<usize>) -> Result<Vec<usize>> {
        let Quantity { name, prefixes, suffixes, .. } = quantity;
        let named = (!self.names.is_empty() || self.fixed).then_some(self.names.len());
        let highest = found.last_key_value().map_or(0, |(&number, _)| number);
        let may_lack = self.lenient && count.is_some() && !found.is_empty();
        let count = count.or(named).unwrap_or(highest);
        let robot = || format!("the robot has {} joints ({})", self.names.len(), self.names.join(", "));
        if let Some((_, &column)) = found.range(count + 1..).next() {
            let known = if self.fixed { robot() } else { format!("there are positions of {count} joints") };
            let problem = format!("a {name} too many: {known}");
            return Err(Error::input(self.path, self.line, &self.header[column], problem));
        }
        let gap = (1..=count.max(1)).find(|number| !found.contains_key(number));
        let Some(gap) = gap else { return Ok(found.values().copied().collect()) };
        if may_lack {
            return Ok((1..=count).map(|number| found.get(&number).copied().unwrap_or(ABSENT)).collect());
        }
        let column = format!("{}{gap}", prefixes[0]);
        let accepted = match self.names.get(gap - 1) {
            Some(joint) => format!("{column}, {}_{joint} or {joint}{}", prefixes[0], suffixes[0]),
            None => column.clone(),
        };
        let reason = if found.is_empty() {
            format!("no column of {name} ({accepted})")
        } else if gap < highest {
            let next = found.range(gap..).next().map_or("", |(_, &column)| self.header[column].as_str());
            format!("a hole in the numbering: {next} is there, but no {accepted}")
        } else if self.fixed {
            format!("fewer joints than the robot: no {accepted}; {}", robot())
        } else {
            format!("no column {accepted}, though there are positions of {count} joints")
        };
        let of_rows = |column: &String| ["name", "joint", "joint_name"].contains(&column.to_lowercase().as_str());
        let cure = match found.is_empty() {
            true if self.header.iter().any(of_rows) => CURE_OF_LONG,
            true => CURE_OF_SIGNALS,
            false => "",
        };
        Err(self.missing(&column, &reason, cure))
    }

    fn missing(&self, column: &str, reason: &str, cure: &str) -> Error {
        let found = listed(self.header);
        let hint = if self.header.iter().all(|name| name.parse::<f64>().is_ok()) {
            "; the first line must name the columns"
        } else if self.line.is_some() {
            "; rename the columns, or give their names in a dataset ([columns])"
        } else {
            ""
        };
        let cure = if hint.contains("first line") { "" } else { cure };
        Error::input(self.path, self.line, column, format!("missing column: {reason}; found: {found}{hint}{cure}"))
    }
}

/// What helps where no column of time is there.
const CURE_OF_TIME: &str = "; without one, give the sampling rate in a dataset: rate_hz = 100 in [columns]";

/// What helps where positions or torques are not there.
const CURE_OF_SIGNALS: &str =
    "; if another file holds them, name both in a dataset: [[train]] files = [\"q.csv\", \"tau.csv\"]";

/// What helps where each row is of one joint.
const CURE_OF_LONG: &str = "; each row holds one joint: make one row of each time, as pandas does with pivot(index=\"time\", \
                            columns=\"name\"), and join the two levels of names by \"/\"";

#[cfg(test)]
mod tests;
