//! What stands in a cell: a number as programs of many countries write it, a date, a list, or nothing.

use super::quotes::OPEN_QUOTE;

/// What programs write for a value that is not there.
pub(super) fn is_empty(cell: &[u8]) -> bool {
    let cell = cell.trim_ascii();
    cell.is_empty()
        || ["none", "null", "na", "n/a", "-", "--", "missing", "<na>"].iter().any(|word| cell.eq_ignore_ascii_case(word.as_bytes()))
        // Spreadsheets' errors, and what C of Windows prints for what is no number.
        || cell.starts_with(b"#")
        || cell.strip_prefix(b"-").unwrap_or(cell).starts_with(b"1.#")
        || cell.strip_prefix(b"-").unwrap_or(cell).starts_with(b"nan(")
}

pub(super) fn not_a_number(cell: &[u8]) -> String {
    let cell = String::from_utf8_lossy(cell).replace(char::from(OPEN_QUOTE), "\"");
    match cell.trim() {
        "" => "the cell is empty; a number goes here".to_owned(),
        text if text.contains('"') => format!("'{text}' has a quote that is not closed"),
        text => format!("'{text}' is not a number"),
    }
}

/// What dates are read, behind a cell that is none.
pub(super) const FORMS_OF_DATES: &str =
    "; a date is read as 2026-03-05 11:59:55.004 or 20260305T115955.004, a time of day as 11:59:55.004";

/// Whether a cell that is not read may be meant as a date or a time of day: digits around a colon, a stroke or a hyphen.
pub(super) fn is_like_a_date(cell: &[u8]) -> bool {
    let is_digit = |byte: &u8| byte.is_ascii_digit();
    let splits = |at: usize| cell[..at].iter().any(is_digit) && cell[at..].iter().any(is_digit);
    (0..cell.len()).any(|at| b":/-".contains(&cell[at]) && splits(at))
}

/// A cell as a number; `decimal_comma` takes 1,5 for 1.5.
pub(super) fn number(cell: &[u8], decimal_comma: bool) -> Option<f64> {
    let cell = std::str::from_utf8(cell.trim_ascii()).ok()?;
    let plain = cell.parse().ok();
    if plain.is_none()
        && let Some((mantissa, exponent)) = cell.split_once(['D', 'd'])
        && !mantissa.is_empty()
    {
        // Fortran's double precision.
        return format!("{mantissa}E{exponent}").parse().ok();
    }
    let with_point = || {
        let is_one = decimal_comma && cell.matches(',').count() == 1 && !cell.contains('.');
        is_one.then(|| cell.replace(',', ".").parse().ok())?
    };
    let of_comma = || decimal_comma.then(|| grouped(cell, '.', ','))?;
    plain
        .or_else(with_point)
        .or_else(|| grouped(cell, ',', '.'))
        .or_else(of_comma)
        .or_else(|| quoted(cell))
        .or_else(|| number(respelled(cell, decimal_comma)?.as_bytes(), decimal_comma))
}

/// A number with the minus of typography, and blanks or apostrophes between thousands, as in `−1 234,5` and `1'234.5`, as programs write it;
/// None where it has none of these, or they stand elsewhere. Plain blanks are those of tables with decimal commas: elsewhere they may be between
/// two numbers.
fn respelled(cell: &str, decimal_comma: bool) -> Option<String> {
    const MINUS: [char; 2] = ['\u{2212}', '\u{2013}'];
    const BETWEEN: [char; 5] = ['\'', '\u{2019}', '\u{a0}', '\u{2009}', '\u{202f}'];
    let is_between = |letter: char| BETWEEN.contains(&letter) || (decimal_comma && letter == ' ');
    let positive = cell.strip_prefix(MINUS);
    let (sign, size) = match positive {
        Some(size) => ("-", size),
        None => cell.strip_prefix('-').map_or(("", cell), |size| ("-", size)),
    };
    let end = size.find(['.', ',']).unwrap_or(size.len());
    let mut groups = size[..end].split(is_between);
    let first = groups.next()?.len();
    let rest: Vec<&str> = groups.collect();
    let is_grouped = !rest.is_empty() && (1..=3).contains(&first) && rest.iter().all(|group| group.len() == 3);
    // Digits and one sign: nothing else is respelled, so that this ends.
    let is_number = size.starts_with(|first: char| first.is_ascii_digit());
    let is_respelled = positive.is_some() || is_grouped;
    (is_number && is_respelled && (rest.is_empty() || is_grouped))
        .then(|| format!("{sign}{}{}", size[..end].replace(is_between, ""), &size[end..]))
}

/// A number with a decimal comma between cells that commas separate, where it stands in quotes. With three digits behind the comma it may be a
/// thousand, unless there is none before it.
fn quoted(cell: &str) -> Option<f64> {
    let (whole, fraction) = cell.split_once(',')?;
    let none = whole.trim_start_matches(['-', '+']) == "0";
    let is_fraction = !fraction.is_empty() && fraction.bytes().all(|byte| byte.is_ascii_digit());
    (is_fraction && (fraction.len() != 3 || none)).then(|| format!("{whole}.{fraction}").parse().ok())?
}

/// A number with a separator between its thousands and another before its fraction, `-1.234,567` or `1,234.567`. One without a fraction
/// is not read so: its separator may be the decimal one.
fn grouped(cell: &str, thousands: char, decimal: char) -> Option<f64> {
    let (whole, fraction) = cell.split_once(decimal)?;
    let mut groups = whole.trim_start_matches(['-', '+']).split(thousands);
    let is_digits = |part: &str| part.bytes().all(|byte| byte.is_ascii_digit());
    let first = groups.next()?;
    let all =
        (1..=3).contains(&first.len()) && is_digits(first) && groups.all(|part| part.len() == 3 && is_digits(part));
    if !all || !is_digits(fraction) {
        return None;
    }
    format!("{}.{fraction}", whole.replace(thousands, "")).parse().ok()
}

/// Seconds of a date with a time, from 1970, of a time of day, from midnight, or of a duration in days, hours, minutes and seconds:
/// `2024-05-01 12:00:00.004`, `2024/05/01-12:00:00`, `20240501T120000.004`, `5/1/2024 12:00:00 PM`, `12:00:00:004`, `0 days 00:00:00.004`.
pub(super) fn date(cell: &[u8]) -> Option<f64> {
    let cell = std::str::from_utf8(cell.trim_ascii()).ok()?;
    if let Some((days, clock)) = cell.split_once(" day") {
        return duration(days, clock);
    }
    let (day, clock) = match cell.split_once(['T', ' ']) {
        Some((day, clock)) if !day.contains(':') => (Some(day), clock),
        _ => match behind_day(cell) {
            Some((day, clock)) => (Some(day), clock),
            None => (None, cell),
        },
    };
    let half = clock.rsplit_once(' ').and_then(|(clock, half)| match half.to_ascii_lowercase().as_str() {
        "am" => Some((clock, 0.0)),
        "pm" => Some((clock, 12.0)),
        _ => None,
    });
    // A zone shifts all rows alike.
    let clock = half.map_or(clock, |(clock, _)| clock).trim_end_matches('Z');
    let clock = clock.split_once(['+', ' ']).map_or(clock, |(clock, _)| clock);
    let clock = clock.rsplit_once('-').map_or(clock, |(clock, _)| clock);
    let compact = day.and_then(|_| colons(clock));
    let mut parts = compact.as_deref().unwrap_or(clock).split(':');
    let mut next = || parts.next()?.replace(',', ".").parse::<f64>().ok();
    let (first, second, third) = (next()?, next()?, next());
    // A minute and a second, where there are no hours, have a fraction behind them.
    let has_fraction = || clock.ends_with(|letter: char| letter.is_ascii_digit()) && clock.contains(['.', ',']);
    let (hours, minutes, seconds) = match third {
        Some(seconds) => (first, second, seconds),
        None if day.is_none() && has_fraction() => (0.0, first, second),
        None => return None,
    };
    let seconds = match (parts.next(), parts.next()) {
        (None, _) => seconds,
        (Some(part), None) => seconds + thousandths(part)?,
        _ => return None,
    };
    let hours = half.map_or(hours, |(_, half)| half + hours % 12.0);
    let days = match day {
        None => 0.0,
        Some(day) => days_of(day)? as f64,
    };
    Some(86400.0 * days + 3600.0 * hours + 60.0 * minutes + seconds)
}

/// A date and the time of day behind it, with a hyphen or an underscore between them.
fn behind_day(cell: &str) -> Option<(&str, &str)> {
    let end = cell.find(':').unwrap_or(cell.len());
    let (day, _) = cell[..end].rsplit_once(['-', '_'])?;
    let is_day = day.bytes().all(|byte| byte.is_ascii_digit() || b"-/.".contains(&byte)) && days_of(day).is_some();
    is_day.then(|| (day, &cell[day.len() + 1..]))
}

/// A time of day without colons, `115955.004`, with them.
fn colons(clock: &str) -> Option<String> {
    let whole = clock.split(['.', ',']).next()?;
    let is_compact = whole.len() == 6 && whole.bytes().all(|byte| byte.is_ascii_digit());
    is_compact.then(|| format!("{}:{}:{}", &clock[..2], &clock[2..4], &clock[4..]))
}

/// The part of a second behind a last colon: up to three digits are ms, up to six us, up to nine ns.
fn thousandths(part: &str) -> Option<f64> {
    let is_part = (1..=9).contains(&part.len()) && part.bytes().all(|byte| byte.is_ascii_digit());
    let groups = i32::try_from(part.len().div_ceil(3)).ok()?;
    Some(part.parse::<f64>().ok().filter(|_| is_part)? / 1000f64.powi(groups))
}

/// Seconds of a duration as pandas writes it, `0 days 00:00:00.004` and `-1 days +23:59:59.5`, from both sides of ` day`. One of whole days
/// has no clock.
fn duration(days: &str, clock: &str) -> Option<f64> {
    let days: i64 = days.parse().ok()?;
    let clock = clock.strip_prefix('s').unwrap_or(clock).trim_start();
    let clock = clock.strip_prefix('+').unwrap_or(clock);
    let mut seconds = 0.0;
    if !clock.is_empty() {
        let parts: Vec<f64> = clock.split(':').map(|part| part.parse().ok()).collect::<Option<_>>()?;
        let [hours, minutes, own] = parts[..] else { return None };
        seconds = 3600.0 * hours + 60.0 * minutes + own;
    }
    Some(86400.0 * days as f64 + seconds)
}

/// Days from 1970 of a date: year, month, day; or with the year last, behind day and month with points, and behind month and day or
/// day and month with strokes. A log of minutes has one order or the other, and its steps are the same.
fn days_of(day: &str) -> Option<i64> {
    if day.len() == 8 && day.bytes().all(|byte| byte.is_ascii_digit()) {
        let of = |range: std::ops::Range<usize>| day[range].parse().ok();
        return Some(days_from_1970(of(0..4)?, of(4..6)?, of(6..8)?));
    }
    let mut parts = day.split(['-', '/', '.']);
    let mut next = || parts.next()?.parse::<i64>().ok();
    let (first, second, third) = (next()?, next()?, next()?);
    let (year, month, day) = match first > 31 {
        true => (first, second, third),
        false if day.contains('/') && second > 12 => (third, first, second),
        false if day.contains('/') && first <= 12 => (third, first, second),
        false => (third, second, first),
    };
    Some(days_from_1970(year, month, day))
}

/// Days of the Gregorian calendar.
fn days_from_1970(year: i64, month: i64, day: i64) -> i64 {
    let year = if month <= 2 { year - 1 } else { year };
    let era = year.div_euclid(400);
    let of_era = year - era * 400;
    let of_year = (153 * (month + if month > 2 { -3 } else { 9 }) + 2) / 5 + day - 1;
    era * 146_097 + of_era * 365 + of_era / 4 - of_era / 100 + of_year - 719_468
}

/// The parts of a cell that is a list, `[0.1, 0.2]`, `array('d', [0.1, 0.2])` or `[np.float64(0.1), np.float64(0.2)]`; none of another
/// cell.
pub(super) fn list(cell: &str) -> Vec<&str> {
    let Some(start) = cell.rfind('[').or(cell.starts_with('(').then_some(0)) else { return Vec::new() };
    if start > 0 && !cell.starts_with("array(") {
        return Vec::new();
    }
    let inside = cell[start + 1..].trim_end_matches([']', ')']);
    inside
        .split([',', ';', ' ', '\t'])
        .map(|part| without_type(part).trim_matches(['\'', '"', ' ']))
        .filter(|part| !part.is_empty())
        .collect()
}

/// A value without the type that numpy writes around it from its second version on.
fn without_type(part: &str) -> &str {
    let typed = part.strip_prefix("np.").or(part.strip_prefix("numpy."));
    typed.and_then(|typed| typed.split_once('(')).map_or(part, |(_, value)| value.trim_end_matches(')'))
}

/// The parts of a cell in a column of lists, or the cell itself.
pub(super) fn of_width(cell: &str, width: usize) -> Vec<String> {
    match width {
        1 => vec![cell.to_owned()],
        _ => list(cell).into_iter().map(str::to_owned).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_are_seconds() {
        assert_eq!(date(b"1970-01-02T00:00:01.5Z"), Some(86401.5));
        assert_eq!(date(b"2024-02-29 12:00:00"), Some(1_709_208_000.0));
        assert_eq!(date(b"2/29/2024 12:00:00 PM"), Some(1_709_208_000.0));
        assert_eq!(date(b"29.02.2024 12:00:00"), Some(1_709_208_000.0));
        assert_eq!(date(b"00:01:02.25"), Some(62.25));
        for cell in [
            "20240229T120000",
            "2024/02/29-12:00:00",
            "2024-02-29_12:00:00",
            "20240229-120000",
            "2024-02-29T12:00:00-00:00",
        ] {
            assert_eq!(date(cell.as_bytes()), Some(1_709_208_000.0), "{cell}");
        }
        assert_eq!([date(b"20240229T120000.25"), date(b"2024-02-29T120000,25Z")], [Some(1_709_208_000.25); 2]);
        assert_eq!([date(b"20240229T12000"), date(b"20240229"), date(b"a_b"), date(b"q-1:0:0")], [None; 4]);
        assert_eq!([date(b"12:00:01 AM"), date(b"01:00:00 pm")], [Some(1.0), Some(46800.0)]);
        assert_eq!([date(b"01:02.500"), date(b"00:00,005"), date(b"11:59")], [Some(62.5), Some(0.005), None]);
        assert_eq!((date(b"1.5"), date(b"x:y:z"), date(b"")), (None, None, None));
    }

    #[test]
    fn what_may_be_a_date_is_known() {
        assert!(["5 March 11:59", "2026/3", "1-2"].iter().all(|cell| is_like_a_date(cell.as_bytes())));
        assert!(["x", "12", "-5x", "5:", "a/b"].iter().all(|cell| !is_like_a_date(cell.as_bytes())));
    }

    #[test]
    fn a_fraction_may_stand_behind_a_colon_or_a_comma() {
        assert_eq!(
            [date(b"00:00:55:250"), date(b"00:00:55,250"), date(b"00:00:55:5")],
            [Some(55.25), Some(55.25), Some(55.005)]
        );
        assert_eq!([date(b"00:00:55:2500"), date(b"00:00:55:500000000")], [Some(55.0025), Some(55.5)]);
        assert_eq!(
            [date(b"00:00:55:0000000000"), date(b"00:00:55:"), date(b"0:0:0:0:0"), date(b"0:0:0:-1")],
            [None; 4]
        );
    }

    #[test]
    fn durations_are_seconds() {
        assert_eq!([date(b"0 days 00:00:00.004000"), date(b"0 days 00:00:01")], [Some(0.004), Some(1.0)]);
        assert_eq!([date(b"1 days 00:00:00.5"), date(b"1 day 01:02:03")], [Some(86400.5), Some(90123.0)]);
        assert_eq!([date(b"-1 days +23:59:59.5"), date(b"2 days")], [Some(-0.5), Some(172_800.0)]);
        assert_eq!([date(b"x days 00:00:01"), date(b"0 days 00:01"), date(b"0 daysx")], [None; 3]);
    }

    #[test]
    fn numbers_of_many_programs() {
        assert_eq!(number(b" 1.5D-03 ", false), Some(0.0015));
        assert_eq!(number(b"-2,5", true), Some(-2.5));
        assert_eq!(number(b"-1.234,567", true), Some(-1234.567));
        assert_eq!(number(b"12.345.678,5", true), Some(12_345_678.5));
        // Thousands with a decimal point are read with any separator of cells.
        assert_eq!([number(b"1,234.5", false), number(b"-12,345,678.", true)], [Some(1234.5), Some(-12_345_678.0)]);
        for cell in ["1.234,567", "1.23,5", "1234.567,8", "1.234,5,6", "1.234,5e3", ".234,5"] {
            assert_eq!(number(cell.as_bytes(), cell != "1.234,567"), None, "{cell}");
        }
        assert_eq!([number(b"1,5", false), number(b"-0,125", false)], [Some(1.5), Some(-0.125)]);
        assert_eq!([number(b"1,500", false), number(b"D1", false), number(b"12d", false)], [None; 3]);
        assert!([b"#N/A".as_slice(), b"1.#IND", b"-1.#INF", b"-nan(ind)", b"None"].iter().all(|cell| is_empty(cell)));
        assert!(!is_empty(b"-1.5") && !is_empty(b"x"));
    }

    #[test]
    fn numbers_of_typography_and_of_other_countries() {
        for (cell, decimal_comma, value) in [
            ("\u{2212}1.5", false, -1.5),
            ("1\u{202f}234,5", true, 1234.5),
            ("-12\u{a0}345,25", true, -12345.25),
            ("1 234,5", true, 1234.5),
            ("1'234.5", false, 1234.5),
            ("\u{2212}1\u{2019}234\u{2019}567.5", false, -1_234_567.5),
            ("1'234", false, 1234.0),
            ("\u{2212}2,5e-3", true, -2.5e-3),
        ] {
            assert_eq!(number(cell.as_bytes(), decimal_comma), Some(value), "{cell}");
        }
        for cell in ["1'23", "1 2345", "\u{2212}", "\u{2212}\u{2212}1", "'123", "1'234'5.0", "q 123", "2 rad", "1 234"]
        {
            assert_eq!(number(cell.as_bytes(), false), None, "{cell}");
        }
    }

    #[test]
    fn lists_in_cells() {
        assert_eq!(list("[0.1, -2e3]"), ["0.1", "-2e3"]);
        assert_eq!(list("array('d', [1.0, 2.0])"), ["1.0", "2.0"]);
        assert_eq!(list("['a', 'b']"), ["a", "b"]);
        assert_eq!(list("[np.float64(-0.5), np.float32(2e-3)]"), ["-0.5", "2e-3"]);
        assert_eq!(list("[np.str_('a'), np.str_('b')]"), ["a", "b"]);
        assert!(list("1.5").is_empty() && list("elbow[0]").is_empty() && list("").is_empty());
    }
}
