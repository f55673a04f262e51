//! Arrays of numpy, samples x joints, as signals, and signals as arrays.

use crate::error::wrong;
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use tauscope::channels::Channels;

/// Rows that are copied together: those of some joints stay in the first-level cache.
const BLOCK: usize = 256;

/// The signals of an array of samples x joints. A signal whose samples lie behind each other is copied as it is.
///
/// # Errors
/// If it has another number of joints.
pub(crate) fn signals(name: &str, array: &PyReadonlyArray2<'_, f64>, joints: usize) -> PyResult<Channels> {
    let [rows, columns] = [array.shape()[0], array.shape()[1]];
    if columns != joints {
        let problem = format!("has {columns} columns; give an array of samples x {joints} joints");
        return Err(wrong(name, problem));
    }
    let view = array.as_array();
    let mut table = Channels::zeros(joints, rows);
    let contiguous = view.columns().into_iter().all(|column| column.as_slice().is_some());
    if contiguous {
        for (joint, column) in view.columns().into_iter().enumerate() {
            table.channel_mut(joint).copy_from_slice(column.as_slice().unwrap_or_default());
        }
        return Ok(table);
    }
    let whole = view.as_slice();
    let cells = table.as_mut_slice();
    for start in (0..rows).step_by(BLOCK) {
        let end = rows.min(start + BLOCK);
        for joint in 0..joints {
            let signal = &mut cells[joint * rows + start..joint * rows + end];
            match whole {
                Some(whole) => {
                    let own = whole[start * joints..end * joints].chunks_exact(joints);
                    own.zip(signal).for_each(|(row, cell)| *cell = row[joint]);
                }
                None => (start..end).zip(signal).for_each(|(row, cell)| *cell = view[[row, joint]]),
            }
        }
    }
    Ok(table)
}

/// Signals as an array of joints x samples, without a copy: its transpose is samples x joints.
pub(crate) fn array(py: Python<'_>, signals: Channels) -> PyResult<Bound<'_, PyArray2<f64>>> {
    let shape = [signals.channels(), signals.samples()];
    PyArray1::from_vec(py, signals.into_vec()).reshape(shape)
}
