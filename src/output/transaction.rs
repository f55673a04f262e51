//! Moving files to their place so that a failure on the way can be undone.

use std::io;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// Steps done so far; dropped before [`Transaction::commit`], it undoes them, last one first.
#[derive(Debug)]
pub(super) struct Transaction {
    /// Holds what the steps replaced, under numbers; on the same file system.
    backup: TempDir,
    done: Vec<Step>,
}

#[derive(Debug)]
enum Step {
    CreatedFolder(PathBuf),
    MovedAway { place: PathBuf, backup: PathBuf },
    MovedHere { place: PathBuf },
}

impl Transaction {
    pub(super) fn new(backup: TempDir) -> Self {
        Transaction { backup, done: Vec::new() }
    }

    /// Creates a folder with its parents; nothing if it is there.
    pub(super) fn create_folder(&mut self, path: &Path) -> io::Result<()> {
        let missing: Vec<&Path> = path.ancestors().take_while(|folder| !folder.is_dir()).collect();
        for folder in missing.into_iter().rev() {
            std::fs::create_dir(folder)?;
            self.done.push(Step::CreatedFolder(folder.to_owned()));
        }
        Ok(())
    }

    /// Removes a file; nothing if it is not there.
    pub(super) fn remove(&mut self, place: &Path) -> io::Result<()> {
        // A link is a file of its own, wherever it leads.
        match place.symlink_metadata() {
            Err(error) if matches!(error.kind(), io::ErrorKind::NotFound | io::ErrorKind::NotADirectory) => {
                return Ok(());
            }
            Err(error) => return Err(error),
            Ok(metadata) if metadata.is_dir() => return Err(io::ErrorKind::IsADirectory.into()),
            Ok(_) => {}
        }
        let backup = self.backup.path().join(self.done.len().to_string());
        std::fs::rename(place, &backup)?;
        self.done.push(Step::MovedAway { place: place.to_owned(), backup });
        Ok(())
    }

    /// Moves `file` to `place`, in the stead of the file there.
    pub(super) fn replace(&mut self, file: &Path, place: &Path) -> io::Result<()> {
        if let Some(folder) = place.parent() {
            self.create_folder(folder)?;
        }
        self.remove(place)?;
        std::fs::rename(file, place)?;
        self.done.push(Step::MovedHere { place: place.to_owned() });
        Ok(())
    }

    /// Keeps what was done.
    pub(super) fn commit(mut self) {
        self.done.clear();
    }
}

impl Drop for Transaction {
    fn drop(&mut self) {
        for step in self.done.drain(..).rev() {
            // A second failure has nowhere to go; the first one is reported.
            let _ = match step {
                Step::CreatedFolder(path) => std::fs::remove_dir(path),
                Step::MovedAway { place, backup } => std::fs::rename(backup, place),
                Step::MovedHere { place } => std::fs::remove_file(place),
            };
        }
    }
}
