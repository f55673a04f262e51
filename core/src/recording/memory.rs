//! Logs that a program holds in memory: they have names in angle brackets, as `<monday>`, which stand where files are named. They
//! are read as files are: columns by their names, rows that cannot be used left out, the clock and the units examined.

use super::Recording;
use super::formats::written;
use crate::error::Result;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// The logs held by this program, by name.
static HELD: Mutex<BTreeMap<PathBuf, Arc<Table>>> = Mutex::new(BTreeMap::new());

/// A log in memory as a table.
#[derive(Debug)]
pub(super) struct Table {
    /// Names of the columns.
    pub header: Vec<String>,
    recording: Recording,
    named: bool,
}

impl Table {
    /// The columns that are `used`; the others are empty.
    pub(super) fn columns(&self, used: &[usize]) -> Result<Vec<Vec<f64>>> {
        let columns = written::table(&self.recording, self.named)?;
        let wanted = |(index, (_, values)): (usize, &(String, &[f64]))| match used.contains(&index) {
            true => values.to_vec(),
            false => Vec::new(),
        };
        Ok(columns.iter().enumerate().map(wanted).collect())
    }
}

/// A log that can be read under [`Held::path`] until this is dropped.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::recording::memory::Held;
/// use tauscope::recording::{self, lenient};
///
/// // A log of this program is read as a file is, until it is dropped.
/// let log = recording::load("../tests/reference/payload/before.csv", None)?;
/// let held = Held::new("monday", log)?;
/// let path = held.path().to_owned();
/// assert!(lenient::load(&path, None, &Default::default()).is_ok());
/// drop(held);
/// assert!(lenient::load(&path, None, &Default::default()).is_err());
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug)]
pub struct Held {
    path: PathBuf,
}

impl Held {
    /// Holds a log under `name`, with a number behind it where another has it. Joints called `joint_1`, `joint_2` and so on count as
    /// numbered, and become the robot's joints in their order.
    ///
    /// ```
    /// # extern crate tauscope_core as tauscope;
    /// use tauscope::channels::Channels;
    /// use tauscope::recording::lenient::{self, ColumnMap};
    /// use tauscope::recording::memory::Held;
    /// use tauscope::recording::Recording;
    ///
    /// let signal = |scale: f64| Channels::from_vectors(&[(0..100).map(|k| (scale * f64::from(k)).sin()).collect()]);
    /// let time: Vec<f64> = (0..100).map(|k| 0.01 * f64::from(k)).collect();
    /// let log = Recording::new(["elbow"], time, signal(0.1), signal(0.2))?;
    ///
    /// let held = Held::new("monday", log)?;
    /// assert_eq!(held.path().to_str(), Some("<monday>"));
    /// assert_eq!(lenient::load(held.path(), None, &ColumnMap::default())?.recording.joints, ["elbow"]);
    /// # Ok::<(), tauscope::error::Error>(())
    /// ```
    ///
    /// # Errors
    /// Signals of different shapes.
    pub fn new(name: &str, recording: Recording) -> Result<Held> {
        let named = !recording.is_numbered();
        let header = written::table(&recording, named)?.into_iter().map(|(name, _)| name).collect();
        let table = Arc::new(Table { header, recording, named });
        let mut held = HELD.lock().unwrap_or_else(PoisonError::into_inner);
        let numbered = (2..).map(|number| PathBuf::from(format!("<{name} {number}>")));
        let mut names = std::iter::once(PathBuf::from(format!("<{name}>"))).chain(numbered);
        let path = names.find(|path| !held.contains_key(path)).unwrap_or_default();
        held.insert(path.clone(), table);
        Ok(Held { path })
    }

    /// What to name in the place of a file.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

impl Drop for Held {
    fn drop(&mut self) {
        HELD.lock().unwrap_or_else(PoisonError::into_inner).remove(&self.path);
    }
}

/// The log that is held under a name.
pub(super) fn find(path: &Path) -> Option<Arc<Table>> {
    HELD.lock().unwrap_or_else(PoisonError::into_inner).get(path).cloned()
}

/// Whether a path names a log in memory.
pub(crate) fn is_held(path: &Path) -> bool {
    find(path).is_some()
}

#[cfg(test)]
mod tests {
    #[cfg(feature = "parquet")]
    use super::super::lenient::{self, ColumnMap};
    #[cfg(feature = "parquet")]
    use super::super::parquet;
    use super::super::samples;
    use super::*;

    #[cfg(feature = "parquet")]
    #[test]
    fn a_log_in_memory_is_read_as_its_file() {
        let folder = tempfile::tempdir().unwrap();
        let mut log = samples::full(3, 40);
        log.provenance.clear();
        log.robot.clear();
        for names in [["hip", "knee", "toe"], ["joint_1", "joint_2", "joint_3"]] {
            log.joints = names.map(str::to_owned).to_vec();
            let file = folder.path().join("log.parquet");
            parquet::write(&file, &log).unwrap();
            let held = Held::new("log", log.clone()).unwrap();
            let joints = names.map(str::to_owned);
            let read = |path: &Path| lenient::load(path, Some(&joints), &ColumnMap::default()).unwrap();
            let (from_memory, from_file) = (read(held.path()), read(&file));
            assert_eq!(samples::bits(&from_memory.recording), samples::bits(&from_file.recording));
            assert_eq!((from_memory.lines, from_memory.rejected), (from_file.lines, from_file.rejected));
        }
    }

    #[test]
    fn names_are_given_once_and_given_back() {
        let hold = || Held::new("twice", samples::full(1, 3)).unwrap();
        let (first, second) = (hold(), hold());
        assert_eq!([first.path(), second.path()], [Path::new("<twice>"), Path::new("<twice 2>")]);
        assert!(is_held(first.path()));
        drop(first);
        assert!(!is_held(Path::new("<twice>")) && is_held(second.path()));
        assert_eq!(hold().path(), Path::new("<twice>"));
    }
}
