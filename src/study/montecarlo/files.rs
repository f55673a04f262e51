//! The files of a study: their names, and what a folder holds.

use super::plan::Identity;
use crate::error::{Error, Result};
use std::fs;
use std::path::{Path, PathBuf};

/// Layout of `study.json`.
pub(super) const STUDY_SCHEMA: &str = "tauscope.study/1";
/// Layout of `summary.json`.
pub const SUMMARY_SCHEMA: &str = "tauscope.montecarlo/1";

/// Rows of the trials.
pub(super) const TRIALS: &str = "trials.parquet";
/// Times of the trials.
pub(super) const TIMINGS: &str = "timings.parquet";
/// The study's [`Identity`].
pub(super) const STUDY: &str = "study.json";
/// What the rows amount to.
pub(super) const SUMMARY: &str = "summary.json";
/// The page for a browser.
pub(super) const REPORT: &str = "report.html";

/// Start of the names of shards' folders.
pub(super) const SHARD: &str = "shard_";

/// Copies of what the study was made from.
pub(super) const INPUTS: [&str; 4] = ["scenario.toml", "robot.urdf", "motion.toml", "held_out.toml"];

/// The study that a folder holds, if it holds one.
///
/// # Errors
/// If `study.json` cannot be read or is none.
pub(super) fn identity_of(folder: &Path) -> Result<Option<Identity>> {
    let path = folder.join(STUDY);
    let text = match fs::read_to_string(&path) {
        Ok(text) => text,
        Err(source) if source.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        Err(source) => return Err(Error::io(&path, "read the study", source)),
    };
    let value: serde_json::Value = serde_json::from_str(&text)
        .map_err(|problem| Error::input(&path, Some(problem.line()), "JSON", problem.to_string()))?;
    if value["schema"] != STUDY_SCHEMA {
        return Err(Error::input(&path, None, "schema", format!("is not `{STUDY_SCHEMA}`; choose another folder")));
    }
    let mut value = value;
    value.as_object_mut().map(|object| object.remove("schema"));
    serde_json::from_value(value).map(Some).map_err(|problem| Error::input(&path, None, "study", problem.to_string()))
}

/// Folders of shards inside a folder, in order.
pub(super) fn shards_in(folder: &Path) -> Result<Vec<PathBuf>> {
    let failed = |source| Error::io(folder, "read the folder", source);
    let mut shards = Vec::new();
    for entry in fs::read_dir(folder).map_err(failed)? {
        let entry = entry.map_err(failed)?;
        if entry.file_name().to_string_lossy().starts_with(SHARD) && entry.path().is_dir() {
            shards.push(entry.path());
        }
    }
    shards.sort();
    Ok(shards)
}
