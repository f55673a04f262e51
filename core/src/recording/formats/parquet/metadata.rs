//! What a file keeps of a recording besides its columns.

use crate::error::{Error, Result};
use crate::recording::Recording;
use ::parquet::file::metadata::KeyValue;
use std::collections::{BTreeMap, HashMap};
use std::path::Path;

const ROBOT: &str = "tauscope.robot";
/// A JSON array of names.
const JOINTS: &str = "tauscope.joints";
/// Followed by the key of the entry.
const PROVENANCE: &str = "tauscope.provenance.";

/// The entries of a recording.
pub(super) fn metadata(recording: &Recording) -> Vec<KeyValue> {
    let joints = serde_json::Value::from(recording.joints.clone()).to_string();
    let mut entries = vec![KeyValue::new(ROBOT.into(), recording.robot.clone()), KeyValue::new(JOINTS.into(), joints)];
    let provenance = recording.provenance.iter();
    entries.extend(provenance.map(|(key, value)| KeyValue::new(format!("{PROVENANCE}{key}"), value.clone())));
    entries
}

/// Names of the joints, in the order of their numbers, where a file has them.
///
/// # Errors
/// An entry that is no list of names.
pub(super) fn own_joints(path: &Path, metadata: &HashMap<String, String>) -> Result<Option<Vec<String>>> {
    let names = metadata.get(JOINTS).map(|text| serde_json::from_str(text)).transpose();
    names.map_err(|error| {
        Error::input(path, None, JOINTS, format!("this entry of the metadata must be a JSON array of names: {error}"))
    })
}

/// Adds the entries of a file to its recording.
pub(super) fn describe(metadata: &HashMap<String, String>, recording: &mut Recording) {
    recording.robot = metadata.get(ROBOT).cloned().unwrap_or_default();
    recording.provenance = provenance(metadata);
}

fn provenance(metadata: &HashMap<String, String>) -> BTreeMap<String, String> {
    let entries = metadata.iter();
    entries.filter_map(|(key, value)| Some((key.strip_prefix(PROVENANCE)?.to_owned(), value.clone()))).collect()
}
