//! Recordings as CSV, for every other program: one header line, one row per sample, no comments.
//!
//! Written: `t`, then `q1..qn`, `qd1..`, `qdd1..`, `tau1..`, and `q1_true..` and so on for the truth, or the same with the
//! joints' names; tables that the recording lacks are left out. Numbers have the fewest digits that read back as the same
//! bits. Robot and provenance are not kept; [`parquet`](crate::recording::parquet) keeps them.
//!
//! Read: columns in any order, called in one of the ways of `columns::names`. Velocity, acceleration and truth may be missing.
//! Semicolons, tabs and blanks may stand between the cells, numbers then with a decimal comma; comments (`#`, `%`) above the
//! header; lists in cells.

use super::text::Text;
use super::written;
use crate::error::{Error, Result};
use crate::recording::Recording;
use crate::recording::columns::Layout;
use std::borrow::Cow;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

/// Writes a recording.
///
/// # Errors
/// The file cannot be written, or the signals differ in shape.
pub fn write(path: &Path, recording: &Recording) -> Result<()> {
    let columns = written::table(recording, false)?;
    let failed = |source| Error::io(path, "write the recording", source);
    write_table(File::create(path).map_err(failed)?, &columns).map_err(failed)
}

/// Writes a recording with the names of its joints in the header: `elbow_position`, `elbow_velocity`, `elbow_effort`.
///
/// # Errors
/// As [`write()`].
pub(crate) fn write_named(path: &Path, recording: &Recording) -> Result<()> {
    let columns = written::table(recording, true)?;
    let failed = |source| Error::io(path, "write the recording", source);
    write_table(File::create(path).map_err(failed)?, &columns).map_err(failed)
}

/// A cell in quotes where it needs them.
fn quoted(cell: &str) -> Cow<'_, str> {
    match cell.contains([',', '"', '\n', '\r']) {
        true => Cow::Owned(format!("\"{}\"", cell.replace('"', "\"\""))),
        false => Cow::Borrowed(cell),
    }
}

fn write_table(writer: impl Write, columns: &[(String, &[f64])]) -> std::io::Result<()> {
    let mut writer = BufWriter::with_capacity(1 << 16, writer);
    let header: Vec<_> = columns.iter().map(|(name, _)| quoted(name)).collect();
    writeln!(writer, "{}", header.join(","))?;
    let rows = columns.first().map_or(0, |(_, values)| values.len());
    for row in 0..rows {
        for (index, (_, values)) in columns.iter().enumerate() {
            let separator = if index == 0 { "" } else { "," };
            // Debug, unlike Display, turns to exponents where plain digits would run into the hundreds.
            write!(writer, "{separator}{:?}", values[row])?;
        }
        writer.write_all(b"\n")?;
    }
    writer.flush()
}

/// Reads a recording and notes on what in the file was not used. `joints` are the robot's joints in order; without
/// them the file's own numbers or names are taken.
///
/// # Errors
/// An unreadable or empty file, a header without what is needed, a ragged row, a cell that is no finite number, time
/// that does not increase.
pub fn read(path: &Path, joints: Option<&[String]>) -> Result<(Recording, Vec<String>)> {
    strictly(path, &Text::open(path)?, joints)
}

fn strictly(path: &Path, text: &Text, joints: Option<&[String]>) -> Result<(Recording, Vec<String>)> {
    let mut layout = Layout::find(path, Some(text.header_line), &text.header, joints)?;
    let rows = text.rows(path, &text.header, &layout.used(), false, &mut |row| {
        Err(Error::input(path, Some(text.line_at(row.start)), row.field, row.problem))
    })?;
    if let Some(fault) = layout.fault(&rows.columns) {
        let line = Some(text.line_at(rows.starts[fault.row]));
        return Err(Error::input(path, line, &text.header[fault.column], fault.problem));
    }
    let notes = std::mem::take(&mut layout.notes);
    Ok((layout.recording(rows.columns), notes))
}

#[cfg(test)]
mod tests;
