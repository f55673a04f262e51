//! A description of logs as a file.

use super::spec::{Part, SCHEMA, Spec};
use crate::error::{Error, Result};
use std::path::{Path, PathBuf};

/// The problem with a file of another kind.
const NO_DATASET: &str = "this is no dataset, a text in TOML that names the robot and its logs: give a robot's URDF with --robot, and logs \
                          with --train and --test";

/// A description of logs.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::dataset::Dataset;
/// use tauscope::robot::{self, InertiaCheck};
/// # let folder = tempfile::tempdir().unwrap();
/// # let path = folder.path().join("dataset.toml");
/// # std::fs::write(folder.path().join("a.csv"), "ms,e1,i1\n0,9000,1.5\n4,18000,-0.5\n8,18000,1.0\n").unwrap();
/// # let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Required)?;
///
/// // Encoder degrees and currents of a motor behind a gear of 100, with stamps in milliseconds.
/// std::fs::write(&path, r#"schema = "tauscope.dataset/1"
/// train = [{ file = "a.csv" }]
/// columns = { time = "ms", q = ["e1"], tau = ["i1"] }
/// units = { time = "ms", position = "deg", torque = "A" }
/// motors = { gear_ratio = 100, torque_constant_nm_a = 0.2, position_at = "motor" }"#).unwrap();
/// let dataset = Dataset::load(&path)?;
/// let log = dataset.read(&dataset.files()[0], &robot)?.recording;
/// assert!((log.q.channel(0)[0] - 90f64.to_radians()).abs() < 1e-12);
/// assert!((log.tau.channel(0)[0] - 1.5 * 0.2 * 100.0).abs() < 1e-9);
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Dataset {
    pub(super) path: PathBuf,
    pub(super) text: String,
    pub(super) spec: Spec,
}

impl Dataset {
    /// Reads a description. Paths in it are relative to its folder.
    ///
    /// # Errors
    /// An unreadable file, an unknown key or unit, another schema, no log to train from.
    pub fn load(path: impl AsRef<Path>) -> Result<Dataset> {
        let path = path.as_ref();
        let bytes = std::fs::read(path).map_err(|source| Error::io(path, "read the dataset", source))?;
        let text = match String::from_utf8(bytes) {
            Ok(text) if !is_other(&text) => text,
            _ => return Err(Error::input(path, None, "--dataset", NO_DATASET)),
        };
        let spec: Spec = toml::from_str(&text).map_err(|error| Error::toml(path, &text, &error))?;
        let dataset = Dataset { path: path.to_owned(), text, spec };
        if dataset.spec.schema != SCHEMA {
            let problem = match dataset.spec.schema.as_str() {
                "" => format!("is missing: begin the file with schema = \"{SCHEMA}\""),
                other => format!("`{other}` is not known; this is {SCHEMA}"),
            };
            return Err(dataset.error("schema", problem));
        }
        if dataset.spec.train.is_empty() {
            return Err(dataset.error("train", "name at least one log: [[train]] with file = \"...\""));
        }
        dataset.check_parts()?;
        dataset.check_columns()?;
        Ok(dataset)
    }

    /// Parts end after they begin, and what judges is not what was trained from.
    fn check_parts(&self) -> Result<()> {
        for (key, part) in self.parts() {
            if part.file.is_some() == part.files.is_some() || part.paths().is_empty() {
                let problem =
                    "name the log by file = \"...\", or by files = [\"...\", \"...\"] where its columns are in several";
                return Err(self.error(key, problem));
            }
            let [from, to] = part.seconds();
            // Not a number compares to nothing.
            if from.partial_cmp(&to) != Some(std::cmp::Ordering::Less) {
                let problem = format!("{}: from {from} s to {to} s is no part of a log", part.name());
                return Err(self.error(key, problem));
            }
        }
        for test in &self.spec.test {
            let [from, to] = test.seconds();
            let shares = |train: &&Part| {
                let [begin, end] = train.seconds();
                train.paths().iter().any(|path| test.paths().contains(path)) && begin < to && from < end
            };
            if let Some(train) = self.spec.train.iter().find(shares) {
                let problem = format!(
                    "{} is trained from in part or as a whole; judge by what the fit did not see, with to_s in [[train]] and \
                     from_s in [[test]] or with another log",
                    train.name()
                );
                return Err(self.error("test", problem));
            }
        }
        Ok(())
    }

    /// All lists of columns have one for each joint.
    fn check_columns(&self) -> Result<()> {
        let columns = &self.spec.columns;
        let lists = [("q", &columns.q), ("qd", &columns.qd), ("qdd", &columns.qdd), ("tau", &columns.tau)];
        let mut given = lists.into_iter().filter_map(|(key, list)| Some((key, list.as_ref()?.len())));
        let Some((first, count)) = given.next() else { return Ok(()) };
        match given.find(|(_, other)| *other != count) {
            Some((key, other)) => {
                let problem = format!(
                    "a list of {other}, and {first} is one of {count}: give one column for each joint, in one order"
                );
                Err(self.error(&format!("columns.{key}"), problem))
            }
            None => Ok(()),
        }
    }

    /// All logs with their keys, the training logs first.
    pub(super) fn parts(&self) -> impl Iterator<Item = (&'static str, &Part)> {
        let of = |key| move |part| (key, part);
        self.spec.train.iter().map(of("train")).chain(self.spec.test.iter().map(of("test")))
    }

    /// The URDF that the dataset names.
    pub fn robot(&self) -> Option<PathBuf> {
        self.spec.robot.as_ref().map(|robot| self.beside(robot))
    }

    /// All logs that it names, the training logs first; of a log in several files the first of them.
    pub fn files(&self) -> Vec<PathBuf> {
        self.parts().filter_map(|(_, part)| Some(self.beside(part.paths().first()?))).collect()
    }

    /// The files of a log, relative to the description's folder.
    pub(super) fn beside_all(&self, part: &Part) -> Vec<PathBuf> {
        part.paths().into_iter().map(|path| self.beside(path)).collect()
    }

    /// A file, relative to the description's folder.
    pub(super) fn beside(&self, file: &Path) -> PathBuf {
        self.path.parent().unwrap_or(Path::new("")).join(file)
    }

    /// An error about a key, at its line.
    pub(super) fn error(&self, key: &str, problem: impl Into<String>) -> Error {
        let last = key.rsplit('.').next().unwrap_or(key);
        let line = self.text.lines().position(|line| {
            let line = line.trim_start().trim_start_matches('[');
            line.strip_prefix(last).is_some_and(|rest| rest.trim_start().starts_with(['=', ']']))
        });
        Error::input(&self.path, line.map(|line| line + 1), key, problem)
    }
}

/// Whether a text is of another kind than TOML: a document of XML or JSON, or a table, whose first lines have neither a key nor a header.
fn is_other(text: &str) -> bool {
    let lines = text.trim_start_matches('\u{feff}').lines().map(str::trim);
    let first: Vec<&str> = lines.filter(|line| !line.is_empty() && !line.starts_with('#')).take(3).collect();
    let is_toml = |line: &&str| line.contains('=') || line.starts_with('[');
    first.first().is_some_and(|line| line.starts_with(['<', '{'])) || !first.is_empty() && !first.iter().any(is_toml)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_other_kinds_are_no_datasets() {
        for text in ["<?xml version=\"1.0\"?><robot/>", "{\"q\": [1]}", "time,q1,tau1\n0.0,1.0,2.0\n", "# log\n0 1 2\n"]
        {
            assert!(is_other(text), "{text}");
        }
        for text in
            ["", "# nothing yet", "schema = \"x\"", "[[train]]\nfile = \"log.csv\"", "schema\nrobot = \"a.urdf\""]
        {
            assert!(!is_other(text), "{text}");
        }
    }
}
