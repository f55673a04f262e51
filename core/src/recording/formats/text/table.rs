//! A table in text of which the header is understood, and its rows as numbers.

use super::cells::{FORMS_OF_DATES, date, is_empty, is_like_a_date, list, not_a_number, number, of_width};
use super::comments::blank_comments;
use super::notation::{self, Commas, Fault, Notation, TWO_READINGS, name_with_unit, with_unit};
use super::quotes::without_open_quotes;
use super::separators::{blanks_to_tabs, separator};
use super::{encoding, header};
use crate::error::{Error, Result};
use crate::recording::columns::{labels, names};
use ::csv::{ByteRecord, ReaderBuilder};
use std::path::Path;

/// A table in text, of which the header is understood.
pub(crate) struct Text {
    /// The file with what stands above the header taken out, line for line.
    bytes: Vec<u8>,
    separator: u8,
    /// Line of the header, or of the first row where there is none.
    pub header_line: usize,
    has_header: bool,
    /// Names of the columns, a list's one for each of its numbers; numbers from 1 on where the file has no names.
    pub header: Vec<String>,
    /// Cells of each column as it stands in the file; more than one for lists.
    widths: Vec<usize>,
    /// How the numbers of each column as it stands in the file are written.
    notations: Vec<Notation>,
}

/// Why a cell has no number.
struct Problem {
    text: String,
    /// Whether no cell of the column can be trusted.
    of_column: bool,
}

/// A row that does not hold a number in every column.
pub(crate) struct BadRow {
    /// Where the row starts (or the blank lines before it), in bytes.
    pub start: usize,
    /// The column.
    pub field: String,
    /// What is wrong.
    pub problem: String,
}

/// The rows that hold numbers.
#[derive(Default)]
pub(crate) struct Rows {
    /// Values of the columns in use, indexed as the header.
    pub columns: Vec<Vec<f64>>,
    /// Where each row starts, in bytes.
    pub starts: Vec<usize>,
    /// Place of each among all rows, those left out counted.
    pub ordinals: Vec<usize>,
}

impl Text {
    /// Reads a file up to its header.
    ///
    /// # Errors
    /// An unreadable or empty file, or one that is no text.
    pub(crate) fn open(path: &Path) -> Result<Text> {
        let bytes = std::fs::read(path).map_err(|source| Error::io(path, "read the recording", source))?;
        Text::new(path, bytes)
    }

    /// The same of a file's content.
    ///
    /// # Errors
    /// Those of [`Text::open`].
    pub(crate) fn new(path: &Path, bytes: Vec<u8>) -> Result<Text> {
        let Some(mut bytes) = encoding::utf8_lines(bytes) else {
            let problem = "the file is no text; export it as CSV";
            return Err(Error::input(path, None, "header", problem));
        };
        blank_comments(&mut bytes);
        header::blank_titles(&mut bytes);
        if bytes.trim_ascii().is_empty() {
            let problem = "the file is empty; a header and one row per sample go here";
            return Err(Error::input(path, None, "header", problem));
        }
        let separator = match separator(&bytes) {
            Some(separator) => separator,
            None => blanks_to_tabs(&mut bytes),
        };
        without_open_quotes(&mut bytes);
        let mut text = Text {
            separator,
            header_line: 0,
            has_header: true,
            header: vec![],
            widths: vec![],
            notations: vec![],
            bytes,
        };
        let mut reader = text.reader();
        let mut record = ByteRecord::new();
        let mut next = || -> Result<Vec<String>> {
            reader
                .read_byte_record(&mut record)
                .map_err(|error| Error::io(path, "read the recording", error.into()))?;
            Ok(record.iter().map(|cell| String::from_utf8_lossy(cell.trim_ascii()).into_owned()).collect())
        };
        let (mut names, first) = (next()?, next()?);
        text.header_line = text.line_at(0);
        if let Some(header) = labels::of_joint_state_message(&names) {
            text.has_header = false;
            text.widths = vec![1; header.len()];
            text.header = header;
            return Ok(text);
        }
        let is_row = |cells: &[String]| {
            let decimal_comma = text.separator != b',';
            let is_number = |cell: &String| {
                number(cell.as_bytes(), decimal_comma).is_some() || with_unit(cell, decimal_comma).is_some()
            };
            cells.len() > 1 && cells.iter().all(is_number)
        };
        text.has_header = !(is_row(&names) && is_row(&first) && names.len() == first.len());
        text.find_notations(path, names.len())?;
        if !text.has_header {
            text.widths = vec![1; names.len()];
            text.header = (1..=names.len()).map(|column| column.to_string()).collect();
            let with_unit = |(name, notation): (&mut String, &Notation)| {
                *name = notation.unit().map_or(name.clone(), |unit| format!("{name} [{unit}]"));
            };
            text.header.iter_mut().zip(&text.notations).for_each(with_unit);
            return Ok(text);
        }
        for (place, (name, notation)) in names.iter_mut().zip(&text.notations).enumerate() {
            let Some(unit) = notation.unit() else { continue };
            *name = name_with_unit(name, place, unit).map_err(|own| {
                let problem = format!("the cells are in {unit} where the name says {own}: write one of the two");
                Error::input(path, Some(text.header_line), name.as_str(), problem)
            })?;
        }
        text.widths =
            (0..names.len()).map(|column| first.get(column).map_or(1, |cell| list(cell).len().max(1))).collect();
        let flat: Vec<String> = names
            .iter()
            .zip(&text.widths)
            .flat_map(|(name, &width)| match width {
                1 => vec![name.clone()],
                _ => (0..width).map(|place| format!("{name}[{place}]")).collect(),
            })
            .collect();
        let cells: Vec<String> =
            first.iter().zip(&text.widths).flat_map(|(cell, &width)| of_width(cell, width)).collect();
        text.header = labels::named(flat, &cells);
        Ok(text)
    }

    /// Finds how the numbers of `columns` columns are written.
    fn find_notations(&mut self, path: &Path, columns: usize) -> Result<()> {
        let decimal_comma = self.separator != b',';
        let (mut reader, mut record) = (self.reader(), ByteRecord::new());
        let has_commas = !decimal_comma && self.bytes.contains(&b'"');
        let mut first: Vec<Option<Notation>> = vec![None; columns];
        let mut commas = vec![Commas::default(); columns];
        let mut skip = self.has_header;
        let mut row = 0;
        while (has_commas || row < notation::ROWS)
            && reader.read_byte_record(&mut record).map_err(|error| broken(path, error))?
        {
            if std::mem::take(&mut skip) {
                continue;
            }
            row += 1;
            for ((cell, first), commas) in record.iter().zip(&mut first).zip(&mut commas) {
                let Ok(cell) = std::str::from_utf8(cell.trim_ascii()) else { continue };
                if first.is_none() && row <= notation::ROWS && !is_empty(cell.as_bytes()) {
                    *first = Some(Notation::of_first(cell, decimal_comma));
                }
                if has_commas {
                    commas.see(cell);
                }
            }
        }
        let with_commas = |(first, commas): (Option<Notation>, Commas)| match has_commas {
            true => first.unwrap_or_default().with_commas(commas),
            false => first.unwrap_or_default(),
        };
        self.notations = first.into_iter().zip(commas).map(with_commas).collect();
        Ok(())
    }

    fn reader(&self) -> ::csv::Reader<&[u8]> {
        // Lengths of rows are checked here, for a more precise error than that of the csv crate.
        ReaderBuilder::new()
            .delimiter(self.separator)
            .has_headers(false)
            .flexible(true)
            .from_reader(self.bytes.as_slice())
    }

    /// Reads all rows. `header` names the columns in messages; `used` are those whose cells must be numbers. An empty cell is
    /// NaN where `lenient`, else no number. `reject` hears of rows that are left out, or turns them into the error that ends
    /// the reading.
    ///
    /// # Errors
    /// A file without rows, and what `reject` returns.
    pub(crate) fn rows(
        &self,
        path: &Path,
        header: &[String],
        used: &[usize],
        lenient: bool,
        reject: &mut dyn FnMut(BadRow) -> Result<()>,
    ) -> Result<Rows> {
        let decimal_comma = self.separator != b',';
        let is_time: Vec<bool> =
            header.iter().enumerate().map(|(column, name)| names::time(name, column).is_some()).collect();
        let places = self.places();
        let plain = Notation::default();
        let mut rows = Rows { columns: vec![Vec::new(); header.len()], ..Rows::default() };
        let (mut reader, mut record, mut ordinal) = (self.reader(), ByteRecord::new(), 0);
        if self.has_header {
            reader.read_byte_record(&mut record).map_err(|error| broken(path, error))?;
        }
        let mut values = vec![0.0; used.len()];
        while reader.read_byte_record(&mut record).map_err(|error| broken(path, error))? {
            let start = record.position().map_or(0, |position| position.byte() as usize);
            if self.is_comment(&record) {
                continue;
            }
            ordinal += 1;
            let parse = |column: usize| -> std::result::Result<f64, Problem> {
                let of_cell = |text: String| Problem { text, of_column: false };
                let (raw, place) = places[column];
                let whole = &record[raw];
                let owned;
                let cell = if self.widths[raw] == 1 {
                    whole
                } else {
                    let text = String::from_utf8_lossy(whole).into_owned();
                    let parts = list(&text);
                    if parts.len() != self.widths[raw] {
                        let text = format!("a list of {} where the first has {}", parts.len(), self.widths[raw]);
                        return Err(of_cell(text));
                    }
                    owned = parts[place].to_owned();
                    owned.as_bytes()
                };
                let fault = match self.notations.get(raw).unwrap_or(&plain).number(cell, decimal_comma) {
                    Ok(number) => return Ok(number),
                    Err(fault) => fault,
                };
                match (if is_time[column] { date(cell) } else { None }, fault) {
                    (Some(number), _) => Ok(number),
                    (None, _) if lenient && is_empty(cell) => Ok(f64::NAN),
                    (None, Fault::OtherUnit(text)) => Err(Problem { text, of_column: true }),
                    (None, Fault::Unit(text)) => Err(of_cell(text)),
                    (None, Fault::Comma) => {
                        Err(of_cell(format!("'{}'{TWO_READINGS}", String::from_utf8_lossy(cell.trim_ascii()))))
                    }
                    (None, Fault::NoNumber) if is_time[column] && is_like_a_date(cell) => {
                        Err(of_cell(format!("{}{FORMS_OF_DATES}", not_a_number(cell))))
                    }
                    (None, Fault::NoNumber) => Err(of_cell(not_a_number(cell))),
                }
            };
            // A separator behind the last cell.
            let more = record.iter().skip(self.widths.len()).all(|cell| cell.trim_ascii().is_empty());
            let fault = if record.len() < self.widths.len() || !more {
                let (cells, names) = (record.len(), self.widths.len());
                let problem = format!("{cells} cells where the header names {names} columns; was the row cut off?");
                Some((format!("column {}", cells.min(names)), Problem { text: problem, of_column: false }))
            } else {
                used.iter().zip(&mut values).find_map(|(&column, value)| match parse(column) {
                    Ok(number) => {
                        *value = number;
                        None
                    }
                    Err(problem) => Some((header[column].clone(), problem)),
                })
            };
            match fault {
                Some((field, Problem { text, of_column: true })) => {
                    return Err(Error::input(path, Some(self.line_at(start)), field, text));
                }
                Some((field, Problem { text, .. })) => reject(BadRow { start, field, problem: text })?,
                None => {
                    used.iter().zip(&values).for_each(|(&column, value)| rows.columns[column].push(*value));
                    rows.starts.push(start);
                    rows.ordinals.push(ordinal - 1);
                }
            }
        }
        if ordinal == 0 {
            return Err(Error::input(path, Some(self.header_line), "rows", "there is no row below the header"));
        }
        Ok(rows)
    }

    /// Whether a line below the header is a comment: it begins as one, and has other cells than a row. A spreadsheet's `#N/A` stands in a row.
    fn is_comment(&self, record: &ByteRecord) -> bool {
        record.len() != self.widths.len() && record.get(0).is_some_and(|cell| cell.trim_ascii().starts_with(b"#"))
    }

    /// Cells of one column as they stand in the file.
    pub(crate) fn cells(&self, column: usize) -> Vec<String> {
        let (raw, _) = self.places()[column];
        let mut reader = self.reader();
        let mut record = ByteRecord::new();
        let mut out = Vec::new();
        let mut skip = self.has_header;
        while let Ok(true) = reader.read_byte_record(&mut record) {
            if !std::mem::take(&mut skip) && !self.is_comment(&record) {
                out.push(record.get(raw).map_or(String::new(), |cell| String::from_utf8_lossy(cell).trim().to_owned()));
            }
        }
        out
    }

    /// For each name of the header the column in the file and the place in its list.
    fn places(&self) -> Vec<(usize, usize)> {
        let column = |(raw, &width): (usize, &usize)| (0..width).map(move |place| (raw, place));
        self.widths.iter().enumerate().flat_map(column).collect()
    }

    /// Number of the first line with content at or after a place in the file.
    pub(crate) fn line_at(&self, start: usize) -> usize {
        self.lines(&[start])[0]
    }

    /// Lines of increasing places in the file, each that of the first line with content from there on.
    pub(crate) fn lines(&self, starts: &[usize]) -> Vec<usize> {
        let (mut line, mut seen) = (1, 0);
        starts
            .iter()
            .map(|&start| {
                let blank = self.bytes[start..].iter().take_while(|byte| matches!(byte, b'\r' | b'\n')).count();
                line += self.bytes[seen..start + blank].iter().filter(|&&byte| byte == b'\n').count();
                seen = start + blank;
                line
            })
            .collect()
    }
}

fn broken(path: &Path, error: ::csv::Error) -> Error {
    Error::io(path, "read the recording", error.into())
}
