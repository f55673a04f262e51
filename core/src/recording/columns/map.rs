//! Names of columns that a data set gives.

use super::names;
use crate::error::{Error, Result};
use crate::robot::Addresses;
use std::path::Path;

/// A column of a file.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::recording::lenient::{self, Column, ColumnMap};
/// # let folder = tempfile::tempdir().unwrap();
/// # let path = folder.path().join("log.csv");
///
/// // The third column is the motor's torque, whatever it is called.
/// std::fs::write(&path, "t,q1,drive\n0.00,0.1,1.5\n0.01,0.2,2.5\n0.02,0.4,2.0\n").unwrap();
/// let map = ColumnMap { tau: Some(vec![Column::Number(3)]), ..ColumnMap::default() };
/// assert_eq!(lenient::load(&path, None, &map)?.recording.tau.channel(0), [1.5, 2.5, 2.0]);
/// assert_eq!(Column::from("drive"), Column::Name("drive".to_owned()));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq, serde::Deserialize)]
#[serde(untagged, expecting = "the name of a column, or its number counted from 1")]
pub enum Column {
    /// By its place, counted from 1: of a file without names, or with names that no one wants to write. Where a log is in several
    /// files, the columns of the second are counted on from those of the first.
    Number(usize),
    /// By its name.
    Name(String),
}

impl From<&str> for Column {
    fn from(name: &str) -> Column {
        Column::Name(name.to_owned())
    }
}

/// Columns in a file, for those that are not called as [`csv`](crate::recording::csv) expects; one per joint in the order of
/// the joints. Quantities left out are looked for under their usual names.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::recording::lenient::{self, ColumnMap};
/// # let folder = tempfile::tempdir().unwrap();
/// # let path = folder.path().join("log.csv");
///
/// // Names that no one could guess, and rows at 100 Hz without a column of time.
/// std::fs::write(&path, "angle,drive\n0.1,1.5\n0.2,2.5\n0.4,2.0\n").unwrap();
/// let column = |name: &str| Some(vec![name.into()]);
/// let map = ColumnMap { rate_hz: Some(100.0), q: column("angle"), tau: column("drive"), ..ColumnMap::default() };
/// let log = lenient::load(&path, None, &map)?.recording;
/// assert_eq!((log.time, log.q.channel(0)), (vec![0.0, 0.01, 0.02], &[0.1, 0.2, 0.4][..]));
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ColumnMap {
    /// The topic, of a log of ROS 2 with several.
    pub topic: Option<String>,
    /// The column of time.
    pub time: Option<Column>,
    /// Rows per second, Hz, where there is no column of time; one that is there is not used then.
    pub rate_hz: Option<f64>,
    /// Columns of position.
    pub q: Option<Vec<Column>>,
    /// Columns of velocity.
    pub qd: Option<Vec<Column>>,
    /// Columns of acceleration.
    pub qdd: Option<Vec<Column>>,
    /// Columns of torque, or of motor current.
    pub tau: Option<Vec<Column>>,
    /// Seconds per unit of time, where it is known; else it is recognised from the column's name and the numbers.
    #[serde(skip)]
    pub time_factor: Option<f64>,
    /// Whether constants are known that make torques of motor currents.
    #[serde(skip)]
    pub torque_constants: bool,
    /// Names of motors, each with its joint: columns may carry them in the place of the joints'.
    #[serde(skip)]
    pub motors: Vec<(String, String)>,
    /// Places of joints and motors in a simulator's vectors: columns may carry their numbers in the place of the joints'.
    #[serde(skip)]
    pub addresses: Addresses,
    /// Whether the unit of position, velocity, acceleration and torque is known: the names of the columns say nothing about it then.
    #[serde(skip)]
    pub known_units: [bool; 4],
}

impl ColumnMap {
    /// The header with the mapped columns under the names that the reader looks for.
    pub(in crate::recording) fn rename(&self, path: &Path, header: Vec<String>) -> Result<Vec<String>> {
        let groups = [("q", &self.q), ("qd", &self.qd), ("qdd", &self.qdd), ("tau", &self.tau)];
        let mut wanted: Vec<(String, &Column)> = self.time.iter().map(|name| ("t".to_owned(), name)).collect();
        for (prefix, names) in groups {
            let names = names.iter().flatten().enumerate();
            wanted.extend(names.map(|(joint, name)| (format!("{prefix}{}", joint + 1), name)));
        }
        let mut renamed = header.clone();
        for (name, original) in &renamed_over(self, &header) {
            let in_brackets = format!("({original})");
            let is_read = !read_as(&in_brackets).is_empty();
            renamed[*name] = if is_read { format!("(column {})", name + 1) } else { in_brackets };
        }
        for (target, wanted) in wanted {
            let column = match wanted {
                Column::Name(name) => {
                    let is_called = |own: &String| names::unit_of(own).is_some() && names::without_unit_of(own) == name;
                    header.iter().position(|own| own == name).or_else(|| header.iter().position(is_called))
                }
                Column::Number(number) => number.checked_sub(1).filter(|column| *column < header.len()),
            };
            let Some(column) = column else {
                let (field, those) = match wanted {
                    Column::Name(name) => (name.clone(), format!("the file has {}", header.join(", "))),
                    Column::Number(number) => {
                        (format!("column {number}"), format!("those of the file are 1 to {}", header.len()))
                    }
                };
                return Err(Error::input(path, None, field, format!("there is no such column; {those}")));
            };
            // The unit stays with the column.
            renamed[column] = match names::unit_of(&header[column]) {
                Some(unit) if target != "t" => format!("{target} [{unit}]"),
                _ => target,
            };
        }
        Ok(renamed)
    }
}

/// The quantities that a name can mean.
fn read_as(name: &str) -> Vec<usize> {
    let readings = names::meanings(name).into_iter().chain(names::scattered(name));
    readings.filter(|meaning| !meaning.exact_only).map(|meaning| meaning.quantity).collect()
}

/// Columns that can be read as a quantity that the map takes from elsewhere, with their names.
fn renamed_over<'a>(map: &ColumnMap, header: &'a [String]) -> Vec<(usize, &'a str)> {
    let given = [&map.q, &map.qd, &map.qdd, &map.tau].map(Option::is_some);
    let taken = |name: &str| {
        let is = |prefixes: &[&str]| {
            prefixes.iter().any(|prefix| {
                name.strip_prefix(prefix).is_some_and(|rest| rest.starts_with(|c: char| c == '_' || c.is_ascii_digit()))
            })
        };
        let ends = |suffixes: &[&str]| suffixes.iter().any(|suffix| name.ends_with(suffix));
        (map.time.is_some() && (name.eq_ignore_ascii_case("t") || name.eq_ignore_ascii_case("time")))
            || (map.q.is_some() && (is(&["q"]) || ends(&["_position"])))
            || (map.qd.is_some() && (is(&["qd", "dq"]) || ends(&["_velocity"])))
            || (map.qdd.is_some() && (is(&["qdd", "ddq"]) || ends(&["_acceleration"])))
            || (map.tau.is_some() && (is(&["tau"]) || ends(&["_effort", "_torque"])))
            || read_as(name).into_iter().any(|quantity| given[quantity])
    };
    header.iter().enumerate().filter(|(_, name)| taken(name)).map(|(column, name)| (column, name.as_str())).collect()
}
