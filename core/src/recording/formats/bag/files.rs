//! The files of a bag.

use crate::error::{Error, Result};
use std::path::{Path, PathBuf};

/// Whether a path is a bag by its name.
pub(crate) fn is_bag(path: &Path) -> bool {
    let name = path.file_name().map(|name| name.to_string_lossy().to_lowercase()).unwrap_or_default();
    let name = name.strip_suffix(".zstd").unwrap_or(&name);
    name.ends_with(".mcap") || name.ends_with(".db3") || path.join(METADATA).is_file()
}

/// The file that describes a bag of several files.
const METADATA: &str = "metadata.yaml";

/// The files of a bag in their order; a file is its own.
pub(super) fn files(path: &Path) -> Result<Vec<PathBuf>> {
    if !path.is_dir() {
        return Ok(vec![path.to_owned()]);
    }
    let metadata = path.join(METADATA);
    let text = std::fs::read_to_string(&metadata).map_err(|source| Error::io(&metadata, "read the bag", source))?;
    let listed = text.lines().skip_while(|line| line.trim() != "relative_file_paths:").skip(1);
    let names = listed.map_while(|line| line.trim().strip_prefix("- "));
    let files: Vec<PathBuf> = names.map(|name| path.join(name.trim_matches(['"', '\'']))).collect();
    match files.is_empty() {
        true => Err(Error::input(metadata, None, "relative_file_paths", "names no file")),
        false => Ok(files),
    }
}
