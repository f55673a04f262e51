//! The `tauscope` command from outside: what it prints and writes, and how it refuses bad input.

mod cases;
mod console;
mod diagnose;
mod disk;
mod effects;
mod identify;
mod inspect;
mod library;
mod options;
mod payload;
mod reports;
mod robots;
#[path = "../schema/mod.rs"]
mod schema;
mod studies;
#[cfg(unix)]
mod terminal;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use tempfile::TempDir;

/// The folder of the sources.
const ROOT: &str = env!("CARGO_MANIFEST_DIR");

/// A folder of its own with a scenario in it, in which the command is run.
struct Case {
    folder: TempDir,
}

impl Case {
    /// The short scenario, shorter still, with `edits` made (each must apply).
    fn new(edits: &[(&str, &str)]) -> Self {
        let text = std::fs::read_to_string(format!("{ROOT}/tests/scenarios/short.toml")).unwrap();
        let mut text = text.replace("../../urdf/irb1600_6_120.urdf", "arm.urdf").replace("= 8.0", "= 4.0");
        for (from, to) in edits {
            assert!(text.contains(from), "{from} is not in the scenario");
            text = text.replacen(from, to, 1);
        }
        let case = Case { folder: tempfile::tempdir().unwrap() };
        case.write("s.toml", &text);
        case.write("arm.urdf", &std::fs::read_to_string(format!("{ROOT}/urdf/irb1600_6_120.urdf")).unwrap());
        case
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn write(&self, name: &str, text: &str) {
        std::fs::write(self.path(name), text).unwrap();
    }

    fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.path(name)).unwrap()
    }

    fn read_bytes(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).unwrap()
    }

    /// The URDF with an edit made.
    fn with_urdf(self, from: &str, to: &str) -> Self {
        let text = self.read("arm.urdf");
        assert!(text.contains(from), "{from} is not in the URDF");
        self.write("arm.urdf", &text.replacen(from, to, 1));
        self
    }

    fn tauscope(&self, arguments: &[&str]) -> Output {
        Command::new(env!("CARGO_BIN_EXE_tauscope")).args(arguments).current_dir(self.folder.path()).output().unwrap()
    }

    /// Runs a line of bash in the folder, with the command as `$TAUSCOPE`.
    fn bash(&self, line: &str) -> Output {
        Command::new("bash")
            .args(["-c", line])
            .env("TAUSCOPE", env!("CARGO_BIN_EXE_tauscope"))
            .current_dir(self.folder.path())
            .output()
            .unwrap()
    }

    /// Everything in the folder, hidden or not.
    fn names(&self) -> Vec<String> {
        names(self.folder.path())
    }

    /// Checks that `run s.toml` is refused with exit code 2 and one line that has all `words`, and writes nothing.
    fn assert_refused(&self, words: &[&str]) {
        let before = self.names();
        assert_refusal(&self.tauscope(&["run", "s.toml", "--out", "out"]), words);
        assert_eq!(self.names(), before, "a refused run must leave nothing behind");
    }
}

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

/// Exit code 2, nothing on standard output, and one line of error that has all `words`.
fn assert_refusal(output: &Output, words: &[&str]) {
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(output.stdout.is_empty(), "{}", text(&output.stdout));
    assert_eq!(message.trim_end().lines().count(), 1, "{message}");
    assert!(message.starts_with("tauscope: ") && message.len() < 1000, "{message}");
    for word in words {
        assert!(message.contains(word), "{message} lacks {word}");
    }
}

/// That logs forbid an answer: it is printed as any, and the exit code reports it.
fn assert_stopped(output: &Output) {
    assert_eq!(output.status.code(), Some(2), "{}", text(&output.stderr));
    assert!(output.stderr.is_empty(), "{}", text(&output.stderr));
}

fn assert_done(output: &Output) {
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}
