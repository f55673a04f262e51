//! The commands of `tauscope`, called with the arguments of the command line.

use crate::{warnings, work};
use pyo3::prelude::*;
use std::ffi::OsString;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use tauscope::cli::{self, Host};

/// What came of a command: exit code, the result as JSON, the same for people, the error, warnings.
type Called = (u8, Option<String>, Option<String>, Option<String>, Vec<String>);

/// Runs a command. After an interrupt it may write results a while longer: then the folder `out` is removed when it is done.
#[pyfunction]
#[pyo3(signature = (arguments, out=None))]
pub(crate) fn call(py: Python<'_>, arguments: Vec<OsString>, out: Option<PathBuf>) -> PyResult<Called> {
    warnings::keep();
    let host = Arc::new(Host::default());
    let interrupted = Arc::new(AtomicBool::new(false));
    let (own, late) = (Arc::clone(&host), Arc::clone(&interrupted));
    let stop = || {
        interrupted.store(true, Ordering::Relaxed);
        host.stop();
    };
    let result = work::run(py, stop, move || {
        let result = cli::call(arguments, &own);
        if let (true, Some(folder)) = (late.load(Ordering::Relaxed), out) {
            // What is left of an interrupted command is of no use; a folder that is gone already is as good.
            let _ = std::fs::remove_dir_all(folder);
        }
        result
    })?;
    let (code, error) = match result {
        Ok(code) => (code, None),
        Err(error) => (cli::BAD_INPUT, Some(error.to_string())),
    };
    let (json, text) = host.take().map(|printed| (printed.json, printed.text)).unzip();
    Ok((code, json, text, error, warnings::take()))
}

/// The command `tauscope`: `arguments` begin with its name. Returns the exit code.
#[pyfunction]
pub(crate) fn main(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| cli::main_with(arguments))
}
