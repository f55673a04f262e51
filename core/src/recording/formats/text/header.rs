//! What stands above the numbers besides one line of names: titles, and a second line of units or of joints.

use super::cells::{date, is_empty, number};
use super::notation::with_unit;
use super::separators::SEPARATORS;
use crate::recording::columns::names as columns;
use std::collections::BTreeSet;

/// Lines that are looked at, and rows of numbers that show how many cells a row has.
const LINES: usize = 60;
const ROWS: usize = 3;

/// Lines of names at most: labels of two levels, and the name of the index in a line of its own, as pandas writes them.
const MOST_LINES: usize = 3;

fn is_number(cell: &[u8]) -> bool {
    number(cell, true).is_some()
        || date(cell).is_some()
        || std::str::from_utf8(cell).is_ok_and(|cell| with_unit(cell, true).is_some())
}

/// The lines with content, with their places; of the first ones.
fn lines(bytes: &[u8]) -> Vec<(usize, &[u8])> {
    let mut start = 0;
    let mut out = Vec::new();
    for line in bytes.split(|byte| *byte == b'\n') {
        if !line.trim_ascii().is_empty() {
            // Tabs at the end are cells without content.
            let blanks = line.iter().rev().take_while(|byte| matches!(byte, b' ' | b'\r')).count();
            out.push((start, &line[..line.len() - blanks]));
        }
        start += line.len() + 1;
        if out.len() == LINES {
            break;
        }
    }
    out
}

/// The cells of a line, where it is one of numbers between separators.
fn count(line: &[u8], separator: u8) -> usize {
    line.iter().filter(|byte| **byte == separator).count() + 1
}

/// Whether two lines have as many cells, with those without content at their ends or without.
fn are_as_long(one: &[u8], other: &[u8], separator: u8) -> bool {
    count(one, separator) == count(other, separator)
        || count(one.trim_ascii_end(), separator) == count(other.trim_ascii_end(), separator)
}

/// The cells of a line as text, without quotes.
fn cells(line: &[u8], separator: u8) -> Vec<String> {
    let cells = line.split(|byte| *byte == separator);
    cells.map(|cell| String::from_utf8_lossy(cell.trim_ascii()).trim_matches('"').trim().to_owned()).collect()
}

/// Whether the cells below a line of names number the columns that are called alike, as pandas writes the second level of labels:
/// `,0,1,0,1` below `t,q,q,tau,tau`. A row of numbers has one for the time, and other names above it.
fn are_numbers_of_columns(names: &[String], below: &[String]) -> bool {
    let whole = |cell: &String| !cell.is_empty() && cell.bytes().all(|byte| byte.is_ascii_digit());
    // The name of the level may stand in the first cell.
    let Some((_, others)) = below.split_first().filter(|(first, _)| !is_number(first.as_bytes())) else { return false };
    let numbered: Vec<(&String, &String)> = names.iter().skip(1).zip(others).filter(|(_, cell)| whole(cell)).collect();
    let called: BTreeSet<&String> = numbered.iter().map(|(name, _)| *name).collect();
    let distinct: BTreeSet<&(&String, &String)> = numbered.iter().collect();
    names.len() == below.len()
        && others.iter().all(|cell| cell.is_empty() || whole(cell))
        && called.len() < numbered.len()
        && distinct.len() == numbered.len()
        && !called.iter().any(|name| is_number(name.as_bytes()))
}

/// Makes blank what stands above the header without being marked as a comment: lines with other numbers of cells than the rows
/// of numbers below. Joins a second line below the header to it, of units, of joints or of their numbers: its cells come behind the
/// names. Lengths stay, so that places in the file stay what they are, where no second line is joined.
pub(super) fn blank_titles(bytes: &mut Vec<u8>) {
    let Some((separator, first)) = rows(bytes) else { return };
    let lines = lines(bytes);
    let above: Vec<(usize, usize, bool)> = lines[..first]
        .iter()
        .map(|(start, line)| (*start, line.len(), are_as_long(line, lines[first].1, separator)))
        .collect();
    // A program for tables fills the line of a title with separators.
    let is_title = |&(start, length): &(usize, usize)| {
        cells(&bytes[start..start + length], separator).iter().skip(1).all(String::is_empty)
    };
    let mut padded: Vec<(usize, usize)> =
        above.iter().filter(|(.., fits)| *fits).map(|&(start, len, _)| (start, len)).collect();
    // More lines than those of names begin with a table of other things, which ends with a title: a file of LabVIEW.
    // The last of all lines may name an index, and looks like a title too.
    let titled = match padded.len() > MOST_LINES {
        true => padded[..padded.len() - 1].iter().rposition(is_title).map_or(0, |last| last + 1),
        false => padded.iter().take_while(|line| is_title(line)).count(),
    };
    let fits = padded.split_off(titled.min(padded.len().saturating_sub(1)));
    if fits.is_empty() || fits.len() > MOST_LINES || above.iter().rev().take(fits.len()).any(|(.., fits)| !fits) {
        return;
    }
    let [(name_start, name_length), below @ ..] = &fits[..] else { return };
    // Lines of separators alone go too.
    bytes[..*name_start].iter_mut().filter(|byte| **byte != b'\n').for_each(|byte| *byte = b'\r');
    let mut names = bytes[*name_start..name_start + name_length].to_vec();
    for (start, length) in below {
        let Some(longer) = joined(&names, &bytes[*start..start + length], separator) else { return };
        names = longer;
    }
    for (start, length) in below {
        bytes[*start..start + length].fill(b'\r');
    }
    bytes.splice(*name_start..name_start + name_length, names);
}

/// The separator, and the first line of numbers among those with content; None where the rows are not alike, or
/// begin at once.
fn rows(bytes: &[u8]) -> Option<(u8, usize)> {
    let lines = lines(bytes);
    SEPARATORS.into_iter().find_map(|separator| {
        let of_numbers = |line: &[u8]| {
            let cells = line.split(|byte| *byte == separator);
            let (mut all, mut numbers) = (0, 0);
            for cell in cells.map(|cell| cell.trim_ascii().trim_ascii_start()) {
                let cell = cell.strip_prefix(b"\"").and_then(|cell| cell.strip_suffix(b"\"")).unwrap_or(cell);
                all += 1;
                numbers += usize::from(is_number(cell) && !is_empty(cell));
            }
            all > 2 && 2 * numbers > all
        };
        let is_row = |&place: &usize| {
            let of_columns = |above: usize| {
                are_numbers_of_columns(&cells(lines[above].1, separator), &cells(lines[place].1, separator))
            };
            of_numbers(lines[place].1) && !place.checked_sub(1).is_some_and(of_columns)
        };
        let are_alike = |first: &usize| {
            let mut below = lines[*first..].iter().take(ROWS);
            below.all(|(_, line)| of_numbers(line) && are_as_long(line, lines[*first].1, separator))
        };
        // Single lines of numbers may be of a table above the names.
        let is_below_names = |first: &usize| {
            let no_number = |cell: &String| cell.is_empty() || !is_number(cell.as_bytes());
            first.checked_sub(1).is_some_and(|above| cells(lines[above].1, separator).iter().all(no_number))
        };
        let mut places = (0..lines.len()).filter(is_row);
        let earliest = places.next()?;
        let first = match are_alike(&earliest) {
            true => Some(earliest),
            false => places.find(|first| is_below_names(first) && are_alike(first)),
        };
        let first = first.filter(|first| *first > 1)?;
        Some((separator, first))
    })
}

/// A line of names with the cells of the line below it: units in brackets, joints as parts of a path, and their numbers.
fn joined(names: &[u8], below: &[u8], separator: u8) -> Option<Vec<u8>> {
    let (mut names, mut below) = (cells(names, separator), cells(below, separator));
    let bare = |cell: &str| cell.trim_matches(['[', ']', '(', ')']).to_owned();
    let are_units = |cells: &[String]| {
        let units = cells.iter().filter(|cell| columns::is_unit(&bare(cell))).count();
        2 * units > cells.iter().filter(|cell| !cell.is_empty()).count()
    };
    // Units may stand above the names.
    if are_units(&names) && !are_units(&below) {
        std::mem::swap(&mut names, &mut below);
    }
    let numbers = are_numbers_of_columns(&names, &below);
    if !numbers && below.iter().any(|cell| is_number(cell.as_bytes())) {
        return None;
    }
    let of_units = are_units(&below);
    // Names of the levels stand above that of the index, and none of them is a column's.
    let of_index = !of_units && below.iter().skip(1).all(String::is_empty) && columns::time(&names[0], 1).is_none();
    let cells =
        names.iter().zip(&below).enumerate().map(|(place, (name, cell))| match (name.as_str(), cell.as_str()) {
            (name, "") => name.to_owned(),
            (_, cell) if of_index => cell.to_owned(),
            (_, _) if numbers && place == 0 => String::new(),
            ("", cell) => cell.to_owned(),
            (name, cell) if numbers => format!("{name}_{cell}"),
            (name, cell) if of_units => format!("{name} [{}]", bare(cell)),
            (name, cell) if name.eq_ignore_ascii_case(cell) => name.to_owned(),
            (name, cell) => format!("{name}/{cell}"),
        });
    Some(cells.collect::<Vec<_>>().join(&char::from(separator).to_string()).into_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> String {
        let mut bytes = text.as_bytes().to_vec();
        blank_titles(&mut bytes);
        String::from_utf8(bytes).unwrap().replace('\r', "")
    }

    #[test]
    fn titles_go_and_second_lines_are_joined() {
        let rows = "0,1,2\n1,2,3\n2,3,4\n";
        assert_eq!(read(&format!("Log of May\nBy: A, B\n\nt,q1,tau1\n{rows}")), format!("\n\n\nt,q1,tau1\n{rows}"));
        assert_eq!(read(&format!("t,q1,tau1\ns,deg,Nm\n{rows}")), format!("t [s],q1 [deg],tau1 [Nm]\n\n{rows}"));
        assert_eq!(read(&format!("s,deg,Nm\nt,q1,tau1\n{rows}")), format!("t [s],q1 [deg],tau1 [Nm]\n\n{rows}"));
        // A title that is filled up with separators.
        let filled = format!("Run 3,,\ns,deg,Nm\nt,q1,tau1\n{rows}");
        assert_eq!(read(&filled), format!("\nt [s],q1 [deg],tau1 [Nm]\n\n{rows}"));
        let all = format!("Run 3,,\nsignal,position,effort\njoint,elbow,elbow\ntime,,\n{rows}");
        assert_eq!(read(&all), format!("\ntime,position/elbow,effort/elbow\n\n\n{rows}"));
        let two = format!("time,position,effort\n,elbow,elbow\n{rows}");
        assert_eq!(read(&two), format!("time,position/elbow,effort/elbow\n\n{rows}"));
        let three = format!(",position,effort\n,elbow,elbow\ntime,,\n{rows}");
        assert_eq!(read(&three), format!("time,position/elbow,effort/elbow\n\n\n{rows}"));
        let levels = format!("signal,position,effort\njoint,elbow,elbow\ntime,,\n{rows}");
        assert_eq!(read(&levels), format!("time,position/elbow,effort/elbow\n\n\n{rows}"));
        // One line of names, no line of names, rows of other lengths: as they are.
        for text in
            [format!("t,q1,tau1\n{rows}"), rows.to_owned(), format!("a\nb\n{rows}"), "t,q1\nx\n0,1\n".to_owned()]
        {
            assert_eq!(read(&text), text);
        }
    }

    #[test]
    fn a_table_above_the_names_ends_with_a_title() {
        let rows = "0\t1\t2\t\n1\t2\t3\t\n2\t3\t4\t\n";
        let own =
            "Channels\t2\nSamples\t3\t3\t\nDate\t2026/03/05\t2026/03/05\t\nX_Dimension\tTime\tTime\t\nX0\t0\t0\t\n";
        let text = format!("LabVIEW Measurement\t\n{own}***End_of_Header***\t\t\t\nX_Value\tq1\ttau1\tComment\n{rows}");
        assert_eq!(read(&text).trim_start(), format!("X_Value\tq1\ttau1\tComment\n{rows}"));
    }

    #[test]
    fn numbers_below_names_that_are_alike_belong_to_them() {
        let rows = "0,1,2,3,4\n1,2,3,4,5\n2,3,4,5,6\n";
        let named = |blanks: &str| format!("t,q_0,q_1,tau_0,tau_1\n{blanks}{rows}");
        // The index as a column like others, as a line of its own, and below the names of the levels.
        assert_eq!(read(&format!("t,q,q,tau,tau\n,0,1,0,1\n{rows}")), named("\n"));
        assert_eq!(read(&format!("t,q,q,tau,tau\n\"\",\"0\",\"1\",\"0\",\"1\"\n{rows}")), named("\n"));
        assert_eq!(read(&format!(",q,q,tau,tau\n,0,1,0,1\nt,,,,\n{rows}")), named("\n\n"));
        assert_eq!(read(&format!("signal,q,q,tau,tau\njoint,0,1,0,1\nt,,,,\n{rows}")), named("\n\n"));
        let index = format!("signal,t,q,q,tau\njoint,,0,1,0\n{rows}");
        assert_eq!(read(&index), format!(",t,q_0,q_1,tau_0\n\n{rows}"));
        // Rows whose first has no time or is like the others, and a label that stands twice.
        for first in ["t,q1,q2,tau1,tau2\n,0,1,0,1", "t,q,q,tau,tau\n0,0,1,0,1", "t,q,q,tau,tau\n,0,0,0,1"] {
            let text = format!("{first}\n{rows}");
            assert_eq!(read(&text), text);
        }
    }
}
