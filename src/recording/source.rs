//! Files of every format as tables: a header first, and then the columns that are wanted.

use super::format::{self, Format};
use super::lenient::ColumnMap;
use super::sieve::{Cause, Rejected};
use super::text::Text;
use super::{Recording, memory, names, numpy, parquet};
use crate::error::{Error, Result};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A file whose header is known.
pub enum Source {
    /// A table in text.
    Text(Text),
    /// A Parquet file.
    Parquet(parquet::Table),
    /// A log of ROS 2, read already.
    #[cfg(feature = "bags")]
    Bag(super::bag::Table),
    /// Arrays of numpy, read already.
    Arrays(numpy::Table),
    /// A log that this program holds.
    Memory(Arc<memory::Table>),
}

/// The rows of a file.
#[derive(Default)]
struct Content {
    /// Values of the columns in use, indexed as the header.
    columns: Vec<Vec<f64>>,
    /// Line, row or message of each row.
    lines: Vec<usize>,
    /// Place of each row among all of the file.
    ordinals: Vec<usize>,
    /// Rows of the file, those left out counted.
    all: usize,
    rejected: Vec<Rejected>,
}

/// Rows of all files together: columns indexed as the header, lines of the first file, rows that cannot be read.
pub type Joined = (Vec<Vec<f64>>, Vec<usize>, Vec<Rejected>);

/// Opens a file, or a log in memory. `joints` are wanted where they are known.
///
/// # Errors
/// An unreadable file, or one of a kind that is not read.
#[cfg_attr(not(feature = "bags"), allow(unused_variables, reason = "only bags are read by joint and topic"))]
pub fn open(path: &Path, joints: Option<&[String]>, map: &ColumnMap) -> Result<Source> {
    if let Some(table) = memory::find(path) {
        return Ok(Source::Memory(table));
    }
    Ok(match format::of(path)? {
        Format::Text => Source::Text(Text::open(path)?),
        Format::Parquet => Source::Parquet(parquet::Table::open(path)?),
        #[cfg(feature = "bags")]
        Format::Bag => Source::Bag(super::bag::read(path, joints, map.topic.as_deref())?),
        Format::Npz => Source::Arrays(numpy::npz(path)?),
        Format::Npy => Source::Arrays(numpy::npy(path)?),
    })
}

impl Source {
    /// Names of the columns.
    pub fn header(&self) -> &[String] {
        match self {
            Source::Text(text) => &text.header,
            Source::Parquet(table) => &table.header,
            #[cfg(feature = "bags")]
            Source::Bag(table) => &table.header,
            Source::Arrays(table) => &table.header,
            Source::Memory(table) => &table.header,
        }
    }

    /// Line of the header, of a text.
    pub fn line(&self) -> Option<usize> {
        match self {
            Source::Text(text) => Some(text.header_line),
            _ => None,
        }
    }

    /// Names of the joints that the file keeps behind its header.
    pub fn own_joints(&self) -> Option<Vec<String>> {
        match self {
            Source::Parquet(table) => table.own_joints.clone(),
            _ => None,
        }
    }

    /// What the file has and its table has not.
    pub fn notes(&self) -> Vec<String> {
        match self {
            #[cfg(feature = "bags")]
            Source::Bag(table) => table.notes.clone(),
            _ => Vec::new(),
        }
    }

    /// Why there is no torque in messages about `joints` whose positions are there.
    #[cfg_attr(not(feature = "bags"), allow(unused_variables, reason = "only bags are read by joint and topic"))]
    pub fn without_effort(&self, joints: Option<&[String]>) -> Option<String> {
        match self {
            #[cfg(feature = "bags")]
            Source::Bag(table) => {
                let has = |joint: &String| table.header.contains(&format!("{joint}_position"));
                let there = joints.is_none_or(|joints| joints.iter().all(has));
                let effort = table.header.iter().any(|column| column.ends_with("_effort"));
                (there && !effort).then(|| {
                    format!(
                        "the messages on {} carry no effort: the driver does not report torques; have it report them, or log \
                         motor currents",
                        table.topic
                    )
                })
            }
            _ => None,
        }
    }

    /// Adds the file's metadata on a recording.
    pub fn describe(&self, recording: &mut Recording) {
        match self {
            Source::Parquet(table) => table.describe(recording),
            #[cfg(feature = "bags")]
            Source::Bag(table) => {
                recording.provenance = super::bag::provenance(table.topic.clone(), table.start_ns);
            }
            _ => {}
        }
    }

    fn content(&mut self, path: &Path, header: &[String], used: &[usize]) -> Result<Content> {
        let numbered = |columns: Vec<Vec<f64>>| {
            let all = used.first().map_or(0, |&column| columns[column].len());
            Content { columns, lines: (1..=all).collect(), ordinals: (0..all).collect(), all, rejected: Vec::new() }
        };
        Ok(match self {
            Source::Text(text) => {
                let mut bad = Vec::new();
                let rows = text.rows(path, header, used, true, &mut |row| {
                    bad.push(row);
                    Ok(())
                })?;
                let starts: Vec<usize> = bad.iter().map(|row| row.start).collect();
                let all = bad.len() + rows.ordinals.len();
                let rejected = bad.into_iter().zip(text.lines(&starts)).map(|(row, line)| Rejected {
                    line,
                    column: row.field,
                    cause: Cause::Unreadable,
                    problem: row.problem,
                });
                Content {
                    rejected: rejected.collect(),
                    lines: text.lines(&rows.starts),
                    columns: rows.columns,
                    ordinals: rows.ordinals,
                    all,
                }
            }
            Source::Parquet(table) => numbered(table.rows(path, header, used, true)?),
            Source::Arrays(table) => numbered(std::mem::take(&mut table.columns)),
            Source::Memory(table) => numbered(table.columns(used)?),
            #[cfg(feature = "bags")]
            Source::Bag(table) => {
                let unreadable = std::mem::take(&mut table.bad).into_iter().map(|(line, problem)| Rejected {
                    line,
                    column: "message".to_owned(),
                    cause: Cause::Unreadable,
                    problem,
                });
                let cut_off = table.cut_off.take().map(|problem| Rejected {
                    line: table.numbers.last().map_or(0, |last| last + 1),
                    column: "file".to_owned(),
                    cause: Cause::CutOff,
                    problem,
                });
                let rejected = unreadable.chain(cut_off).collect();
                let lines = std::mem::take(&mut table.numbers);
                let count = lines.len();
                let columns = std::mem::take(&mut table.columns);
                Content { columns, lines, ordinals: (0..count).collect(), all: count, rejected }
            }
        })
    }
}

/// Hides the times of all files but the first that has one, and returns for every file its column of time.
pub fn hide_times(sources: &[Source], header: &mut [String]) -> Vec<Option<usize>> {
    let mut start = 0;
    let mut known = false;
    let mut out = Vec::new();
    for source in sources {
        let own = start..start + source.header().len();
        let ranked = own.clone().filter_map(|column| {
            let time = names::time(&header[column], column - own.start)?;
            (time.rank < names::INDEX).then_some((time.rank, column))
        });
        let time = ranked.min().map(|(_, column)| column);
        if known && sources.len() > 1 {
            for column in own.clone() {
                if names::time(&header[column], column - own.start).is_some() {
                    header[column] = format!("({})", header[column]);
                }
            }
        }
        known |= time.is_some();
        out.push(time);
        start = own.end;
    }
    out
}

/// The rows of all files together: columns indexed as the header, lines of the first file, rows that cannot be read.
///
/// # Errors
/// Those of reading, and files whose rows cannot be matched.
pub fn rows(
    paths: &[PathBuf],
    sources: &mut [Source],
    header: &[String],
    used: &[usize],
    times: &[Option<usize>],
) -> Result<Joined> {
    let mut contents = Vec::new();
    let mut start = 0;
    for ((path, source), time) in paths.iter().zip(sources.iter_mut()).zip(times) {
        let own = start..start + source.header().len();
        let mut wanted: Vec<usize> =
            used.iter().filter(|column| own.contains(*column)).map(|column| column - own.start).collect();
        if paths.len() > 1 {
            wanted.extend(time.map(|time| time - own.start).filter(|time| !wanted.contains(time)));
            wanted.sort_unstable();
        }
        contents.push(source.content(path, &header[own.clone()], &wanted)?);
        start = own.end;
    }
    let Some(first) = contents.first() else { return Ok(Default::default()) };
    if contents.len() == 1 {
        let Content { columns, lines, rejected, .. } = contents.remove(0);
        return Ok((columns, lines, rejected));
    }
    let one_by_one = contents.iter().all(|content| content.all == first.all);
    if one_by_one { matched(contents) } else { by_time(paths, contents, times) }
}

/// Rows that are good in every file, matched by their place.
fn matched(contents: Vec<Content>) -> Result<Joined> {
    let mut seen: BTreeMap<usize, usize> = BTreeMap::new();
    contents.iter().flat_map(|content| &content.ordinals).for_each(|&ordinal| *seen.entry(ordinal).or_default() += 1);
    let good = |ordinal: &usize| seen.get(ordinal) == Some(&contents.len());
    let mut out = (Vec::new(), Vec::new(), Vec::new());
    for (file, content) in contents.iter().enumerate() {
        let kept: Vec<usize> = (0..content.ordinals.len()).filter(|&row| good(&content.ordinals[row])).collect();
        out.0.extend(content.columns.iter().map(|column| match column.is_empty() {
            true => Vec::new(),
            false => kept.iter().map(|&row| column[row]).collect(),
        }));
        if file == 0 {
            out.1 = kept.iter().map(|&row| content.lines[row]).collect();
        }
        out.2.extend(content.rejected.iter().cloned());
    }
    Ok(out)
}

/// The rows of the first file with time, and the values of the others at its times.
fn by_time(paths: &[PathBuf], contents: Vec<Content>, times: &[Option<usize>]) -> Result<Joined> {
    let mut start = 0;
    let mut clocks: Vec<&[f64]> = Vec::new();
    for ((content, time), path) in contents.iter().zip(times).zip(paths) {
        let Some(time) = time else {
            let counts: Vec<String> = contents.iter().map(|content| content.all.to_string()).collect();
            let problem = format!(
                "no column of time, and the files have {} rows, so that they cannot be matched; give each a time, or as many \
                 rows",
                counts.join(" and ")
            );
            return Err(Error::input(path, None, "t", problem));
        };
        clocks.push(&content.columns[time - start]);
        start += content.columns.len();
    }
    let mut out = (Vec::new(), Vec::new(), Vec::new());
    for (file, content) in contents.iter().enumerate() {
        out.0.extend(content.columns.iter().map(|column| match (file, column.is_empty()) {
            (0, _) | (_, true) => column.clone(),
            _ => at_times(clocks[file], column, clocks[0]),
        }));
        if file == 0 {
            out.1 = content.lines.clone();
        }
        out.2.extend(content.rejected.iter().cloned());
    }
    Ok(out)
}

/// Values at other times, in a line between samples; NaN outside.
fn at_times(time: &[f64], values: &[f64], wanted: &[f64]) -> Vec<f64> {
    let mut points: Vec<(f64, f64)> =
        time.iter().copied().zip(values.iter().copied()).filter(|(t, v)| t.is_finite() && v.is_finite()).collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    points.dedup_by(|a, b| a.0 == b.0);
    let at = |&t: &f64| {
        let next = points.partition_point(|point| point.0 < t);
        match (next.checked_sub(1).map(|before| points[before]), points.get(next)) {
            (_, Some(&(t1, v1))) if t1 == t => v1,
            (Some((t0, v0)), Some(&(t1, v1))) => v0 + (v1 - v0) * (t - t0) / (t1 - t0),
            _ => f64::NAN,
        }
    };
    wanted.iter().map(at).collect()
}
