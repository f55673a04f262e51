//! Recordings as CSV, for every other program: one header line, one row per sample, no comments.
//!
//! Written: `t`, then `q1..qn`, `qd1..`, `qdd1..`, `tau1..`, and `q1_true..` and so on for the truth; tables that the
//! recording lacks are left out. Numbers have the fewest digits that read back as the same bits. Robot, joint names
//! and provenance are not kept; [`super::parquet`] keeps them.
//!
//! Read: columns in any order; `t` or `time`; `dq1`, `ddq1` for velocity and acceleration; joints by name, as in
//! `q_elbow`, `tau_elbow` or `elbow_position`, `elbow_velocity`, `elbow_effort`. Velocity, acceleration and truth may
//! be missing. Semicolons and tabs may stand between the cells, numbers then with a decimal comma; comments (`#`) above the
//! header.

use super::Recording;
use super::columns::{self, Layout};
use crate::error::{Error, Result};
use ::csv::{ByteRecord, ReaderBuilder};
use std::borrow::Cow;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

/// Writes a recording.
///
/// # Errors
/// The file cannot be written, or the signals differ in shape.
pub fn write(path: &Path, recording: &Recording) -> Result<()> {
    let columns = columns::table(recording)?;
    let failed = |source| Error::io(path, "write the recording", source);
    write_table(File::create(path).map_err(failed)?, &columns).map_err(failed)
}

fn write_table(writer: impl Write, columns: &[(String, &[f64])]) -> std::io::Result<()> {
    let mut writer = BufWriter::with_capacity(1 << 16, writer);
    let header: Vec<&str> = columns.iter().map(|(name, _)| name.as_str()).collect();
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
    parse(path, &bytes(path)?, joints)
}

/// The file, with what may stand above the header taken out.
pub(super) fn bytes(path: &Path) -> Result<Vec<u8>> {
    let mut bytes = std::fs::read(path).map_err(|source| Error::io(path, "read the recording", source))?;
    blank_comments(&mut bytes);
    Ok(bytes)
}

/// Lines above the header that begin with `#` become blank, so that places in the file stay what they are. Where numbers
/// follow the last of them, as numpy writes it, it is the header.
fn blank_comments(bytes: &mut [u8]) {
    let mut start = if bytes.starts_with(BYTE_ORDER_MARK) { BYTE_ORDER_MARK.len() } else { 0 };
    while bytes.get(start) == Some(&b'#') {
        let line = |from: usize| from + bytes[from..].iter().take_while(|byte| **byte != b'\n').count();
        let end = line(start);
        let next = (end + 1).min(bytes.len());
        let below = &bytes[next..line(next)];
        let numbers = below.split(|byte| SEPARATORS.contains(byte)).all(|cell| number(cell, true).is_some());
        if numbers {
            bytes[start] = b' ';
        } else {
            bytes[start..end].fill(b'\r');
        }
        start = next;
    }
}

fn parse(path: &Path, bytes: &[u8], joints: Option<&[String]>) -> Result<(Recording, Vec<String>)> {
    let bytes = content(path, bytes)?;
    let mut table = Table::parse(path, bytes, joints, &as_it_is, &mut |row| {
        Err(Error::input(path, Some(line_at(bytes, row.start)), row.field, row.problem))
    })?;
    if let Some(fault) = table.layout.fault(&table.columns) {
        let line = Some(line_at(bytes, table.starts[fault.row]));
        return Err(Error::input(path, line, &table.header[fault.column], fault.problem));
    }
    let notes = std::mem::take(&mut table.layout.notes);
    Ok((table.layout.recording(table.columns), notes))
}

/// What is in the file behind a byte order mark.
pub(super) fn content<'a>(path: &Path, bytes: &'a [u8]) -> Result<&'a [u8]> {
    let bytes = bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(bytes);
    if bytes.starts_with(b"\xFF\xFE")
        || bytes.starts_with(b"\xFE\xFF")
        || bytes.iter().take(1000).any(|&byte| byte == 0)
    {
        let problem = "the file is no text in UTF-8 (UTF-16, or no text at all); export it as CSV in UTF-8";
        return Err(Error::input(path, None, "header", problem));
    }
    if bytes.trim_ascii().is_empty() {
        return Err(Error::input(path, None, "header", "the file is empty; a header and one row per sample go here"));
    }
    Ok(bytes)
}

/// The names of the columns.
pub(super) fn header(bytes: &[u8]) -> Vec<String> {
    let mut reader = ReaderBuilder::new().delimiter(separator(bytes)).has_headers(false).from_reader(bytes);
    let mut record = ByteRecord::new();
    match reader.read_byte_record(&mut record) {
        Ok(true) => record.iter().map(|name| String::from_utf8_lossy(name.trim_ascii()).into_owned()).collect(),
        _ => Vec::new(),
    }
}

/// A header that needs no renaming.
fn as_it_is(header: Vec<String>) -> Result<Vec<String>> {
    Ok(header)
}

const BYTE_ORDER_MARK: &[u8] = b"\xEF\xBB\xBF";

/// What may stand between two cells.
const SEPARATORS: [u8; 3] = [b',', b';', b'\t'];

/// What separates the cells: the most frequent in the first line with content. Spreadsheets of countries that write numbers
/// with a comma put semicolons between them.
fn separator(bytes: &[u8]) -> u8 {
    let mut lines = bytes.split(|byte| matches!(byte, b'\r' | b'\n'));
    let header = lines.find(|line| !line.trim_ascii().is_empty()).unwrap_or_default();
    let count = |separator: u8| header.iter().filter(|byte| **byte == separator).count();
    SEPARATORS.into_iter().rev().max_by_key(|&separator| count(separator)).unwrap_or(b',')
}

/// The cells as numbers, whatever their values.
pub(super) struct Table {
    pub header: Vec<String>,
    pub layout: Layout,
    /// Values of the columns in use, indexed as the header.
    pub columns: Vec<Vec<f64>>,
    /// Where each row starts in the file (or in the blank lines before it), in bytes.
    pub starts: Vec<usize>,
}

/// A row that does not hold a number in every column.
pub(super) struct BadRow {
    /// As in [`Table`].
    pub start: usize,
    /// The column.
    pub field: String,
    /// What is wrong.
    pub problem: String,
}

impl Table {
    /// Reads all rows. `rename` may call the columns by other names; `reject` hears of rows that are left out, or turns
    /// them into the error that ends the reading.
    pub fn parse(
        path: &Path,
        bytes: &[u8],
        joints: Option<&[String]>,
        rename: &dyn Fn(Vec<String>) -> Result<Vec<String>>,
        reject: &mut dyn FnMut(BadRow) -> Result<()>,
    ) -> Result<Table> {
        let bytes = &*without_open_quotes(bytes);
        // Lengths of rows are checked here, to say more than the csv crate does.
        let separator = separator(bytes);
        let decimal_comma = separator != b',';
        let mut reader = ReaderBuilder::new().delimiter(separator).has_headers(false).flexible(true).from_reader(bytes);
        let mut record = ByteRecord::new();
        let broken = |error: ::csv::Error| Error::io(path, "read the recording", error.into());
        reader.read_byte_record(&mut record).map_err(broken)?;
        let header: Vec<String> =
            record.iter().map(|name| String::from_utf8_lossy(name.trim_ascii()).into_owned()).collect();
        let header_line = line_at(bytes, 0);
        let header = rename(header)?;
        let layout = Layout::find(path, Some(header_line), &header, joints)?;

        let used = layout.used();
        let mut columns = vec![Vec::new(); header.len()];
        let mut starts = Vec::new();
        let mut rows = 0;
        while reader.read_byte_record(&mut record).map_err(broken)? {
            rows += 1;
            let start = record.position().map_or(0, |position| position.byte() as usize);
            match bad_cell(&record, &header, &used, decimal_comma) {
                Some((field, problem)) => reject(BadRow { start, field, problem })?,
                None => {
                    used.iter().for_each(|&column| columns[column].extend(number(&record[column], decimal_comma)));
                    starts.push(start);
                }
            }
        }
        if rows == 0 {
            return Err(Error::input(path, Some(header_line), "rows", "there is no row below the header"));
        }
        Ok(Table { header, layout, columns, starts })
    }
}

/// Stands for the quotes of a line in which one is not closed.
const OPEN_QUOTE: u8 = 0x01;

/// A quote that is not closed would swallow all lines up to the next one: no cell of a log goes over several lines, so
/// that such a line is broken, and its quotes are none.
fn without_open_quotes(bytes: &[u8]) -> Cow<'_, [u8]> {
    if !bytes.contains(&b'"') {
        return Cow::Borrowed(bytes);
    }
    let mut mended = bytes.to_vec();
    for line in mended.split_mut(|&byte| byte == b'\n') {
        if line.iter().filter(|&&byte| byte == b'"').count() % 2 == 1 {
            line.iter_mut().filter(|byte| **byte == b'"').for_each(|byte| *byte = OPEN_QUOTE);
        }
    }
    Cow::Owned(mended)
}

/// The first column of a row that does not hold a number, and why.
fn bad_cell(record: &ByteRecord, header: &[String], used: &[usize], decimal_comma: bool) -> Option<(String, String)> {
    if record.len() != header.len() {
        let (cells, names) = (record.len(), header.len());
        let problem = format!("{cells} cells where the header names {names} columns; was the row cut off?");
        return Some((format!("column {}", cells.min(names)), problem));
    }
    let column = used.iter().copied().find(|&column| number(&record[column], decimal_comma).is_none())?;
    let cell = String::from_utf8_lossy(&record[column]).replace(char::from(OPEN_QUOTE), "\"");
    let problem = match cell.trim() {
        "" => "the cell is empty; a number goes here".to_owned(),
        text if text.contains('"') => format!("'{text}' has a quote that is not closed"),
        text => format!("'{text}' is not a number"),
    };
    Some((header[column].clone(), problem))
}

/// A cell as a number; `decimal_comma` takes 1,5 for 1.5.
fn number(cell: &[u8], decimal_comma: bool) -> Option<f64> {
    let cell = std::str::from_utf8(cell.trim_ascii()).ok()?;
    let plain = cell.parse().ok();
    if plain.is_none() && decimal_comma && cell.matches(',').count() == 1 && !cell.contains('.') {
        return cell.replace(',', ".").parse().ok();
    }
    plain
}

/// Number of the first line with content at or after a place in the file.
pub(super) fn line_at(bytes: &[u8], start: usize) -> usize {
    let blank = bytes[start..].iter().take_while(|byte| matches!(byte, b'\r' | b'\n')).count();
    1 + bytes[..start + blank].iter().filter(|&&byte| byte == b'\n').count()
}

#[cfg(test)]
mod tests;
