//! The load between logs of real arms, where a folder has them. Run with `--ignored`.

use super::folder;
use serde_json::Value;
use std::process::Command;
use tempfile::TempDir;

/// `payload.json` of two logs; the tests that call it are ignored, so that the folder must be there.
fn payload(urdf: &str, logs: [&str; 2], more: &[&str]) -> Value {
    let folder = folder().expect("the folder of measured logs: set TAUSCOPE_MEASURED");
    let work = TempDir::new().unwrap();
    let path = |name: &str| std::path::absolute(folder.join(name)).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_tauscope"))
        .arg("payload")
        .args([path(logs[0]), path(logs[1])])
        .arg("--robot")
        .arg(path(urdf))
        .args(["--out", "out", "--json"])
        .args(more)
        .current_dir(work.path())
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}
