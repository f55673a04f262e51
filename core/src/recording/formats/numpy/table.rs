//! The columns of arrays.

use super::archive::entries;
use super::array::{Array, fields};
use crate::error::{Error, Result};
use crate::recording::columns::names;
use std::path::Path;

/// The columns of all arrays.
#[derive(Debug, Default)]
pub(crate) struct Table {
    /// Names of the columns.
    pub header: Vec<String>,
    /// Their values.
    pub columns: Vec<Vec<f64>>,
}

/// Whether a ZIP archive holds arrays of numpy.
pub(crate) fn is_npz(path: &Path) -> bool {
    let Ok(bytes) = std::fs::read(path) else { return false };
    entries(&bytes).is_some_and(|entries| entries.iter().any(|entry| entry.name.ends_with(".npy")))
}

/// Reads a `.npz` file.
///
/// # Errors
/// A damaged file, or one without arrays of numbers.
pub(crate) fn npz(path: &Path) -> Result<Table> {
    let bytes = std::fs::read(path).map_err(|source| Error::io(path, "read the recording", source))?;
    let broken = |problem: &str| Error::input(path, None, "numpy", problem);
    let entries = entries(&bytes).ok_or_else(|| broken("the archive is damaged or cut off; save it again"))?;
    let mut arrays = Vec::new();
    for entry in entries {
        let content =
            entry.content(&bytes).ok_or_else(|| broken("the archive is damaged or cut off; save it again"))?;
        let name = entry.name.strip_suffix(".npy").unwrap_or(&entry.name).to_owned();
        // Arrays of other things than numbers do not belong to the log.
        arrays.extend(fields(&content, &name).unwrap_or_default());
    }
    table(path, arrays)
}

/// Reads a `.npy` file, which must have named fields.
///
/// # Errors
/// A damaged file, or an array without names.
pub(crate) fn npy(path: &Path) -> Result<Table> {
    let bytes = std::fs::read(path).map_err(|source| Error::io(path, "read the recording", source))?;
    let arrays = fields(&bytes, "").map_err(|problem| Error::input(path, None, "numpy", problem))?;
    if let [Array { name, shape, .. }] = arrays.as_slice()
        && name.is_empty()
    {
        let size = shape.iter().map(usize::to_string).collect::<Vec<_>>().join(" x ");
        let problem = format!(
            "an array of {size} numbers without names: which columns are time, positions and torques? Save it as \
             np.savez('log.npz', t=..., q=..., tau=...)"
        );
        return Err(Error::input(path, None, "numpy", problem));
    }
    table(path, arrays)
}

/// What arrays with the names of another array's columns are called.
const OF_COLUMNS: [&str; 5] = ["columns", "column_names", "header", "fields", "labels"];

/// What makes seconds between two rows of a number with this name.
fn step_of(name: &str) -> Option<fn(f64) -> f64> {
    match name.to_ascii_lowercase().as_str() {
        "dt" | "ts" | "period" | "timestep" | "time_step" | "sample_time" | "dt_s" => Some(|seconds| seconds),
        "dt_ms" | "period_ms" => Some(|milliseconds| 1e-3 * milliseconds),
        "rate" | "rate_hz" | "fs" | "freq" | "frequency" | "hz" | "sampling_rate" | "sample_rate" | "fps" => {
            Some(|rate| 1.0 / rate)
        }
        _ => None,
    }
}

fn table(path: &Path, arrays: Vec<Array>) -> Result<Table> {
    let is_time = |array: &&Array| names::time(&array.name, 1).is_some() && array.values.len() > 1;
    let longest = || arrays.iter().flat_map(|array| &array.shape).copied().max();
    let rows = arrays.iter().find(is_time).map(|array| array.values.len()).or_else(longest).unwrap_or(0);
    let labels: &[String] = arrays
        .iter()
        .find(|array| {
            matches!(array.name.as_str(), "name" | "names" | "joint_names" | "joints") && !array.texts.is_empty()
        })
        .map_or(&[], |array| array.texts.as_slice());
    // Names of the columns of one array.
    let columns: &[String] =
        arrays.iter().find(|array| OF_COLUMNS.contains(&array.name.as_str())).map_or(&[], |array| &array.texts);
    let mut table = Table::default();
    let is_position = |name: &str| {
        let readings = names::meanings(&format!("{name}[0]"));
        readings.first().is_some_and(|meaning| meaning.quantity == names::POSITION && !meaning.of_controller)
    };
    // Positions of several arms.
    let mut several: Vec<(String, usize, usize)> = Vec::new();
    for array in &arrays {
        // One of one arm, as simulators of many have it: (time, 1, joint).
        let shape: Vec<usize> = array.shape.iter().copied().filter(|size| *size != 1).collect();
        let (count, step) = match *shape.as_slice() {
            [own] if own == rows => (1, [1, 0]),
            [own, count] if own == rows => (count, [count, 1]),
            [count, own] if own == rows => (count, [1, rows]),
            [own, arms, joints] if own == rows => {
                several.extend(is_position(&array.name).then(|| (array.name.clone(), arms, joints)));
                continue;
            }
            _ => continue,
        };
        if array.values.len() != rows * count {
            continue;
        }
        let single = count == 1 && names::meanings(&array.name).is_empty();
        let of_joint = names::meanings(&format!("{}[0]", array.name)).first().map(|meaning| meaning.quantity);
        for place in 0..count {
            let name = match (of_joint, labels.get(place)) {
                _ if columns.len() == count && count > 1 => columns[place].clone(),
                (Some(quantity), Some(label)) if labels.len() == count => {
                    format!("{label}{}", names::QUANTITIES[quantity].suffixes[0])
                }
                _ if count == 1 && (!single || of_joint.is_none()) => array.name.clone(),
                _ => format!("{}[{place}]", array.name),
            };
            table.header.push(name);
            table.columns.push((0..rows).map(|row| array.values[row * step[0] + place * step[1]]).collect());
        }
    }
    let has_positions = table.header.iter().any(|name| is_position(name.split('[').next().unwrap_or_default()));
    if let (Some((name, arms, joints)), false) = (several.first(), has_positions) {
        let problem = format!(
            "{rows} x {arms} x {joints} numbers, the positions of {arms} arms: save one of them, as {name}[:, 0], with its velocities and torques; \
             others as logs of their own"
        );
        return Err(Error::input(path, None, name.as_str(), problem));
    }
    // The time between two rows stands in for their times.
    let step = arrays.iter().find_map(|array| match (array.values.as_slice(), step_of(&array.name)) {
        ([value], Some(step)) if *value > 0.0 => Some(step(*value)),
        _ => None,
    });
    if let (Some(step), None) = (step, arrays.iter().find(is_time)) {
        table.header.push("t".to_owned());
        table.columns.push((0..rows).map(|row| row as f64 * step).collect());
    }
    match table.header.is_empty() {
        true => Err(Error::input(path, None, "numpy", "there is no array of numbers in it")),
        false => Ok(table),
    }
}
