//! Recordings as CSV, for every other program: one header line, one row per sample, no comments.
//!
//! Written: `t`, then `q1..qn`, `qd1..`, `qdd1..`, `tau1..`, and `q1_true..` and so on for the truth; tables that the
//! recording lacks are left out. Numbers have the fewest digits that read back as the same bits. Robot, joint names
//! and provenance are not kept; [`super::parquet`] keeps them.
//!
//! Read: columns in any order; `t` or `time`; `dq1`, `ddq1` for velocity and acceleration; joints by name, as in
//! `q_elbow`, `tau_elbow` or `elbow_position`, `elbow_velocity`, `elbow_effort`. Velocity, acceleration and truth may
//! be missing.

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
    let bytes = std::fs::read(path).map_err(|source| Error::io(path, "read the recording", source))?;
    parse(path, &bytes, joints)
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
    let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    if bytes.trim_ascii().is_empty() {
        return Err(Error::input(path, None, "header", "the file is empty; a header and one row per sample go here"));
    }
    Ok(bytes)
}

/// A header that needs no renaming.
fn as_it_is(header: Vec<String>) -> Result<Vec<String>> {
    Ok(header)
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
        let mut reader = ReaderBuilder::new().has_headers(false).flexible(true).from_reader(bytes);
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
            match bad_cell(&record, &header, &used) {
                Some((field, problem)) => reject(BadRow { start, field, problem })?,
                None => {
                    used.iter().for_each(|&column| columns[column].extend(number(&record[column])));
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
fn bad_cell(record: &ByteRecord, header: &[String], used: &[usize]) -> Option<(String, String)> {
    if record.len() != header.len() {
        let (cells, names) = (record.len(), header.len());
        let problem = format!("{cells} cells where the header names {names} columns; was the row cut off?");
        return Some((format!("column {}", cells.min(names)), problem));
    }
    let column = used.iter().copied().find(|&column| number(&record[column]).is_none())?;
    let cell = String::from_utf8_lossy(&record[column]).replace(char::from(OPEN_QUOTE), "\"");
    let problem = match cell.trim() {
        "" => "the cell is empty; a number goes here".to_owned(),
        text if text.contains('"') => format!("'{text}' has a quote that is not closed"),
        text => format!("'{text}' is not a number"),
    };
    Some((header[column].clone(), problem))
}

fn number(cell: &[u8]) -> Option<f64> {
    std::str::from_utf8(cell.trim_ascii()).ok()?.parse().ok()
}

/// Number of the first line with content at or after a place in the file.
pub(super) fn line_at(bytes: &[u8], start: usize) -> usize {
    let blank = bytes[start..].iter().take_while(|byte| matches!(byte, b'\r' | b'\n')).count();
    1 + bytes[..start + blank].iter().filter(|&&byte| byte == b'\n').count()
}

#[cfg(test)]
mod tests {
    use super::super::samples;
    use super::*;
    use proptest::prelude::*;

    fn text(recording: &Recording) -> Vec<u8> {
        let mut bytes = Vec::new();
        write_table(&mut bytes, &columns::table(recording).unwrap()).unwrap();
        bytes
    }

    fn parse_text(text: &str) -> Result<(Recording, Vec<String>)> {
        parse(Path::new("log.csv"), text.as_bytes(), None)
    }

    #[test]
    fn header_and_shortest_digits() {
        let mut recording = samples::full(1, 2);
        recording.truth = None;
        recording.qdd = None;
        recording.q.channel_mut(0).copy_from_slice(&[-0.0, 0.1]);
        recording.tau.channel_mut(0).copy_from_slice(&[1e300, 5e-324]);
        recording.qd.as_mut().unwrap().channel_mut(0).copy_from_slice(&[0.1 + 0.2, 1.0 / 3.0]);
        let expected = "t,q1,qd1,tau1\n0.0,-0.0,0.30000000000000004,1e300\n0.002,0.1,0.3333333333333333,5e-324\n";
        assert_eq!(String::from_utf8(text(&recording)).unwrap(), expected);
    }

    #[test]
    fn columns_in_their_order() {
        let bytes = text(&samples::full(2, 1));
        let header = "t,q1,q2,qd1,qd2,qdd1,qdd2,tau1,tau2,q1_true,q2_true,qd1_true,qd2_true,qdd1_true,qdd2_true,\
                      tau1_true,tau2_true\n";
        assert!(bytes.starts_with(header.as_bytes()));
    }

    proptest! {
        #[test]
        fn round_trip_is_bit_for_bit(recording in samples::any_recording()) {
            let (read, notes) = parse(Path::new("log.csv"), &text(&recording), Some(&recording.joints)).unwrap();
            prop_assert_eq!(samples::bits(&read), samples::bits(&recording));
            prop_assert_eq!(&read.joints, &recording.joints);
            prop_assert!(notes.is_empty());
        }

        #[test]
        fn no_input_panics(header in "[tqdau_12,]{0,20}", body in "[0-9,.\n\r\" ne-]{0,40}") {
            let _ = parse_text(&format!("{header}\n{body}"));
            let _ = parse_text(&format!("t,q1,tau1\n{body}"));
        }
    }

    #[test]
    fn logs_of_other_programs() {
        let text =
            "\u{feff}Time, q_elbow ,state,dq_elbow,\"tau_elbow\"\r\n\r\n 0, 1.5 ,idle,+2,-3e1\r\n.5,2,,3,4\r\n\r\n";
        let (recording, notes) = parse_text(text).unwrap();
        assert_eq!(recording.joints, ["elbow"]);
        assert_eq!(recording.time, [0.0, 0.5]);
        assert_eq!(recording.q.channel(0), [1.5, 2.0]);
        assert_eq!(recording.qd.unwrap().channel(0), [2.0, 3.0]);
        assert_eq!(recording.tau.channel(0), [-30.0, 4.0]);
        assert_eq!(notes, ["columns not used: state"]);
    }

    #[test]
    fn faults_are_named_by_line_and_column() {
        let cases = [
            ("", "log.csv: header: the file is empty"),
            (" \n\n", "log.csv: header: the file is empty"),
            ("t,q1,tau1\n", "log.csv:1: rows: there is no row"),
            ("\n\nt,q1\n0,1\n", "log.csv:3: tau1: missing column"),
            ("t,q1,tau1\n0,1,2\n1,x2,2\n", "log.csv:3: q1: 'x2' is not a number"),
            ("t,q1,tau1\n0,1,2\n\n\n1,2,\n", "log.csv:5: tau1: the cell is empty"),
            ("t,q1,tau1\r\n0,1,2\r\n\r\n1,2,-\r\n", "log.csv:4: tau1: '-' is not a number"),
            ("t,q1,tau1\n0,1,2\n1,2\n", "log.csv:3: column 2: 2 cells where the header names 3 columns"),
            ("t,q1,tau1\n0,1,2,3\n", "log.csv:2: column 3: 4 cells"),
            ("t,q1,tau1\n0,1,2\n1,2,NaN\n", "log.csv:3: tau1: NaN is not a finite number"),
            ("t,q1,tau1\n0,-inf,2\n1,2,NaN\n", "log.csv:2: q1: -inf is not a finite number"),
            ("t,q1,tau1\n0,1e999,2\n", "log.csv:2: q1: inf is not a finite number"),
            ("t,q1,tau1\n0,1,2\n1,1,2\n1,1,2\n", "log.csv:4: t: time must increase, but 1.0 s follows 1.0 s"),
            ("t,q1,tau1\n0,1,2\n\n-1,1,nan\n", "log.csv:4: "),
            ("t,q1,tau1\nnan,1,2\n", "log.csv:2: t: NaN"),
            ("t,q1,tau1\n0,1,2\n1,\"2,3\n2,3,4\n", "log.csv:3: q1: '\"2' has a quote that is not closed"),
        ];
        for (text, expected) in cases {
            let error = parse_text(text).unwrap_err().to_string();
            assert!(error.contains(expected), "{text:?}: {error}");
        }
    }

    #[test]
    fn a_full_disk_is_an_error() {
        let Ok(full) = File::options().write(true).open("/dev/full") else { return };
        let recording = samples::full(1, 3);
        assert!(write_table(full, &columns::table(&recording).unwrap()).is_err());
    }

    #[test]
    fn signals_of_other_shape_are_refused() {
        let mut recording = samples::full(2, 3);
        recording.tau = samples::full(2, 4).tau;
        let error = write(Path::new("unused.csv"), &recording).unwrap_err().to_string();
        assert!(error.starts_with("torque: 2 joints of 4 samples"), "{error}");
    }
}
