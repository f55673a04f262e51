//! Reading of recordings.

use super::table::Table;
use crate::error::{Error, Result};
use crate::recording::Recording;
use crate::recording::columns::Layout;
use std::path::Path;

/// Reads a recording and notes on what in the file was not used. `joints` are the robot's joints in order; without
/// them the file's own names or numbers are taken. Columns are called as in [`csv`](crate::recording::csv) and hold numbers, or lists of
/// them.
///
/// # Errors
/// An unreadable file, columns that are missing or not numbers, other joints than `joints`, values that are empty or
/// not finite, time that does not increase.
pub fn read(path: &Path, joints: Option<&[String]>) -> Result<(Recording, Vec<String>)> {
    let mut table = Table::open(path)?;
    let own = std::mem::take(&mut table.own_joints);
    let mut layout = Layout::find(path, None, &table.header, joints.or(own.as_deref()))?;
    let columns = table.rows(path, &table.header, &layout.used(), false)?;
    if let Some(fault) = layout.fault(&columns) {
        let place = format!("{}, row {}", table.header[fault.column], fault.row + 1);
        return Err(Error::input(path, None, place, fault.problem));
    }
    let notes = std::mem::take(&mut layout.notes);
    let mut recording = layout.recording(columns);
    table.describe(&mut recording);
    Ok((recording, notes))
}
