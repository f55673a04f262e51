//! Logs from arrays and from files.

use crate::arrays::{array, signals};
use crate::error::{raised, wrong};
use numpy::{PyArray1, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;
use tauscope::channels::Channels;
use tauscope::recording::lenient::{self, ColumnMap};
use tauscope::recording::{Recording, memory};

/// A log that commands find under `path` as long as this lives.
#[pyclass(frozen, module = "tauscope._tauscope")]
pub(crate) struct Held(memory::Held);

#[pymethods]
impl Held {
    /// What to name in the place of a file.
    #[getter]
    fn path(&self) -> PathBuf {
        self.0.path().to_owned()
    }
}

type Signals<'py> = Option<PyReadonlyArray2<'py, f64>>;

/// Holds a log of arrays, samples x joints, for the commands. A log without torque has one that is not a number.
#[pyfunction]
#[pyo3(signature = (name, joints, t, q, qd=None, qdd=None, tau=None))]
pub(crate) fn hold(
    name: &str,
    joints: Vec<String>,
    t: PyReadonlyArray1<'_, f64>,
    q: PyReadonlyArray2<'_, f64>,
    qd: Signals<'_>,
    qdd: Signals<'_>,
    tau: Signals<'_>,
) -> PyResult<Held> {
    let count = joints.len();
    let time: Vec<f64> = t.as_array().iter().copied().collect();
    let missing = || {
        let mut none = Channels::zeros(count, time.len());
        none.as_mut_slice().fill(f64::NAN);
        none
    };
    let tau = tau.map_or_else(|| Ok(missing()), |tau| signals("tau", &tau, count))?;
    let mut log = Recording::new(joints, time, signals("q", &q, count)?, tau).map_err(|error| raised(&error))?;
    if let Some(qd) = qd {
        log = log.velocities(signals("qd", &qd, count)?).map_err(|error| raised(&error))?;
    }
    if let Some(qdd) = qdd {
        log = log.accelerations(signals("qdd", &qdd, count)?).map_err(|error| raised(&error))?;
    }
    memory::Held::new(name, log).map(Held).map_err(|error| raised(&error))
}

/// Reads a log as the commands do: `joints`, `t`, and arrays of joints x samples; with `truth` where a simulation wrote it, and `notes`.
#[pyfunction]
#[pyo3(signature = (path, joints=None))]
pub(crate) fn read_log(py: Python<'_>, path: PathBuf, joints: Option<Vec<String>>) -> PyResult<Bound<'_, PyDict>> {
    if joints.as_ref().is_some_and(Vec::is_empty) {
        return Err(wrong("joints", "name at least one"));
    }
    let read = py.detach(|| lenient::load(&path, joints.as_deref(), &ColumnMap::default()));
    let sieved = read.map_err(|error| raised(&error))?;
    let mut notes = sieved.corrections;
    let rows =
        sieved.rejected.iter().map(|row| format!("line {}: {}: {}: left out", row.line, row.column, row.problem));
    notes.extend(rows);
    let Recording { joints, time, q, qd, qdd, tau, truth, .. } = sieved.recording;
    let log = PyDict::new(py);
    log.set_item("joints", joints)?;
    log.set_item("t", PyArray1::from_vec(py, time))?;
    log.set_item("notes", notes)?;
    for (name, signals) in [("q", Some(q)), ("qd", qd), ("qdd", qdd), ("tau", Some(tau))] {
        log.set_item(name, signals.map(|signals| array(py, signals)).transpose()?)?;
    }
    let Some(truth) = truth else { return Ok(log) };
    let exact = PyDict::new(py);
    for (name, signals) in [("q", &truth.q), ("qd", &truth.qd), ("qdd", &truth.qdd), ("tau", &truth.tau)] {
        exact.set_item(name, array(py, signals.clone())?)?;
    }
    log.set_item("truth", exact)?;
    Ok(log)
}
