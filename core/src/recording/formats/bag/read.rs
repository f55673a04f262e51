//! Reading of logs of ROS 2.

use super::files::files;
use super::groups::Groups;
use super::storage::{self, Contents, Topic};
use super::table::Table;
use crate::error::{Error, Result};
use crate::recording::Recording;
use crate::recording::columns::Layout;
use std::collections::BTreeMap;
use std::path::Path;

/// How a file of SQLite begins.
const SQLITE: &[u8] = b"SQLite format 3\0";

/// Reads a log. `joints` are wanted where they are known, from `topic` where that is known.
///
/// # Errors
/// An unreadable file, no joint state in it, several topics with the joints.
pub(crate) fn read(path: &Path, joints: Option<&[String]>, topic: Option<&str>) -> Result<Table> {
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
pub(crate) fn recording(path: &Path, joints: Option<&[String]>) -> Result<(Recording, Vec<String>)> {
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
pub(crate) fn provenance(topic: String, start_ns: i64) -> BTreeMap<String, String> {
    BTreeMap::from([("topic".to_owned(), topic), ("start_unix_ns".to_owned(), start_ns.to_string())])
}
