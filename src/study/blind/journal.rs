//! Runs of a study as they are finished, one JSON line each, so that they survive whatever ends the program.

use super::row::Row;
use crate::error::{Error, Result};
use serde::{Deserialize, Serialize};
use std::fs::{self, File, OpenOptions};
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};

/// Where runs are kept until the study is finished.
const UNFINISHED: &str = "unfinished";
const LINES: &str = "runs.jsonl";

/// What a study is made from: runs of another one must not be taken for its own.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Identity {
    /// Seed of the study.
    pub seed: u64,
    /// The scenario whose arm and sensors are used.
    pub scenario: String,
    /// The plan, in words.
    pub plan: String,
}

/// Finished runs in a file.
#[derive(Debug)]
pub(crate) struct Journal {
    folder: PathBuf,
    file: File,
}

impl Journal {
    /// Opens the journal in a results folder; with `resume` the runs that are there come back.
    ///
    /// # Errors
    /// If it cannot be written, holds runs of another study, or of this one without `resume`.
    pub(crate) fn open(results: &Path, identity: &Identity, resume: bool) -> Result<(Self, Vec<Row>)> {
        let folder = results.join(UNFINISHED);
        let path = folder.join(LINES);
        let failed = |source| Error::io(&path, "keep finished runs", source);
        let mut rows = Vec::new();
        if path.exists() {
            let refuse = |problem: &str| {
                let problem = format!("{problem}; choose another --out or remove it");
                Err(Error::request(path.display().to_string(), problem))
            };
            let mut lines = BufReader::new(File::open(&path).map_err(failed)?).lines();
            let first = lines.next().transpose().map_err(failed)?.unwrap_or_default();
            match serde_json::from_str::<Identity>(&first) {
                Ok(known) if known != *identity => {
                    return refuse("holds runs of another study (seed, scenario or plan)");
                }
                Ok(_) if !resume => {
                    return refuse("holds runs of a study that was not finished: continue with --resume");
                }
                Ok(_) => {}
                Err(_) => return refuse("is no journal of blind runs"),
            }
            for line in lines {
                // The last line may be cut off where the program was killed: that run is made again.
                rows.extend(serde_json::from_str::<Row>(&line.map_err(failed)?).ok());
            }
        }
        fs::create_dir_all(&folder).map_err(failed)?;
        // What came back is written again, so that nothing follows a line that was cut off.
        let mut journal = Journal { file: File::create(path.with_extension("tmp")).map_err(failed)?, folder };
        journal.line(identity)?;
        rows.iter().try_for_each(|row| journal.line(row))?;
        fs::rename(path.with_extension("tmp"), &path).map_err(failed)?;
        journal.file = OpenOptions::new().append(true).open(&path).map_err(failed)?;
        Ok((journal, rows))
    }

    /// Adds a run.
    ///
    /// # Errors
    /// If it cannot be written.
    pub(crate) fn add(&mut self, row: &Row) -> Result<()> {
        self.line(row)
    }

    fn line(&mut self, value: &impl Serialize) -> Result<()> {
        let text = serde_json::to_string(value).map_err(std::io::Error::from);
        text.and_then(|text| self.file.write_all(format!("{text}\n").as_bytes()))
            .map_err(|source| Error::io(self.folder.join(LINES), "keep a finished run", source))
    }

    /// Removes the file, whose runs are in the results now.
    ///
    /// # Errors
    /// If it cannot be removed.
    pub(crate) fn remove(self) -> Result<()> {
        fs::remove_dir_all(&self.folder).map_err(|source| Error::io(&self.folder, "remove the finished runs", source))
    }
}

#[cfg(test)]
mod tests {
    use super::super::case::Case;
    use super::*;

    fn identity(seed: u64) -> Identity {
        Identity { seed, scenario: "s".into(), plan: "p".into() }
    }

    #[test]
    fn runs_come_back_and_a_line_cut_off_does_not() {
        let folder = tempfile::tempdir().unwrap();
        let row = Row::new(&Case::plain(7), &Err(Error::request("x", "y")));
        let (mut journal, rows) = Journal::open(folder.path(), &identity(1), false).unwrap();
        assert!(rows.is_empty());
        journal.add(&row).unwrap();
        journal.file.write_all(b"{\"run\": 2, \"cla").unwrap();
        drop(journal);
        assert!(Journal::open(folder.path(), &identity(1), false).unwrap_err().to_string().contains("--resume"));
        assert!(Journal::open(folder.path(), &identity(2), true).unwrap_err().to_string().contains("another study"));
        let (mut journal, rows) = Journal::open(folder.path(), &identity(1), true).unwrap();
        assert_eq!(rows, std::slice::from_ref(&row));
        journal.add(&row).unwrap();
        drop(journal);
        let (journal, rows) = Journal::open(folder.path(), &identity(1), true).unwrap();
        assert_eq!(rows.len(), 2);
        journal.remove().unwrap();
        assert!(!folder.path().join(UNFINISHED).exists());
    }
}
