//! Files of every format as tables: a header first, and then the columns that are wanted.

use crate::error::Result;
use crate::recording::Recording;
use crate::recording::cleaning::{Cause, Rejected};
use crate::recording::columns::ColumnMap;
#[cfg(feature = "bags")]
use crate::recording::formats::bag;
#[cfg(feature = "parquet")]
use crate::recording::formats::parquet;
use crate::recording::formats::text::Text;
use crate::recording::formats::{self, Format, numpy};
use crate::recording::memory;
use std::path::Path;
use std::sync::Arc;

/// A file whose header is known.
pub(super) enum Source {
    /// A table in text.
    Text(Text),
    /// A Parquet file.
    #[cfg(feature = "parquet")]
    Parquet(parquet::Table),
    /// A log of ROS 2, read already.
    #[cfg(feature = "bags")]
    Bag(bag::Table),
    /// Arrays of numpy, read already.
    Arrays(numpy::Table),
    /// A log that this program holds.
    Memory(Arc<memory::Table>),
}

/// The rows of a file.
#[derive(Default)]
pub(super) struct Content {
    /// Values of the columns in use, indexed as the header.
    pub columns: Vec<Vec<f64>>,
    /// Line, row or message of each row.
    pub lines: Vec<usize>,
    /// Place of each row among all of the file.
    pub ordinals: Vec<usize>,
    /// Rows of the file, those left out counted.
    pub all: usize,
    /// Rows that cannot be read.
    pub rejected: Vec<Rejected>,
}

/// Opens a file, or a log in memory. `joints` are wanted where they are known.
///
/// # Errors
/// An unreadable file, or one of a kind that is not read.
#[cfg_attr(not(feature = "bags"), allow(unused_variables, reason = "only bags are read by joint and topic"))]
pub(super) fn open(path: &Path, joints: Option<&[String]>, map: &ColumnMap) -> Result<Source> {
    if let Some(table) = memory::find(path) {
        return Ok(Source::Memory(table));
    }
    Ok(match formats::of(path)? {
        Format::Text => Source::Text(Text::open(path)?),
        #[cfg(feature = "parquet")]
        Format::Parquet => Source::Parquet(parquet::Table::open(path)?),
        #[cfg(feature = "bags")]
        Format::Bag => Source::Bag(bag::read(path, joints, map.topic.as_deref())?),
        Format::Npz => Source::Arrays(numpy::npz(path)?),
        Format::Npy => Source::Arrays(numpy::npy(path)?),
    })
}

impl Source {
    /// Names of the columns.
    pub(super) fn header(&self) -> &[String] {
        match self {
            Source::Text(text) => &text.header,
            #[cfg(feature = "parquet")]
            Source::Parquet(table) => &table.header,
            #[cfg(feature = "bags")]
            Source::Bag(table) => &table.header,
            Source::Arrays(table) => &table.header,
            Source::Memory(table) => &table.header,
        }
    }

    /// The table, of a text.
    pub(super) fn text(&self) -> Option<&Text> {
        match self {
            Source::Text(text) => Some(text),
            _ => None,
        }
    }

    /// Line of the header, of a text.
    pub(super) fn line(&self) -> Option<usize> {
        self.text().map(|text| text.header_line)
    }

    /// Names of the joints that the file keeps behind its header.
    pub(super) fn own_joints(&self) -> Option<Vec<String>> {
        match self {
            #[cfg(feature = "parquet")]
            Source::Parquet(table) => table.own_joints.clone(),
            _ => None,
        }
    }

    /// What the file has and its table has not.
    pub(super) fn notes(&self) -> Vec<String> {
        match self {
            #[cfg(feature = "bags")]
            Source::Bag(table) => table.notes.clone(),
            _ => Vec::new(),
        }
    }

    /// Why there is no torque in messages about `joints` whose positions are there.
    #[cfg_attr(not(feature = "bags"), allow(unused_variables, reason = "only bags are read by joint and topic"))]
    pub(super) fn without_effort(&self, joints: Option<&[String]>) -> Option<String> {
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
    #[cfg_attr(
        not(any(feature = "bags", feature = "parquet")),
        allow(unused_variables, reason = "only these files have metadata")
    )]
    pub(super) fn describe(&self, recording: &mut Recording) {
        match self {
            #[cfg(feature = "parquet")]
            Source::Parquet(table) => table.describe(recording),
            #[cfg(feature = "bags")]
            Source::Bag(table) => {
                recording.provenance = bag::provenance(table.topic.clone(), table.start_ns);
            }
            _ => {}
        }
    }

    /// The rows of the file, whose columns are called as in `header`.
    ///
    /// # Errors
    /// Those of reading.
    pub(super) fn content(&mut self, path: &Path, header: &[String], used: &[usize]) -> Result<Content> {
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
            #[cfg(feature = "parquet")]
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
