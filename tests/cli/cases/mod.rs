//! Public robots and logs as their owners have them. They are not part of the project: the tests run where a folder holds
//! them, given by `TAUSCOPE_CASES`.

mod descriptions;
mod identified;
mod logs;
mod numerics;
mod robots;

use super::Case;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The folder of the cases, from the environment or in the parent folder of the project.
fn folder() -> PathBuf {
    let given = std::env::var_os("TAUSCOPE_CASES").map(PathBuf::from);
    given.unwrap_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/cases"))
}

/// A copy of one case in a folder of its own, compressed files expanded.
fn case(name: &str) -> Case {
    let case = Case { folder: tempfile::tempdir().unwrap() };
    copy(&folder().join(name), case.folder.path());
    case
}

/// Copies a folder with all in it; `FILE.gz` becomes `FILE`.
fn copy(from: &Path, to: &Path) {
    let entries = std::fs::read_dir(from).unwrap_or_else(|error| panic!("{}: {error}", from.display()));
    for entry in entries {
        let path = entry.unwrap().path();
        let place = to.join(path.file_name().unwrap());
        if path.is_dir() {
            std::fs::create_dir(&place).unwrap();
            copy(&path, &place);
            continue;
        }
        match path.extension().is_some_and(|extension| extension == "gz") {
            true => {
                let output = Command::new("gunzip").arg("-c").arg(&path).output().unwrap();
                assert!(output.status.success(), "{}", path.display());
                std::fs::write(place.with_extension(""), output.stdout).unwrap();
            }
            false => std::fs::write(&place, std::fs::read(&path).unwrap()).unwrap(),
        }
    }
}
