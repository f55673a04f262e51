//! Logs of ROS 2: MCAP files and bags (folders, `.mcap`, `.db3`) with sensor_msgs/JointState.
//!
//! A message is a row. Time is that of the messages' headers, from the first on; where nobody set it, that at which they
//! were logged. Columns are `NAME_position`, `NAME_velocity`, `NAME_effort`, whatever order the messages name their joints
//! in. Several nodes may send different joints on one topic: messages with the same joints belong together.

mod joint_state;
mod storage;
pub mod write;

use super::Recording;
use super::columns::Layout;
use crate::error::{Error, Result};
use joint_state::JointState;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use storage::{Contents, Topic};

/// The messages of one topic about the same joints as a table.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Table {
    /// The topic.
    pub topic: String,
    /// Time of the first message, ns since 1970.
    pub start_ns: i64,
    /// `t` and one column per joint and quantity that was sent.
    pub header: Vec<String>,
    /// Values, indexed as the header; NaN where a message has none.
    pub columns: Vec<Vec<f64>>,
    /// Number of every message on its topic, counted from 1.
    pub numbers: Vec<usize>,
    /// Messages that cannot be read: number, what is wrong.
    pub bad: Vec<(usize, String)>,
    /// Why reading ended before the end of the log.
    pub cut_off: Option<String>,
    /// What the log has and the table has not.
    pub notes: Vec<String>,
}

/// Whether a path is a bag by its name.
pub fn is_bag(path: &Path) -> bool {
    let name = path.file_name().map(|name| name.to_string_lossy().to_lowercase()).unwrap_or_default();
    let name = name.strip_suffix(".zstd").unwrap_or(&name);
    name.ends_with(".mcap") || name.ends_with(".db3") || path.join(METADATA).is_file()
}

/// The file that describes a bag of several files.
const METADATA: &str = "metadata.yaml";

/// How a file of SQLite begins.
const SQLITE: &[u8] = b"SQLite format 3\0";

/// Reads a log. `joints` are wanted where they are known, from `topic` where that is known.
///
/// # Errors
/// An unreadable file, no joint state in it, several topics with the joints.
pub fn read(path: &Path, joints: Option<&[String]>, topic: Option<&str>) -> Result<Table> {
    let mut groups = Groups::default();
    let mut topics: Vec<Topic> = Vec::new();
    let mut cut_off = None;
    for file in files(path)? {
        let name = file.to_string_lossy().to_lowercase();
        let mut hear = |topic: &str, logged: i64, data: &[u8]| groups.add(topic, logged, data);
        let sqlite = name.trim_end_matches(".zstd").ends_with(".db3") || storage::begins_with(&file, SQLITE)?;
        let read = if sqlite { storage::sqlite } else { storage::mcap };
        let Contents { topics: found, cut_off: cut } = read(&file, &mut hear)?;
        topics.extend(found);
        cut_off = cut_off.or(cut.map(|reason| match file == *path {
            true => reason,
            false => format!("{}: {reason}", file.display()),
        }));
    }
    if let (true, Some(reason)) = (topics.is_empty(), &cut_off) {
        return Err(Error::input(path, None, "messages", format!("none can be read: {reason}; copy the log again")));
    }
    topics.sort();
    topics.dedup();
    let group = groups.choose(path, &topics, joints, topic)?;
    Ok(Table { cut_off, ..group })
}

/// A log without a fault, and what in it was not used.
///
/// # Errors
/// Those of [`read`], a message that cannot be read, a log that is cut off, values that are not finite, time that does not
/// increase.
pub fn recording(path: &Path, joints: Option<&[String]>) -> Result<(Recording, Vec<String>)> {
    let table = read(path, joints, None)?;
    let mut layout = Layout::find(path, None, &table.header, joints)?;
    if let Some((number, problem)) = table.bad.first() {
        return Err(Error::input(path, Some(*number), "message", problem.as_str()));
    }
    if let Some(problem) = table.cut_off {
        return Err(Error::input(path, None, "file", format!("the log is cut off: {problem}")));
    }
    if let Some(fault) = layout.fault(&table.columns) {
        return Err(Error::input(path, Some(table.numbers[fault.row]), &table.header[fault.column], fault.problem));
    }
    let notes = std::mem::take(&mut layout.notes).into_iter().chain(table.notes).collect();
    let provenance = provenance(table.topic, table.start_ns);
    Ok((Recording { provenance, ..layout.recording(table.columns) }, notes))
}

/// What a recording keeps of where it comes from.
pub fn provenance(topic: String, start_ns: i64) -> BTreeMap<String, String> {
    BTreeMap::from([("topic".to_owned(), topic), ("start_unix_ns".to_owned(), start_ns.to_string())])
}

/// The files of a bag in their order; a file is its own.
fn files(path: &Path) -> Result<Vec<PathBuf>> {
    if !path.is_dir() {
        return Ok(vec![path.to_owned()]);
    }
    let metadata = path.join(METADATA);
    let text = std::fs::read_to_string(&metadata).map_err(|source| Error::io(&metadata, "read the bag", source))?;
    let listed = text.lines().skip_while(|line| line.trim() != "relative_file_paths:").skip(1);
    let names = listed.map_while(|line| line.trim().strip_prefix("- "));
    let files: Vec<PathBuf> = names.map(|name| path.join(name.trim_matches(['"', '\'']))).collect();
    match files.is_empty() {
        true => Err(Error::input(metadata, None, "relative_file_paths", "names no file")),
        false => Ok(files),
    }
}

/// Messages on one topic about the same joints.
#[derive(Debug)]
struct Group {
    topic: String,
    names: Vec<String>,
    numbers: Vec<usize>,
    stamps: Vec<i64>,
    logged: Vec<i64>,
    /// Position, velocity and effort, `[quantity][joint][message]`.
    values: [Vec<Vec<f64>>; 3],
}

/// All messages so far.
#[derive(Debug, Default)]
struct Groups {
    all: Vec<Group>,
    /// Messages heard on every topic.
    heard: Vec<(String, usize)>,
    bad: Vec<(String, usize, String)>,
}

impl Groups {
    fn add(&mut self, topic: &str, logged: i64, data: &[u8]) {
        let heard = match self.heard.iter_mut().find(|(own, _)| own == topic) {
            Some((_, count)) => {
                *count += 1;
                *count
            }
            None => {
                self.heard.push((topic.to_owned(), 1));
                1
            }
        };
        let state = match JointState::decode(data) {
            Ok(state) => state,
            Err(problem) => return self.bad.push((topic.to_owned(), heard, problem)),
        };
        let same = |group: &Group| group.topic == topic && group.order(&state.names).is_some();
        let place = self.all.iter().rposition(same).unwrap_or_else(|| {
            let columns = || vec![Vec::new(); state.names.len()];
            self.all.push(Group {
                topic: topic.to_owned(),
                names: state.names.clone(),
                numbers: Vec::new(),
                stamps: Vec::new(),
                logged: Vec::new(),
                values: std::array::from_fn(|_| columns()),
            });
            self.all.len() - 1
        });
        self.all[place].push(heard, logged, &state);
    }

    /// The messages that are wanted, as a table.
    fn choose(self, path: &Path, topics: &[Topic], joints: Option<&[String]>, topic: Option<&str>) -> Result<Table> {
        let listed = || {
            let named = topics.iter().map(|topic| format!("{} ({}, {})", topic.name, topic.kind, topic.encoding));
            named.collect::<Vec<_>>().join(", ")
        };
        let mut groups = self.all;
        if let Some(topic) = topic {
            groups.retain(|group| group.topic == topic);
        }
        let has_all = |group: &Group| joints.is_none_or(|joints| joints.iter().all(|j| group.names.contains(j)));
        if groups.iter().any(has_all) {
            groups.retain(has_all);
        }
        if groups.iter().any(Group::has_effort) {
            groups.retain(Group::has_effort);
        }
        groups.sort_by_key(|group| std::cmp::Reverse(group.numbers.len()));
        let Some(first) = groups.first() else {
            let wanted = topic.unwrap_or("sensor_msgs/msg/JointState in cdr");
            let problem = match topics.is_empty() {
                true => "there is no message in it".to_owned(),
                false => format!("no message of {wanted} that can be read; the log has {}", listed()),
            };
            return Err(Error::input(path, None, "topic", problem));
        };
        let mut rivals: Vec<&str> = groups.iter().map(|group| group.topic.as_str()).collect();
        rivals.sort_unstable();
        rivals.dedup();
        if rivals.len() > 1 {
            let problem = format!("{} hold joint states; choose one in a dataset: [columns] topic", rivals.join(", "));
            return Err(Error::input(path, None, "topic", problem));
        }
        let chosen = first.topic.clone();
        let mut notes = Vec::new();
        let others = self.heard.iter().filter(|(topic, _)| *topic != chosen);
        notes.extend(others.map(|(topic, count)| format!("topic not used: {topic} ({count} messages)")));
        let rest: usize = groups[1..].iter().map(|group| group.numbers.len()).sum();
        if rest > 0 {
            notes.push(format!("{rest} messages of {chosen} about other joints are not used"));
        }
        let group = groups.swap_remove(0);
        let bad = self.bad.into_iter().filter(|(topic, ..)| *topic == chosen);
        let bad = bad.map(|(_, number, problem)| (number, problem)).collect();
        Ok(Table { bad, ..group.table(notes) })
    }
}

impl Group {
    /// Where each of this group's joints is among `names`; None for other joints.
    fn order(&self, names: &[String]) -> Option<Vec<usize>> {
        if names.len() != self.names.len() {
            return None;
        }
        self.names.iter().map(|own| names.iter().position(|name| name == own)).collect()
    }

    fn has_effort(&self) -> bool {
        self.values[2].iter().any(|column| column.iter().any(|value| value.is_finite()))
    }

    fn push(&mut self, number: usize, logged: i64, state: &JointState) {
        let order: Vec<usize> = match state.names == self.names {
            true => (0..self.names.len()).collect(),
            false => self.order(&state.names).unwrap_or_default(),
        };
        let sent = [&state.position, &state.velocity, &state.effort];
        for (columns, sent) in self.values.iter_mut().zip(sent) {
            for (column, &place) in columns.iter_mut().zip(&order) {
                column.push(sent.get(place).copied().unwrap_or(f64::NAN));
            }
        }
        self.numbers.push(number);
        self.stamps.push(state.stamp_ns);
        self.logged.push(logged);
    }

    fn table(self, mut notes: Vec<String>) -> Table {
        let stamped = self.stamps.iter().any(|&stamp| stamp != 0);
        if !stamped {
            notes.push("the messages carry no time; that at which they were logged is used".to_owned());
        }
        let stamps = if stamped { self.stamps } else { self.logged };
        let start_ns = stamps.first().copied().unwrap_or_default();
        let mut header = vec!["t".to_owned()];
        let mut columns: Vec<Vec<f64>> =
            vec![stamps.iter().map(|stamp| stamp.saturating_sub(start_ns) as f64 / 1e9).collect()];
        for (ending, values) in ["position", "velocity", "effort"].into_iter().zip(self.values) {
            if values.iter().all(|column| column.iter().all(|value| value.is_nan())) {
                continue;
            }
            header.extend(self.names.iter().map(|name| format!("{name}_{ending}")));
            columns.extend(values);
        }
        Table { topic: self.topic, start_ns, header, columns, numbers: self.numbers, notes, ..Table::default() }
    }
}

#[cfg(test)]
mod tests;
