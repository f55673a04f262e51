//! Folders of results that are written whole or not at all.
//!
//! Files are written to a hidden folder on the same file system and moved to their place by
//! [`ResultFolder::finish`]. `manifest.json` lists what was written, so that the next run in the same folder can remove
//! what it no longer writes, and nothing else.

mod transaction;

pub(crate) use crate::internal::{json, measured, significant};

use crate::error::{Error, Result};
use crate::internal::pretty;
use serde::{Deserialize, Serialize};
use std::cell::OnceCell;
use std::collections::BTreeSet;
use std::fs::File;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use tempfile::TempDir;
use transaction::Transaction;

const MANIFEST: &str = "manifest.json";
const MANIFEST_SCHEMA: &str = "tauscope.manifest/1";

/// A folder of results in the making. Dropped before [`ResultFolder::finish`], it leaves no trace.
#[derive(Debug)]
pub struct ResultFolder {
    target: PathBuf,
    /// Where the hidden folder is made.
    place: PathBuf,
    /// Made with the first file, so that a run that is killed while it computes leaves nothing behind.
    staging: OnceCell<TempDir>,
}

#[derive(Serialize, Deserialize)]
struct Manifest {
    schema: String,
    /// Names in the folder, with `/` between folder and file.
    files: BTreeSet<String>,
}

impl ResultFolder {
    /// Prepares to write the folder `path`, which need not exist. Nothing in it changes before
    /// [`ResultFolder::finish`].
    ///
    /// # Errors
    /// [`Error::Io`] if `path` is a file, cannot be written to, or has a `manifest.json` of another program.
    pub fn create(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let failed = |source| Error::io(path, "write results to this folder", source);
        let target = std::path::absolute(path).map_err(failed)?;
        let exists = target.try_exists().unwrap_or(false);
        if exists && !target.is_dir() {
            return Err(failed(io::Error::new(ErrorKind::NotADirectory, "it is a file; name a folder")));
        }
        let target = if exists { target.canonicalize().map_err(failed)? } else { target };
        previous_files(&target)?;
        // Whether it can be written is found out now rather than when hours of work are to be moved.
        let place = if exists {
            tempfile::tempfile_in(&target).map_err(failed)?;
            place_beside(&target).unwrap_or_else(|| target.clone())
        } else {
            target.ancestors().find(|ancestor| ancestor.exists()).unwrap_or(Path::new(".")).to_owned()
        };
        drop(staging_in(&place).map_err(failed)?);
        Ok(ResultFolder { target, place, staging: OnceCell::new() })
    }

    fn staging(&self) -> io::Result<&Path> {
        if let Some(staging) = self.staging.get() {
            return Ok(staging.path());
        }
        let made = staging_in(&self.place)?;
        Ok(self.staging.get_or_init(|| made).path())
    }

    /// Where to write the file that will be called `name` in the folder. Names may have folders in front, as in
    /// `plots/joint_1.svg`; these are made.
    ///
    /// # Errors
    /// [`Error::Io`] if `name` points out of the folder or is `manifest.json`, or its folder cannot be made.
    pub fn file(&self, name: &str) -> Result<PathBuf> {
        let failed = |source| Error::io(self.target.join(name), "write this result", source);
        if !is_inside(name) || name == MANIFEST {
            let problem = "names of results are relative, as in plots/joint_1.svg, and not manifest.json";
            return Err(failed(io::Error::new(ErrorKind::InvalidInput, problem)));
        }
        let path = self.staging().map_err(failed)?.join(name);
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder).map_err(failed)?;
        }
        Ok(path)
    }

    /// Writes a file by `write`, which gets its path.
    ///
    /// # Errors
    /// Those of [`ResultFolder::file`] and of `write`, with the name the file was to have instead of where it was written.
    pub fn write_with(&self, name: &str, write: impl FnOnce(&Path) -> Result<()>) -> Result<()> {
        let staged = self.file(name)?;
        write(&staged).map_err(|error| error.named(&staged, self.target.join(name)))
    }

    /// Writes a text.
    ///
    /// # Errors
    /// [`Error::Io`] if `name` is refused by [`ResultFolder::file`] or the file cannot be written.
    pub fn write_text(&self, name: &str, text: &str) -> Result<()> {
        let path = self.file(name)?;
        std::fs::write(path, text).map_err(|source| Error::io(self.target.join(name), "write this result", source))
    }

    /// Writes a JSON object with `schema`, the name and version of its layout, as its first field.
    ///
    /// # Errors
    /// [`Error::Io`] if `name` is refused by [`ResultFolder::file`], the file cannot be written, or `value` is not an
    /// object or has a field `schema` of its own.
    pub fn write_json(&self, name: &str, schema: &str, value: &impl Serialize) -> Result<()> {
        let path = self.file(name)?;
        let written = File::create(path).and_then(|file| json(file, schema, value));
        written.map_err(|source| Error::io(self.target.join(name), "write this result", source))
    }

    /// Moves all files to their place, over files of the same names; removes what the manifest of an earlier run lists
    /// and this run did not write; writes `manifest.json` last. Other files are not touched. Returns the folder.
    ///
    /// # Errors
    /// [`Error::Io`]; the folder is then as before.
    pub fn finish(self) -> Result<PathBuf> {
        let failed = |source| Error::io(&self.target, "write results to this folder", source);
        let old = previous_files(&self.target)?;
        let mut files = BTreeSet::new();
        let staging = self.staging().map_err(failed)?;
        collect(staging, "", &mut files).map_err(failed)?;
        let manifest = Manifest { schema: MANIFEST_SCHEMA.to_owned(), files };
        let staged_manifest = staging.join(MANIFEST);
        File::create(staged_manifest).and_then(|file| pretty(file, &manifest)).map_err(failed)?;
        for name in manifest.files.iter().map(String::as_str).chain([MANIFEST]) {
            let synced = File::open(staging.join(name)).and_then(|file| file.sync_all());
            synced.map_err(|source| Error::io(self.target.join(name), "write this result", source))?;
        }

        // Beside the staged files' folder, where no name of a result can be.
        let backup = staging_in(staging).map_err(failed)?;
        let mut transaction = Transaction::new(backup);
        let at = |name: &str, source| Error::io(self.target.join(name), "move this result to its place", source);
        transaction.create_folder(&self.target).map_err(failed)?;
        for name in old.difference(&manifest.files) {
            transaction.remove(&self.target.join(name)).map_err(|source| at(name, source))?;
        }
        for name in manifest.files.iter().map(String::as_str).chain([MANIFEST]) {
            let moved = transaction.replace(&staging.join(name), &self.target.join(name));
            moved.map_err(|source| at(name, source))?;
        }
        transaction.commit();
        for name in old.difference(&manifest.files) {
            remove_empty_folders(&self.target, name);
        }
        sync_folder(&self.target);
        Ok(self.target)
    }
}

/// The folder of `target`, if it can be written and is on the same file system; that of a mounted folder is not.
fn place_beside(target: &Path) -> Option<PathBuf> {
    let parent = target.parent()?;
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        if parent.metadata().ok()?.dev() != target.metadata().ok()?.dev() {
            return None;
        }
    }
    staging_in(parent).ok().map(|_| parent.to_owned())
}

fn staging_in(folder: &Path) -> io::Result<TempDir> {
    tempfile::Builder::new().prefix(".tauscope-").tempdir_in(folder)
}

/// Whether `name` is a plain relative path of folders and a file.
fn is_inside(name: &str) -> bool {
    name.split('/').all(|part| !matches!(part, "" | "." | "..") && !part.contains(['\\', ':', '\0']))
}

/// What the manifest of an earlier run lists; nothing if there is none.
fn previous_files(target: &Path) -> Result<BTreeSet<String>> {
    let path = target.join(MANIFEST);
    let failed = |source| Error::io(&path, "read what an earlier run wrote", source);
    let text = match std::fs::read_to_string(&path) {
        Ok(text) => text,
        Err(error) if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => {
            return Ok(BTreeSet::new());
        }
        Err(error) => return Err(failed(error)),
    };
    let manifest = serde_json::from_str::<Manifest>(&text).ok().filter(|manifest| manifest.schema == MANIFEST_SCHEMA);
    let Some(manifest) = manifest else {
        let problem = "this manifest was not written by tauscope; choose another folder for the results";
        return Err(failed(io::Error::new(ErrorKind::InvalidData, problem)));
    };
    // A manifest edited by hand must not make files elsewhere disappear.
    Ok(manifest.files.into_iter().filter(|name| is_inside(name)).collect())
}

fn collect(folder: &Path, prefix: &str, files: &mut BTreeSet<String>) -> io::Result<()> {
    for entry in std::fs::read_dir(folder)? {
        let entry = entry?;
        let name = entry.file_name();
        let name = name.to_str().ok_or_else(|| io::Error::new(ErrorKind::InvalidData, "a name is not UTF-8"))?;
        let name = format!("{prefix}{name}");
        if entry.file_type()?.is_dir() {
            collect(&entry.path(), &format!("{name}/"), files)?;
        } else {
            files.insert(name);
        }
    }
    Ok(())
}

/// Removes the folders of a removed file that are empty now.
fn remove_empty_folders(target: &Path, name: &str) {
    let folders = Path::new(name).ancestors().skip(1).filter(|folder| !folder.as_os_str().is_empty());
    for folder in folders {
        if std::fs::remove_dir(target.join(folder)).is_err() {
            return;
        }
    }
}

/// Makes new names survive a power cut where the system can; some file systems cannot, and the results are whole anyway.
fn sync_folder(folder: &Path) {
    if let Ok(folder) = File::open(folder) {
        let _ = folder.sync_all();
    }
}

#[cfg(test)]
mod tests;
