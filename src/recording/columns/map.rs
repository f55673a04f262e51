//! Names of columns that a data set gives.

use crate::error::{Error, Result};
use std::path::Path;

/// Names of columns in a file, for those that are not called as [`csv`](crate::recording::csv) expects; one per joint in the order of
/// the joints. Quantities left out are looked for under their usual names.
#[derive(Debug, Clone, PartialEq, Default, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ColumnMap {
    /// The topic, of a log of ROS 2 with several.
    pub topic: Option<String>,
    /// The column of time.
    pub time: Option<String>,
    /// Rows per second, Hz, where there is no column of time; one that is there is not used then.
    pub rate_hz: Option<f64>,
    /// Columns of position.
    pub q: Option<Vec<String>>,
    /// Columns of velocity.
    pub qd: Option<Vec<String>>,
    /// Columns of acceleration.
    pub qdd: Option<Vec<String>>,
    /// Columns of torque, or of motor current.
    pub tau: Option<Vec<String>>,
    /// Seconds per unit of time, where it is known; else it is recognised from the column's name and the numbers.
    #[serde(skip)]
    pub time_factor: Option<f64>,
}

impl ColumnMap {
    /// The header with the mapped columns under the names that the reader looks for.
    pub(in crate::recording) fn rename(&self, path: &Path, header: Vec<String>) -> Result<Vec<String>> {
        let groups = [("q", &self.q), ("qd", &self.qd), ("qdd", &self.qdd), ("tau", &self.tau)];
        let mut wanted: Vec<(String, &String)> = self.time.iter().map(|name| ("t".to_owned(), name)).collect();
        for (prefix, names) in groups {
            let names = names.iter().flatten().enumerate();
            wanted.extend(names.map(|(joint, name)| (format!("{prefix}{}", joint + 1), name)));
        }
        let mut renamed = header.clone();
        for (name, original) in &renamed_over(self, &header) {
            renamed[*name] = format!("({original})");
        }
        for (target, name) in wanted {
            let Some(column) = header.iter().position(|own| own == name) else {
                let problem = format!("there is no such column; the file has {}", header.join(", "));
                return Err(Error::input(path, None, name.as_str(), problem));
            };
            renamed[column] = target;
        }
        Ok(renamed)
    }
}

/// Columns that carry a usual name of a quantity that the map takes from elsewhere, with that name.
fn renamed_over<'a>(map: &ColumnMap, header: &'a [String]) -> Vec<(usize, &'a str)> {
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
    };
    header.iter().enumerate().filter(|(_, name)| taken(name)).map(|(column, name)| (column, name.as_str())).collect()
}
