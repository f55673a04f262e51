//! TOML from and to JSON, which Python reads and writes by itself.

use crate::error::wrong;
use pyo3::prelude::*;

/// The JSON text of a TOML text.
#[pyfunction]
pub(crate) fn from_toml(text: &str) -> PyResult<String> {
    let value: toml::Value = toml::from_str(text).map_err(|problem| wrong("TOML", problem.to_string().trim()))?;
    serde_json::to_string(&value).map_err(|problem| wrong("TOML", problem))
}

/// The TOML text of a JSON text.
#[pyfunction]
pub(crate) fn to_toml(text: &str) -> PyResult<String> {
    let value: serde_json::Value = serde_json::from_str(text).map_err(|problem| wrong("scenario", problem))?;
    toml::to_string(&value).map_err(|problem| wrong("scenario", problem))
}
