//! How the numbers of a column are written: with a unit behind each, or with commas between thousands.
//!
//! Both are properties of a column and not of a cell: a unit holds for all cells, and whether `1,500` is one and a half is shown by the
//! other cells.

use super::cells::number;
use crate::recording::columns::names;

/// Rows in which the first cell with content of a column is looked for.
pub(super) const ROWS: usize = 60;

/// How the numbers of one column are written.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Notation {
    /// The unit behind every number.
    unit: Option<String>,
    /// Whether a comma with three digits behind it separates thousands, where the other cells show it.
    thousands: Option<bool>,
}

/// What the cells of a column show of their commas, in a table whose cells are separated by commas too.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Commas {
    fraction: bool,
    thousands: bool,
}

impl Commas {
    /// Learns from a cell.
    pub(super) fn see(&mut self, cell: &str) {
        let cell = cell.trim().trim_start_matches(['-', '+']);
        match cell.split_once(',') {
            // A point, or another comma.
            Some((_, rest)) if rest.contains(['.', ',']) => self.thousands = true,
            Some((whole, rest)) if whole == "0" || whole.is_empty() || rest.len() != 3 => self.fraction = true,
            Some(_) => {}
            // Fractions of three digits have them everywhere, but for a zero.
            None => self.thousands |= cell.parse::<f64>().is_ok_and(|value| value != 0.0 && value.abs() < 1000.0),
        }
    }
}

/// A cell that is no number of its column.
#[derive(Debug, PartialEq)]
pub(super) enum Fault {
    /// It has another unit than the column: no cell of it can be trusted.
    OtherUnit(String),
    /// Nothing is known but that it is no number.
    NoNumber,
    /// It lacks the unit of the column, or has one that the column has not.
    Unit(String),
    /// A comma may separate thousands or a fraction.
    Comma,
}

impl Notation {
    /// That of a column by the first cell with content.
    pub(super) fn of_first(cell: &str, decimal_comma: bool) -> Notation {
        Notation { unit: with_unit(cell, decimal_comma).map(|(_, unit)| unit.to_owned()), thousands: None }
    }

    /// The unit of the cells.
    pub(super) fn unit(&self) -> Option<&str> {
        self.unit.as_deref()
    }

    /// The same with what the cells of the column show of their commas.
    pub(super) fn with_commas(self, commas: Commas) -> Notation {
        let thousands = (commas.fraction != commas.thousands).then_some(commas.thousands);
        Notation { thousands, ..self }
    }

    /// The number of a cell.
    ///
    /// # Errors
    /// Why it is none.
    pub(super) fn number(&self, cell: &[u8], decimal_comma: bool) -> Result<f64, Fault> {
        let Some(unit) = &self.unit else {
            let Some(value) = self.plain(cell, decimal_comma) else {
                return Err(self.fault(cell, decimal_comma));
            };
            return Ok(value);
        };
        let own = cell.trim_ascii().strip_suffix(unit.as_bytes());
        own.and_then(|own| self.plain(own, decimal_comma)).ok_or_else(|| self.fault(cell, decimal_comma))
    }

    fn plain(&self, cell: &[u8], decimal_comma: bool) -> Option<f64> {
        if self.thousands.is_none() || !cell.contains(&b',') {
            return number(cell, decimal_comma);
        }
        let without: String = match self.thousands {
            Some(true) => String::from_utf8_lossy(cell).replace(',', ""),
            _ => String::from_utf8_lossy(cell).replace(',', "."),
        };
        number(without.as_bytes(), false)
    }

    fn fault(&self, cell: &[u8], decimal_comma: bool) -> Fault {
        let text = String::from_utf8_lossy(cell);
        let text = text.trim();
        match (with_unit(text, decimal_comma), &self.unit) {
            (Some((_, own)), Some(unit)) => Fault::OtherUnit(format!(
                "'{text}' is in {own} where the cells above are in {unit}: write the column in one unit"
            )),
            (Some((_, own)), None) => Fault::Unit(format!(
                "'{text}' is in {own} where the cells above have no unit: write it with each cell, or with the name"
            )),
            (None, Some(unit)) if number(cell, decimal_comma).is_some() => {
                Fault::Unit(format!("'{text}' has no unit where the cells above are in {unit}"))
            }
            _ if is_thousand_or_fraction(text) => Fault::Comma,
            _ => Fault::NoNumber,
        }
    }
}

/// Whether a cell may be thousands or a fraction: `1,500`.
fn is_thousand_or_fraction(cell: &str) -> bool {
    let digits = |part: &str| !part.is_empty() && part.bytes().all(|byte| byte.is_ascii_digit());
    cell.split_once(',')
        .is_some_and(|(whole, rest)| digits(whole.trim_start_matches(['-', '+'])) && rest.len() == 3 && digits(rest))
}

/// What a problem with a comma says.
pub(super) const TWO_READINGS: &str =
    " may be thousands or a fraction, and no cell of the column shows which: write the numbers without commas";

/// A number and the unit behind it, of a cell that is not a number by itself: `0.123 rad`, `12,5 Nm`, `45°`, `12 %`.
pub(super) fn with_unit(cell: &str, decimal_comma: bool) -> Option<(f64, &str)> {
    let cell = cell.trim();
    if !cell.starts_with(|first: char| first.is_ascii_digit() || "+-.−".contains(first))
        || number(cell.as_bytes(), decimal_comma).is_some()
    {
        return None;
    }
    let is_unit = |unit: &str| unit == "%" || names::is_unit(unit) || unit.eq_ignore_ascii_case("min");
    // The longest number: what is behind it is the unit.
    cell.char_indices().rev().map(|(place, _)| cell.split_at(place)).find_map(|(value, unit)| {
        let unit = unit.trim_start();
        let value = number(value.as_bytes(), decimal_comma).filter(|_| is_unit(unit))?;
        Some((value, unit))
    })
}

/// The name of a column with the unit of its cells, in brackets as a name may have it.
///
/// # Errors
/// The unit of the name, where it is another.
pub(super) fn name_with_unit(name: &str, place: usize, unit: &str) -> Result<String, String> {
    let of_time = |name: &str| names::time(name, place).map(|time| time.factor);
    if let Some(factor) = of_time(name) {
        return match (factor, of_time(&format!("time [{unit}]")).flatten()) {
            (None, Some(_)) => Ok(format!("{name} [{unit}]")),
            (Some(own), Some(of_cells)) if own != of_cells => Err(name.to_owned()),
            _ => Ok(name.to_owned()),
        };
    }
    let known = names::meanings(name).into_iter().find_map(|meaning| Some((meaning.unit?, meaning.quantity)));
    match known {
        Some((own, quantity)) if names::Unit::of(unit, quantity) == Some(own) => Ok(name.to_owned()),
        Some((own, _)) => Err(own.symbol.to_owned()),
        None => Ok(format!("{name} [{unit}]")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_and_its_unit() {
        for (cell, value, unit) in [
            ("0.123 rad", 0.123, "rad"),
            ("-1e-3rad/s", -1e-3, "rad/s"),
            ("45.5°", 45.5, "°"),
            ("12.5 N m", 12.5, "N m"),
            ("0.004 sec", 0.004, "sec"),
            ("12 %", 12.0, "%"),
        ] {
            assert_eq!(with_unit(cell, false), Some((value, unit)), "{cell}");
        }
        assert_eq!(with_unit("3,25 Nm", true), Some((3.25, "Nm")));
        for cell in ["1.5", "rad", "1.5 x", "", "12:00 s", "1e5", "0x1F", "q1 [rad]"] {
            assert_eq!(with_unit(cell, false), None, "{cell}");
        }
    }

    #[test]
    fn a_column_has_one_unit() {
        let column = Notation::of_first("0.1 rad", false);
        assert_eq!((column.unit(), column.number(b" 2.5 rad", false)), (Some("rad"), Ok(2.5)));
        assert!(
            matches!(column.number(b"45 deg", false), Err(Fault::OtherUnit(text)) if text.contains("is in deg where"))
        );
        assert!(matches!(column.number(b"0.5", false), Err(Fault::Unit(text)) if text.contains("no unit where")));
        assert_eq!(column.number(b"x", false), Err(Fault::NoNumber));
        let plain = Notation::of_first("0.1", false);
        assert!(plain.unit().is_none() && matches!(plain.number(b"4 deg", false), Err(Fault::Unit(_))));
    }

    #[test]
    fn other_cells_show_what_a_comma_is() {
        let of = |cells: &[&str]| {
            let mut commas = Commas::default();
            cells.iter().for_each(|cell| commas.see(cell));
            Notation::default().with_commas(commas).number(b"1,500", false)
        };
        for cells in [&["999", "1,500"][..], &["1,234.5"], &["1,234,567", "0"]] {
            assert_eq!(of(cells), Ok(1500.0), "{cells:?}");
        }
        for cells in [&["0,500", "1,500"][..], &["-0,125"], &["1,5"], &["12,25", "1,500"]] {
            assert_eq!(of(cells), Ok(1.5), "{cells:?}");
        }
        for cells in [&["1,500", "2,500"][..], &["0,5", "999"], &["0", "1,500"]] {
            assert_eq!(of(cells), Err(Fault::Comma), "{cells:?}");
        }
    }
}
