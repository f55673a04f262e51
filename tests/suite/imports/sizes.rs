//! Files and folders that can be read at once.

use super::gates::sources;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Most lines of a file, and most files of a folder.
const LINES: usize = 500;
const FILES: usize = 15;

#[test]
fn files_and_folders_are_short() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut folders: BTreeMap<PathBuf, usize> = BTreeMap::new();
    for file in ["core/src", "src", "tests"].into_iter().flat_map(|folder| sources(&root.join(folder))) {
        if file.extension().is_some_and(|extension| extension == "rs") {
            let lines = std::fs::read_to_string(&file).expect("it is text").lines().count();
            assert!(lines <= LINES, "{} has {lines} lines", file.display());
            *folders.entry(file.parent().expect("it is in a folder").to_owned()).or_default() += 1;
        }
    }
    assert!(folders.len() > 40, "{folders:?}");
    for (folder, files) in folders {
        assert!(files <= FILES, "{} holds {files} files", folder.display());
    }
}
