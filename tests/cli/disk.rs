//! Folders that cannot be written, and disks that are full: an error, and no half-written results.
#![cfg(unix)]

use super::{Case, assert_done, assert_refusal, names};
use std::path::Path;

#[test]
fn places_that_are_no_folder() {
    let case = Case::new(&[]);
    let before = case.names();
    for (out, words) in [
        ("s.toml", ["s.toml: cannot write results", "it is a file"]),
        ("s.toml/out", ["s.toml/out: cannot write results", "directory"]),
    ] {
        assert_refusal(&case.tauscope(&["run", "s.toml", "--out", out]), &words);
        assert_eq!(case.names(), before);
    }
}

/// A folder without permission to write; root may write there all the same, so `/proc` stands in.
#[test]
fn folders_that_cannot_be_written() {
    let case = Case::new(&[]);
    if Path::new("/proc/self").exists() {
        assert_refusal(&case.tauscope(&["run", "s.toml", "--out", "/proc/out"]), &["/proc/out: cannot write results"]);
    }
    let locked = case.path("locked");
    std::fs::create_dir(&locked).unwrap();
    let mut permissions = std::fs::metadata(&locked).unwrap().permissions();
    permissions.set_readonly(true);
    std::fs::set_permissions(&locked, permissions).unwrap();
    if std::fs::write(locked.join("probe"), "").is_ok() {
        println!("skipped: this user may write everywhere");
        return;
    }
    assert_refusal(&case.tauscope(&["run", "s.toml", "--out", "locked"]), &["locked: cannot write results", "denied"]);
    assert!(names(&locked).is_empty());
}

/// Every size of the disk at which writing stops gives the same picture: an error that names a file, and the results of
/// the run before untouched.
#[test]
fn files_that_may_not_grow() {
    let case = Case::new(&[]);
    assert_done(&case.tauscope(&["run", "s.toml", "--out", "out", "--quiet", "--seed", "1"]));
    let (before, old) = (case.names(), case.read("out/recording.csv"));
    let files = names(&case.path("out"));
    for kilobytes in [1, 100, 1000] {
        // The signal is ignored, so that the write fails as on a full disk.
        let line = format!("trap '' XFSZ; ulimit -f {kilobytes}; exec \"$TAUSCOPE\" run s.toml --out out --seed 2");
        assert_refusal(&case.bash(&line), &["out/recording.csv", "File too large"]);
        assert_eq!(case.names(), before);
        assert_eq!(names(&case.path("out")), files);
        assert_eq!(case.read("out/recording.csv"), old);
    }
    let line = "trap '' XFSZ; ulimit -f 1; exec \"$TAUSCOPE\" run s.toml --out fresh";
    assert_refusal(&case.bash(line), &["fresh/recording.csv"]);
    assert_eq!(case.names(), before);
}

/// A small file system of its own, where it may be mounted.
#[test]
fn a_full_disk() {
    let case = Case::new(&[]);
    // In a mount namespace of its own, so that nothing stays mounted whatever happens.
    let inside = "mount -t tmpfs -o size=500k tmpfs disk 2>/dev/null || exit 77
                  \"$TAUSCOPE\" run s.toml --out disk/out; code=$?
                  [ -z \"$(ls -A disk)\" ] || exit 78; exit $code";
    let output =
        case.bash(&format!("mkdir disk; unshare -m true 2>/dev/null || exit 77; unshare -m bash -c '{inside}'"));
    if output.status.code() == Some(77) {
        println!("skipped: no file system may be mounted here");
        return;
    }
    assert_refusal(&output, &["disk/out/recording.csv", "No space left"]);
}

/// A run that is killed while it computes leaves no hidden folder.
#[test]
fn killed_while_computing() {
    let case = Case::new(&[("duration_s = 4.0", "duration_s = 1000.0")]);
    let before = case.names();
    case.bash("timeout -s KILL 0.5 \"$TAUSCOPE\" run s.toml --out out");
    assert_eq!(case.names(), before);
}
