//! One column for each joint, and one of time, from the columns that were found by their names; else what is missing.

use super::flat;
use super::layout::ABSENT;
use super::names::{self, Part, Quantity};
use crate::error::{Error, Result};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Columns of one quantity: number of the joint, counted from 1 -> index of the column.
pub(super) type Found = BTreeMap<usize, usize>;

/// Where time is.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Clock {
    pub time: usize,
    pub nanoseconds: Option<usize>,
    pub factor: Option<f64>,
    pub open_unit: bool,
    pub is_index: bool,
}

/// Turns columns found into one column per joint, or reports what is missing.
pub(super) struct Resolver<'a> {
    pub path: &'a Path,
    pub line: Option<usize>,
    pub header: &'a [String],
    pub names: &'a [String],
    /// The names are the caller's, not the header's.
    pub fixed: bool,
    pub lenient: bool,
}

impl Resolver<'_> {
    /// The column of time, or the two of seconds and nanoseconds.
    pub(super) fn clock(&self, used: &BTreeSet<usize>, [no_position, no_torque]: [bool; 2]) -> Result<Clock> {
        let times = self.header.iter().enumerate().filter(|(column, _)| !used.contains(column));
        let times = times.filter_map(|(column, name)| names::time(name, column).map(|time| (column, time)));
        let times: Vec<(usize, names::Time)> = times.collect();
        // `time_sec` next to `time_nsec` holds whole seconds.
        let behind = |column: usize| {
            self.header.iter().position(|other| names::are_seconds_and_rest(&self.header[column], other))
        };
        let rests: Vec<usize> = times.iter().filter_map(|(column, _)| behind(*column)).collect();
        let times: Vec<(usize, names::Time)> =
            times.into_iter().filter(|(column, _)| !rests.contains(column)).collect();
        let of_part = |part| times.iter().filter(move |(_, time)| time.part == part);
        let best = times.iter().filter(|(_, time)| time.part != Part::Nanoseconds).min_by_key(|(_, time)| time.rank);
        let Some(&(column, time)) = best else {
            let (others, files) = match (no_position, no_torque) {
                (false, false) => ("", String::new()),
                (true, false) => (", and none of position", self.cure_of_signals()),
                (false, true) => (", and none of torque", CURE_OF_SIGNALS.to_owned()),
                (true, true) => (", and none of position or torque", self.cure_of_signals()),
            };
            let reason = format!("no column of time (t or time, in s){others}");
            return Err(self.missing("t", &reason, &format!("{CURE_OF_TIME}{files}")));
        };
        let second = of_part(Part::Whole).find(|(other, own)| *other != column && own.rank == names::OWN_TIME);
        if let (names::OWN_TIME, Some(&(second, _))) = (time.rank, second) {
            let problem = format!("holds the same as column {}; leave one of them out", self.header[column]);
            return Err(Error::input(self.path, self.line, &self.header[second], problem));
        }
        let apart = of_part(Part::Nanoseconds).next().map(|(column, _)| *column);
        let nanoseconds = behind(column).or(apart.filter(|_| time.part == Part::Seconds));
        let factor = time.factor.filter(|_| nanoseconds.is_none());
        Ok(Clock {
            time: column,
            nanoseconds,
            factor,
            open_unit: factor.is_none()
                && !matches!(time.rank, names::OWN_TIME | names::INDEX)
                && nanoseconds.is_none(),
            is_index: time.rank == names::INDEX,
        })
    }

    /// Column of each joint; `count` joints where that is already known.
    pub(super) fn all(&self, quantity: Quantity, found: &Found, count: Option<usize>) -> Result<Vec<usize>> {
        let Quantity { name, prefixes, suffixes, .. } = quantity;
        let named = (!self.names.is_empty() || self.fixed).then_some(self.names.len());
        let highest = found.last_key_value().map_or(0, |(&number, _)| number);
        let may_lack = self.lenient && count.is_some() && !found.is_empty();
        let count = count.or(named).unwrap_or(highest);
        let robot = || format!("the robot has {} joints ({})", self.names.len(), self.names.join(", "));
        let gap = (1..=count.max(1)).find(|number| !found.contains_key(number));
        // Beyond a hole, the numbers of the file are not those of the joints.
        if let Some((_, &column)) = found.range(count + 1..).next().filter(|_| gap.is_none()) {
            let known = if self.fixed { robot() } else { format!("there are positions of {count} joints") };
            let header = &self.header[column];
            let of_simulator = if highest == 2 * count {
                "with twice as many numbers they may be a state, positions and velocities behind them: "
            } else if header.contains("qpos") {
                "qpos holds all bodies of a MuJoCo model, of which a free one takes 7 places here and 6 in qvel and qfrc: give the model, an .xml \
                 file, as the robot, or "
            } else {
                ""
            };
            let cure = "name the columns of these joints in a dataset: [columns] q = [..], qd = [..], tau = [..]";
            let example = flat::cure(self.header, count, Some(header)).filter(|_| self.fixed);
            let cure = example.as_deref().unwrap_or(cure);
            let problem = format!("a {name} too many: {known}; {of_simulator}{cure}");
            return Err(Error::input(self.path, self.line, header, problem));
        }
        let Some(gap) = gap else { return Ok(found.values().copied().collect()) };
        if may_lack {
            return Ok((1..=count).map(|number| found.get(&number).copied().unwrap_or(ABSENT)).collect());
        }
        let column = format!("{}{gap}", prefixes[0]);
        let accepted = match self.names.get(gap - 1).filter(|_| highest <= count) {
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
        let external = self
            .header
            .iter()
            .find(|own| name == names::QUANTITIES[names::TORQUE].name && names::is_external_torque(own));
        let of_rows = |column: &String| ["name", "joint", "joint_name"].contains(&column.to_lowercase().as_str());
        let cure = match found.is_empty() {
            true => match self.header.iter().find(|column| of_rows(column)) {
                Some(joint) => self.cure_of_long(joint),
                None => match external {
                    Some(external) => format!(
                        "; {external} and its like are torques of contact, without those that move the arm: log the measured torques too"
                    ),
                    None if name == names::QUANTITIES[names::TORQUE].name => {
                        let control = self.header.iter().find(|own| own.to_lowercase().starts_with("ctrl"));
                        let of_control = control.map_or(String::new(), |own| format!("; {own} {CURE_OF_CONTROLS}"));
                        format!("{CURE_OF_SIGNALS}{CURE_OF_TORQUES}{of_control}")
                    }
                    None => self.cure_of_signals(),
                },
            },
            false => String::new(),
        };
        Err(self.missing(&column, &reason, &cure))
    }

    /// What helps where no column is a position: an array may hold them, or another file.
    fn cure_of_signals(&self) -> String {
        let of_array = flat::cure(self.header, self.names.len(), None).filter(|_| self.fixed);
        of_array.map_or_else(|| CURE_OF_SIGNALS.to_owned(), |cure| format!("; {cure}"))
    }

    /// What helps where each row is of the one joint that column `joint` names.
    fn cure_of_long(&self, joint: &str) -> String {
        let others = self.header.iter().enumerate().filter(|(_, name)| *name != joint);
        let times = others.filter_map(|(column, name)| Some((names::time(name, column)?.rank, name)));
        let time = times.min_by_key(|(rank, _)| *rank).map_or("time", |(_, name)| name.as_str());
        format!(
            "; each row holds one joint: make one row of each time, as pandas does with pivot(index=\"{time}\", columns=\"{joint}\"), and \
             join the two levels of names by \"/\""
        )
    }

    fn missing(&self, column: &str, reason: &str, cure: &str) -> Error {
        let unnamed = self.header.iter().all(|name| name.parse::<f64>().is_ok());
        let found = match unnamed {
            true => format!("{} columns of numbers", self.header.len()),
            false => listed(self.header),
        };
        let hint = if unnamed {
            "; no line names the columns: write their names above the rows, or give their numbers in a dataset, counted from 1: \
             [columns] time = 1, q = [2, 3], tau = [4, 5]"
        } else if self.line.is_some() {
            "; rename the columns, or give their names in a dataset ([columns])"
        } else {
            ""
        };
        let cure = if unnamed { "" } else { cure };
        let cure = &format!("{cure}{}", if is_garbled(self.header) { CURE_OF_ENCODING } else { "" });
        Error::input(self.path, self.line, column, format!("missing column: {reason}; found: {found}{hint}{cure}"))
    }
}

/// Names of columns, those of one list as one: `action[0..5]`.
pub(super) fn listed(names: &[String]) -> String {
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

/// Whether names hold control characters, which no text in UTF-8 or Latin-1 has: the file is in another encoding.
fn is_garbled(header: &[String]) -> bool {
    header.iter().flat_map(|name| name.chars()).any(|letter| ('\u{80}'..='\u{9f}').contains(&letter))
}

/// What helps where the names are in another encoding.
const CURE_OF_ENCODING: &str = "; the names are in an encoding that is not read, as Shift-JIS or GBK: save the file as UTF-8 (iconv -f SHIFT_JIS -t UTF-8)";

/// What helps where torques were not logged.
const CURE_OF_TORQUES: &str = "; if they were not logged, log the measured torques or motor currents with the positions: without them nothing of the dynamics is known";

/// What helps where a simulator's controls were logged.
const CURE_OF_CONTROLS: &str = "and its like are controls of a simulator: those of torque motors (<motor> of MuJoCo) are torques before their gears, which \
                                a dataset names ([columns] tau = [\"ctrl_0\", ..], [motors] gear_ratio = [..], torque_at = \"motor\"); those of \
                                position or velocity actuators are no torques: log qfrc_actuator";

/// What helps where no column of time is there.
const CURE_OF_TIME: &str = "; without one, give the sampling rate in a dataset: rate_hz = 100 in [columns]";

/// What helps where positions or torques are not there.
const CURE_OF_SIGNALS: &str =
    "; if another file holds them, name both in a dataset: [[train]] files = [\"q.csv\", \"tau.csv\"]";
